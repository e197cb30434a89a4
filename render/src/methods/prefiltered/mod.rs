//! Image-based lighting by prefiltered environment maps.
//!
//! Kautz, Vázquez, Heidrich and Seidel, "A Unified Approach to Prefiltered Environment Maps", EGRW 2000; McAllister,
//! Lastra and Heidrich, "Efficient Rendering of Spatial Bi-directional Reflectance Distribution Functions", GH 2002. The
//! environment is convolved with Phong's lobe for a row of exponents ([`filter`]); a pixel looks up the two nearest, in
//! the mirrored direction, and interpolates. The lobe of exponent 1 is the cosine, so that the first map, looked up at
//! the normal, is the diffuse part. The cosine to the normal and the horizon, which a map of whole lobes ignores, are
//! modelled by another whole lobe of the same energy, mean and spread, from a table ([`lobe`]).
//!
//! Limits. A lobe that the horizon cuts is no longer round: where a bright light is at its edge, towards grazing, its
//! highlight is too round and too long. The triangle's own horizon, where its normal is not the shading one, is unknown.
//! Maps have a finite height, which blurs what the smoothest surfaces mirror.
//!
//! Nine coefficients of spherical harmonics (Ramamoorthi and Hanrahan 2001) would hold the diffuse part in less room. By
//! that paper they err by up to 9 %, and they ring below 0; the map of 32 rows errs by less than 1 %.

pub mod filter;
pub mod lobe;
pub mod passes;
pub mod reference;
#[cfg(test)]
mod tests;

use super::environment_map::EnvironmentMap;
use super::{Quality, images};
use crate::scene::Environment;
use crate::screen::{Compiled, Inputs, MethodStep, PlainInputs, Technique, View, Written};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::GpuError;
use deepshade_shaders::wgsl::uniforms;
use deepshade_shaders::{Attribute, Effect, MissingAttribute};
use glam::Vec3;
use passes::Passes;

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct Parameters {
    /// Rows of the finest map: rounded down to a power of two, at least 32.
    #[schemars(range(min = 32, max = 1024), extend("unit" = "rows"))]
    pub height: usize,
}

impl Default for Parameters {
    fn default() -> Self {
        Self::of(Quality::default())
    }
}

impl Parameters {
    /// Those of a quality: finer maps take longer to filter, once for an environment, and mirror more sharply. A frame
    /// takes the same time. On training scenes, whose surfaces are hardly ever mirrors, 64 rows are as good as 512.
    pub fn of(quality: Quality) -> Self {
        let height = match quality {
            Quality::Low => 32,
            Quality::Medium => 64,
            Quality::High => 128,
            Quality::Ultra => 256,
        };
        Self { height }
    }

    /// An environment as the pass reads it; black without one.
    fn filtered(&self, environment: Option<&Environment>) -> Filtered {
        let black = Environment::uniform(Vec3::ZERO);
        Filtered { maps: filter::maps(environment.unwrap_or(&black), self.height), table: lobe::table() }
    }
}

/// An environment convolved with lobes, and which of them replace those that surfaces have.
#[derive(Clone, Debug)]
pub struct Filtered {
    /// [`filter::maps`].
    pub maps: Vec<EnvironmentMap>,
    /// [`lobe::table`].
    pub table: Vec<Vec3>,
}

/// The method, compiled for a device.
pub type Prefiltered = Compiled<Parameters>;

impl Technique for Parameters {
    const NAME: &'static str = "prefiltered";
    const EFFECT: Effect = Effect::Ibl;
    const ATTRIBUTES: &'static [Attribute] = &passes::ATTRIBUTES;
    type Passes = Passes;

    fn compile(device: &wgpu::Device) -> Result<Passes, GpuError> {
        Passes::new(device)
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        let image = uniforms::Prefiltered { width: view.width as u32, height: view.height as u32 };
        vec![bytes_of(&image).to_vec()]
    }

    fn steps(
        &self,
        passes: &Passes,
        device: &wgpu::Device,
        inputs: &Inputs<'_>,
        uniforms: &[wgpu::Buffer],
        output: &wgpu::Buffer,
    ) -> Result<Vec<MethodStep>, GpuError> {
        let environment = self.filtered(inputs.environment);
        passes.steps(device, inputs.gbuffer, &environment, &uniforms[0], output)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, _view: &View) -> Result<Written, MissingAttribute> {
        Ok(images([reference::shade(inputs.gbuffer, &self.filtered(inputs.environment))?]))
    }
}
