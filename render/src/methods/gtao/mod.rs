//! Ground-truth ambient occlusion by visibility bitmasks.
//!
//! Jimenez, Wu, Pesce and Jarabo, "Practical Realtime Strategies for Accurate Indirect Occlusion", SIGGRAPH
//! 2016 courses, with the bitmasks of Therrien, Levesque and Gilet, "Screen Space Indirect Lighting with
//! Visibility Bitmask", The Visual Computer 2023, in place of horizons. The hemisphere of each pixel is cut
//! into slices that the camera sees as lines; along them the g-buffer is marched, and what is met within the
//! radius covers sectors of equal cosine-weighted solid angle ([`slices`]). Openness is the share of sectors
//! that stays uncovered. A blur that keeps edges removes the noise.
//!
//! Limits. What is hidden behind something in front, behind the camera or outside the image does not occlude,
//! and everything is equally thick: thin things occlude too much, thick ones that are seen from their thin
//! side let light through behind them.
//!
//! Unlike [`hbao`](super::hbao) it weighs directions by their cosine as truth does, needs neither falloff nor
//! strength, and lets light pass behind thin things.

mod processor;
pub mod reference;
#[cfg(test)]
mod tests;

pub use processor::on_processor;

use super::{Quality, Surface, blur, march::Marched, slices};
use crate::screen::{PlainInputs, View};
use deepshade_shaders::wgsl::{Shader, uniforms};
use deepshade_shaders::{Effect, MissingAttribute, Planes};

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct GtaoParameters {
    /// The march.
    pub slices: slices::SliceParameters,
    /// What removes its noise.
    pub blur: blur::BlurParameters,
}

impl GtaoParameters {
    /// Those of a quality: more slices and steps leave less noise to the blur, and miss less.
    ///
    /// Swept on room, colonnade, still life, machinery, stairs and shelves at 176x120 with radii of 4 and 10
    /// % of the diagonal. A thickness of 0.25 is best at 10 %, 0.4 at 4 %, both within 0.005 of SSIM of 0.3;
    /// 0.1 and 0.7 lose up to 0.05 and 0.03. A blur of 2 pixels and a sharpness of 512 to 1,024 are best with
    /// many slices, more pixels with few; a sharpness of 64 loses 0.025. Steps matter more than slices: what
    /// lies between two of them lets light through.
    pub fn of(quality: Quality) -> Self {
        let (slices, steps, blur_radius) = match quality {
            Quality::Low => (2, 8, 4),
            Quality::Medium => (4, 12, 3),
            Quality::High => (8, 20, 2),
            Quality::Ultra => (24, 48, 1),
        };
        Self {
            slices: slices::SliceParameters { slices, steps, thickness: 0.3 },
            blur: blur::BlurParameters { radius: blur_radius, sharpness: 1024.0 },
        }
    }
}

impl Marched for GtaoParameters {
    const NAME: &'static str = "gtao";
    const EFFECT: Effect = Effect::Ao;
    const SHADER: Shader = Shader::at("methods/gtao/occlusion");
    type March = uniforms::Slices;

    fn march(&self, view: &View) -> uniforms::Slices {
        self.slices.settings(view)
    }

    fn blur(&self) -> blur::BlurParameters {
        self.blur
    }

    fn noisy(
        &self,
        _inputs: &PlainInputs<'_>,
        surface: &Surface,
        march: &uniforms::Slices,
    ) -> Result<Planes, MissingAttribute> {
        Ok(reference::occlude(surface, march))
    }

    fn on_processor(&self, surface: &Surface, view: &View) -> Option<[Planes; 3]> {
        Some(on_processor(self, surface, view))
    }
}
