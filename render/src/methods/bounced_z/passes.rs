//! What runs on the GPU: surfels and their tree, the rays of every pixel, the filter.

use super::directional::SkyAtOnce;
use super::{BouncedZParameters, bounces};
use crate::methods::disks::DiskEffect;
use crate::methods::lobe;
use crate::methods::surfel::directional::Sky;
use crate::raster::groups;
use crate::screen::{MethodStep, Resources, View};
use crate::surfels::{Tree, frame, light};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::Shader;
use deepshade_shaders::{Attribute, Effect};

/// What the passes of an effect do.
#[derive(Clone, Copy, Debug)]
pub struct Rays {
    /// What a pixel's rays meet.
    pub trace: Shader,
    /// What arrives from there.
    pub arrives: Arrives,
    /// What brings neighbours' rays together.
    pub filter: Shader,
}

/// What arrives along rays.
#[derive(Clone, Copy, Debug)]
pub enum Arrives {
    /// What a pass makes of the surfels that are met.
    OfSurfels(Shader),
    /// Light of the environment.
    OfEnvironment {
        /// Whether what surfels reflect of it is a part.
        reflected: bool,
    },
}

/// What the passes after the rays are bound to.
#[derive(Debug)]
pub struct TracedRays<'a> {
    /// The filter's uniform buffer.
    pub window: &'a wgpu::Buffer,
    /// Position, normal, and validity or gloss of every pixel.
    pub surface: [&'a wgpu::Buffer; 3],
    /// Into which pixels look, `[directions, height, width]`.
    pub directions: wgpu::Buffer,
    /// What they meet there, of the same shape; then what arrives from there, if it is of surfels.
    pub met: wgpu::Buffer,
    /// How many rays there are.
    pub count: usize,
    /// What brings those of neighbours together.
    pub filter: Pass,
}

impl TracedRays<'_> {
    /// The pass that brings together what has arrived.
    ///
    /// # Errors
    /// If the device refuses a binding.
    pub fn filtered(
        &self,
        to: &Resources<'_>,
        arrived: &wgpu::Buffer,
        image: &wgpu::Buffer,
    ) -> Result<MethodStep, GpuError> {
        let reads = [&[self.window], &self.surface[..], &[&self.directions, arrived]].concat();
        MethodStep::bind(to.device, &self.filter, to.whole(), &reads, &[image])
    }
}

/// The contents of the passes' uniform buffers.
pub fn uniforms(parameters: &BouncedZParameters, effect: Effect, view: &View) -> Vec<Vec<u8>> {
    let window = super::window(&parameters.filter, parameters.directions, effect, view);
    let own = [bytes_of(&parameters.bounces(effect, view)).to_vec(), bytes_of(&window).to_vec()];
    frame::uniforms(&parameters.surfels, view).chain(own).collect()
}

/// The passes bound to a scene and a g-buffer.
///
/// # Errors
/// If there is no scene, or the device has no room for what lies between them.
pub fn steps(
    effect: &DiskEffect<BouncedZParameters>,
    directions: u32,
    to: &Resources<'_>,
) -> Result<Vec<MethodStep>, GpuError> {
    let (of_surfels, [bounces, window]) = to.uniforms.split_at(frame::UNIFORMS) else {
        unreachable!("rays and filter have a uniform buffer each")
    };
    let (device, world, lit) = (to.device, to.scene()?, effect.lit);
    let Rays { trace, arrives, filter } = effect.passes;
    let (cloud, mut steps) = frame::steps(device, world, of_surfels, Tree::All, lit)?;
    let count = directions as usize * to.size().iter().product::<usize>();
    let samples = |label: &str| gpu::empty::<u32>(device, label, count);
    let (ways, met) = (samples("bounced-z.directions")?, samples("bounced-z.met")?);
    let [position, normal, valid] = to.seen([Attribute::Position, Attribute::Normal, Attribute::Valid]);
    let is_glossy = effect.attributes.contains(&Attribute::Glossiness);
    let gloss = is_glossy.then(|| lobe::step(device, to.gbuffer)).transpose()?;
    steps.extend(gloss.as_ref().map(|(_, step)| step.clone()));
    let surface = [position, normal, gloss.as_ref().map_or(valid, |(gloss, _)| gloss)];
    let [columns, rows, _] = to.whole();
    let tree = [&cloud.totals, &cloud.surfels, &cloud.nodes];
    let reads = [&[bounces], &surface[..], &tree].concat();
    let (trace, rays) = (device.pass(trace, &[])?, [columns, rows, directions]);
    steps.push(MethodStep::bind(device, &trace, rays, &reads, &[&ways, &met])?);
    let filter = device.pass(filter, &[("CHANNELS", effect.effect.channels() as u32)])?;
    let traced = TracedRays { window, surface, directions: ways, met, count, filter };
    let view = &of_surfels[1];
    match arrives {
        Arrives::OfSurfels(arrive) => {
            let reads: Vec<_> = (1..).zip(&cloud.sent).collect();
            let (arrive, writes) = (device.pass(arrive, &[])?, [(0, &traced.met)]);
            steps.push(MethodStep::bind_at(device, &arrive, groups(count), &reads, &writes)?);
            steps.push(traced.filtered(to, &traced.met, to.output)?);
        }
        Arrives::OfEnvironment { reflected } => {
            let [sky, open] = &Sky::new(to.environment).upload(device)?;
            let (at_once, seen) = SkyAtOnce::new(&traced, view, [sky, open], to)?;
            steps.push(seen);
            if reflected {
                // Paths take the place of what their first rays meet.
                steps.push(bounces::step(&traced, &cloud, [bounces, view, sky], to)?);
                steps.push(traced.filtered(to, &traced.met, to.output)?);
            }
            steps.extend(at_once.image_steps(&traced, view, reflected, to)?);
        }
    }
    steps.extend(light::ending(device, world, lit, to.output)?);
    Ok(steps)
}
