//! What runs on the GPU: the parts one after the other, each into a room that they share, added to the image.

use super::{Part, Shown, lamps, sky, through};
use crate::path::bsdf::directional_table;
use crate::raster::World;
use crate::raster::medium::MediumOnGpu;
use crate::screen::{MethodStep, PassDispatch, Resources};
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::Shader;

/// The passes of parts, of those that the scene has.
///
/// # Errors
/// If there is no scene, or the device has no room.
pub fn steps(parts: &[Part], to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
    let world = to.scene()?;
    let [height, width] = to.size();
    let room = gpu::empty::<f32>(to.device, "composed.part", 3 * height * width)?;
    // How many uniform buffers a part has does not depend on the view.
    let (view, mut of_parts) = to.uniforms.split_at(1);
    let reflectances = gpu::empty::<f32>(to.device, "composed.reflectances", 3 * height * width)?;
    let mut steps = vec![begin_step(to, &view[0])?, reflectance_step(to, world, [&view[0], &reflectances])?];
    if lamps::has(world.scene()) {
        steps.extend(lamps::steps(to, world, &view[0])?.into_iter().map(|step| step.within("lamps")));
    }
    let mut is_dimmed = false;
    for part in parts {
        let (uniforms, rest) = of_parts.split_at(part.uniforms);
        of_parts = rest;
        if !(part.has)(world.scene()) {
            continue;
        }
        if part.shown == Shown::Between && !is_dimmed {
            steps.push(dim_step(to, world, &view[0])?);
            is_dimmed = true;
        }
        let mut made = part.made.steps(&Resources { uniforms, output: &room, ..*to })?;
        if part.shown == Shown::FromSky && world.scene().medium.is_some() {
            made.push(through::step(to, world, [&view[0], &room])?);
        }
        let added = add_step(to, [&view[0], &room, &reflectances], part.shown)?;
        steps.extend(made.into_iter().chain([added]).map(|step| step.within(part.name)));
    }
    Ok(steps)
}

fn begin_step(to: &Resources<'_>, view: &wgpu::Buffer) -> Result<MethodStep, GpuError> {
    let sky = sky(to.environment);
    let texels: Vec<[f32; 4]> = sky.padded().collect();
    let environment = gpu::storage(to.device, "composed.sky", &texels)?;
    let height = ("HEIGHT", sky.height() as u32);
    let pass = to.device.pass(Shader::at("methods/composed/begin"), &[height])?;
    let [valid, light, emission] = to.seen([Attribute::Valid, Attribute::Light, Attribute::Emission]);
    let reads = [view, valid, light, emission, &environment];
    MethodStep::bind(to.device, &pass, to.whole(), &reads, &[to.output])
}

/// What surfaces reflect of light from everywhere, `[3, height, width]`.
fn reflectance_step(
    to: &Resources<'_>,
    world: &World,
    [view, reflectances]: [&wgpu::Buffer; 2],
) -> Result<MethodStep, GpuError> {
    let objects = lamps::of_microfacets(world.scene()).into_iter().map(|is_one| [is_one as f32, 0.0]);
    let table: Vec<[f32; 2]> = directional_table().iter().copied().chain(objects).collect();
    let table = gpu::storage(to.device, "composed.directional", &table)?;
    let pass = to.device.pass(Shader::at("methods/composed/reflectance"), &[])?;
    let [position, normal, diffuse, specular, glossiness, ids] = to.seen([
        Attribute::Position,
        Attribute::Normal,
        Attribute::Diffuse,
        Attribute::Specular,
        Attribute::Glossiness,
        Attribute::ObjectId,
    ]);
    let reads = [view, position, normal, diffuse, specular, glossiness, ids, &table];
    MethodStep::bind(to.device, &pass, to.whole(), &reads, &[reflectances])
}

fn add_step(
    to: &Resources<'_>,
    [view, part, reflectances]: [&wgpu::Buffer; 3],
    shown: Shown,
) -> Result<MethodStep, GpuError> {
    let reflected = ("REFLECTED", u32::from(shown.is_reflected()));
    let pass = to.device.pass(Shader::at("methods/composed/add"), &[reflected])?;
    MethodStep::bind(to.device, &pass, to.whole(), &[view, part, reflectances], &[to.output])
}

fn dim_step(to: &Resources<'_>, world: &World, view: &wgpu::Buffer) -> Result<MethodStep, GpuError> {
    let MediumOnGpu { kind, record, densities } = &world.medium;
    let pass = to.device.pass(Shader::at("methods/composed/dim"), &[("MEDIUM", *kind)])?;
    let [valid, position] = to.seen([Attribute::Valid, Attribute::Position]);
    let buffers = [(0, view), (1, record), (3, valid), (4, position), (5, to.output)];
    let buffers = buffers.map(|(binding, buffer)| (binding, buffer.as_entire_binding()));
    let densities = (2, wgpu::BindingResource::TextureView(densities));
    let pass = pass.bind_at(to.device, buffers.into_iter().chain([densities]))?;
    let step = PassDispatch { pass, workgroups: to.whole().into() };
    Ok(MethodStep { step, writes: vec![to.output.clone()] })
}
