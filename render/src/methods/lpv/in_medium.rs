//! Light in a medium by the grid: `fog-indirect`, which one surface throws into it, and `fog-multiple`, all that went
//! another way with the medium in it but for single scattering.

use super::Parameters;
use super::lit_volume::LitVolumes;
use super::passes::{self, Filled, Passes, Pixel, Shown};
use super::reference;
use super::shown::Marched;
use crate::screen::{Compiled, Inputs, MethodStep, PlainInputs, Technique, View, Written};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::GpuError;
use deepshade_shaders::wgsl::uniforms;
use deepshade_shaders::{Attribute, Effect, MissingAttribute};

/// Light that was scattered, shown by the medium and by surfaces, and light that several surfaces have reflected, shown
/// by the medium.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Multiple(pub Parameters);

/// Light that one surface has reflected and that was not scattered yet, shown by what is said.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Indirect(pub Parameters, pub Pixel);

/// `fog-multiple`, compiled for a device.
pub type MultipleScattering = Compiled<Multiple>;

/// `fog-indirect`, compiled for a device.
pub type IndirectScattering = Compiled<Indirect>;

/// What of light in a medium is shown where.
#[derive(Clone, Copy)]
struct InMedium {
    parameters: Parameters,
    light: Shown,
    pixel: Pixel,
}

impl From<Parameters> for Multiple {
    fn from(parameters: Parameters) -> Self {
        Self(parameters)
    }
}

/// Shown by the medium, which is what the effect `fog-indirect` is.
impl From<Parameters> for Indirect {
    fn from(parameters: Parameters) -> Self {
        Self(parameters, Pixel { medium: true, surface: false })
    }
}

impl From<Multiple> for InMedium {
    fn from(Multiple(parameters): Multiple) -> Self {
        Self { parameters, light: Shown::Multiple, pixel: Pixel { medium: true, surface: true } }
    }
}

impl From<Indirect> for InMedium {
    fn from(Indirect(parameters, pixel): Indirect) -> Self {
        Self { parameters, light: Shown::Reflected { by_surfaces: pixel.surface }, pixel }
    }
}

impl InMedium {
    fn uniforms(self, view: &View) -> Vec<Vec<u8>> {
        let (width, height) = (view.width as u32, view.height as u32);
        let march = uniforms::Marching { width, height, steps: self.parameters.steps, seed: view.seed };
        let mut all = passes::uniforms(view, f32::MAX);
        all.push(bytes_of(&march).to_vec());
        all
    }

    fn steps(
        self,
        passes: &Passes,
        device: &wgpu::Device,
        inputs: &Inputs<'_>,
        uniforms: &[wgpu::Buffer],
        output: &wgpu::Buffer,
    ) -> Result<Vec<MethodStep>, GpuError> {
        let filled = Filled::Medium(self.light);
        let (volumes, mut steps) = passes.volume_steps(device, inputs, self.parameters, uniforms, filled)?;
        let [.., march] = uniforms else { unreachable!("the march has a uniform buffer") };
        let (view, scale) = (&uniforms[passes::VIEW], self.parameters.scale);
        let marched = Marched { inputs, view, march, pixel: self.pixel, scale };
        steps.extend(marched.steps(device, &volumes, output)?);
        Ok(steps)
    }

    fn reference(self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        let Some(scene) = inputs.scene else { return Ok(Written::new()) };
        let Some(medium) = scene.scene().medium.as_deref() else {
            return Ok(vec![vec![0.0; 3 * view.height * view.width]]);
        };
        let volumes = LitVolumes::new(scene, self.parameters, view, Filled::Medium(self.light), f32::MAX);
        let image = reference::shade(inputs.gbuffer, &volumes, medium, self.parameters, (self.pixel, view))?;
        Ok(vec![image.data().to_vec()])
    }
}

/// Both are the same technique but for their effect.
macro_rules! technique {
    ($name:ident, $effect:expr) => {
        impl Technique for $name {
            const NAME: &'static str = "lpv";
            const EFFECT: Effect = $effect;
            const ATTRIBUTES: &'static [Attribute] =
                &[Attribute::Position, Attribute::Normal, Attribute::Diffuse, Attribute::Valid];
            const LOOKS_BEYOND: bool = true;
            type Passes = Passes;

            fn compile(device: &wgpu::Device) -> Result<Passes, GpuError> {
                Passes::new(device)
            }

            fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
                InMedium::from(*self).uniforms(view)
            }

            fn steps(
                &self,
                passes: &Passes,
                device: &wgpu::Device,
                inputs: &Inputs<'_>,
                uniforms: &[wgpu::Buffer],
                output: &wgpu::Buffer,
            ) -> Result<Vec<MethodStep>, GpuError> {
                InMedium::from(*self).steps(passes, device, inputs, uniforms, output)
            }

            fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
                InMedium::from(*self).reference(inputs, view)
            }
        }
    };
}

technique!(Multiple, Effect::FogMultiple);
technique!(Indirect, Effect::FogIndirect);
