//! What runs on the GPU: surfels and their tree, the levels one after the other, their blurs, their sum.

use super::around::{Around, Ending};
use super::{Parameters, shells};
use crate::methods::blur::Blur;
use crate::screen::{Inputs, MethodStep, View};
use crate::surfels::{Cloud, Lit, Tree, frame, light};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::{Shader, TILE, uniforms};
use deepshade_shaders::{Attribute, Effect};

/// The shaders that make an effect of what all have in common.
#[derive(Clone, Copy, Debug)]
pub struct Shaders {
    /// Which surfels do something to pixels.
    pub tree: Tree,
    /// What surfels do to pixels.
    pub splat: &'static Shader,
    /// What the sum of all levels means.
    pub add: &'static Shader,
    /// Of the sums.
    pub channels: usize,
    /// What of the lights surfels send, where they are lit first.
    pub lit: Option<Lit>,
    /// What the sums become.
    pub ending: Ending<&'static Shader>,
}

/// The compiled passes.
#[derive(Clone, Debug)]
pub struct Passes {
    surfels: crate::surfels::Passes,
    splat: Pass,
    blur: Blur,
    add: Pass,
    channels: usize,
    lit: Option<Lit>,
    ending: Ending<Pass>,
}

/// Uniforms of a level of the framebuffer: splat, blur along rows and along columns, sum.
const OF_LEVEL: usize = 4;

/// The contents of the passes' uniform buffers.
pub fn uniforms(parameters: &Parameters, effect: Effect, view: &View) -> Vec<Vec<u8>> {
    let mut all: Vec<Vec<u8>> = frame::uniforms(&parameters.surfels, view).collect();
    for level in 0..parameters.levels {
        all.push(bytes_of(&shells::level(parameters, level, view)).to_vec());
        let blurs = parameters.blur_of(level).settings(view, effect);
        all.extend(blurs.map(|blur| bytes_of(&uniforms::Blur { background: 0.0, ..blur }).to_vec()));
        all.push(bytes_of(&sum(parameters, effect, level, view)).to_vec());
    }
    all
}

fn sum(parameters: &Parameters, effect: Effect, level: u32, view: &View) -> uniforms::LevelSum {
    uniforms::LevelSum {
        width: view.width as u32,
        height: view.height as u32,
        first: u32::from(level == 0),
        last: u32::from(level + 1 == parameters.levels),
        background: effect.background().unwrap_or(0.0),
    }
}

impl Passes {
    /// Compiles them.
    ///
    /// # Errors
    /// If the device refuses them.
    pub fn new(device: &wgpu::Device, shaders: &Shaders) -> Result<Self, GpuError> {
        let channels = shaders.channels;
        let with_channels = |shader: &Shader| {
            Pass::new(device, shader.name, &shader.specialised(&[("CHANNELS", channels as u32)]))
        };
        Ok(Self {
            surfels: crate::surfels::Passes::new(device, shaders.tree)?,
            splat: with_channels(shaders.splat)?,
            blur: Blur::new(device, channels)?,
            add: with_channels(shaders.add)?,
            channels,
            lit: shaders.lit,
            ending: shaders.ending.compiled(device)?,
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
        uniforms: &[wgpu::Buffer],
        image: &wgpu::Buffer,
    ) -> Result<Vec<MethodStep>, GpuError> {
        let (of_surfels, levels) = uniforms.split_at(frame::UNIFORMS);
        let (cloud, mut steps) = frame::steps(&self.surfels, device, inputs.world, of_surfels, self.lit)?;
        let room = Room::new(device, inputs, self.channels)?;
        let [.., size] = levels else { unreachable!("there is a level") };
        let around = Around::new(device, &self.ending, inputs, [size, &of_surfels[1]], image)?;
        let Around { before, after, .. } = &around;
        steps.extend_from_slice(before);
        let splatting = Splatting { device, inputs, cloud: &cloud, room: &room, around: &around };
        for (level, uniforms) in levels.chunks_exact(OF_LEVEL).enumerate() {
            steps.extend(self.level_steps(splatting, level, uniforms)?);
        }
        steps.extend_from_slice(after);
        steps.extend(light::ending(device, frame::scene(inputs.world)?, self.lit, image)?);
        Ok(steps)
    }

    fn level_steps(
        &self,
        Splatting { device, inputs, cloud, room, around }: Splatting<'_>,
        level: usize,
        uniforms: &[wgpu::Buffer],
    ) -> Result<Vec<MethodStep>, GpuError> {
        let [splat, rows, columns, sum] = uniforms else { unreachable!("a level has four uniform buffers") };
        let (gbuffer, Room { sums, half_blurred }) = (inputs.gbuffer, room);
        let [position, normal, third] = &around.receivers;
        let reads = [splat, position, normal, third, &cloud.totals, &cloud.surfels, &cloud.nodes];
        // The sum is binding 7, and what only some effects read comes after it.
        let more = cloud.sent.iter().chain(&around.more);
        let reads = (0..).zip(reads).chain((8..).zip(more)).collect::<Vec<_>>();
        let groups = groups_of_level([gbuffer.width(), gbuffer.height()], level);
        let mut steps = vec![MethodStep::bind_at(device, &self.splat, groups, &reads, &[(7, sums)])?];
        steps.extend(self.blur.steps_between(
            device,
            gbuffer,
            &around.mask,
            [rows, columns],
            half_blurred,
            sums,
        )?);
        let whole = gpu::groups(gbuffer.height(), gbuffer.width(), TILE);
        let valid = gbuffer.buffer(Attribute::Valid);
        steps.push(MethodStep::bind(device, &self.add, whole, &[sum, valid, sums], &[&around.total])?);
        Ok(steps)
    }
}

/// What the passes of every level are bound to.
#[derive(Clone, Copy)]
struct Splatting<'a> {
    device: &'a wgpu::Device,
    inputs: &'a Inputs<'a>,
    cloud: &'a Cloud,
    room: &'a Room,
    around: &'a Around,
}

/// Workgroups that cover the sub-buffers of a level: columns, rows, sub-buffers.
pub fn groups_of_level(size: [usize; 2], level: usize) -> [u32; 3] {
    let [columns, rows] = size.map(|pixels| (pixels as u32).div_ceil(1 << level).div_ceil(TILE));
    [columns, rows, 1 << (2 * level)]
}

/// What lies between the passes; every level uses it again.
struct Room {
    /// `[channels, height, width]`.
    sums: wgpu::Buffer,
    /// `[channels, height, width]`.
    half_blurred: wgpu::Buffer,
}

impl Room {
    fn new(device: &wgpu::Device, inputs: &Inputs<'_>, channels: usize) -> Result<Self, GpuError> {
        let (height, width) = (inputs.gbuffer.height(), inputs.gbuffer.width());
        let image = |label: &str| gpu::empty::<f32>(device, label, channels * height * width);
        Ok(Self { sums: image("surfel.sums")?, half_blurred: image("surfel.half_blurred")? })
    }
}
