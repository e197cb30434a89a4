//! `gpu-march`: single scattering by steps along every view ray, on the GPU.
//!
//! What [`ray_march`](super::ray_march) does on the processor, with the frame's shadow maps. Steps are as
//! many on every ray and shifted by a number of the pixel's own; towards local lamps they are of equal angle,
//! as seen from the lamp, which bring the same light each (Kulla and Fajardo 2012). What a step scatters, it
//! scatters evenly, and what is left of that at the eye is exact.
//!
//! Why it: nothing lies between it and the medium, grids neither; the reference of a frame loop. Why not: it
//! costs pixels times steps times lamps, which are passes of their own.
//!
//! Limits. Light of point, spot and directional lights only. Shadows are as fine as the frame's maps; through
//! grids the way to a lamp is 32 points.

pub mod reference;
#[cfg(test)]
mod tests;

use super::{Quality, single_scattering};
use crate::raster::light::shadow_sampler;
use crate::screen::{About, MethodStep, PassDispatch, PlainInputs, Resources, Technique, View, Written};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::{Shader, uniforms};
use deepshade_shaders::{Attribute, Effect, MissingAttribute};

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct FogMarchParameters {
    /// Steps along each view ray, for each lamp.
    #[schemars(range(min = 1, max = 4096))]
    pub steps: u32,
}

impl FogMarchParameters {
    /// More time is more steps.
    pub const fn of(quality: Quality) -> Self {
        let steps = match quality {
            Quality::Low => 16,
            Quality::Medium => 32,
            Quality::High => 96,
            Quality::Ultra => 384,
        };
        Self { steps }
    }

    /// What the pass reads.
    pub fn settings(self, view: &View) -> uniforms::FogMarch {
        let (width, height) = (view.width as u32, view.height as u32);
        uniforms::FogMarch { width, height, steps: self.steps.max(1), seed: view.seed }
    }
}

impl Technique for FogMarchParameters {
    fn about(&self) -> About {
        About::beyond_screen("gpu-march", Effect::FogDirect, single_scattering::ATTRIBUTES)
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        let camera = view.perspective();
        vec![bytes_of(&self.settings(view)).to_vec(), bytes_of(&camera).to_vec()]
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        let (device, world, output) = (to.device, to.scene()?, to.output);
        let pass = device.pass(Shader::at("methods/fog-march/march"), &[("MEDIUM", world.medium.kind)])?;
        let sampler = shadow_sampler(device);
        let [valid, position] = to.seen([Attribute::Valid, Attribute::Position]);
        let [settings, view] = to.uniforms else { unreachable!("it has two uniform buffers") };
        let of_lamp = |number: u32| {
            let lamp = gpu::uniform(device, "fog-march.lamp", &uniforms::OfLamp { number })?;
            let own = [(0, settings), (1, view), (7, valid), (8, position), (9, output), (13, &lamp)];
            let own = own.map(|(binding, buffer)| (binding, buffer.as_entire_binding()));
            let resources = own.into_iter().chain(single_scattering::bindings(
                world,
                &world.gpu_lights.records,
                &sampler,
            ));
            let pass = pass.bind_at(device, resources)?;
            Ok(MethodStep {
                step: PassDispatch { pass, workgroups: to.whole().into() },
                writes: vec![output.clone()],
            })
        };
        (0..world.gpu_lights.count as u32).map(of_lamp).collect()
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        inputs.image_of_scene(|scene| reference::shade(inputs.gbuffer, scene, *self, view))
    }
}
