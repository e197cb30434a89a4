//! Fast approximate anti-aliasing: the filter that the thesis names as the practice beside its network (7.4).
//!
//! Lottes, "FXAA", NVIDIA white paper 2009, as of version 3.11 (2011), quality. Where the luma of a pixel and
//! its four neighbours differs enough there is an edge. Second differences of the eight neighbours tell
//! whether it runs along rows or columns, and it is followed both ways, in steps that grow, until luma leaves
//! the mean of the edge's two sides. The nearer end says how much of the pixel lies beyond the edge: at the
//! end half of it, in the middle of the edge nothing. By so much the pixel is blended with its neighbour
//! across the edge; pixels that stand out from all their neighbours are blended at least by that.
//!
//! The original reads a tone-mapped picture. Here light is linear and has no upper end: edges are looked for
//! in the square root of luminance, where contrast is a share of the brightest pixel around and so does not
//! depend on exposure, and what is blended is light itself, as truth averages it. Where the original takes
//! the length of its last step on trust, here luma is looked at there as well.
//!
//! Limits. Nothing that falls between samples comes back; textures and highlights are taken for edges; an
//! edge is blended with what is across it, at most by half. What truth shows beside direct light, emission
//! and the environment, is not in the g-buffer of the effect. Its rivals (morphological anti-aliasing, SMAA,
//! CMAA2) recognise shapes of edges and need several passes over lists of them; this is the one that the
//! thesis names.

pub mod reference;
#[cfg(test)]
mod tests;

use super::{LightImage, Quality, images};
use crate::screen::{About, MethodStep, PlainInputs, Resources, Technique, View, Written};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::{Shader, uniforms};
use deepshade_shaders::{Attribute, Effect, MissingAttribute};

/// Most steps of a search.
const MOST_STEPS: usize = 12;

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct FxaaParameters {
    /// Lengths of the steps of the search for an edge's end, pixels; where there are fewer than 12, zeros
    /// come last.
    pub search: [f32; MOST_STEPS],
    /// Contrast of luma, as a share of the brightest around, above which there is an edge.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub contrast: f32,
    /// Contrast of luma, square roots of radiance, above which there is an edge.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub least_contrast: f32,
    /// How much of what is smaller than a pixel is blurred, 0 to 1.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub subpixel: f32,
}

impl Technique for FxaaParameters {
    fn about(&self) -> About {
        About::on_screen("fxaa", Effect::Aa, &[Attribute::Light, Attribute::Valid])
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        let FxaaUniforms { fxaa, lengths } = self.settings(view);
        vec![bytes_of(&fxaa).to_vec(), bytes_of(&lengths).to_vec()]
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        let (device, [settings, lengths]) = (to.device, to.uniforms) else {
            unreachable!("the method has two uniform buffers")
        };
        // [1, height, width]
        let luma = gpu::empty::<f32>(device, "fxaa.luma", to.size().iter().product())?;
        let [light, valid] = to.seen([Attribute::Light, Attribute::Valid]);
        let step = |file, reads: &[&wgpu::Buffer], written: &wgpu::Buffer| {
            MethodStep::bind(device, &device.pass(file, &[])?, to.whole(), reads, &[written])
        };
        let smooth = [settings, light, valid, &luma, lengths];
        Ok(vec![
            step(Shader::at("methods/fxaa/luma"), &[settings, light, valid], &luma)?,
            step(Shader::at("methods/fxaa/smooth"), &smooth, to.output)?,
        ])
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        Ok(images(reference::shade(&LightImage::of(inputs.gbuffer)?, &self.settings(view))))
    }
}

/// Uniforms of the passes for one frame, as the GPU reads them.
#[derive(Clone, Copy, Debug)]
pub struct FxaaUniforms {
    /// The blend.
    pub fxaa: uniforms::Fxaa,
    /// Lengths of the search's steps, pixels.
    pub lengths: [f32; MOST_STEPS],
}

impl FxaaParameters {
    /// Those of a quality: presets 10, 12, 29 and 39 of the original, which differ in the steps of the
    /// search, and the contrasts that it calls low, default, more than enough and, for `Ultra`, every edge
    /// there is.
    ///
    /// Swept on ten training pairs of `dataset/recipes/aa.toml` (rooms, colonnades, still lives, shelves,
    /// cities): `subpixel` from 0.25 to 1 (best from 0.5 to 0.6; the original's 0.75 blurs too much), both
    /// contrasts, and luma with an upper end, `sqrt(x / (1 + x))`, which is worse at each quality.
    pub fn of(quality: Quality) -> Self {
        let search: &[f32] = match quality {
            Quality::Low => &[1.5, 3.0, 12.0],
            Quality::Medium => &[1.0, 1.5, 2.0, 4.0, 12.0],
            Quality::High => &[1.0, 1.5, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 4.0, 8.0],
            Quality::Ultra => &[1.0, 1.0, 1.0, 1.0, 1.0, 1.5, 2.0, 2.0, 2.0, 2.0, 4.0, 8.0],
        };
        let (contrast, least_contrast) = match quality {
            Quality::Low => (0.25, 0.0833),
            Quality::Medium => (0.166, 0.0833),
            Quality::High => (0.063, 0.0312),
            Quality::Ultra => (0.03, 0.0),
        };
        let mut lengths = [0.0; MOST_STEPS];
        lengths[..search.len()].copy_from_slice(search);
        Self { search: lengths, contrast, least_contrast, subpixel: 0.5 }
    }

    /// The passes' parameters for a view.
    pub fn settings(&self, view: &View) -> FxaaUniforms {
        let steps = self.search.iter().take_while(|length| **length > 0.0).count();
        let fxaa = uniforms::Fxaa {
            width: view.width as u32,
            height: view.height as u32,
            steps: steps as u32,
            contrast: self.contrast,
            least_contrast: self.least_contrast,
            subpixel: self.subpixel,
        };
        FxaaUniforms { fxaa, lengths: self.search }
    }
}
