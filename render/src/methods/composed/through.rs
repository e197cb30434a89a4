//! Light of the sky on surfaces, dimmed by the medium on its way to them, as if none of it were hidden: by
//! the mean over 14 directions, by their cosines.

use crate::raster::World;
use crate::raster::medium::MediumOnGpu;
use crate::scene::Medium;
use crate::screen::{MethodStep, PassDispatch, PlainInputs, Resources, View, surface::vector};
use deepshade_shaders::gpu::GpuError;
use deepshade_shaders::wgsl::Shader;
use deepshade_shaders::{Attribute, MissingAttribute, shows_surface};
use glam::{IVec2, Vec3};

/// Points of a way through a grid at which density is looked up.
const POINTS: u32 = 8;

/// Along axes and to corners of a cube; unit vectors.
fn ways() -> impl Iterator<Item = Vec3> {
    let corner = |i: u32| Vec3::from([0, 1, 2].map(|axis| (2 * (i >> axis & 1)) as f32 - 1.0)).normalize();
    (0..8).map(corner).chain(Vec3::AXES.into_iter().flat_map(|axis| [axis, -axis]))
}

/// What of the sky's light comes to a surface, of each colour.
fn share(medium: &Medium, point: Vec3, normal: Vec3) -> Vec3 {
    let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
    for way in ways() {
        let weight = way.dot(normal).max(0.0);
        sum += weight * medium.passed_share(point, way, super::FAR, POINTS);
        weights += weight;
    }
    sum / weights.max(1e-6)
}

/// The pass that dims such a part of an image, `[3, height, width]`.
///
/// # Errors
/// If the device refuses it.
pub fn step(
    to: &Resources<'_>,
    world: &World,
    [view, part]: [&wgpu::Buffer; 2],
) -> Result<MethodStep, GpuError> {
    let MediumOnGpu { kind, record, densities } = &world.medium;
    let pass = to.device.pass(Shader::at("methods/composed/through"), &[("MEDIUM", *kind)])?;
    let [position, normal, valid] = to.seen([Attribute::Position, Attribute::Normal, Attribute::Valid]);
    let buffers = [(0, view), (4, record), (6, part)].into_iter();
    let surfaces = [(1, position), (2, normal), (3, valid)];
    let buffers = buffers.chain(surfaces).map(|(binding, buffer)| (binding, buffer.as_entire_binding()));
    let densities = (5, wgpu::BindingResource::TextureView(densities));
    let pass = pass.bind_at(to.device, buffers.chain([densities]))?;
    let step = PassDispatch { pass, workgroups: to.whole().into() };
    Ok(MethodStep { step, writes: vec![part.clone()] })
}

/// The same in plain Rust.
///
/// # Errors
/// If the g-buffer lacks an attribute.
pub fn dim(
    part: &mut [f32],
    medium: &Medium,
    inputs: &PlainInputs<'_>,
    view: &View,
) -> Result<(), MissingAttribute> {
    let of = |attribute| inputs.gbuffer.select(&[attribute]);
    let (position, normal, valid) = (of(Attribute::Position)?, of(Attribute::Normal)?, of(Attribute::Valid)?);
    let pixels = view.height * view.width;
    for pixel in (0..pixels).filter(|pixel| shows_surface(valid.plane(0)[*pixel])) {
        let at = IVec2::new((pixel % view.width) as i32, (pixel / view.width) as i32);
        let [offset, normal] = [&position, &normal].map(|planes| view.camera.rotation * vector(planes, at));
        let share = share(medium, view.camera.position + offset, normal);
        (0..3).for_each(|channel| part[channel * pixels + pixel] *= share[channel]);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Bounds, Density};

    #[test]
    fn on_the_floor_of_fog_without_an_edge_it_is_the_exponential_integral() {
        let wide = Bounds { min: Vec3::new(-1e4, 0.0, -1e4), max: Vec3::new(1e4, 1.0, 1e4) };
        // Twice the third exponential integral of 0.5 and of 1.
        for (depth, wanted) in [(0.5, 0.4432), (1.0, 0.2194)] {
            let medium =
                Medium::new(Vec3::ZERO, Vec3::splat(depth), 0.0, Density::Within(wide)).expect("fog");
            let is = share(&medium, Vec3::ZERO, Vec3::Y).x;
            assert!((is - wanted).abs() < 0.06, "{depth}: {is}");
        }
    }
}
