//! The slow, plain version of `occlusion.wgsl` and `blur.wgsl`, kept so close to them that both can be read side by
//! side.

use super::{Settings, Surface};
use deepshade_shaders::{Planes, random, shows_surface, wgsl::uniforms};
use glam::{IVec2, Vec2, Vec3};
use rayon::prelude::*;
use std::f32::consts::PI;

/// Openness after the blur, `[1, height, width]`.
pub fn shade(surface: &Surface, settings: &Settings) -> Planes {
    let [rows, columns] = &settings.blurs;
    blur(surface, columns, &blur(surface, rows, &occlude(surface, &settings.occlusion)))
}

/// Openness before the blur, `[1, height, width]`: `occlusion.wgsl`.
pub fn occlude(surface: &Surface, hbao: &uniforms::Hbao) -> Planes {
    image(surface, |pixel| openness(surface, hbao, pixel))
}

/// One direction of the blur of `openness`, `[1, height, width]`: `blur.wgsl`.
pub fn blur(surface: &Surface, blur: &uniforms::HbaoBlur, openness: &Planes) -> Planes {
    image(surface, |centre| {
        let position = surface.position_at(centre);
        let normal = surface.normal_at(centre);
        let mut sum = 0.0;
        let mut weights = 0.0;
        for i in -blur.radius..=blur.radius {
            let at = centre + i * IVec2::new(blur.step_x, blur.step_y);
            if !surface.contains(at) || !surface.valid_at(at) {
                continue;
            }
            let off_plane = blur.sharpness * normal.dot(surface.position_at(at) - position);
            let weight = (-(blur.falloff * (i * i) as f32 + off_plane * off_plane)).exp();
            sum += weight * openness.at(0, at.y as usize, at.x as usize);
            weights += weight;
        }
        sum / weights
    })
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

/// An image of `value` where the surface is valid and 1 elsewhere.
fn image(surface: &Surface, value: impl Fn(IVec2) -> f32 + Sync) -> Planes {
    let (height, width) = (surface.height, surface.width);
    let pixels = (0..height * width).into_par_iter().map(|index| {
        let pixel = IVec2::new((index % width) as i32, (index / width) as i32);
        if surface.valid_at(pixel) { value(pixel) } else { 1.0 }
    });
    Planes::from_data(1, height, width, pixels.collect())
}

/// What `shared/surface.wgsl` offers.
impl Surface {
    fn contains(&self, at: IVec2) -> bool {
        at.cmpge(IVec2::ZERO).all() && (at.x as usize) < self.width && (at.y as usize) < self.height
    }

    fn position_at(&self, at: IVec2) -> Vec3 {
        vector(&self.position, at)
    }

    fn normal_at(&self, at: IVec2) -> Vec3 {
        vector(&self.normal, at)
    }

    fn valid_at(&self, at: IVec2) -> bool {
        shows_surface(self.valid.at(0, at.y as usize, at.x as usize))
    }
}

fn vector(planes: &Planes, at: IVec2) -> Vec3 {
    let component = |channel| planes.at(channel, at.y as usize, at.x as usize);
    Vec3::new(component(0), component(1), component(2))
}
