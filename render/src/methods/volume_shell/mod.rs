//! Light that surfaces throw into a medium: volume shell splatting.
//!
//! Nalbach, Ritschel and Seidel, "Deep Screen Space for Indirect Lighting of Volumes", VMV 2014 (thesis
//! chapter 5). Each pixel's ray is divided into [`intervals`] between which the transmittance to the eye
//! falls by equal parts; surfels that the lamps light through the medium scatter light into those that lie in
//! their shells, on the levels of an interleaved framebuffer as [`surfel`] has it. Levels are blurred by a
//! Gaussian [`pyramid`] and added up.
//!
//! Beyond the paper are the [`Improvement`]s, which can be left out one by one to be measured. Surfels'
//! shells are as wide for a dim one as for a bright one, so that the threshold has no unit. [`direct`] is
//! light straight from the lamps by the same map.
//!
//! Limits. Nothing hides surfels from the medium: where much does, light is too bright, unlike that of
//! [`bounced_z`](super::bounced_z::fog). Light of point, spot and directional lights only, so that scenes lit
//! by emissive surfaces or an environment stay black: with these, a room under a sky was three times too
//! bright. On lavapipe, which ends long loops, images are right up to some 500,000 visits of intervals a
//! pixel and level. Images have at most four million pixels: a binding holds no more intervals.

pub mod direct;
mod improvements;
pub mod intervals;
pub mod map;
pub mod passes;
pub mod pyramid;
pub mod reference;
pub mod samples;
#[cfg(test)]
mod tests;

pub use improvements::{Improvement, Improvements};

use super::Quality;
use super::surfel::{self, shells};
use crate::screen::{About, MethodStep, PlainInputs, Resources, Technique, View, Written};
use crate::surfels;
use deepshade_shaders::gpu::GpuError;
use deepshade_shaders::wgsl::uniforms;
use deepshade_shaders::{Attribute, Effect, MissingAttribute};
use intervals::Division;

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct VolumeShellParameters {
    /// How finely the scene is laid out.
    pub surfels: surfels::SurfelDensity,
    /// The paper's epsilon: what of a surfel's effect may be left to the next coarser level, from 0 to 1.
    #[schemars(range(min = 0.001, max = 1.0))]
    pub threshold: f32,
    /// Levels of the interleaved framebuffer, 1 to 8.
    #[schemars(range(min = 1, max = 8))]
    pub levels: u32,
    /// Points of a ray's way through the medium at which density is looked up.
    #[schemars(range(min = 1, max = 2048))]
    pub steps: u32,
    /// Distances of each ray that are kept, one more than intervals; a multiple of 4.
    #[schemars(range(min = 4, max = 32), extend("multipleOf" = 4))]
    pub samples: u32,
    /// Points of the way from a surfel at which a grid's density is looked up.
    #[schemars(range(min = 1, max = 32))]
    pub points: u32,
    /// The paper's delta: surfels nearer than this, over the effect's radius, do what they would at this
    /// distance.
    #[schemars(range(min = 0.0, max = 1.0), extend("unit" = "radii"))]
    pub nearest: f32,
    /// What is done in another way than in the paper; all of it but in studies.
    #[schemars(skip)]
    pub improvements: Improvements,
}

impl VolumeShellParameters {
    /// Those of a quality. On `colonnade:1` in clouds (48x32, truth of 512 samples) low and ultra come to a
    /// relative mean squared error of 0.027 and 0.034 where truth's own noise is 0.06: what is left there is
    /// light that something should hide. In an empty box a smaller threshold helps
    /// (`deepshade-studies volume-shell`).
    pub fn of(quality: Quality) -> Self {
        let (scale, threshold, steps, points) = match quality {
            Quality::Low => (0.060, 0.06, 64, 2),
            Quality::Medium => (0.040, 0.03, 128, 2),
            Quality::High => (0.030, 0.02, 200, 4),
            Quality::Ultra => (0.020, 0.015, 400, 4),
        };
        Self {
            surfels: surfels::SurfelDensity { scale, near: 0.25 },
            threshold,
            levels: 6,
            steps,
            samples: 16,
            points,
            nearest: 0.02,
            improvements: Improvements::ALL,
        }
    }

    /// Whether coefficients are their means over the colours.
    const fn is_grey(&self) -> bool {
        !self.improvements.has(Improvement::Colours)
    }

    /// What of them surfels and shells are made by.
    fn of_shells(&self) -> surfel::SurfelParameters {
        surfel::SurfelParameters {
            surfels: self.surfels,
            threshold: self.threshold,
            levels: self.levels,
            ..surfel::SurfelParameters::of(Quality::High)
        }
    }

    /// A level as the passes read it: surfels scatter however far away they are.
    pub fn level(&self, level: u32, view: &View) -> uniforms::SplatLevel {
        let usual = shells::level(&self.of_shells(), level, view);
        let last = usual.last * self.improvements.flag(Improvement::FarLight);
        uniforms::SplatLevel { reach: far_reaching(view).radius, last, ..usual }
    }

    /// What what scatters reads, beside levels.
    pub fn scattering(&self, view: &View) -> uniforms::VolumeShell {
        uniforms::VolumeShell { steps: self.steps.max(1), nearest: self.nearest * view.radius }
    }

    /// How rays are divided, as plain Rust reads it.
    pub(super) fn division(&self, seed: u32) -> Division {
        let is_wide = self.improvements.has(Improvement::WideEncoding);
        Division { steps: self.steps.max(1), samples: self.samples as usize, is_wide, seed }
    }
}

/// A view from which surfels matter wherever they are.
fn far_reaching(view: &View) -> View {
    View { radius: f32::MAX.sqrt(), ..*view }
}

impl Technique for VolumeShellParameters {
    fn about(&self) -> About {
        About::beyond_screen("volume-shell", Effect::FogIndirect, &[Attribute::Position, Attribute::Valid])
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        passes::uniforms(self, view)
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        passes::steps(self, to)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        inputs.image_of_scene(|scene| reference::shade(inputs.gbuffer, scene, self, view))
    }
}
