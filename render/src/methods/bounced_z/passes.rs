//! What runs on the GPU: surfels and their tree, the rays of every pixel, the filter.

use super::technique::Shaders;
use super::{BouncedEffect, Parameters};
use crate::methods::lobe;
use crate::screen::{Inputs, MethodStep, View};
use crate::surfels::{self, Lit, frame};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::{self, TILE};
use deepshade_shaders::{Attribute, Effect};

/// The compiled passes.
#[derive(Clone, Debug)]
pub struct Passes {
    surfels: surfels::Passes,
    trace: Pass,
    filter: Pass,
    lit: Option<Lit>,
    /// What gathers the gloss of receivers that are glossy.
    gloss: Option<Pass>,
}

/// The contents of the passes' uniform buffers.
pub fn uniforms(parameters: &Parameters, effect: Effect, view: &View) -> Vec<Vec<u8>> {
    let window = super::window(&parameters.filter, parameters.directions, effect, view);
    let own = [bytes_of(&parameters.bounces(view)).to_vec(), bytes_of(&window).to_vec()];
    frame::uniforms(&parameters.surfels, view).chain(own).collect()
}

impl Passes {
    /// Compiles them for an effect.
    ///
    /// # Errors
    /// If the device refuses them.
    pub fn new<E: BouncedEffect>(device: &wgpu::Device) -> Result<Self, GpuError> {
        let Shaders { trace, filter } = E::shaders();
        let filter_source = filter.specialised(&[("CHANNELS", E::EFFECT.channels() as u32)]);
        Ok(Self {
            surfels: surfels::Passes::new(device, &wgsl::SURFELS_LEAVES)?,
            trace: Pass::new(device, trace.name, &trace.source())?,
            filter: Pass::new(device, filter.name, &filter_source)?,
            lit: E::LIT.then_some(Lit::Reflected),
            gloss: E::ATTRIBUTES.contains(&Attribute::Glossiness).then(|| lobe::pass(device)).transpose()?,
        })
    }

    /// The passes bound to a scene and a g-buffer. They write `image`, `[channels, height, width]`.
    ///
    /// # Errors
    /// If there is no scene, or the device has no room for what lies between them.
    pub fn steps(
        &self,
        device: &wgpu::Device,
        inputs: &Inputs<'_>,
        directions: u32,
        uniforms: &[wgpu::Buffer],
        image: &wgpu::Buffer,
    ) -> Result<Vec<MethodStep>, GpuError> {
        let (of_surfels, [bounces, window]) = uniforms.split_at(frame::UNIFORMS) else {
            unreachable!("rays and filter have a uniform buffer each")
        };
        let (cloud, mut steps) = frame::steps(&self.surfels, device, inputs.world, of_surfels, self.lit)?;
        let gbuffer = inputs.gbuffer;
        let (height, width) = (gbuffer.height(), gbuffer.width());
        let samples = |label: &str| gpu::empty::<u32>(device, label, directions as usize * height * width);
        let (ways, arrived) = (samples("bounced-z.directions")?, samples("bounced-z.arrived")?);
        let [position, normal, valid] =
            [Attribute::Position, Attribute::Normal, Attribute::Valid].map(|a| gbuffer.buffer(a));
        let gloss = self.gloss.as_ref().map(|pass| lobe::step(device, pass, gbuffer)).transpose()?;
        steps.extend(gloss.as_ref().map(|(_, step)| step.clone()));
        let surface = [position, normal, gloss.as_ref().map_or(valid, |(gloss, _)| gloss)];
        let groups = gpu::groups(height, width, TILE);
        let rays = [groups[0], groups[1], directions];
        let met = [&cloud.totals, &cloud.surfels, &cloud.nodes];
        let reads = [&[bounces], &surface[..], &met].concat();
        steps.push(MethodStep::bind(device, &self.trace, rays, &reads, &[&ways, &arrived])?);
        let reads = [&[window], &surface[..], &[&ways, &arrived]].concat();
        steps.push(MethodStep::bind(device, &self.filter, groups, &reads, &[image])?);
        Ok(steps)
    }
}
