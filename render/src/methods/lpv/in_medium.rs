//! Light in a medium by the grid: `fog-indirect`, which one surface throws into it, and `fog-multiple`, all
//! that went another way with the medium in it but for single scattering.

use super::LpvParameters;
use super::lit_volume::LitVolumes;
use super::passes::{self, Filled, MediumLight, Pixel};
use super::reference;
use super::shown::Marched;
use crate::screen::{About, MethodStep, PlainInputs, Resources, Technique, View, Written};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::GpuError;
use deepshade_shaders::wgsl::uniforms;
use deepshade_shaders::{Attribute, Effect, MissingAttribute, Planes};

/// What of light in a medium is shown where.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InMedium {
    parameters: LpvParameters,
    light: MediumLight,
    pixel: Pixel,
}

impl InMedium {
    /// Light that was scattered, shown by the medium and by surfaces, and light that several surfaces have
    /// reflected, shown by the medium: `fog-multiple`.
    pub const fn multiple(parameters: LpvParameters) -> Self {
        Self { parameters, light: MediumLight::Multiple, pixel: Pixel { medium: true, surface: true } }
    }

    /// Light that one surface has reflected and that was not scattered yet, shown by the medium:
    /// `fog-indirect`.
    pub const fn indirect(parameters: LpvParameters) -> Self {
        Self::indirect_at(parameters, Pixel { medium: true, surface: false })
    }

    /// The same, shown by what is said.
    pub const fn indirect_at(parameters: LpvParameters, pixel: Pixel) -> Self {
        Self { parameters, light: MediumLight::Reflected { by_surfaces: pixel.surface }, pixel }
    }
}

impl Technique for InMedium {
    fn about(&self) -> About {
        let effect = match self.light {
            MediumLight::Multiple => Effect::FogMultiple,
            MediumLight::Reflected { .. } => Effect::FogIndirect,
        };
        let seen = &[Attribute::Position, Attribute::Normal, Attribute::Diffuse, Attribute::Valid];
        About::beyond_screen("lpv", effect, seen)
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        let (width, height) = (view.width as u32, view.height as u32);
        let march = uniforms::Marching { width, height, steps: self.parameters.steps, seed: view.seed };
        let mut all = passes::uniforms(view, f32::MAX);
        all.push(bytes_of(&march).to_vec());
        all
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        let (volumes, mut steps) = passes::volume_steps(to, self.parameters, Filled::Medium(self.light))?;
        let [.., march] = to.uniforms else { unreachable!("the march has a uniform buffer") };
        let (view, scale) = (&to.uniforms[passes::VIEW], self.parameters.scale);
        steps.extend(Marched { to, view, march, pixel: self.pixel, scale }.steps(&volumes)?);
        Ok(steps)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        inputs.image_of_scene(|scene| {
            let Some(medium) = scene.scene().medium.as_deref() else {
                return Ok(Planes::filled(3, view.height, view.width, 0.0));
            };
            let volumes = LitVolumes::new(scene, self.parameters, view, Filled::Medium(self.light), f32::MAX);
            reference::shade(inputs.gbuffer, &volumes, medium, self.parameters, (self.pixel, view))
        })
    }
}
