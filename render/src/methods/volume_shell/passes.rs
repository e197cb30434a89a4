//! What runs on the GPU: surfels, their light through the medium and their tree; the interval map; the levels
//! one after the other, and their sum.

use super::improvements::Improvement;
use super::map::{self, IntervalMap};
use super::pyramid::{self, PyramidBuffers};
use super::{VolumeShellParameters, far_reaching};
use crate::methods::surfel::passes::groups_of_level;
use crate::raster::World;
use crate::raster::medium::MediumOnGpu;
use crate::screen::{Device, MethodStep, PassDispatch, Resources, View, Workgroups};
use crate::surfels::{Cloud, SurfelLight, Tree, frame};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::{Shader, uniforms};

/// Runs of a splat, each over a part of the tree's leaves: lavapipe ends the loops of an invocation after
/// 65,535 turns in all, and what all of them do to a pixel may take more.
const PARTS: u32 = 16;

/// The contents of the passes' uniform buffers: surfels and their tree, march, splats, then of each level
/// splat and sum.
pub fn uniforms(parameters: &VolumeShellParameters, view: &View) -> Vec<Vec<u8>> {
    let mut settings = parameters.surfels;
    // Near is over the effect's radius, which is not how far surfels matter.
    settings.near *= view.radius / far_reaching(view).radius;
    let mut all: Vec<Vec<u8>> = frame::uniforms(&settings, &far_reaching(view)).collect();
    all.push(bytes_of(&parameters.division(view.seed).marching(view)).to_vec());
    all.push(bytes_of(&parameters.scattering(view)).to_vec());
    for level in 0..parameters.levels {
        all.push(bytes_of(&parameters.level(level, view)).to_vec());
        let (width, height) = (view.width as u32, view.height as u32);
        let first = u32::from(level == 0);
        let last = u32::from(level + 1 == parameters.levels);
        all.push(bytes_of(&uniforms::LevelSum { width, height, first, last, background: 0.0 }).to_vec());
    }
    all
}

/// The passes bound to a scene and a g-buffer.
///
/// # Errors
/// If there is no scene, or the device has no room for what lies between them.
pub fn steps(parameters: &VolumeShellParameters, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
    let (device, world) = (to.device, to.scene()?);
    let (of_surfels, [march, volume, levels @ ..]) = to.uniforms.split_at(frame::UNIFORMS) else {
        unreachable!("march and splats have a uniform buffer each")
    };
    let lit = Some(SurfelLight::Dimmed { is_grey: parameters.is_grey() });
    let (cloud, mut steps) = frame::steps(device, world, of_surfels, Tree::Lit, lit)?;
    let view = &of_surfels[1];
    let (map, step) = IntervalMap::step(&parameters.division(0), to, map::Uniforms { march, view })?;
    steps.push(step);
    let [height, width] = to.size();
    let sums = gpu::empty::<[f32; 4]>(device, "volume-shell.sums", height * width)?;
    let room = PyramidBuffers::new(device, [width, height], levels.len() / 2 - 1)?;
    let pass = splat_pass(device, parameters, world.medium.kind)?;
    let add = device.pass(Shader::at("methods/volume-shell/add"), &[])?;
    let part = |index| gpu::uniform(device, "volume-shell.part", &uniforms::SplatPart { index });
    let parts = (0..PARTS).map(part).collect::<Result<Vec<_>, _>>()?;
    let splatting = Splatting { pass, world, volume, view, cloud: &cloud, map: &map, sums: &sums };
    for (level, uniforms) in levels.chunks_exact(2).enumerate() {
        let [splat, sum] = uniforms else { unreachable!("a level has two uniform buffers") };
        let workgroups = groups_of_level([width, height], level);
        for part in &parts {
            steps.push(splatting.step(device, [splat, part], workgroups.into())?);
        }
        let smooth = if level == 0 { &sums } else { &room.smooth };
        if level > 0 {
            steps.extend(pyramid::steps(device, &sums, &room, level)?);
        }
        steps.push(MethodStep::bind(device, &add, to.whole(), &[sum, &sums, smooth], &[to.output])?);
    }
    Ok(steps)
}

/// The pass that splats a level, for a kind of medium.
fn splat_pass(device: &Device, parameters: &VolumeShellParameters, medium: u32) -> Result<Pass, GpuError> {
    let improvements = parameters.improvements;
    let shader = match improvements.has(Improvement::WideEncoding) {
        true => Shader::at("methods/volume-shell/splat"),
        false => Shader::at("methods/volume-shell/paper_splat"),
    };
    let constants = [
        ("SAMPLES", parameters.samples),
        ("MEDIUM", medium),
        ("PARTS", PARTS),
        ("LOOKUPS", parameters.points.max(1)),
        ("GREY", u32::from(parameters.is_grey())),
        ("ATTENUATED", improvements.flag(Improvement::Attenuation)),
        ("TOUCHED_ONLY", improvements.flag(Improvement::TouchedOnly)),
        ("SILHOUETTES", improvements.flag(Improvement::Silhouettes)),
    ];
    device.pass(shader, &constants)
}

/// What the splats of all levels are bound to.
struct Splatting<'a> {
    pass: Pass,
    world: &'a World,
    volume: &'a wgpu::Buffer,
    view: &'a wgpu::Buffer,
    cloud: &'a Cloud,
    map: &'a IntervalMap,
    sums: &'a wgpu::Buffer,
}

impl Splatting<'_> {
    fn step(
        &self,
        device: &wgpu::Device,
        [level, part]: [&wgpu::Buffer; 2],
        workgroups: Workgroups,
    ) -> Result<MethodStep, GpuError> {
        let MediumOnGpu { record, densities, .. } = &self.world.medium;
        let Cloud { totals, surfels, nodes, sent, .. } = self.cloud;
        let buffers = [level, self.volume, self.view, record, totals, surfels, nodes, self.sums];
        let more = sent.iter().chain([&self.map.rays, &self.map.samples]);
        let buffers = buffers.into_iter().chain(more).map(|buffer| buffer.as_entire_binding());
        let densities = wgpu::BindingResource::TextureView(densities);
        let resources: Vec<_> = buffers.chain([densities, part.as_entire_binding()]).collect();
        let pass = self.pass.bind(device, &resources)?;
        Ok(MethodStep { step: PassDispatch { pass, workgroups }, writes: vec![self.sums.clone()] })
    }
}
