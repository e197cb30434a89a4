//! The slow, plain version of `light.wgsl`, kept so close to it that both can be read side by side.

use crate::methods::Surface;
use crate::methods::environment_map::EnvironmentMap;
use deepshade_shaders::{Planes, random, wgsl::uniforms};
use glam::{IVec2, Vec2, Vec3};
use std::f32::consts::TAU;

/// Angle between a direction and the next, turns.
const GOLDEN_TURN: f32 = 0.381_966;

/// Irradiance over pi before the blur, `[3, height, width]`: `light.wgsl`.
pub fn gather_light(surface: &Surface, environment: &EnvironmentMap, ssdo: &uniforms::Ssdo) -> Planes {
    surface.image(0.0, |pixel| light(surface, environment, ssdo, pixel).to_array())
}

/// Whether a point in camera space is behind a surface that the camera sees, and no further than that is
/// thick.
fn is_hidden(surface: &Surface, ssdo: &uniforms::Ssdo, point: Vec3) -> bool {
    let middle = 0.5 * Vec2::new(ssdo.width as f32, ssdo.height as f32);
    let at = (middle + Vec2::new(point.x, -point.y) * (ssdo.focal_length / -point.z)).floor().as_ivec2();
    if point.z.is_nan() || point.z >= 0.0 || !surface.contains(at) || !surface.valid_at(at) {
        return false;
    }
    let position = surface.position_at(at);
    // Behind the plane of the pixel's surface, since the point is beside the ray through the pixel's middle,
    // by more than rounding.
    (point - position).dot(surface.normal_at(at)) < -1e-4 * ssdo.radius
        && point.length() - position.length() < ssdo.thickness
}

/// Whether one of the points along a direction is hidden; they are denser near the surface.
fn is_blocked(surface: &Surface, ssdo: &uniforms::Ssdo, position: Vec3, direction: Vec3, start: f32) -> bool {
    (0..ssdo.steps).any(|step| {
        let share = (step as f32 + start) / ssdo.steps as f32;
        is_hidden(surface, ssdo, position + ssdo.radius * share * share * direction)
    })
}

/// From camera to world space.
fn to_world(ssdo: &uniforms::Ssdo, v: Vec3) -> Vec3 {
    v.x * Vec3::new(ssdo.right_x, ssdo.right_y, ssdo.right_z)
        + v.y * Vec3::new(ssdo.up_x, ssdo.up_y, ssdo.up_z)
        + v.z * Vec3::new(ssdo.back_x, ssdo.back_y, ssdo.back_z)
}

fn light(surface: &Surface, environment: &EnvironmentMap, ssdo: &uniforms::Ssdo, pixel: IVec2) -> Vec3 {
    let position = surface.position_at(pixel);
    let normal = surface.normal_at(pixel);
    // Two tangents (Duff et al. 2017, "Building an Orthonormal Basis, Revisited").
    let sign = if normal.z >= 0.0 { 1.0 } else { -1.0 };
    let a = -1.0 / (sign + normal.z);
    let b = normal.x * normal.y * a;
    let tangent = Vec3::new(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
    let bitangent = Vec3::new(b, sign + normal.y * normal.y * a, -normal.y);
    let draw = |dimension| random::random(pixel.x as u32, pixel.y as u32, ssdo.seed, dimension);
    let (turn, shift) = (draw(0), draw(1));
    let mut light = Vec3::ZERO;
    for k in 0..ssdo.directions {
        // A spiral over the disk, lifted onto the hemisphere, has the density cosine / pi (Malley's method).
        let squared = (k as f32 + shift) / ssdo.directions as f32;
        let angle = TAU * ((GOLDEN_TURN * k as f32 + turn).fract() - 0.5);
        let disk = squared.sqrt() * Vec2::new(angle.cos(), angle.sin());
        let direction = disk.x * tangent + disk.y * bitangent + (1.0 - squared).sqrt() * normal;
        if !is_blocked(surface, ssdo, position, direction, draw(2 + k)) {
            light += environment.radiance(to_world(ssdo, direction));
        }
    }
    light / ssdo.directions as f32
}
