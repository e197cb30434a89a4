//! The room in frames on the GPU, and what methods make of it.

use super::cornell::room;
use anyhow::{Context, Result};
use deepshade::shared::arguments::Size;
use deepshade_render::bvh::TracedScene;
use deepshade_render::gbuffer;
use deepshade_render::path::{self, Sampling, Shot};
use deepshade_render::raster::frame::{Frame, FrameStage, RasterSettings};
use deepshade_render::scene::Glow;
use deepshade_render::screen::{Inputs, MethodPasses, ScreenMethod, View};
use deepshade_shaders::gpu::{self, Gpu};
use deepshade_shaders::{Attribute, Effect, Planes};
use std::sync::Arc;

/// Edge of shadow maps, texels.
const SHADOW_SIZE: usize = 1024;

/// The room and its camera.
pub struct GlowingRoom<'a> {
    gpu: &'a Gpu,
    scene: TracedScene,
    frame: Frame,
    view: View,
}

impl<'a> GlowingRoom<'a> {
    /// The room under a lamp of so many W/sr that shines at these times; `all` is whether every surface keeps
    /// light.
    ///
    /// # Errors
    /// If the device has no room.
    pub fn new(
        gpu: &'a Gpu,
        Size { width, height }: Size,
        intensity: f32,
        all: bool,
        on: Vec<[f32; 2]>,
    ) -> Result<Self> {
        let (scene, camera) = room(intensity, all, on)?;
        let attributes = vec![
            Attribute::Position,
            Attribute::Normal,
            Attribute::ObjectId,
            Attribute::DiffuseLight,
            Attribute::Diffuse,
            Attribute::Valid,
        ];
        let settings = RasterSettings { height, width, attributes, shadow_size: Some(SHADOW_SIZE) };
        let frame = Frame::new(gpu, &scene.clone().into(), &settings)?;
        let scene = TracedScene::new(scene)?;
        let view = View { height, width, camera, radius: scene.diagonal(), seed: 0 };
        Ok(Self { gpu, scene, frame, view })
    }

    /// The passes of a method.
    ///
    /// # Errors
    /// If the device has no room.
    pub fn passes(&self, method: &ScreenMethod) -> Result<MethodPasses> {
        let inputs =
            Inputs { gbuffer: self.frame.gbuffer(), environment: None, world: Some(self.frame.world()) };
        Ok(MethodPasses::new(method, &inputs, &self.view)?)
    }

    /// Makes the frame of a moment, and with it what plans make of it.
    ///
    /// # Errors
    /// If the device fails.
    pub fn make(&mut self, moment: f32, plans: &[&MethodPasses]) -> Result<()> {
        let Gpu { device, queue, .. } = self.gpu;
        self.frame.set(queue, moment, 0.0, &self.view.camera);
        gpu::submit(device, queue, "bench.phosphor", |encoder| {
            FrameStage::ALL.into_iter().for_each(|stage| self.frame.encode(stage, encoder, None));
            plans.iter().for_each(|passes| passes.encode(encoder));
        })?;
        Ok(())
    }

    /// What passes have made.
    ///
    /// # Errors
    /// If the device fails.
    pub fn image(&self, passes: &MethodPasses) -> Result<Planes> {
        let data = gpu::read(&self.gpu.device, &self.gpu.queue, passes.output())?;
        Ok(Planes::from_data(3, self.view.height, self.view.width, data))
    }

    /// An attribute of the frame that was made last.
    ///
    /// # Errors
    /// If the device fails.
    pub fn attribute(&self, attribute: Attribute) -> Result<Planes> {
        let buffer = self.frame.gbuffer().buffer(attribute);
        let data = gpu::read(&self.gpu.device, &self.gpu.queue, buffer)?;
        Ok(Planes::from_data(attribute.width(), self.view.height, self.view.width, data))
    }

    /// The same by rays.
    pub fn traced(&self, attribute: Attribute) -> Planes {
        let View { height, width, camera, .. } = self.view;
        gbuffer::render(&self.scene, &camera, height, width, &[attribute]).planes().clone()
    }

    /// Milliseconds of passes, of the frame that was made last.
    ///
    /// # Errors
    /// If the device fails.
    pub fn milliseconds(&self, passes: &MethodPasses, runs: usize) -> Result<f64> {
        let Gpu { device, queue, .. } = self.gpu;
        Ok(gpu::time(device, queue, "bench.phosphor", 1, runs, |encoder| passes.encode(encoder))?
            .milliseconds)
    }

    /// Milliseconds of the step of all states alone, and the texels that have them.
    ///
    /// # Errors
    /// If the device fails.
    pub fn step(&self, passes: &MethodPasses, runs: usize) -> Result<(f64, usize)> {
        let Gpu { device, queue, .. } = self.gpu;
        let [.., step, _] = passes.steps() else { unreachable!("it ends with the step and what is shown") };
        let timing = gpu::time(device, queue, "bench.phosphor.step", 1, runs, |encoder| {
            step.step.encode(encoder, "step", None);
        })?;
        let states = self.frame.world().glow.states();
        let texels = step.writes.first().context("states")?.size() as usize / 8 / states;
        Ok((timing.milliseconds, texels))
    }

    /// Truth at a moment, of so many samples a pixel.
    ///
    /// # Errors
    /// If the scene cannot look like that, which it can.
    pub fn truth(&self, effect: Effect, moment: f32, samples: u32) -> Result<Planes> {
        let mut look = self.scene.scene().look();
        let glow = Glow { moment, ..Glow::of(self.scene.scene()).clone() };
        look.glow = Some(Arc::new(glow));
        let scene = self.scene.with_look(look)?;
        let View { height, width, camera, radius, .. } = self.view;
        let shot = Shot::new(&scene, &camera, [height, width], radius);
        Ok(path::render(effect, &shot, Sampling::one(samples, 1)).mean)
    }
}
