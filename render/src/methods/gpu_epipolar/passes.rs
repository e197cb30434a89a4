//! What runs on the GPU, for each lamp: lines, the bounds of light rays, their ends, sums, the image, and what is marched of it.

use super::{LEVELS, Parameters};
use crate::raster::World;
use crate::raster::light::{Lights, shadow_sampler};
use crate::raster::medium::MediumOnGpu;
use crate::screen::{Inputs, MethodStep, Step, Workgroups};
use crate::surfels::frame;
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::{self, Shader, TILE};
use wgpu::{BindingResource, BufferUsages};

/// Which kind of medium is a grid: `GRID` in shaders.
const GRID: u32 = 2;

/// What lies between the passes; every lamp uses it again.
struct Room {
    /// `[border + 6]` u32.
    lines: wgpu::Buffer,
    /// `[lines, light rays]` f32.
    ends: wgpu::Buffer,
    /// `[5, lines, light rays, 2]` u32.
    sums: wgpu::Buffer,
}

/// What the passes of every lamp are bound to.
struct Binding<'a> {
    device: &'a wgpu::Device,
    inputs: &'a Inputs<'a>,
    world: &'a World,
    settings: &'a wgpu::Buffer,
    view: &'a wgpu::Buffer,
    room: Room,
    image: &'a wgpu::Buffer,
}

/// The passes bound to a scene and a g-buffer. They write `image`, `[3, height, width]`.
///
/// # Errors
/// If there is no scene, its medium is a grid, or the device has no room.
pub fn steps(
    device: &wgpu::Device,
    inputs: &Inputs<'_>,
    parameters: Parameters,
    uniforms: &[wgpu::Buffer],
    image: &wgpu::Buffer,
) -> Result<Vec<MethodStep>, GpuError> {
    let world = frame::scene(inputs.world)?;
    if world.medium.kind == GRID {
        return Err(GpuError::Refused {
            label: "deepshade.medium".to_owned(),
            what: "the medium is a grid, and light must be dimmed alike everywhere; `gpu-march` and `froxel` go \
                   through grids"
                .to_owned(),
        });
    }
    let [settings, view] = uniforms else { unreachable!("it has two uniform buffers") };
    let size = [inputs.gbuffer.height(), inputs.gbuffer.width()];
    let (lines, rays) = (Parameters::lines(size), parameters.rays(size));
    let counted = BufferUsages::STORAGE | BufferUsages::INDIRECT | BufferUsages::COPY_SRC;
    let room = Room {
        lines: gpu::filled(device, "epipolar.lines", &vec![0; 4 * (lines + 4)], counted)?,
        ends: gpu::empty::<f32>(device, "epipolar.ends", lines * rays)?,
        sums: gpu::empty::<[u32; 2]>(device, "epipolar.sums", LEVELS * lines * rays)?,
    };
    let binding = Binding { device, inputs, world, settings, view, room, image };
    let lamps = (0..world.gpu_lights.count as u32).map(|lamp| binding.of_lamp(lamp));
    Ok(lamps.collect::<Result<Vec<_>, GpuError>>()?.concat())
}

impl Binding<'_> {
    fn of_lamp(&self, lamp: u32) -> Result<Vec<MethodStep>, GpuError> {
        let Self { device, inputs, world, settings, view, room, image } = self;
        let Room { lines, ends, sums } = room;
        let Lights { records, map_views, pictures, .. } = &world.gpu_lights;
        let MediumOnGpu { record, densities, kind } = &world.medium;
        let (height, width) = (inputs.gbuffer.height(), inputs.gbuffer.width());
        let [valid, position] = [Attribute::Valid, Attribute::Position].map(|a| inputs.gbuffer.buffer(a));
        let whole = Workgroups::from(gpu::groups(height, width, TILE));
        let by_lines = Workgroups::Counted(lines.clone(), 4 * (2 * (height + width) as u64 + 3));
        let sampler = shadow_sampler(device);
        let dimmed = [(11, record.as_entire_binding()), (12, BindingResource::TextureView(densities))];
        let maps = BindingResource::TextureView(&world.shadows.maps);
        let step = |shader: &Shader, workgroups: &Workgroups, resources, written: &wgpu::Buffer| {
            let known = |(name, _): &(&str, u32)| shader.constants.iter().any(|(other, _)| other == name);
            let constants: Vec<_> = [("LAMP", lamp), ("MEDIUM", *kind)].into_iter().filter(known).collect();
            let resources: Vec<(u32, BindingResource<'_>)> = resources;
            let pass = Pass::new(device, shader.name, &shader.specialised(&constants))?;
            let pass = pass.bind_at(device, resources)?;
            let step = Step { pass, workgroups: workgroups.clone() };
            Ok(MethodStep { step, writes: vec![written.clone()] })
        };
        Ok(vec![
            step(&wgsl::EPIPOLAR_LINES, &[1; 3].into(), buffers(&[settings, view, records, lines]), lines)?,
            step(
                &wgsl::EPIPOLAR_BOUNDS,
                &whole,
                buffers(&[settings, view, record, records, valid, position, lines]),
                lines,
            )?,
            step(
                &wgsl::EPIPOLAR_TRACE,
                &by_lines,
                [buffers(&[settings, view, records, map_views, lines, ends]), vec![(6, maps.clone())]]
                    .concat(),
                ends,
            )?,
            step(&wgsl::EPIPOLAR_SUMS, &by_lines, buffers(&[settings, ends, sums]), sums)?,
            step(
                &wgsl::EPIPOLAR_GATHER,
                &whole,
                [
                    buffers(&[settings, view, records, pictures, valid, position, lines, ends, sums, image]),
                    dimmed.to_vec(),
                ]
                .concat(),
                image,
            )?,
            step(
                &wgsl::EPIPOLAR_MARCH,
                &whole,
                [
                    buffers(&[settings, view, records, map_views, pictures, valid, position, lines, image]),
                    vec![(9, maps), (10, BindingResource::Sampler(&sampler))],
                    dimmed.to_vec(),
                ]
                .concat(),
                image,
            )?,
        ])
    }
}

/// Bindings from 0 on.
fn buffers<'a>(buffers: &[&'a wgpu::Buffer]) -> Vec<(u32, BindingResource<'a>)> {
    (0..).zip(buffers).map(|(binding, buffer)| (binding, buffer.as_entire_binding())).collect()
}
