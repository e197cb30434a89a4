//! Subsurface scattering gathered on the screen: what the thesis trains on (7.4), with as many samples as
//! there is time for.
//!
//! Truth sums over all pixels the profile of Christensen and Burley (2015) at their distance in space times
//! the area of the surface that they show, divided by the sum of these weights. Here the sum is an estimate:
//! positions on the screen are drawn by the profile itself, laid on the plane through the surface that faces
//! the camera (Golubev, "Efficient screen-space subsurface scattering using Burley's normalized diffusion in
//! real-time", SIGGRAPH 2018 courses), each colour by its own, evenly in the profile's share and turned by
//! the golden angle. A sample weighs as truth's pixel does, over the density it was drawn with. The pixel's
//! own share is known and is no sample. With many samples it becomes truth.
//!
//! Limits. Few samples leave noise, above all where the surface is slanted or its pixels are much nearer in
//! space than on the plane that samples are drawn on. The g-buffer of the effect has no normals: areas follow
//! from differences of positions, which are those of flat triangles, and coarse where positions are half
//! floats. What is not on the screen neither gives nor takes, in truth neither. Its rival, the two blurs of
//! `methods/separable`, has no noise and does not converge.

pub mod reference;
#[cfg(test)]
mod tests;

use super::{Quality, Translucent, images};
use crate::screen::{About, MethodStep, PlainInputs, Resources, Technique, View, Written};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::{Shader, uniforms};
use deepshade_shaders::{Attribute, Effect, MissingAttribute};

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct GatherParameters {
    /// Samples of each colour of a pixel, at least 1.
    #[schemars(range(min = 1, max = 4096))]
    pub samples: u32,
}

impl Technique for GatherParameters {
    fn about(&self) -> About {
        About::on_screen(
            "gather",
            Effect::Sss,
            &[Attribute::Position, Attribute::MeanFreePath, Attribute::Light, Attribute::Valid],
        )
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        vec![bytes_of(&self.settings(view)).to_vec()]
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        let (device, settings) = (to.device, &to.uniforms[0]);
        // [1, height, width]
        let areas = gpu::empty::<f32>(device, "gather.areas", to.size().iter().product())?;
        let [light, valid, position, length] =
            to.seen([Attribute::Light, Attribute::Valid, Attribute::Position, Attribute::MeanFreePath]);
        let step = |file, reads: &[(u32, &wgpu::Buffer)], written: (u32, &wgpu::Buffer)| {
            MethodStep::bind_at(device, &device.pass(file, &[])?, to.whole(), reads, &[written])
        };
        let gather = [(0, settings), (1, light), (2, valid), (3, position), (4, length), (5, &areas)];
        let seen = [(0, settings), (2, valid), (3, position)];
        Ok(vec![
            step(Shader::at("methods/gather/areas"), &seen, (5, &areas))?,
            step(Shader::at("methods/gather/gather"), &gather, (6, to.output))?,
        ])
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        Ok(images(reference::shade(&Translucent::of(inputs.gbuffer)?, &self.settings(view))))
    }
}

impl GatherParameters {
    /// Those of a quality: four times as many samples have half the noise.
    ///
    /// Tried on ten training pairs of `dataset/recipes/sss.toml` (rooms, colonnades, still lives, shelves,
    /// cities): the same pattern at every pixel, which has no noise but copies of what is bright: SSIM likes
    /// that better (`High`: 0.935, with noise 0.921), FLIP worse (0.076, 0.052). Noise has no bias, and
    /// stays.
    pub fn of(quality: Quality) -> Self {
        let samples = match quality {
            Quality::Low => 8,
            Quality::Medium => 32,
            Quality::High => 128,
            Quality::Ultra => 512,
        };
        Self { samples }
    }

    /// The passes' parameters for a view.
    pub fn settings(&self, view: &View) -> uniforms::Gather {
        uniforms::Gather {
            width: view.width as u32,
            height: view.height as u32,
            samples: self.samples.max(1),
            seed: view.seed,
            focal_length: view.focal_length(),
        }
    }
}
