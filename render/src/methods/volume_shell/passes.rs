//! What runs on the GPU: surfels, their light through the medium and their tree; the interval map; the levels one after the
//! other, and their sum.

use super::improvements::Improvement;
use super::map::{self, IntervalMap};
use super::pyramid::{Pyramid, Room};
use super::{Parameters, far_reaching};
use crate::methods::surfel::passes::groups_of_level;
use crate::raster::World;
use crate::raster::medium::MediumOnGpu;
use crate::screen::{Inputs, MethodStep, Step, View, Workgroups};
use crate::surfels::{self, Cloud, Lit, Tree, frame};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::{self, TILE, uniforms};

/// Runs of a splat, each over a part of the tree's leaves: lavapipe ends the loops of an invocation after 65,535 turns in all, and what
/// all of them do to a pixel may take more.
const PARTS: u32 = 16;

/// The compiled passes; those that depend on parameters are compiled where they are bound.
#[derive(Clone, Debug)]
pub struct Passes {
    surfels: surfels::Passes,
    pyramid: Pyramid,
    add: Pass,
}

/// The contents of the passes' uniform buffers: surfels and their tree, march, splats, then of each level splat and sum.
pub fn uniforms(parameters: &Parameters, view: &View) -> Vec<Vec<u8>> {
    let mut settings = parameters.surfels;
    // Near is over the effect's radius, which is not how far surfels matter.
    settings.near *= view.radius / far_reaching(view).radius;
    let mut all: Vec<Vec<u8>> = frame::uniforms(&settings, &far_reaching(view)).collect();
    all.push(bytes_of(&parameters.marching(view)).to_vec());
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

impl Passes {
    /// Compiles them.
    ///
    /// # Errors
    /// If the device refuses them.
    pub fn new(device: &wgpu::Device) -> Result<Self, GpuError> {
        let add = &wgsl::VOLUME_SHELL_ADD;
        Ok(Self {
            surfels: surfels::Passes::new(device, Tree::Lit)?,
            pyramid: Pyramid::new(device)?,
            add: Pass::new(device, add.name, &add.source())?,
        })
    }

    /// The passes bound to a scene and a g-buffer. They write `image`, `[3, height, width]`.
    ///
    /// # Errors
    /// If there is no scene, or the device has no room for what lies between them.
    pub fn steps(
        &self,
        device: &wgpu::Device,
        parameters: &Parameters,
        inputs: &Inputs<'_>,
        uniforms: &[wgpu::Buffer],
        image: &wgpu::Buffer,
    ) -> Result<Vec<MethodStep>, GpuError> {
        let world = frame::scene(inputs.world)?;
        let (of_surfels, [march, volume, levels @ ..]) = uniforms.split_at(frame::UNIFORMS) else {
            unreachable!("march and splats have a uniform buffer each")
        };
        let lit = Some(Lit::Dimmed { is_grey: parameters.is_grey() });
        let (cloud, mut steps) = frame::steps(&self.surfels, device, inputs.world, of_surfels, lit)?;
        let view = &of_surfels[1];
        let read = map::Uniforms { march, view };
        let (map, step) = IntervalMap::step(device, parameters, inputs.gbuffer, world, read)?;
        steps.push(step);
        let (height, width) = (inputs.gbuffer.height(), inputs.gbuffer.width());
        let sums = gpu::empty::<[f32; 4]>(device, "volume-shell.sums", height * width)?;
        let room = Room::new(device, [width, height], levels.len() / 2 - 1)?;
        let pass = splat_pass(device, parameters, world.medium.kind)?;
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
                steps.extend(self.pyramid.steps(device, &sums, &room, level)?);
            }
            let whole = gpu::groups(height, width, TILE);
            steps.push(MethodStep::bind(device, &self.add, whole, &[sum, &sums, smooth], &[image])?);
        }
        Ok(steps)
    }
}

/// The pass that splats a level, for a kind of medium.
fn splat_pass(device: &wgpu::Device, parameters: &Parameters, medium: u32) -> Result<Pass, GpuError> {
    let improvements = parameters.improvements;
    let shader = match improvements.has(Improvement::WideEncoding) {
        true => &wgsl::VOLUME_SHELL_SPLAT,
        false => &wgsl::VOLUME_SHELL_PAPER_SPLAT,
    };
    let source = shader.specialised(&[
        ("SAMPLES", parameters.samples),
        ("MEDIUM", medium),
        ("PARTS", PARTS),
        ("LOOKUPS", parameters.points.max(1)),
        ("GREY", u32::from(parameters.is_grey())),
        ("ATTENUATED", improvements.flag(Improvement::Attenuation)),
        ("TOUCHED_ONLY", improvements.flag(Improvement::TouchedOnly)),
        ("SILHOUETTES", improvements.flag(Improvement::Silhouettes)),
    ]);
    Pass::new(device, shader.name, &source)
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
        Ok(MethodStep { step: Step { pass, workgroups }, writes: vec![self.sums.clone()] })
    }
}
