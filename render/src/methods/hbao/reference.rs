//! The slow, plain version of `occlusion.wgsl`, kept so close to it that both can be read side by side.

use crate::methods::Surface;
use deepshade_shaders::{Planes, random, wgsl::uniforms};
use glam::{IVec2, Vec2, Vec3};
use std::f32::consts::PI;

/// Openness before the blur, `[1, height, width]`: `occlusion.wgsl`.
pub fn occlude(surface: &Surface, hbao: &uniforms::Hbao) -> Planes {
    surface.image(1.0, |pixel| [openness(surface, hbao, pixel)])
}

fn openness(surface: &Surface, hbao: &uniforms::Hbao, pixel: IVec2) -> f32 {
    let position = surface.position_at(pixel);
    let normal = surface.normal_at(pixel);
    let extent = (hbao.radius * hbao.focal_length / -position.z).min((hbao.width + hbao.height) as f32);
    if extent.is_nan() || extent < 1.0 {
        return 1.0;
    }
    let count = hbao.steps.min(extent as u32);
    let spacing = extent / count as f32;
    let turn = random::random(pixel.x as u32, pixel.y as u32, hbao.seed, 0);
    let start = random::random(pixel.x as u32, pixel.y as u32, hbao.seed, 1);
    let mut occlusion = 0.0;
    for k in 0..hbao.directions {
        let angle = (k as f32 + turn) * (2.0 * PI / hbao.directions as f32) - PI;
        let samples = (0..count).map(|step| (step as f32 + start) * spacing);
        occlusion += march(surface, hbao, pixel, position, normal, Vec2::from_angle(angle), samples);
    }
    (1.0 - hbao.strength * occlusion / hbao.directions as f32).clamp(0.0, 1.0)
}

/// What occludes a pixel in one direction of the image; `samples` are distances in pixels.
fn march(
    surface: &Surface,
    hbao: &uniforms::Hbao,
    pixel: IVec2,
    position: Vec3,
    normal: Vec3,
    direction: Vec2,
    samples: impl Iterator<Item = f32>,
) -> f32 {
    let mut horizon = 0.0;
    let mut occlusion = 0.0;
    for distance in samples {
        let offset = (direction * distance + 0.5).floor();
        let at = pixel + offset.as_ivec2();
        if !surface.contains(at) {
            break;
        }
        if offset == Vec2::ZERO || !surface.valid_at(at) {
            continue;
        }
        let toward = surface.position_at(at) - position;
        let reach = toward.length();
        let rise = toward.z / reach - biased_tangent(hbao, position, normal, offset);
        if reach < hbao.radius && rise > horizon {
            let nearness = 1.0 - (reach * reach) / (hbao.radius * hbao.radius);
            occlusion += nearness * (rise - horizon);
            horizon = rise;
        }
    }
    occlusion
}

/// Sine of the elevation, above the image plane, of the tangent plane towards another pixel, plus the bias.
fn biased_tangent(hbao: &uniforms::Hbao, position: Vec3, normal: Vec3, offset: Vec2) -> f32 {
    let across = Vec3::new(offset.x, -offset.y, 0.0);
    let sine = (normal.dot(across) * position - normal.dot(position) * across).normalize().z;
    if sine >= hbao.bias_cosine {
        return 1.0;
    }
    sine * hbao.bias_cosine + (1.0 - sine * sine).max(0.0).sqrt() * hbao.bias_sine
}
