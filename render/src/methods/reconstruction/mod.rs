//! Motion blur by reconstruction from the picture at one moment: the analytic rival of the thesis' network
//! (7.4).
//!
//! McGuire, Hennessy, Bukowski and Osman, "A reconstruction filter for plausible motion blur", I3D 2012.
//! Tiles learn the longest movement that reaches them, and every pixel gathers along lines, in two layers
//! told apart by a soft comparison of depths. In front: samples along the tile's movement whose own movement
//! leads over the pixel each give their light for the share of the exposure that they are there, and these
//! shares add up to how much of the pixel is covered. Behind: the mean along the pixel's own movement, as in
//! Guertin, McGuire and Nowrouzezahrai, "A fast and stable feature-aware motion blur filter", HPG 2014, of
//! all that is not in front of it: its surface while that is there and what is bare when not.
//!
//! Where the paper divides the sum of all samples by that of their weights, with cones that fade along the
//! movement, here shares are those of a shutter that opens and closes at once: an edge that moves is a linear
//! ramp, as in truth.
//!
//! Limits. One movement a tile passes in front: of two that cross, the shorter is blurred at its own pixels
//! only. What a moving thing hides all the time is not in the picture and is made up from what surrounds it;
//! nor does it blur shadows and highlights that move over what stands still, or what comes in from outside of
//! the image. Movements end at a share of the height. What truth shows beside direct light, emission and the
//! environment, is not in the g-buffer of the effect. Its rivals blur along each pixel's own movement alone,
//! which leaves edges of what moves sharp.

pub mod reference;
#[cfg(test)]
mod tests;

use super::Quality;
use crate::screen::{About, MethodStep, PlainInputs, Resources, Technique, View, Written};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::{Shader, TILE, uniforms};
use deepshade_shaders::{Attribute, Effect, MissingAttribute};

/// Edge of a tile, pixels; the paper has 20.
const TILE_SIZE: u32 = 16;

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct ReconstructionParameters {
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

impl Technique for ReconstructionParameters {
    fn about(&self) -> About {
        About::on_screen(
            "reconstruction",
            Effect::MotionBlur,
            &[Attribute::Motion, Attribute::Light, Attribute::Depth, Attribute::Valid],
        )
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        vec![bytes_of(&self.settings(view)).to_vec()]
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        let (device, settings) = (to.device, &to.uniforms[0]);
        let [height, width] = to.size();
        let uniforms::Reconstruction { tiles_high, tiles_wide, .. } = self.sizes(height, width);
        let (rows, columns) = (tiles_high as usize, tiles_wide as usize);
        // [tiles_high, tiles_wide, 4], of vec3f
        let of_tiles = gpu::empty::<[f32; 4]>(device, "reconstruction.longest_of_tiles", rows * columns)?;
        let around = gpu::empty::<[f32; 4]>(device, "reconstruction.longest_around", rows * columns)?;
        let [light, valid, motion, depth] =
            to.seen([Attribute::Light, Attribute::Valid, Attribute::Motion, Attribute::Depth]);
        let step = |file, workgroups: [u32; 3], reads: &[(u32, &wgpu::Buffer)], written| {
            MethodStep::bind_at(device, &device.pass(file, &[])?, workgroups, reads, &[written])
        };
        let [tiles, neighbours, gather] = [
            Shader::at("methods/reconstruction/tiles"),
            Shader::at("methods/reconstruction/neighbours"),
            Shader::at("methods/reconstruction/gather"),
        ];
        let over_tiles = gpu::groups(rows, columns, TILE);
        let seen = [(0, settings), (1, light), (2, valid), (3, motion), (4, depth), (5, &around)];
        Ok(vec![
            step(tiles, over_tiles, &[(0, settings), (2, valid), (3, motion)], (4, &of_tiles))?,
            step(neighbours, over_tiles, &[(0, settings), (1, &of_tiles)], (2, &around))?,
            step(gather, to.whole(), &seen, (6, to.output))?,
        ])
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        Ok(reference::shade(&reference::Moving::of(inputs.gbuffer)?, &self.settings(view)))
    }
}

impl ReconstructionParameters {
    /// Those of a quality: more samples leave less noise and shorter steps.
    ///
    /// Swept on ten training pairs of `dataset/recipes/motion-blur.toml` (rooms, colonnades, still lives,
    /// shelves, cities): `samples`, and `depth_extent` from 0.005 to 0.2, which is best from 0.05 to 0.1.
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
