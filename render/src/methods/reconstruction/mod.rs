//! Motion blur by reconstruction from the picture at one moment: the analytic rival of the thesis' network (7.4).
//!
//! McGuire, Hennessy, Bukowski and Osman, "A reconstruction filter for plausible motion blur", I3D 2012. Tiles learn the
//! longest movement that reaches them, and every pixel gathers along lines, in two layers told apart by a soft comparison
//! of depths. In front: samples along the tile's movement whose own movement leads over the pixel each give their light for
//! the share of the exposure that they are there, and these shares add up to how much of the pixel is covered. Behind: the
//! mean along the pixel's own movement, as in Guertin, McGuire and Nowrouzezahrai, "A fast and stable feature-aware motion
//! blur filter", HPG 2014, of all that is not in front of it: its surface while that is there and what is bare when not.
//!
//! Where the paper divides the sum of all samples by that of their weights, with cones that fade along the movement, here
//! shares are those of a shutter that opens and closes at once: an edge that moves is a linear ramp, as in truth.
//!
//! Limits. One movement a tile passes in front: of two that cross, the shorter is blurred at its own pixels only. What a
//! moving thing hides all the time is not in the picture and is made up from what surrounds it; nor does it blur shadows and
//! highlights that move over what stands still, or what comes in from outside of the image. Movements end at a share of
//! the height. What truth shows beside direct light, emission and the environment, is not in the g-buffer of the effect.
//! Its rivals blur along each pixel's own movement alone, which leaves edges of what moves sharp.

pub mod passes;
pub mod reference;
#[cfg(test)]
mod tests;

use super::Quality;
use crate::screen::{Compiled, Inputs, MethodStep, PlainInputs, Technique, View, Written};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::GpuError;
use deepshade_shaders::wgsl::uniforms;
use deepshade_shaders::{Attribute, Effect, MissingAttribute};
use passes::Passes;

/// Edge of a tile, pixels; the paper has 20.
const TILE_SIZE: u32 = 16;

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct Parameters {
    /// Samples along a line, at least 1; the paper has 15.
    #[schemars(range(min = 1, max = 512))]
    pub samples: u32,
    /// Longest half of a movement, as a share of the image's height.
    #[schemars(range(min = 0.0, max = 0.5), extend("unit" = "heights"))]
    pub longest: f32,
    /// How much nearer, as a share of the depth, what is fully in front.
    #[schemars(range(min = 0.001, max = 1.0))]
    pub depth_extent: f32,
}

impl Default for Parameters {
    fn default() -> Self {
        Self::of(Quality::default())
    }
}

/// The method, compiled for a device.
pub type Reconstruction = Compiled<Parameters>;

impl Technique for Parameters {
    const NAME: &'static str = "reconstruction";
    const EFFECT: Effect = Effect::MotionBlur;
    const ATTRIBUTES: &'static [Attribute] =
        &[Attribute::Motion, Attribute::Light, Attribute::Depth, Attribute::Valid];
    type Passes = Passes;

    fn compile(device: &wgpu::Device) -> Result<Passes, GpuError> {
        Passes::new(device)
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        vec![bytes_of(&self.settings(view)).to_vec()]
    }

    fn steps(
        &self,
        passes: &Passes,
        device: &wgpu::Device,
        inputs: &Inputs<'_>,
        uniforms: &[wgpu::Buffer],
        output: &wgpu::Buffer,
    ) -> Result<Vec<MethodStep>, GpuError> {
        let gbuffer = inputs.gbuffer;
        let sizes = self.sizes(gbuffer.height(), gbuffer.width());
        passes.steps(device, gbuffer, &sizes, &uniforms[0], output)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        Ok(reference::shade(&reference::Moving::of(inputs.gbuffer)?, &self.settings(view)))
    }
}

impl Parameters {
    /// Those of a quality: more samples leave less noise and shorter steps.
    ///
    /// Swept on ten training pairs of `dataset/recipes/motion-blur.toml` (rooms, colonnades, still lives, shelves, cities):
    /// `samples`, and `depth_extent` from 0.005 to 0.2, which is best from 0.05 to 0.1.
    pub fn of(quality: Quality) -> Self {
        let samples = match quality {
            Quality::Low => 7,
            Quality::Medium => 15,
            Quality::High => 31,
            Quality::Ultra => 127,
        };
        Self { samples, longest: 0.15, depth_extent: 0.1 }
    }

    /// The passes' parameters for a view.
    pub fn settings(&self, view: &View) -> uniforms::Reconstruction {
        uniforms::Reconstruction { seed: view.seed, ..self.sizes(view.height, view.width) }
    }

    /// The passes' parameters for an image of this size, of seed 0.
    fn sizes(&self, height: usize, width: usize) -> uniforms::Reconstruction {
        let (width, height) = (width as u32, height as u32);
        let longest = (self.longest * height as f32).max(1.0);
        uniforms::Reconstruction {
            width,
            height,
            tile: TILE_SIZE,
            tiles_wide: width.div_ceil(TILE_SIZE),
            tiles_high: height.div_ceil(TILE_SIZE),
            reach: (longest / TILE_SIZE as f32).ceil() as i32,
            samples: self.samples.max(1),
            seed: 0,
            longest,
            depth_extent: self.depth_extent,
        }
    }
}
