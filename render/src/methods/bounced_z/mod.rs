//! Shading by surfels with visibility: the bounced z-buffer.
//!
//! Nalbach, Ritschel and Seidel, "The Bounced Z-Buffer for Indirect Visibility", VMV 2015 (thesis chapter 6).
//! Where [`surfel`](super::surfel) adds up what all surfels do to a pixel, here each pixel looks into a few
//! directions and keeps of each the nearest surfel, as a z-buffer does: what hides behind something does
//! nothing. Neighbouring pixels look elsewhere, and a filter brings together what they see, each sample
//! weighed by what the receiving pixel's own surface makes of its direction.
//!
//! Surfels, their light and their tree are those of [`surfel`](super::surfel), and so are the levels of the
//! interleaved framebuffer: on level l a pixel meets one of 4^l surfels, 2^l times as large. A hit belongs to
//! the shell around its surfel that the pixel is in, or to its own level where that is finer; the finest
//! level that has one wins (thesis 6.3).
//!
//! The splatting is turned round here, too: rays walk the tree. Directions are spread by their cosine to the
//! normal for ambient occlusion as well, where the paper spreads them evenly: of an even sky the cosine
//! leaves no noise at all, an even spread that of a variance of 1/3 a direction. The filter divides by the
//! sum of its weights, so that it keeps an even sky.
//!
//! Methods: [`occlusion`] and [`indirect`] light, which [`glossy`] surfaces also reflect. What a pixel's
//! surface makes of light, and so where it looks for it, is its [`Reflector`].
//!
//! Limits. Disks whose areas add up to a surface's lie over one another in places and leave holes in others:
//! a single sheet of them lets a part of the rays through ([`COVER`]), which is light lost to `gi`. Where it
//! ends, disks stand over its edge, the more the coarser the level: thresholds are therefore smaller than
//! those of [`surfel`](super::surfel). Few directions are noise, of bright things in a dark scene above all,
//! and the filter turns it into blur. A far group of surfels is taken to look like the one of it that is met.
//! Only lamps light surfels.
//!
//! Unlike [`surfel`](super::surfel) it does not grow darker, or brighter, with every surface behind the
//! first; it takes a few times as long.

pub mod glossy;
pub mod indirect;
pub mod occlusion;
pub mod passes;
pub mod reference;
pub mod reflector;
#[cfg(test)]
mod tests;

pub use reflector::{Matte, Reflector};

use super::disks::{ByDisks, DiskEffect};
use super::surfel::{MOST_LEVELS, shells};
use super::{Quality, blur};
use crate::screen::{MethodStep, Resources, View};
use crate::surfels;
use deepshade_shaders::Effect;
use deepshade_shaders::gpu::GpuError;
use deepshade_shaders::wgsl::uniforms;

/// How much larger than its own is the radius of a surfel that rays meet.
///
/// Swept on room, colonnade and still life at 192x128, 0.7 m. Of the room's indirect light, a mean of 0.228,
/// 1 loses 0.059 through holes, 1.25 0.037 and 1.5 0.028; of the still life's ambient occlusion the relative
/// mean squared error is 0.06, 0.16 and 0.26 at a threshold of 0.02, as disks stand over edges, and 0.06 with
/// 1.25 at 0.005.
pub const COVER: f32 = 1.25;
/// Most directions of a pixel.
pub const MOST_DIRECTIONS: u32 = 16;

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct BouncedZParameters {
    /// How finely the scene is laid out.
    pub surfels: surfels::SurfelDensity,
    /// The papers' epsilon: what of a surfel's effect may be left to the next coarser level, from 0 to 1.
    #[schemars(range(min = 0.001, max = 1.0))]
    pub threshold: f32,
    /// Levels of the interleaved framebuffer, 1 to 8; on 1 all pixels meet all surfels.
    #[schemars(range(min = 1, max = 8))]
    pub levels: u32,
    /// Directions of a pixel, 1 to 16.
    #[schemars(range(min = 1, max = 16))]
    pub directions: u32,
    /// What brings neighbours' samples together.
    pub filter: blur::BlurParameters,
}

impl BouncedZParameters {
    /// Those of a quality: more directions, smaller surfels, and more of their effect on every pixel. On the
    /// six scenes of `dataset/recipes/gi-rivals.toml` low, medium and high come to a relative mean squared
    /// error of 0.172, 0.099 and 0.067.
    pub fn of(quality: Quality) -> Self {
        let (scale, threshold, directions, radius) = match quality {
            Quality::Low => (0.020, 0.05, 1, 5),
            Quality::Medium => (0.014, 0.02, 2, 5),
            Quality::High => (0.010, 0.01, 4, 5),
            Quality::Ultra => (0.006, 0.005, 16, 4),
        };
        Self {
            surfels: surfels::SurfelDensity { scale, near: 0.25 },
            threshold,
            levels: 6,
            directions,
            filter: blur::BlurParameters { radius, sharpness: 512.0 },
        }
    }

    /// What the rays read.
    pub fn bounces(&self, view: &View) -> uniforms::Bounces {
        uniforms::Bounces {
            width: view.width as u32,
            height: view.height as u32,
            directions: self.directions,
            levels: self.levels,
            seed: view.seed,
            shell: shells::reach(self.threshold),
            cover: COVER,
            reach: view.radius,
        }
    }
}

impl ByDisks for BouncedZParameters {
    const NAME: &'static str = "bounced-z";
    type Passes = passes::Rays;

    fn sane(self) -> Self {
        Self {
            threshold: self.threshold.clamp(1e-6, 1.0),
            levels: self.levels.clamp(1, MOST_LEVELS),
            directions: self.directions.clamp(1, MOST_DIRECTIONS),
            ..self
        }
    }

    fn surfels(&self) -> &surfels::SurfelDensity {
        &self.surfels
    }

    fn uniforms(&self, effect: Effect, view: &View) -> Vec<Vec<u8>> {
        passes::uniforms(self, effect, view)
    }

    fn steps(&self, effect: &DiskEffect<Self>, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        passes::steps(effect, self.directions, to)
    }
}

/// What the filter reads that brings together so many directions of each pixel.
pub fn window(
    filter: &blur::BlurParameters,
    directions: u32,
    effect: Effect,
    view: &View,
) -> uniforms::BounceWindow {
    let [uniforms::Blur { width, height, radius, falloff, sharpness, background, .. }, _] =
        filter.settings(view, effect);
    uniforms::BounceWindow { width, height, directions, radius, falloff, sharpness, background }
}
