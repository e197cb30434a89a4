//! Depth of field by gathering on rings: what games do, the analytic rival of the thesis' network (7.4).
//!
//! Jimenez, "Next generation post processing in Call of Duty: Advanced Warfare", SIGGRAPH 2014 courses; AMD
//! FidelityFX Depth of Field 1.1 is of the same kind. The picture is shrunk to half its size where time is
//! short (`Low`), each pixel with the signed radius of its circle of confusion. Tiles learn the radius of the
//! largest circle in front of focus that reaches them. Each pixel then gathers samples on rings, in two
//! layers. Behind: the mean over its own circle of all that is not in front of it, since through the lens it
//! shows its own surface and, past that surface's edge, what is farther away. In front: every sample whose
//! own circle holds the pixel gives its light over that circle's area, and these shares add up to how much of
//! the pixel is covered, so that blur of near things spreads over what is sharp. At full size both are laid
//! over the picture, which stays as it is where it is in focus.
//!
//! Where the original sorts into one near and one far layer of an image region, here each pixel parts its
//! samples by whether they are in front of itself: on either side of an edge the covered shares are then
//! those of the disc that the edge cuts, and the picture has no seam.
//!
//! Limits. What a near thing hides from the pinhole is not in the picture and is made up from what surrounds
//! it; of things in front of each other in front of the pixel, the shares are added. Radii end at a share of
//! the height. What truth shows beside direct light, emission and the environment, is not in the g-buffer of
//! the effect. Its rivals, separable blurs of the picture (Gaussian, hexagonal, octagonal), are faster and
//! have neither round discs nor layers.

pub mod reference;
#[cfg(test)]
mod tests;

use super::Quality;
use crate::screen::{About, MethodStep, PlainInputs, Resources, Technique, View, Written};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::{Shader, TILE, uniforms};
use deepshade_shaders::{Attribute, Effect, MissingAttribute};

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct RingGatherParameters {
    /// Pixels of the image along the edge of one that is gathered: 2 is half the size, 1 the full one.
    #[schemars(range(min = 1, max = 2), extend("unit" = "pixels"))]
    pub scale: u32,
    /// Most rings around a pixel; fewer where they would be nearer to each other than pixels.
    #[schemars(range(min = 1, max = 64))]
    pub rings: u32,
    /// Largest radius of a circle of confusion, as a share of the image's height.
    #[schemars(range(min = 0.0, max = 0.5), extend("unit" = "heights"))]
    pub largest: f32,
    /// Difference of signed radii, pixels, from which on the nearer of two surfaces is fully in front of the
    /// other.
    #[schemars(range(min = 0.0, max = 64.0), extend("unit" = "pixels"))]
    pub softness: f32,
}

impl Technique for RingGatherParameters {
    fn about(&self) -> About {
        About::on_screen(
            "ring-gather",
            Effect::Dof,
            &[Attribute::Light, Attribute::Depth, Attribute::Blurriness, Attribute::Valid],
        )
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        vec![bytes_of(&self.settings(view)).to_vec()]
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        let (device, settings) = (to.device, &to.uniforms[0]);
        let [height, width] = to.size();
        let sizes = self.sizes(height, width);
        let [low_height, low_width, tiles_high, tiles_wide] =
            [sizes.low_height, sizes.low_width, sizes.tiles_high, sizes.tiles_wide].map(|edge| edge as usize);
        let image = |label: &str| gpu::empty::<[f32; 4]>(device, label, low_height * low_width);
        let (low, behind) = (image("ring_gather.low")?, image("ring_gather.behind")?);
        let before = image("ring_gather.before")?;
        let of_tiles = |label: &str| gpu::empty::<f32>(device, label, tiles_high * tiles_wide);
        let largest_in_front = of_tiles("ring_gather.largest_in_front")?;
        let largest_around = of_tiles("ring_gather.largest_around")?;
        let over_low = gpu::groups(low_height, low_width, TILE);
        let over_tiles = gpu::groups(tiles_high, tiles_wide, TILE);
        let step = |file, workgroups, reads: &[&wgpu::Buffer], writes: &[&wgpu::Buffer]| {
            let pass = device.pass(file, &[])?;
            MethodStep::bind(device, &pass, workgroups, &[&[settings], reads].concat(), writes)
        };
        let [shrink, tiles, neighbours, gather, combine] = [
            Shader::at("methods/ring-gather/shrink"),
            Shader::at("methods/ring-gather/tiles"),
            Shader::at("methods/ring-gather/neighbours"),
            Shader::at("methods/ring-gather/gather"),
            Shader::at("methods/ring-gather/combine"),
        ];
        let seen = to.seen([Attribute::Light, Attribute::Valid, Attribute::Depth, Attribute::Blurriness]);
        Ok(vec![
            step(shrink, over_low, &seen, &[&low])?,
            step(tiles, over_tiles, &[&low], &[&largest_in_front])?,
            step(neighbours, over_tiles, &[&largest_in_front], &[&largest_around])?,
            step(gather, over_low, &[&low, &largest_around], &[&behind, &before])?,
            step(combine, to.whole(), &[&seen[..], &[&low, &behind, &before]].concat(), &[to.output])?,
        ])
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        Ok(reference::shade(&reference::Blurred::of(inputs.gbuffer)?, &self.settings(view)))
    }
}

impl RingGatherParameters {
    /// Those of a quality: half the size for `Low`, the full one for others, and more rings.
    ///
    /// Swept on ten training pairs of `dataset/recipes/dof.toml` (rooms, colonnades, still lives, shelves,
    /// cities): `scale`, `rings` and `softness` from 0.25 to 4. Half the size loses where circles are a few
    /// pixels wide, however many rings there are; at the full size more than 6 rings change SSIM by 0.0002.
    pub fn of(quality: Quality) -> Self {
        let (scale, rings) = match quality {
            Quality::Low => (2, 3),
            Quality::Medium => (1, 3),
            Quality::High => (1, 6),
            Quality::Ultra => (1, 24),
        };
        Self { scale, rings, largest: 0.125, softness: 2.0 }
    }

    /// The passes' parameters for a view.
    pub fn settings(&self, view: &View) -> uniforms::RingGather {
        let blur_at_infinity = view.camera.blur_at_infinity(view.height);
        uniforms::RingGather { blur_at_infinity, ..self.sizes(view.height, view.width) }
    }

    /// The passes' parameters for an image of this size that is not blurred where nothing is seen.
    fn sizes(&self, height: usize, width: usize) -> uniforms::RingGather {
        let scale = self.scale.max(1);
        let (width, height) = (width as u32, height as u32);
        let (low_width, low_height) = (width.div_ceil(scale), height.div_ceil(scale));
        let largest = (self.largest * height as f32).max(1.0);
        let sharp = 0.5;
        uniforms::RingGather {
            width,
            height,
            scale,
            low_width,
            low_height,
            tiles_wide: low_width.div_ceil(TILE),
            tiles_high: low_height.div_ceil(TILE),
            reach: (largest / (scale * TILE) as f32).ceil() as i32,
            rings: self.rings.max(1),
            blur_at_infinity: 0.0,
            largest,
            sharp,
            blurred: sharp * (2 * scale) as f32,
            softness: self.softness,
        }
    }
}
