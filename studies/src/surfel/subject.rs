//! A frame of a scene on the GPU, with all that shading by surfels reads.

use super::Args;
use crate::stages;
use anyhow::{Result, bail};
use deepshade::shared::animated_view::{self, AnimatedView};
use deepshade::shared::arguments::Size;
use deepshade_render::methods::Quality;
use deepshade_render::methods::disks::Disks;
use deepshade_render::methods::surfel;
use deepshade_render::raster::frame::{Frame, FrameStage, RasterSettings};
use deepshade_render::raster::patches::{self, Reflectance};
use deepshade_render::screen::{Inputs, MethodPasses, ScreenMethod, View};
use deepshade_render::surfels::{self, Surfel, reference};
use deepshade_shaders::gpu::{self, Gpu, GpuError};
use deepshade_shaders::{Attribute, Effect};
use std::f64::consts::PI;

/// How far effects reach, over the scene's diagonal.
const RADIUS: f32 = 0.05;
/// So far that no surfel is left out, over the scene's diagonal.
const EVERYWHERE: f32 = 10.0;
/// Edge of shadow maps, texels.
const SHADOW_SIZE: usize = 1024;

/// The scene that is measured, with what the effects need, as a camera sees it that is the same for all
/// sizes.
///
/// # Errors
/// If the scene cannot be read.
pub fn open(args: &Args, effects: &[Effect]) -> Result<AnimatedView> {
    let Some(Size { width, height }) = args.sizes.first() else { bail!("--sizes names no size") };
    animated_view::plain(&args.scene, &args.viewpoint, effects, [*height, *width])
}

/// The frame.
pub struct SurfelFrame<'a> {
    gpu: &'a Gpu,
    animated_view: &'a AnimatedView,
    frame: Frame,
    /// From where it is seen.
    pub view: View,
}

impl<'a> SurfelFrame<'a> {
    /// Makes it; effects reach `radius` metres, or as far as they do by default.
    ///
    /// # Errors
    /// If the device has no room.
    pub fn new(
        gpu: &'a Gpu,
        animated_view: &'a AnimatedView,
        radius: Option<f32>,
        Size { width, height }: Size,
        attributes: &[Attribute],
    ) -> Result<Self, GpuError> {
        let mut attributes = attributes.to_vec();
        // The frame shows light; areas, memory and sweeps are of ambient occlusion.
        attributes.extend([Attribute::Light, Attribute::Position, Attribute::Normal, Attribute::Valid]);
        attributes.sort_unstable();
        attributes.dedup();
        let settings = RasterSettings { height, width, attributes, shadow_size: Some(SHADOW_SIZE) };
        let mut frame = Frame::new(gpu, &animated_view.animated, &settings)?;
        frame.set(&gpu.queue, 0.0, 0.0, &animated_view.camera);
        gpu::submit(&gpu.device, &gpu.queue, "bench.surfel", |encoder| {
            FrameStage::ALL.into_iter().for_each(|stage| frame.encode(stage, encoder, None));
        })?;
        let radius = radius.unwrap_or(RADIUS * animated_view.diagonal);
        let view = View { height, width, camera: animated_view.camera, radius, seed: 0 };
        Ok(Self { gpu, animated_view, frame, view })
    }

    /// What methods read.
    pub fn inputs(&self) -> Inputs<'_> {
        let environment = self.animated_view.animated.scene.environment.as_deref();
        Inputs { gbuffer: self.frame.gbuffer(), environment, world: Some(self.frame.world()) }
    }

    /// Of the scene.
    pub fn triangles(&self) -> usize {
        self.animated_view.animated.scene.meshes.iter().map(|mesh| mesh.triangles.len()).sum()
    }

    /// Parts of its surface that surfels are laid out on.
    pub fn patches(&self) -> usize {
        self.frame.world().patches(Reflectance::Diffuse).len()
    }

    /// By how much the areas of all surfels together miss that of the surface, as a share of it. For that
    /// nothing is left out for being out of view.
    ///
    /// # Errors
    /// If the device fails.
    pub fn area_error(&self, quality: Quality) -> Result<f64, GpuError> {
        let view = View { radius: EVERYWHERE * self.animated_view.diagonal, ..self.view };
        let usual = surfel::SurfelParameters::of(quality);
        let near = usual.surfels.near * self.view.radius / view.radius;
        let parameters =
            surfel::SurfelParameters { surfels: surfels::SurfelDensity { near, ..usual.surfels }, ..usual };
        let method = ScreenMethod::new(self.gpu, Disks::new(parameters, surfel::occlusion::OCCLUSION));
        let passes = MethodPasses::new(&method, &self.inputs(), &view)?;
        let found = self.surfel_area(&passes)?;
        let scene = &self.animated_view.animated.scene;
        let vertices = reference::vertices(scene.meshes.iter(), &view.camera);
        Ok(found / patches::covered_area(self.frame.world().patches(Reflectance::Diffuse), &vertices) - 1.0)
    }

    /// The area of all surfels that a method's passes lay out, m².
    fn surfel_area(&self, passes: &MethodPasses) -> Result<f64, GpuError> {
        let Gpu { device, queue, .. } = self.gpu;
        let laying = passes.steps().iter().take_while(|step| stages::Stage::is_laying(step));
        let laying: Vec<_> = laying.collect();
        gpu::submit(device, queue, "bench.surfel", |encoder| {
            laying.iter().for_each(|step| step.step.encode(encoder, "surfels", None));
        })?;
        let [count, _] = stages::surfels(self.gpu, passes)?;
        let Some(made) = laying.last().and_then(|step| step.writes.last()) else { return Ok(0.0) };
        let bytes = u64::from(count) * size_of::<Surfel>() as u64;
        let made: Vec<Surfel> = gpu::read_part(device, queue, made, 0, bytes)?;
        Ok(made.iter().map(|surfel| PI * f64::from(surfel.radius()).powi(2)).sum())
    }
}
