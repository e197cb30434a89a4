//! Shading by surfels: deep screen space.
//!
//! Nalbach, Ritschel and Seidel, "Deep Screen Space", I3D 2014 (thesis chapter 4). Surfels
//! ([`crate::surfels`]) stand for the whole scene; each does to every pixel what a disk of its size does.
//! Near ones do it to every pixel; those farther away than a threshold epsilon of effect allows do it to one
//! pixel of four, of sixteen and so on, four, sixteen times as much each: shells around a surfel, splatted to
//! the levels of an interleaved framebuffer ([`shells`]). Levels are blurred and added up.
//!
//! In the paper a surfel is as much larger as it stands for others, and a large disk hides less than the
//! small ones together: what is farther than a shell or two grows too bright. Here it keeps its size and
//! counts for all, so that the mean is right at every threshold (colonnade:1, 0.6 m, against all surfels on
//! all pixels: a difference of 0.058 in place of 0.088 at a threshold of 0.2, 0.126 in place of 0.244 at
//! 0.8).
//!
//! The splatting is turned round: a pixel walks a tree over the surfels of its sub-buffer. What is summed up
//! is the same as with splats that are blended, always in the same order; there is no list of splats that
//! could become too long, nothing to shuffle or unshuffle, and nothing to cull, since only what reaches the
//! pixel is met.
//!
//! Methods: [`occlusion`], [`directional`] occlusion, [`indirect`] light, which [`glossy`] surfaces also
//! reflect, and subsurface [`scattering`].
//!
//! Limits. What hides behind something occludes too: two sheets one behind the other occlude twice. A far
//! group of surfels is taken to look like the one of it that was drawn. One surfel more or less early in
//! their order draws other ones on all coarser levels. Only lamps light surfels, emissive triangles and the
//! environment do not.
//!
//! Unlike [`gtao`](super::gtao) and [`hbao`](super::hbao) it knows what the camera does not see: behind it,
//! beside the image, behind something in front, and surfaces seen from their edge.

pub mod around;
pub mod directional;
pub mod glossy;
pub mod indirect;
pub mod occlusion;
pub mod passes;
pub mod reference;
pub mod scattering;
pub mod shells;
pub mod splat;
#[cfg(test)]
mod tests;

use super::disks::{ByDisks, DiskEffect};
use super::{Quality, blur};
use crate::screen::{MethodStep, Resources, View};
use crate::surfels;
use deepshade_shaders::Effect;
use deepshade_shaders::gpu::GpuError;

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct SurfelParameters {
    /// How finely the scene is laid out.
    pub surfels: surfels::SurfelDensity,
    /// The papers' epsilon: what of a surfel's effect may be left to the next coarser level, from 0 to 1.
    #[schemars(range(min = 0.001, max = 1.0))]
    pub threshold: f32,
    /// Levels of the interleaved framebuffer, 1 to 8; 1 is splatting in full resolution.
    #[schemars(range(min = 1, max = 8))]
    pub levels: u32,
    /// What removes the noise of a level: the radius is that of the finest, and is doubled with each coarser
    /// one.
    pub blur: blur::BlurParameters,
}

/// Most levels: 2^10 pixels to a side become sub-buffers of 8 x 8.
pub const MOST_LEVELS: u32 = 8;
/// A level is blurred no farther than this, pixels.
const MOST_BLUR: u32 = 32;

impl SurfelParameters {
    /// Those of a quality: smaller surfels, and more of their effect on every pixel. On the six scenes of
    /// `dataset/recipes/gi-rivals.toml` low, medium and high come to a relative mean squared error of 0.279,
    /// 0.231 and 0.235: beyond medium what is left is what hides nothing.
    pub fn of(quality: Quality) -> Self {
        let (scale, threshold) = match quality {
            Quality::Low => (0.020, 0.3),
            Quality::Medium => (0.014, 0.2),
            Quality::High => (0.010, 0.1),
            Quality::Ultra => (0.006, 0.05),
        };
        Self {
            surfels: surfels::SurfelDensity { scale, near: 0.25 },
            threshold,
            levels: 6,
            blur: blur::BlurParameters { radius: 1, sharpness: 512.0 },
        }
    }

    /// The blur of a level.
    fn blur_of(&self, level: u32) -> blur::BlurParameters {
        blur::BlurParameters { radius: (self.blur.radius << level).min(MOST_BLUR), ..self.blur }
    }
}

impl ByDisks for SurfelParameters {
    const NAME: &'static str = "surfel";
    type Passes = passes::Shading;

    fn sane(self) -> Self {
        Self { threshold: self.threshold.clamp(1e-6, 1.0), levels: self.levels.clamp(1, MOST_LEVELS), ..self }
    }

    fn reaching(mut self, times: f32) -> Self {
        self.surfels.near /= times;
        self.blur.sharpness *= times;
        self
    }

    fn surfels(&self) -> &surfels::SurfelDensity {
        &self.surfels
    }

    fn uniforms(&self, effect: Effect, view: &View) -> Vec<Vec<u8>> {
        passes::uniforms(self, effect, view)
    }

    fn steps(&self, effect: &DiskEffect<Self>, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        passes::steps(effect, to)
    }
}
