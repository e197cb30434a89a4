//! Image-based lighting by prefiltered environment maps.
//!
//! Kautz, Vázquez, Heidrich and Seidel, "A Unified Approach to Prefiltered Environment Maps", EGRW 2000;
//! McAllister, Lastra and Heidrich, "Efficient Rendering of Spatial Bi-directional Reflectance Distribution
//! Functions", GH 2002. The environment is convolved with Phong's lobe for a row of exponents ([`filter`]); a
//! pixel looks up the two nearest, in the mirrored direction, and interpolates. The lobe of exponent 1 is the
//! cosine, so that the first map, looked up at the normal, is the diffuse part. The cosine to the normal and
//! the horizon, which a map of whole lobes ignores, are modelled by another whole lobe of the same energy,
//! mean and spread, from a table ([`lobe`]).
//!
//! Limits. A lobe that the horizon cuts is no longer round: where a bright light is at its edge, towards
//! grazing, its highlight is too round and too long. The triangle's own horizon, where its normal is not the
//! shading one, is unknown. Maps have a finite height, which blurs what the smoothest surfaces mirror.
//!
//! Nine coefficients of spherical harmonics (Ramamoorthi and Hanrahan 2001) would hold the diffuse part in
//! less room. By that paper they err by up to 9 %, and they ring below 0; the map of 32 rows errs by less
//! than 1 %.

pub mod filter;
pub mod lobe;
pub mod reference;
#[cfg(test)]
mod tests;

use super::environment_map::EnvironmentMap;
use super::{Quality, images};
use crate::scene::Environment;
use crate::screen::{About, MethodStep, PlainInputs, Resources, Technique, View, Written};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::{Shader, uniforms};
use deepshade_shaders::{Attribute, Effect, MissingAttribute};
use filter::LEVELS;
use glam::Vec3;
use lobe::{ANGLES, EXPONENTS};

/// What the pass reads, in the order of its bindings.
const ATTRIBUTES: &[Attribute] = &[
    Attribute::WorldNormal,
    Attribute::ToCamera,
    Attribute::Diffuse,
    Attribute::Specular,
    Attribute::Glossiness,
    Attribute::Valid,
];

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct PrefilteredParameters {
    /// Rows of the finest map: rounded down to a power of two, at least 32.
    #[schemars(range(min = 32, max = 1024), extend("unit" = "rows"))]
    pub height: usize,
}

impl PrefilteredParameters {
    /// Those of a quality: finer maps take longer to filter, once for an environment, and mirror more
    /// sharply. A frame takes the same time. On training scenes, whose surfaces are hardly ever mirrors, 64
    /// rows are as good as 512.
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
        Filtered {
            maps: filter::maps(environment.unwrap_or(&black), self.height),
            table: lobe::table().to_vec(),
        }
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

impl Technique for PrefilteredParameters {
    fn about(&self) -> About {
        About::on_screen("prefiltered", Effect::Ibl, ATTRIBUTES)
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        let image = uniforms::Prefiltered { width: view.width as u32, height: view.height as u32 };
        vec![bytes_of(&image).to_vec()]
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        let (device, environment) = (to.device, self.filtered(to.environment));
        let sizes = [("LEVELS", LEVELS), ("EXPONENTS", EXPONENTS), ("ANGLES", ANGLES)];
        let constants = sizes.map(|(name, size)| (name, size as u32));
        let pass = device.pass(Shader::at("methods/prefiltered/shade"), &constants)?;
        let environment = gpu::storage(device, "prefiltered.environment", &packed(&environment))?;
        let attributes = ATTRIBUTES.iter().map(|attribute| to.gbuffer.buffer(*attribute));
        let reads: Vec<_> = [&to.uniforms[0]].into_iter().chain(attributes).chain([&environment]).collect();
        Ok(vec![MethodStep::bind(device, &pass, to.whole(), &reads, &[to.output])?])
    }

    fn reference(&self, inputs: &PlainInputs<'_>, _view: &View) -> Result<Written, MissingAttribute> {
        Ok(images([reference::shade(inputs.gbuffer, &self.filtered(inputs.environment))?]))
    }
}

/// First texel and height of each map, the table of lobes, the maps' texels: one buffer, since a stage may
/// have eight.
fn packed(environment: &Filtered) -> Vec<[f32; 4]> {
    let mut first = LEVELS + EXPONENTS * ANGLES;
    let mut packed = Vec::new();
    for map in &environment.maps {
        // Whole numbers below 2^24, which floats hold.
        packed.push([first as f32, map.height() as f32, 0.0, 0.0]);
        first += map.texels().len();
    }
    packed.extend(environment.table.iter().map(|lobe| lobe.extend(0.0).to_array()));
    packed.extend(environment.maps.iter().flat_map(|map| map.padded()));
    packed
}
