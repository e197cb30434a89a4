//! What runs on the GPU: surfels and their tree, the levels one after the other, their blurs, their sum.

use super::around::{Around, Ending};
use super::{SurfelParameters, shells};
use crate::methods::blur::{self, Blurred};
use crate::methods::disks::DiskEffect;
use crate::screen::{MethodStep, Resources, View};
use crate::surfels::{Cloud, Tree, frame, light};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::{Shader, TILE, uniforms};
use deepshade_shaders::{Attribute, Effect};

/// What the passes of an effect do.
#[derive(Clone, Copy, Debug)]
pub struct Shading {
    /// Which surfels do something to pixels.
    pub tree: Tree,
    /// What surfels do to pixels.
    pub splat: Shader,
    /// What the sum of all levels means.
    pub add: Shader,
    /// Of the sums.
    pub channels: usize,
    /// What the sums become.
    pub ending: Ending,
}

/// Uniforms of a level of the framebuffer: splat, blur along rows and along columns, sum.
const OF_LEVEL: usize = 4;

/// The contents of the passes' uniform buffers.
pub fn uniforms(parameters: &SurfelParameters, effect: Effect, view: &View) -> Vec<Vec<u8>> {
    let mut all: Vec<Vec<u8>> = frame::uniforms(&parameters.surfels, view).collect();
    for level in 0..parameters.levels {
        all.push(bytes_of(&shells::level(parameters, level, view)).to_vec());
        let blurs = parameters.blur_of(level).settings(view, effect);
        all.extend(blurs.map(|blur| bytes_of(&uniforms::Blur { background: 0.0, ..blur }).to_vec()));
        all.push(bytes_of(&sum(parameters, effect, level, view)).to_vec());
    }
    all
}

fn sum(parameters: &SurfelParameters, effect: Effect, level: u32, view: &View) -> uniforms::LevelSum {
    uniforms::LevelSum {
        width: view.width as u32,
        height: view.height as u32,
        first: u32::from(level == 0),
        last: u32::from(level + 1 == parameters.levels),
        background: effect.background().unwrap_or(0.0),
    }
}

/// The passes bound to a scene and a g-buffer.
///
/// # Errors
/// If there is no scene, or the device has no room for what lies between them.
pub fn steps(effect: &DiskEffect<SurfelParameters>, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
    let (device, world, lit) = (to.device, to.scene()?, effect.lit);
    let Shading { tree, channels, ending, .. } = effect.passes;
    let (of_surfels, levels) = to.uniforms.split_at(frame::UNIFORMS);
    let (cloud, mut steps) = frame::steps(device, world, of_surfels, tree, lit)?;
    let room = LevelBuffers::new(to, channels)?;
    let [.., size] = levels else { unreachable!("there is a level") };
    let around = Around::new(ending, to, [size, &of_surfels[1]])?;
    let Around { before, after, .. } = &around;
    steps.extend_from_slice(before);
    let splatting = Splatting { to, shading: effect.passes, cloud: &cloud, room: &room, around: &around };
    for (level, uniforms) in levels.chunks_exact(OF_LEVEL).enumerate() {
        steps.extend(splatting.steps(level, uniforms)?);
    }
    steps.extend_from_slice(after);
    steps.extend(light::ending(device, world, lit, to.output)?);
    Ok(steps)
}

/// What the passes of every level are bound to.
#[derive(Clone, Copy)]
struct Splatting<'a> {
    to: &'a Resources<'a>,
    shading: Shading,
    cloud: &'a Cloud,
    room: &'a LevelBuffers,
    around: &'a Around,
}

impl Splatting<'_> {
    /// The passes of a level.
    fn steps(&self, level: usize, uniforms: &[wgpu::Buffer]) -> Result<Vec<MethodStep>, GpuError> {
        let Self { to, shading: Shading { splat, add, channels, .. }, cloud, room, around } = *self;
        let [of_splat, rows, columns, of_sum] = uniforms else {
            unreachable!("a level has four uniform buffers")
        };
        let (device, gbuffer, LevelBuffers { sums, half_blurred }) = (to.device, to.gbuffer, room);
        let constants = [("CHANNELS", channels as u32)];
        let [position, normal, third] = &around.receivers;
        let reads = [of_splat, position, normal, third, &cloud.totals, &cloud.surfels, &cloud.nodes];
        // The sum is binding 7, and what only some effects read comes after it.
        let more = cloud.sent.iter().chain(&around.more);
        let reads = (0..).zip(reads).chain((8..).zip(more)).collect::<Vec<_>>();
        let groups = groups_of_level([gbuffer.width(), gbuffer.height()], level);
        let splat = device.pass(splat, &constants)?;
        let mut steps = vec![MethodStep::bind_at(device, &splat, groups, &reads, &[(7, sums)])?];
        let blurred = Blurred { image: sums, channels, half_blurred, mask: &around.mask };
        steps.extend(blur::steps(device, gbuffer, blurred, [rows, columns])?);
        let valid = gbuffer.buffer(Attribute::Valid);
        let add = device.pass(add, &constants)?;
        steps.push(MethodStep::bind(device, &add, to.whole(), &[of_sum, valid, sums], &[&around.total])?);
        Ok(steps)
    }
}

/// Workgroups that cover the sub-buffers of a level: columns, rows, sub-buffers.
pub fn groups_of_level(size: [usize; 2], level: usize) -> [u32; 3] {
    let [columns, rows] = size.map(|pixels| (pixels as u32).div_ceil(1 << level).div_ceil(TILE));
    [columns, rows, 1 << (2 * level)]
}

/// What lies between the passes; every level uses it again.
struct LevelBuffers {
    /// `[channels, height, width]`.
    sums: wgpu::Buffer,
    /// `[channels, height, width]`.
    half_blurred: wgpu::Buffer,
}

impl LevelBuffers {
    fn new(to: &Resources<'_>, channels: usize) -> Result<Self, GpuError> {
        let [height, width] = to.size();
        let image = |label: &str| gpu::empty::<f32>(to.device, label, channels * height * width);
        Ok(Self { sums: image("surfel.sums")?, half_blurred: image("surfel.half_blurred")? })
    }
}
