//! What runs on the GPU, for each lamp: lines, the bounds of light rays, for each part of the lines their
//! ends, sums and the image, and what is marched of it.

use super::{LEVELS, Part};
use crate::methods::shafts::UNEVEN;
use crate::raster::World;
use crate::raster::light::{Lights, shadow_sampler};
use crate::raster::medium::MediumOnGpu;
use crate::screen::{MethodStep, PassDispatch, Resources, Workgroups};
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::Shader;
use deepshade_shaders::wgsl::uniforms::{EpipolarPart, OfLamp};
use wgpu::{BindingResource, BufferUsages};

/// What lies between the passes; every lamp and every part uses it again.
struct EpipolarBuffers {
    /// `[border + 3 + 3 parts]` u32.
    lines: wgpu::Buffer,
    /// `[lines of a part, light rays]` f32.
    ends: wgpu::Buffer,
    /// `[5, lines of a part, light rays, 2]` u32.
    sums: wgpu::Buffer,
}

/// What the passes of every lamp are bound to.
struct Binding<'a> {
    to: &'a Resources<'a>,
    world: &'a World,
    room: EpipolarBuffers,
    /// Which of the lines' parts a pass is of.
    parts: Vec<wgpu::Buffer>,
}

/// The passes bound to a scene and a g-buffer. They write `image`, `[3, height, width]`, which is black as it
/// was made where there are no lamps.
///
/// # Errors
/// If there is no scene, its medium is a grid, or the device has no room.
pub(super) fn steps(part: Part, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
    let (device, world) = (to.device, to.scene()?);
    if world.medium.kind == MediumOnGpu::GRID {
        return Err(GpuError::Refused { label: "medium".to_owned(), what: UNEVEN.to_owned() });
    }
    let size @ [height, width] = to.size();
    let Part { light_rays, lines } = part;
    let parts = part.count(size);
    let counts = 2 * (height + width) + 3 + 3 * parts;
    let counted = BufferUsages::STORAGE | BufferUsages::INDIRECT | BufferUsages::COPY_SRC;
    let room = EpipolarBuffers {
        lines: gpu::filled(device, "epipolar.lines", &vec![0; 4 * counts], counted)?,
        ends: gpu::empty::<f32>(device, "epipolar.ends", lines * light_rays)?,
        sums: gpu::empty::<[u32; 2]>(device, "epipolar.sums", LEVELS * lines * light_rays)?,
    };
    let number =
        |number: usize| gpu::uniform(device, "epipolar.part", &EpipolarPart { number: number as u32 });
    let parts = (0..parts).map(number).collect::<Result<_, _>>()?;
    let binding = Binding { to, world, room, parts };
    let lamps = (0..world.gpu_lights.count as u32).map(|lamp| binding.of_lamp(lamp));
    Ok(lamps.collect::<Result<Vec<_>, GpuError>>()?.concat())
}

impl Binding<'_> {
    fn of_lamp(&self, number: u32) -> Result<Vec<MethodStep>, GpuError> {
        let Self { to, world, room, parts } = self;
        let [settings, view] = to.uniforms else { unreachable!("it has two uniform buffers") };
        let (device, image) = (to.device, to.output);
        let EpipolarBuffers { lines, ends, sums } = room;
        let Lights { records, map_views, pictures, .. } = &world.gpu_lights;
        let MediumOnGpu { record, densities, .. } = &world.medium;
        let [height, width] = to.size();
        let [valid, position] = to.seen([Attribute::Valid, Attribute::Position]);
        let whole = Workgroups::from(to.whole());
        let first_counts = 2 * (height + width) + 3;
        let sampler = shadow_sampler(device);
        let lamp = gpu::uniform(device, "epipolar.lamp", &OfLamp { number })?;
        let of_lamp = [(13, lamp.as_entire_binding())];
        let dimmed = [(11, record.as_entire_binding()), (12, BindingResource::TextureView(densities))];
        let maps = BindingResource::TextureView(&world.shadows.maps);
        let medium = [("MEDIUM", world.medium.kind)];
        let step = |pass: Result<Pass, GpuError>,
                    workgroups: &Workgroups,
                    resources: &[&[_]],
                    written: &wgpu::Buffer| {
            let pass = pass?.bind_at(device, resources.concat())?;
            let step = PassDispatch { pass, workgroups: workgroups.clone() };
            Ok::<_, GpuError>(MethodStep { step, writes: vec![written.clone()] })
        };
        let seen = [settings, view, record, records, valid, position, lines];
        let traced = [settings, view, records, map_views, lines, ends];
        let gathered = [settings, view, records, pictures, valid, position, lines, ends, sums, image];
        let marched = [settings, view, records, map_views, pictures, valid, position, lines, image];
        let looked_up = [(9, maps.clone()), (10, BindingResource::Sampler(&sampler))];
        let mut steps = vec![
            step(
                device.pass(Shader::at("methods/epipolar/lines"), &[]),
                &[1; 3].into(),
                &[&buffers(&[settings, view, records, lines]), &of_lamp],
                lines,
            )?,
            step(
                device.pass(Shader::at("methods/epipolar/bounds"), &medium),
                &whole,
                &[&buffers(&seen), &of_lamp],
                lines,
            )?,
        ];
        for (number, part) in parts.iter().enumerate() {
            let of_part = [(14, part.as_entire_binding())];
            let by_lines = Workgroups::Counted(lines.clone(), 4 * (first_counts + 3 * number) as u64);
            steps.extend([
                step(
                    device.pass(Shader::at("methods/epipolar/trace"), &[]),
                    &by_lines,
                    &[&buffers(&traced), &[(6, maps.clone())], &of_lamp, &of_part],
                    ends,
                )?,
                step(
                    device.pass(Shader::at("methods/epipolar/sums"), &[]),
                    &by_lines,
                    &[&buffers(&[settings, ends, sums])],
                    sums,
                )?,
                step(
                    device.pass(Shader::at("methods/epipolar/gather"), &medium),
                    &whole,
                    &[&buffers(&gathered), &dimmed, &of_lamp, &of_part],
                    image,
                )?,
            ]);
        }
        steps.push(step(
            device.pass(Shader::at("methods/epipolar/march"), &medium),
            &whole,
            &[&buffers(&marched), &looked_up, &dimmed, &of_lamp],
            image,
        )?);
        Ok(steps)
    }
}

/// Bindings from 0 on.
fn buffers<'a>(buffers: &[&'a wgpu::Buffer]) -> Vec<(u32, BindingResource<'a>)> {
    (0..).zip(buffers).map(|(binding, buffer)| (binding, buffer.as_entire_binding())).collect()
}
