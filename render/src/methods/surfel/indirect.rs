//! Diffuse indirect light of one bounce by surfels (thesis 4.3): the sum of what they send, lit by the scene's lights with
//! shadows.
//!
//! Unlike the paper's, shells are as wide for a dim surfel as for a bright one, so that the threshold has no unit; surfels
//! without light are left out.

use super::{Parameters, passes, reference};
use crate::methods::Surface;
use crate::screen::{Compiled, Inputs, MethodStep, PlainInputs, Technique, View, Written};
use crate::surfels;
use deepshade_shaders::gpu::GpuError;
use deepshade_shaders::wgsl;
use deepshade_shaders::{Attribute, Effect, MissingAttribute};

/// What can be set.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Indirect(pub Parameters);

/// The method, compiled for a device.
pub type SurfelIndirect = Compiled<Indirect>;

impl Technique for Indirect {
    const NAME: &'static str = "surfel";
    const EFFECT: Effect = Effect::Gi;
    const ATTRIBUTES: &'static [Attribute] = &[Attribute::Position, Attribute::Normal, Attribute::Valid];
    const LOOKS_BEYOND: bool = true;
    type Passes = passes::Passes;

    fn compile(device: &wgpu::Device) -> Result<passes::Passes, GpuError> {
        let shaders = passes::Shaders {
            leaves: &wgsl::SURFELS_LIT_LEAVES,
            splat: &wgsl::SURFEL_LIGHT,
            add: &wgsl::SURFEL_INDIRECT,
            lit: true,
        };
        passes::Passes::new(device, &shaders, Self::EFFECT)
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        passes::uniforms(&self.0.sane(), Self::EFFECT, view)
    }

    fn steps(
        &self,
        passes: &passes::Passes,
        device: &wgpu::Device,
        inputs: &Inputs<'_>,
        uniforms: &[wgpu::Buffer],
        output: &wgpu::Buffer,
    ) -> Result<Vec<MethodStep>, GpuError> {
        passes.steps(device, inputs, uniforms, output)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        let surface = Surface::of(inputs.gbuffer)?;
        let disks = inputs.scene.map_or_else(Vec::new, |scene| {
            let disks = surfels::reference::surfels(scene.scene(), &self.0.surfels, view);
            surfels::reference::lit(scene, &surfels::patches::of_scene(scene.scene()), disks, &view.camera)
        });
        Ok(vec![reference::sums(&surface, &disks, reference::LIGHT, &self.0.sane(), view).data().to_vec()])
    }
}
