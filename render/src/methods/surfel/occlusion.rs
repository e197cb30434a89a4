//! Ambient occlusion by surfels (thesis 4.3): the sum of their form factors.

use super::{Parameters, passes, reference};
use crate::bvh::TracedScene;
use crate::methods::Surface;
use crate::screen::{Compiled, Inputs, MethodStep, PlainInputs, Technique, View, Written};
use crate::surfels;
use deepshade_shaders::gpu::GpuError;
use deepshade_shaders::wgsl;
use deepshade_shaders::{Attribute, Effect, MissingAttribute};

/// What can be set.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Occlusion(pub Parameters);

/// The method, compiled for a device.
pub type SurfelOcclusion = Compiled<Occlusion>;

impl Technique for Occlusion {
    const NAME: &'static str = "surfel";
    const EFFECT: Effect = Effect::Ao;
    const ATTRIBUTES: &'static [Attribute] = &[Attribute::Position, Attribute::Normal, Attribute::Valid];
    const LOOKS_BEYOND: bool = true;
    type Passes = passes::Passes;

    fn compile(device: &wgpu::Device) -> Result<passes::Passes, GpuError> {
        let shaders = passes::Shaders {
            leaves: &wgsl::SURFELS_LEAVES,
            splat: &wgsl::SURFEL_OCCLUSION,
            add: &wgsl::SURFEL_OPENNESS,
            lit: false,
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
        let laid_out =
            |scene: &TracedScene| surfels::reference::surfels(scene.scene(), &self.0.surfels, view);
        let disks = inputs.scene.map_or_else(Vec::new, laid_out);
        Ok(vec![reference::openness(&surface, &disks, &self.0.sane(), view).data().to_vec()])
    }
}
