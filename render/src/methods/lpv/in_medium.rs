//! Light in a medium by the grid: `fog-indirect`, which one surface throws into it, and `fog-multiple`, all
//! that went another way with the medium in it but for single scattering.

use super::LpvParameters;
use super::lit_volume::LitVolumes;
use super::passes::{self, Filled, FilledVolumes, MediumLight, Pixel};
use super::reference;
use super::shown::Marched;
use crate::screen::{About, MethodStep, PlainInputs, Resources, Technique, View, Written};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::GpuError;
use deepshade_shaders::wgsl::uniforms;
use deepshade_shaders::{Attribute, Effect, MissingAttribute, Planes};

/// What of light in a medium is shown where: one kind, or both added up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InMedium {
    parameters: LpvParameters,
    shown: [Option<Kind>; 2],
}

/// A kind of light, and what of pixels it lights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Kind {
    light: MediumLight,
    pixel: Pixel,
    /// Whether the medium shows what a scene and the sky send by themselves, too.
    emission: bool,
}

impl Kind {
    const MULTIPLE: Self =
        Self { light: MediumLight::Multiple, pixel: Pixel { medium: true, surface: true }, emission: false };
    const INDIRECT: Self = Self::indirect(Pixel { medium: true, surface: false });

    const fn indirect(pixel: Pixel) -> Self {
        Self { light: MediumLight::Reflected { by_surfaces: pixel.surface }, pixel, emission: false }
    }
}

impl InMedium {
    /// Light that was scattered, shown by the medium and by surfaces, and light that several surfaces have
    /// reflected, shown by the medium: `fog-multiple`.
    pub const fn multiple(parameters: LpvParameters) -> Self {
        Self { parameters, shown: [Some(Kind::MULTIPLE), None] }
    }

    /// Light that one surface has reflected and that was not scattered yet, shown by the medium:
    /// `fog-indirect`.
    pub const fn indirect(parameters: LpvParameters) -> Self {
        Self { parameters, shown: [Some(Kind::INDIRECT), None] }
    }

    /// The same, shown by what is said.
    pub const fn indirect_at(parameters: LpvParameters, pixel: Pixel) -> Self {
        Self { parameters, shown: [Some(Kind::indirect(pixel)), None] }
    }

    /// Both, of the same surfels, and what the medium scatters once of light that the scene and the sky send
    /// by themselves: all but what it scatters once of lamps.
    pub const fn all(parameters: LpvParameters) -> Self {
        let indirect = Kind { emission: true, ..Kind::INDIRECT };
        Self { parameters, shown: [Some(indirect), Some(Kind::MULTIPLE)] }
    }

    fn kinds(&self) -> impl Iterator<Item = Kind> {
        self.shown.into_iter().flatten()
    }
}

impl Technique for InMedium {
    fn about(&self) -> About {
        let seen = &[Attribute::Position, Attribute::Normal, Attribute::Diffuse, Attribute::Valid];
        let is_multiple = self.kinds().any(|kind| kind.light == MediumLight::Multiple);
        let effect = if is_multiple { Effect::FogMultiple } else { Effect::FogIndirect };
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
        let [.., march] = to.uniforms else { unreachable!("the march has a uniform buffer") };
        let (view, scale) = (&to.uniforms[passes::VIEW], self.parameters.scale);
        // Surfels are lit alike for all kinds.
        let (surfels, mut steps) =
            passes::lit_surfels(to, self.parameters, Filled::Medium(MediumLight::Multiple))?;
        for (number, Kind { light, pixel, emission }) in self.kinds().enumerate() {
            let (FilledVolumes { light, emission: emitted }, filling) =
                passes::volume_steps(to, self.parameters, Filled::Medium(light), &surfels)?;
            steps.extend(filling);
            let marched = Marched { to, view, march, pixel, scale, adds: number > 0 };
            for volume in &light {
                steps.extend(marched.steps(volume)?);
            }
            for volume in emitted.iter().filter(|_| emission) {
                let pixel = Pixel { medium: true, surface: false };
                steps.extend(Marched { pixel, adds: true, ..marched }.steps(volume)?);
            }
        }
        Ok(steps)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        inputs.image_of_scene(|scene| {
            let mut sum = Planes::filled(3, view.height, view.width, 0.0);
            let Some(medium) = scene.scene().medium.as_deref() else {
                return Ok(sum);
            };
            for Kind { light, pixel, emission } in self.kinds() {
                let filled = Filled::Medium(light);
                let [light, emitted] =
                    LitVolumes::with_emission(scene, self.parameters, view, filled, f32::MAX);
                let before = Pixel { medium: true, surface: false };
                let emitted = emission.then_some((emitted, before));
                for (volumes, pixel) in std::iter::once((light, pixel)).chain(emitted) {
                    let image =
                        reference::shade(inputs.gbuffer, &volumes, medium, self.parameters, (pixel, view))?;
                    sum.data_mut().iter_mut().zip(image.data()).for_each(|(sum, value)| *sum += value);
                }
            }
            Ok(sum)
        })
    }
}
