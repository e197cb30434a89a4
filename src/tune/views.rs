//! What parameters are tuned on: validation views of a dataset, with their truth.

use anyhow::{Context, Result};
use deepshade_dataset::{Dataset, Props, SceneRecord, StagedScene};
use deepshade_render::bvh::TracedScene;
use deepshade_render::method::{Frame, Method, Repeats};
use deepshade_render::metrics::{exposed, exposure, ssim};
use deepshade_render::scene::Camera;
use deepshade_shaders::{GBuffer, Planes};
use std::fmt::{Display, Formatter};
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
    seed: u32,
}

impl View {
    /// The views of some pairs, with the g-buffer in full precision, as methods get it.
    ///
    /// # Errors
    /// If a scene or a pair cannot be read.
    pub fn open(dataset: &Dataset, props: &Props, pairs: &[usize]) -> Result<Vec<Self>> {
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
            let gbuffer = staged.gbuffer(&scene, &record.camera, record.seed);
            let exposure = exposure(dataset.recipe().effect, &target);
            let target = exposed(&target, exposure);
            let (camera, radius, seed) = (record.camera, record.radius, record.seed);
            Ok(Self { scene, camera, gbuffer, target, exposure, radius, seed })
        };
        pairs.iter().map(view).collect()
    }
}

/// How near to truth a method is on average, and how fast.
#[derive(Clone, Copy, Debug)]
pub struct Timed {
    /// Mean structural similarity.
    pub ssim: f64,
    /// Mean time.
    pub milliseconds: f64,
}

impl Display for Timed {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "ssim {:.4}, {:.1} ms", self.ssim, self.milliseconds)
    }
}

/// How similar to truth a method's image of each view is.
///
/// # Errors
/// If the method fails.
pub fn similarities(method: &dyn Method, views: &[View]) -> Result<Vec<f64>> {
    views.iter().map(|view| Ok(shown(method, view, Repeats::ONCE)?.0)).collect()
}

/// The same on average, with the time that it takes once it is warm.
///
/// # Errors
/// If the method fails.
pub fn timed(method: &dyn Method, views: &[View]) -> Result<Timed> {
    let (mut ssim, mut milliseconds) = (0.0, 0.0);
    for view in views {
        let (similarity, time) = shown(method, view, Repeats { warm_up: 1, timed: 3 })?;
        (ssim, milliseconds) = (ssim + similarity, milliseconds + time);
    }
    let count = views.len() as f64;
    Ok(Timed { ssim: ssim / count, milliseconds: milliseconds / count })
}

/// How similar to truth a method's image of a view is, and the median time that it took, milliseconds.
fn shown(method: &dyn Method, view: &View, repeats: Repeats) -> Result<(f64, f64)> {
    let View { scene, camera, gbuffer, target, exposure, radius, seed } = view;
    let frame = Frame { scene, camera, gbuffer, radius: *radius, seed: *seed };
    let shaded = method.shade(&frame, repeats)?;
    Ok((ssim(&exposed(&shaded.image, *exposure), target), shaded.milliseconds))
}
