//! Subsurface scattering gathered on the screen: what the thesis trains on (7.4), with as many samples as there is time for.
//!
//! Truth sums over all pixels the profile of Christensen and Burley (2015) at their distance in space times the area of the
//! surface that they show, divided by the sum of these weights. Here the sum is an estimate: positions on the screen are
//! drawn by the profile itself, laid on the plane through the surface that faces the camera (Golubev, "Efficient
//! screen-space subsurface scattering using Burley's normalized diffusion in real-time", SIGGRAPH 2018 courses), each colour
//! by its own, evenly in the profile's share and turned by the golden angle. A sample weighs as truth's pixel does, over the
//! density it was drawn with. The pixel's own share is known and is no sample. With many samples it becomes truth.
//!
//! Limits. Few samples leave noise, above all where the surface is slanted or its pixels are much nearer in space than on
//! the plane that samples are drawn on. The g-buffer of the effect has no normals: areas follow from differences of
//! positions, which are those of flat triangles, and coarse where positions are half floats. What is not on the screen
//! neither gives nor takes, in truth neither. Its rival, the two blurs of `methods/separable`, has no noise and does not
//! converge.

pub mod passes;
pub mod reference;
#[cfg(test)]
mod tests;

use super::{Quality, Translucent, images};
use crate::screen::{Compiled, Inputs, MethodStep, PlainInputs, Technique, View, Written};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::GpuError;
use deepshade_shaders::wgsl::uniforms;
use deepshade_shaders::{Attribute, Effect, MissingAttribute};
use passes::Passes;

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct Parameters {
    /// Samples of each colour of a pixel, at least 1.
    #[schemars(range(min = 1, max = 4096))]
    pub samples: u32,
}

impl Default for Parameters {
    fn default() -> Self {
        Self::of(Quality::default())
    }
}

/// The method, compiled for a device.
pub type Gather = Compiled<Parameters>;

impl Technique for Parameters {
    const NAME: &'static str = "gather";
    const EFFECT: Effect = Effect::Sss;
    const ATTRIBUTES: &'static [Attribute] =
        &[Attribute::Position, Attribute::MeanFreePath, Attribute::Light, Attribute::Valid];
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
        passes.steps(device, inputs.gbuffer, &uniforms[0], output)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        Ok(images(reference::shade(&Translucent::of(inputs.gbuffer)?, &self.settings(view))))
    }
}

impl Parameters {
    /// Those of a quality: four times as many samples have half the noise.
    ///
    /// Tried on ten training pairs of `dataset/recipes/sss.toml` (rooms, colonnades, still lives, shelves, cities):
    /// the same pattern at every pixel, which has no noise but copies of what is bright: SSIM likes that better (`High`:
    /// 0.935, with noise 0.921), FLIP worse (0.076, 0.052). Noise has no bias, and stays.
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
