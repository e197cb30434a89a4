//! What runs on the GPU, for each lamp: lines, the bounds of light rays, their ends, sums, the image, and what is marched of it.

use super::{LEVELS, Parameters};
use crate::methods::shafts::UNEVEN;
use crate::raster::World;
use crate::raster::light::{Lights, shadow_sampler};
use crate::raster::medium::MediumOnGpu;
use crate::screen::{Inputs, MethodStep, Step, Workgroups};
use crate::surfels::frame;
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::uniforms::OfLamp;
use deepshade_shaders::wgsl::{self, Shader, TILE};
use wgpu::{BindingResource, BufferUsages};

/// What lies between the passes; every lamp uses it again.
struct Room {
    /// `[border + 6]` u32.
    lines: wgpu::Buffer,
    /// `[lines, light rays]` f32.
    ends: wgpu::Buffer,
    /// `[5, lines, light rays, 2]` u32.
    sums: wgpu::Buffer,
}

/// The passes, compiled for a scene's medium.
struct Passes {
    lines: Pass,
    bounds: Pass,
    trace: Pass,
    sums: Pass,
    gather: Pass,
    march: Pass,
}

impl Passes {
    fn new(device: &wgpu::Device, medium: u32) -> Result<Self, GpuError> {
        let pass = |shader: &Shader, constants: &[(&str, u32)]| {
            Pass::new(device, shader.name, &shader.specialised(constants))
        };
        let medium = [("MEDIUM", medium)];
        Ok(Self {
            lines: pass(&wgsl::EPIPOLAR_LINES, &[])?,
            bounds: pass(&wgsl::EPIPOLAR_BOUNDS, &medium)?,
            trace: pass(&wgsl::EPIPOLAR_TRACE, &[])?,
            sums: pass(&wgsl::EPIPOLAR_SUMS, &[])?,
            gather: pass(&wgsl::EPIPOLAR_GATHER, &medium)?,
            march: pass(&wgsl::EPIPOLAR_MARCH, &medium)?,
        })
    }
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

/// The passes bound to a scene and a g-buffer. They write `image`, `[3, height, width]`, which is black as it was made where there
/// are no lamps.
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
    if world.medium.kind == MediumOnGpu::GRID {
        return Err(GpuError::Refused { label: "medium".to_owned(), what: UNEVEN.to_owned() });
    }
    let [settings, view] = uniforms else { unreachable!("it has two uniform buffers") };
    let size @ [height, width] = [inputs.gbuffer.height(), inputs.gbuffer.width()];
    let (lines, rays) = (Parameters::lines(size), parameters.rays(size));
    let counted = BufferUsages::STORAGE | BufferUsages::INDIRECT | BufferUsages::COPY_SRC;
    let room = Room {
        lines: gpu::filled(device, "epipolar.lines", &vec![0; 4 * (2 * (height + width) + 6)], counted)?,
        ends: gpu::empty::<f32>(device, "epipolar.ends", lines * rays)?,
        sums: gpu::empty::<[u32; 2]>(device, "epipolar.sums", LEVELS * lines * rays)?,
    };
    let passes = Passes::new(device, world.medium.kind)?;
    let binding = Binding { device, inputs, world, settings, view, room, image };
    let lamps = (0..world.gpu_lights.count as u32).map(|lamp| binding.of_lamp(&passes, lamp));
    Ok(lamps.collect::<Result<Vec<_>, GpuError>>()?.concat())
}

impl Binding<'_> {
    fn of_lamp(&self, passes: &Passes, number: u32) -> Result<Vec<MethodStep>, GpuError> {
        let Self { device, inputs, world, settings, view, room, image } = self;
        let Room { lines, ends, sums } = room;
        let Lights { records, map_views, pictures, .. } = &world.gpu_lights;
        let MediumOnGpu { record, densities, .. } = &world.medium;
        let (height, width) = (inputs.gbuffer.height(), inputs.gbuffer.width());
        let [valid, position] = [Attribute::Valid, Attribute::Position].map(|a| inputs.gbuffer.buffer(a));
        let whole = Workgroups::from(gpu::groups(height, width, TILE));
        let by_lines = Workgroups::Counted(lines.clone(), 4 * (2 * (height + width) as u64 + 3));
        let sampler = shadow_sampler(device);
        let lamp = gpu::uniform(device, "epipolar.lamp", &OfLamp { number })?;
        let of_lamp = [(13, lamp.as_entire_binding())];
        let dimmed = [(11, record.as_entire_binding()), (12, BindingResource::TextureView(densities))];
        let maps = BindingResource::TextureView(&world.shadows.maps);
        let step = |pass: &Pass, workgroups: &Workgroups, resources: &[&[_]], written: &wgpu::Buffer| {
            let pass = pass.bind_at(device, resources.concat())?;
            let step = Step { pass, workgroups: workgroups.clone() };
            Ok::<_, GpuError>(MethodStep { step, writes: vec![written.clone()] })
        };
        let seen = [*settings, view, record, records, valid, position, lines];
        let traced = [*settings, view, records, map_views, lines, ends];
        let gathered = [*settings, view, records, pictures, valid, position, lines, ends, sums, image];
        let marched = [*settings, view, records, map_views, pictures, valid, position, lines, image];
        let looked_up = [(9, maps.clone()), (10, BindingResource::Sampler(&sampler))];
        Ok(vec![
            step(
                &passes.lines,
                &[1; 3].into(),
                &[&buffers(&[settings, view, records, lines]), &of_lamp],
                lines,
            )?,
            step(&passes.bounds, &whole, &[&buffers(&seen), &of_lamp], lines)?,
            step(&passes.trace, &by_lines, &[&buffers(&traced), &[(6, maps)], &of_lamp], ends)?,
            step(&passes.sums, &by_lines, &[&buffers(&[settings, ends, sums])], sums)?,
            step(&passes.gather, &whole, &[&buffers(&gathered), &dimmed, &of_lamp], image)?,
            step(&passes.march, &whole, &[&buffers(&marched), &looked_up, &dimmed, &of_lamp], image)?,
        ])
    }
}

/// Bindings from 0 on.
fn buffers<'a>(buffers: &[&'a wgpu::Buffer]) -> Vec<(u32, BindingResource<'a>)> {
    (0..).zip(buffers).map(|(binding, buffer)| (binding, buffer.as_entire_binding())).collect()
}
