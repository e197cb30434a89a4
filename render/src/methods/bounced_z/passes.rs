//! What runs on the GPU: surfels and their tree, the rays of every pixel, the filter.

use super::technique::Shaders;
use super::{BouncedEffect, Parameters};
use crate::methods::lobe;
use crate::raster::groups;
use crate::screen::{Inputs, MethodStep, View};
use crate::surfels::{self, Lit, Tree, frame, light};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::{Shader, TILE};
use deepshade_shaders::{Attribute, Effect};

/// The compiled passes.
#[derive(Clone, Debug)]
pub struct Passes {
    surfels: surfels::Passes,
    trace: Pass,
    arrive: Pass,
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
        let Shaders { trace, arrive, filter } = E::shaders();
        let pass = |shader: &Shader| Pass::new(device, shader.name, &shader.source());
        let filter_source = filter.specialised(&[("CHANNELS", E::EFFECT.channels() as u32)]);
        Ok(Self {
            surfels: surfels::Passes::new(device, Tree::All)?,
            trace: pass(trace)?,
            arrive: pass(arrive)?,
            filter: Pass::new(device, filter.name, &filter_source)?,
            lit: E::LIT,
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
        let pixels = gpu::groups(height, width, TILE);
        let rays = [pixels[0], pixels[1], directions];
        let met = [&cloud.totals, &cloud.surfels, &cloud.nodes];
        let reads = [&[bounces], &surface[..], &met].concat();
        steps.push(MethodStep::bind(device, &self.trace, rays, &reads, &[&ways, &arrived])?);
        let all = groups(directions as usize * height * width);
        let reads: Vec<_> = (1..).zip(&cloud.sent).collect();
        steps.push(MethodStep::bind_at(device, &self.arrive, all, &reads, &[(0, &arrived)])?);
        let reads = [&[window], &surface[..], &[&ways, &arrived]].concat();
        steps.push(MethodStep::bind(device, &self.filter, pixels, &reads, &[image])?);
        steps.extend(light::ending(device, frame::scene(inputs.world)?, self.lit, image)?);
        Ok(steps)
    }
}
