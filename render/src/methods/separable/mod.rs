//! Subsurface scattering as two blurs, along rows and along columns: what games do, the rival that the thesis
//! names (7.4).
//!
//! Jimenez, Zsolnai, Jarabo, Freude, Auzinger, Wu, von der Pahlen, Wimmer and Gutierrez, "Separable
//! subsurface scattering", Computer Graphics Forum 34(6), 2015. Each colour of a pixel is the weighted mean
//! of taps on its row, then of taps of that on its column, at distances that its mean free path and its depth
//! scale. The weights are truth's profile integrated across the row ([`kernel`]). A tap whose surface is
//! farther away in space than on the screen counts less, and one that shows nothing not at all; weights are
//! divided by their sum, as truth does.
//!
//! The paper's other kernel, two Gaussians set by hand, is for artists without a profile: for truth's there
//! is nothing to set.
//!
//! Limits. The product of two kernels is exact where light varies along one axis; about a point of light it
//! is a star and not a disc. Slanted surfaces are seen shortened along the slant, and areas are not weighed.
//! What is not on the screen neither gives nor takes. Its rival, the gather (`methods/gather`), has neither
//! of the first two limits and noise instead.

pub mod kernel;
pub mod reference;
#[cfg(test)]
mod tests;

use super::{Quality, Translucent, images};
use crate::screen::{About, MethodStep, PlainInputs, Resources, Technique, View, Written};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::{Shader, uniforms};
use deepshade_shaders::{Attribute, Effect, MissingAttribute};

/// Most taps of one side, the middle among them: `MOST_TAPS` of the shader.
const MOST_TAPS: usize = 25;

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct SeparableParameters {
    /// Taps of a row or column, 3 to 49, odd.
    #[schemars(range(min = 3, max = 49))]
    pub taps: usize,
    /// Distance of the last tap, mean free paths.
    #[schemars(range(min = 0.5, max = 32.0), extend("unit" = "mean free paths"))]
    pub reach: f32,
    /// How many of itself a tap's weight falls by where it is a mean free path farther in space than on the
    /// screen: `exp(-follow)`.
    #[schemars(range(min = 0.0, max = 4.0))]
    pub follow: f32,
}

impl Technique for SeparableParameters {
    fn about(&self) -> About {
        About::on_screen(
            "separable",
            Effect::Sss,
            &[Attribute::Position, Attribute::MeanFreePath, Attribute::Light, Attribute::Valid],
        )
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        let SeparableUniforms { passes: [rows, columns], taps } = self.settings(view);
        vec![bytes_of(&rows).to_vec(), bytes_of(&columns).to_vec(), bytes_of(&taps).to_vec()]
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        let (device, [rows, columns, taps]) = (to.device, to.uniforms) else {
            unreachable!("the method has three uniform buffers")
        };
        let pass = device.pass(Shader::at("methods/separable/blur"), &[("MOST_TAPS", MOST_TAPS as u32)])?;
        // [3, height, width]
        let pixels = to.size().iter().product::<usize>();
        let half_blurred = gpu::empty::<f32>(device, "separable.half_blurred", 3 * pixels)?;
        let [light, valid, position, mean_free_path] =
            to.seen([Attribute::Light, Attribute::Valid, Attribute::Position, Attribute::MeanFreePath]);
        let step = |settings: &wgpu::Buffer, from: &wgpu::Buffer, written: &wgpu::Buffer| {
            let reads = [settings, from, valid, position, mean_free_path, taps];
            MethodStep::bind(device, &pass, to.whole(), &reads, &[written])
        };
        Ok(vec![step(rows, light, &half_blurred)?, step(columns, &half_blurred, to.output)?])
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        Ok(images(reference::shade(&Translucent::of(inputs.gbuffer)?, &self.settings(view))))
    }
}

/// Uniforms of the passes for one frame, as the GPU reads them.
#[derive(Clone, Copy, Debug)]
pub struct SeparableUniforms {
    /// The blur along rows, then along columns.
    pub passes: [uniforms::Separable; 2],
    /// [`kernel::taps`]
    pub taps: [[f32; 4]; MOST_TAPS],
}

impl SeparableParameters {
    /// Those of a quality: the paper's 7 to 25 taps, and at last more.
    ///
    /// Swept on ten training pairs of `dataset/recipes/sss.toml` (rooms, colonnades, still lives, shelves,
    /// cities): `reach` from 3 to 15 for each number of taps, `follow` from 0 to 1 (1/3 is what the profile's
    /// long tail falls by), and kernels 0.7 to 1.4 times as wide, of which the derived one is as good as any.
    pub fn of(quality: Quality) -> Self {
        let (taps, reach) = match quality {
            Quality::Low => (7, 4.0),
            Quality::Medium => (13, 6.0),
            Quality::High => (25, 8.0),
            Quality::Ultra => (49, 10.0),
        };
        Self { taps, reach, follow: 0.33 }
    }

    /// The passes' parameters for a view.
    pub fn settings(&self, view: &View) -> SeparableUniforms {
        let on_one_side = (self.taps / 2 + 1).clamp(2, MOST_TAPS);
        let pass = |step_x, step_y| uniforms::Separable {
            width: view.width as u32,
            height: view.height as u32,
            step_x,
            step_y,
            taps: on_one_side as u32,
            focal_length: view.focal_length(),
            follow: self.follow,
        };
        SeparableUniforms { passes: [pass(1, 0), pass(0, 1)], taps: kernel::taps(on_one_side, self.reach) }
    }
}
