//! A frame of the box with the cloud, what volume shells make of it and what is right.

use super::cloud_box::cloud_box;
use crate::stages::{Cost, Stage};
use anyhow::{Context, Result};
use deepshade::shared::arguments::Size;
use deepshade_render::bvh::TracedScene;
use deepshade_render::methods::volume_shell::VolumeShellParameters;
use deepshade_render::methods::volume_shell::direct::Direct;
use deepshade_render::metrics::{exposed, exposure, relative_mse};
use deepshade_render::path::{self, Sampling, Shot};
use deepshade_render::raster::frame::{Frame, FrameStage, RasterSettings};
use deepshade_render::screen::{Inputs, MethodPasses, ScreenMethod, View};
use deepshade_shaders::gpu::{self, Gpu, GpuError};
use deepshade_shaders::{Attribute, Effect, Planes};

/// How far effects reach, over the scene's diagonal, as where nothing else is asked for.
const RADIUS: f32 = 0.05;
/// Edge of shadow maps, texels.
const SHADOW_SIZE: usize = 1024;
/// What is computed.
const EFFECT: Effect = Effect::FogIndirect;

/// The frame.
pub struct ShellFrame<'a> {
    gpu: &'a Gpu,
    scene: TracedScene,
    frame: Frame,
    view: View,
}

/// An image by some parameters, and what it took.
pub struct Shaded {
    /// `[3, height, width]`.
    pub image: Planes,
    /// Milliseconds of its stages.
    pub cost: Cost,
}

impl<'a> ShellFrame<'a> {
    /// Makes it.
    ///
    /// # Errors
    /// If the device has no room.
    pub fn new(gpu: &'a Gpu, Size { width, height }: Size) -> Result<Self> {
        let (scene, camera) = cloud_box()?;
        let scene = TracedScene::new(scene)?;
        let attributes = vec![Attribute::Position, Attribute::Normal, Attribute::Light, Attribute::Valid];
        let settings = RasterSettings { height, width, attributes, shadow_size: Some(SHADOW_SIZE) };
        let mut frame = Frame::new(gpu, &scene.scene().clone().into(), &settings)?;
        frame.set(&gpu.queue, 0.0, 0.0, &camera);
        gpu::submit(&gpu.device, &gpu.queue, "bench.volume-shell", |encoder| {
            FrameStage::ALL.into_iter().for_each(|stage| frame.encode(stage, encoder, None));
        })?;
        let view = View { height, width, camera, radius: RADIUS * scene.diagonal(), seed: 0 };
        Ok(Self { gpu, scene, frame, view })
    }

    /// Indirect light that the cloud scatters.
    ///
    /// # Errors
    /// If the device fails.
    pub fn shaded(&self, parameters: VolumeShellParameters, runs: usize) -> Result<Shaded> {
        let method = ScreenMethod::new(self.gpu, parameters);
        self.measured(&method, runs).context("volume-shell")
    }

    /// Milliseconds of direct light that the cloud scatters, but for its intervals.
    ///
    /// # Errors
    /// If the device fails.
    pub fn direct(&self, parameters: VolumeShellParameters, runs: usize) -> Result<f64> {
        let method = ScreenMethod::new(self.gpu, Direct(parameters));
        let shaded = self.measured(&method, runs).context("volume-shell of fog-direct")?;
        Ok(shaded.cost.of_stage(Stage::Direct))
    }

    /// Milliseconds of the shadow maps.
    ///
    /// # Errors
    /// If the device fails.
    pub fn shadow_maps(&self, runs: usize) -> Result<f64> {
        let Gpu { device, queue, .. } = self.gpu;
        let draw = |encoder: &mut wgpu::CommandEncoder| self.frame.encode(FrameStage::Shadows, encoder, None);
        Ok(gpu::time(device, queue, "shadow maps", 1, runs, draw)?.milliseconds)
    }

    /// Path-traced truth of so many samples a pixel.
    pub fn truth(&self, samples: u32) -> Planes {
        let View { height, width, camera, radius, .. } = self.view;
        let shot = Shot::new(&self.scene, &camera, [height, width], radius);
        path::render(EFFECT, &shot, Sampling::one(samples, 1)).mean
    }

    fn measured(&self, method: &ScreenMethod, runs: usize) -> Result<Shaded, GpuError> {
        let inputs =
            Inputs { gbuffer: self.frame.gbuffer(), environment: None, world: Some(self.frame.world()) };
        let passes = MethodPasses::new(method, &inputs, &self.view)?;
        let cost = Cost::of(self.gpu, &passes, runs)?;
        let data = gpu::read(&self.gpu.device, &self.gpu.queue, passes.output())?;
        Ok(Shaded { image: Planes::from_data(3, self.view.height, self.view.width, data), cost })
    }
}

/// Relative squared error under the exposure of truth.
pub fn error(image: &Planes, truth: &Planes) -> f64 {
    let exposure = exposure(EFFECT, truth);
    relative_mse(&exposed(image, exposure), &exposed(truth, exposure))
}
