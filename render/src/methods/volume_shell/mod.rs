//! Light that surfaces throw into a medium: volume shell splatting.
//!
//! Nalbach, Ritschel and Seidel, "Deep Screen Space for Indirect Lighting of Volumes", VMV 2014 (thesis chapter 5). Each
//! pixel's ray is divided into [`intervals`] between which the transmittance to the eye falls by equal parts; surfels that the
//! lamps light through the medium scatter light into those that lie in their shells, on the levels of an interleaved
//! framebuffer as [`surfel`](super::surfel) has it. Levels are blurred by a Gaussian [`pyramid`] and added up.
//!
//! Beyond the paper: coefficients of three colours; what the medium takes between a surfel and an interval
//! ([`Parameters::attenuated`]); only the intervals are visited that a shell touches ([`Parameters::culled`]); and an interval's
//! light is the albedo times the transmittance that it takes, without a lookup of density. What is blurred is light over how
//! much the ray scatters, so that silhouettes stay sharp.
//!
//! Limits. Nothing hides surfels from the medium. What glossy surfaces reflect is left out.

pub mod intervals;
pub mod passes;
pub mod pyramid;
pub mod reference;
#[cfg(test)]
mod tests;

use super::Quality;
use super::surfel::{self, shells};
use crate::screen::{Compiled, Inputs, MethodStep, PlainInputs, Technique, View, Written};
use crate::surfels;
use deepshade_shaders::gpu::GpuError;
use deepshade_shaders::wgsl::uniforms;
use deepshade_shaders::{Attribute, Effect, MissingAttribute};
use passes::Passes;

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// How finely the scene is laid out.
    pub surfels: surfels::Parameters,
    /// The paper's epsilon: what of a surfel's effect may be left to the next coarser level, from 0 to 1.
    pub threshold: f32,
    /// Levels of the interleaved framebuffer, 1 to [`surfel::MOST_LEVELS`].
    pub levels: u32,
    /// Points of a ray's way through the medium at which density is looked up.
    pub steps: u32,
    /// Whether the medium dims light on its way from surfels.
    pub attenuated: bool,
    /// Whether only the intervals are visited that a shell touches.
    pub culled: bool,
    /// Points of the way from a surfel at which a grid's density is looked up.
    pub points: u32,
    /// The paper's delta: surfels nearer than this, over the effect's radius, do what they would at this distance.
    pub nearest: f32,
}

impl Default for Parameters {
    fn default() -> Self {
        Self::of(Quality::default())
    }
}

/// The method, compiled for a device.
pub type VolumeShell = Compiled<Parameters>;

impl Parameters {
    /// Those of a quality.
    pub fn of(quality: Quality) -> Self {
        let (scale, threshold, steps, points) = match quality {
            Quality::Low => (0.060, 0.06, 64, 2),
            Quality::Medium => (0.040, 0.03, 128, 3),
            Quality::High => (0.030, 0.02, 200, 4),
            Quality::Ultra => (0.020, 0.01, 400, 8),
        };
        Self {
            surfels: surfels::Parameters { scale, near: 0.25 },
            threshold,
            levels: 6,
            steps,
            attenuated: true,
            culled: true,
            points,
            nearest: 0.02,
        }
    }

    /// What of them surfels and shells are made by.
    fn of_shells(&self) -> surfel::Parameters {
        surfel::Parameters {
            surfels: self.surfels,
            threshold: self.threshold,
            levels: self.levels,
            ..surfel::Parameters::default()
        }
    }

    /// A level as the passes read it: surfels scatter however far away they are.
    pub fn level(&self, level: u32, view: &View) -> uniforms::SplatLevel {
        uniforms::SplatLevel { reach: f32::MAX.sqrt(), ..shells::level(&self.of_shells(), level, view) }
    }

    /// What the march reads.
    pub fn marching(&self, view: &View) -> uniforms::Intervals {
        let (width, height) = (view.width as u32, view.height as u32);
        uniforms::Intervals { width, height, steps: self.steps.max(1), seed: view.seed }
    }

    /// What splats read beside their level.
    pub fn splatting(&self, view: &View) -> uniforms::VolumeShell {
        uniforms::VolumeShell {
            attenuated: u32::from(self.attenuated),
            culled: u32::from(self.culled),
            points: self.points.max(1),
            nearest: self.nearest * view.radius,
        }
    }
}

/// A view from which surfels matter wherever they are.
fn far_reaching(view: &View) -> View {
    View { radius: f32::MAX.sqrt(), ..*view }
}

impl Technique for Parameters {
    const NAME: &'static str = "volume-shell";
    const EFFECT: Effect = Effect::FogIndirect;
    const ATTRIBUTES: &'static [Attribute] = &[Attribute::Position, Attribute::Valid];
    const LOOKS_BEYOND: bool = true;
    type Passes = Passes;

    fn compile(device: &wgpu::Device) -> Result<Passes, GpuError> {
        Passes::new(device)
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        passes::uniforms(self, view)
    }

    fn steps(
        &self,
        passes: &Passes,
        device: &wgpu::Device,
        inputs: &Inputs<'_>,
        uniforms: &[wgpu::Buffer],
        output: &wgpu::Buffer,
    ) -> Result<Vec<MethodStep>, GpuError> {
        passes.steps(device, inputs, uniforms, output)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        let shaded = |scene| Ok(reference::shade(inputs.gbuffer, scene, self, view)?.data().to_vec());
        inputs.scene.map(shaded).into_iter().collect()
    }
}
