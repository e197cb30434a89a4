//! What parameters are tuned on: validation views of a dataset, with their truth.

use anyhow::{Context, Result};
use deepshade_dataset::{Dataset, Props, SceneRecord, StagedScene, truth};
use deepshade_render::bvh::TracedScene;
use deepshade_render::gbuffer;
use deepshade_render::method::{Frame, Method, Repeats};
use deepshade_render::metrics::{exposed, exposure, ssim};
use deepshade_render::scene::Camera;
use deepshade_shaders::{GBuffer, Planes};
use std::rc::Rc;
use std::sync::Arc;

/// A validation view with its truth.
pub struct View {
    /// Views of a scene share it where nothing varies.
    scene: Arc<TracedScene>,
    camera: Camera,
    gbuffer: GBuffer,
    /// As light as it is compared.
    target: Planes,
    /// What images are multiplied by before they are.
    exposure: f32,
    radius: f32,
}

impl View {
    /// The views of some pairs, with the g-buffer in full precision, as methods get it.
    ///
    /// # Errors
    /// If a scene or a pair cannot be read.
    pub fn open(dataset: &Dataset, props: &Props, pairs: &[usize]) -> Result<Vec<Self>> {
        let attributes = truth::attributes(dataset.recipe().effect);
        // Pairs of a scene follow each other.
        let mut current: Option<(&SceneRecord, Rc<StagedScene<'_>>)> = None;
        let view = |index: &usize| {
            let record = dataset.record(*index);
            let staged = match &current {
                Some((source, scene)) if **source == record.scene => Rc::clone(scene),
                _ => {
                    let scene = StagedScene::load(&record.scene, dataset.recipe(), props);
                    Rc::new(scene.context("--scenes says where scene files are")?)
                }
            };
            current = Some((&record.scene, Rc::clone(&staged)));
            let scene = staged.shown(&record.camera, record.variation.as_ref())?;
            let target = dataset.pair(*index)?.target;
            let (height, width) = (target.height(), target.width());
            let gbuffer = gbuffer::render(&scene, &record.camera, height, width, attributes);
            let exposure = exposure(dataset.recipe().effect, &target);
            let target = exposed(&target, exposure);
            Ok(Self { scene, camera: record.camera, gbuffer, target, exposure, radius: record.radius })
        };
        pairs.iter().map(view).collect()
    }
}

/// Mean structural similarity of a method to truth.
///
/// # Errors
/// If the method fails.
pub fn mean_ssim(method: &dyn Method, views: &[View]) -> Result<f64> {
    let mut sum = 0.0;
    for view in views {
        let View { scene, camera, gbuffer, target, exposure, radius } = view;
        let frame = Frame { scene, camera, gbuffer, radius: *radius, seed: 0 };
        sum += ssim(&exposed(&method.shade(&frame, Repeats::ONCE)?.image, *exposure), target);
    }
    Ok(sum / views.len() as f64)
}
