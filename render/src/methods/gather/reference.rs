//! The slow, plain version of `areas.wgsl` and `gather.wgsl`, kept so close to them that both can be read
//! side by side.

use crate::methods::Translucent;
use crate::methods::picture::every_pixel;
use deepshade_shaders::{Planes, random, wgsl::uniforms};
use glam::{IVec2, Vec2, Vec3};
use std::f32::consts::PI;

/// The cosine that seen surfaces have at least.
const LEAST_COSINE: f32 = 0.05;
/// Angle between a sample and the next, turns.
const GOLDEN_TURN: f32 = 0.381_966;
/// The share of the profile that is left out.
const LEFT_OUT: f32 = 1e-4;

/// The areas of what pixels show, square metres, `[1, height, width]`, and scattered light, radiance,
/// `[3, height, width]`.
pub fn shade(surface: &Translucent, settings: &uniforms::Gather) -> [Planes; 2] {
    let (height, width) = (surface.picture.height, surface.picture.width);
    let areas = every_pixel(height, width, |pixel| area_of_surface(surface, settings, pixel));
    let light = surface.picture.image(|pixel| surface.picture.light_at(pixel));
    let image = surface.image(&light, |pixel, channel, d| {
        gather_channel(surface, &light, &areas, settings, pixel, channel, d)
    });
    [Planes::from_data(1, height, width, areas), image]
}

/// `areas.wgsl`
pub fn area_of_surface(surface: &Translucent, settings: &uniforms::Gather, pixel: IVec2) -> f32 {
    if !surface.picture.valid_at(pixel) {
        return 0.0;
    }
    let here = surface.position_at(pixel);
    let normal = way(surface, pixel, here, IVec2::X).cross(way(surface, pixel, here, IVec2::Y));
    let mut cosine = 1.0;
    if normal.length_squared() > 0.0 {
        cosine = normal.normalize().dot(here.normalize()).abs().max(LEAST_COSINE);
    }
    let size = -here.z / settings.focal_length;
    size * size * -here.z / (here.length() * cosine)
}

/// The surface's way to the neighbour before or after, whichever is nearer in depth; 0 where there is
/// neither.
fn way(surface: &Translucent, pixel: IVec2, here: Vec3, step: IVec2) -> Vec3 {
    let mut nearest = Vec3::ZERO;
    for side in [-1, 1] {
        let at = pixel + side * step;
        if !surface.picture.contains(at) || !surface.picture.valid_at(at) {
            continue;
        }
        let difference = side as f32 * (surface.position_at(at) - here);
        if nearest == Vec3::ZERO || difference.z.abs() < nearest.z.abs() {
            nearest = difference;
        }
    }
    nearest
}

fn profile(r: f32, d: f32) -> f32 {
    let slow = (-r / (3.0 * d)).exp();
    (slow * slow * slow + slow) / (8.0 * PI * d * r)
}

fn within(r: f32, d: f32) -> f32 {
    let slow = (-r / (3.0 * d)).exp();
    1.0 - 0.25 * slow * slow * slow - 0.75 * slow
}

/// The radius of the disc that holds a share of the profile: the inverse of `within`.
pub fn radius_of(share: f32, d: f32) -> f32 {
    let left = 2.0 * (1.0 - share);
    let root = (left + (left * left + 1.0).sqrt()).powf(1.0 / 3.0);
    -3.0 * d * (root - 1.0 / root).ln()
}

/// `gather.wgsl`
fn gather_channel(
    surface: &Translucent,
    unblurred: &Planes,
    areas: &[f32],
    settings: &uniforms::Gather,
    pixel: IVec2,
    channel: usize,
    d: f32,
) -> f32 {
    let at_pixel = |at: IVec2| unblurred.at(channel, at.y as usize, at.x as usize);
    let area_at = |at: IVec2| areas[at.y as usize * surface.picture.width + at.x as usize];
    let here = surface.position_at(pixel);
    let size = -here.z / settings.focal_length;
    let own = within((area_at(pixel) / PI).sqrt(), d);
    let first = within(0.5 * size, d);
    let random =
        |dimension: usize| random::random(pixel.x as u32, pixel.y as u32, settings.seed, dimension as u32);
    let (start, turn) = (random(2 * channel), random(2 * channel + 1));
    let mut light = own * at_pixel(pixel);
    let mut weights = own;
    for i in 0..settings.samples {
        let share = first + (1.0 - first) * (i as f32 + start) / settings.samples as f32;
        let radius = radius_of(share.min(1.0 - LEFT_OUT), d);
        let angle = ((i as f32 * GOLDEN_TURN + turn).fract() - 0.5) * (2.0 * PI);
        let offset = (radius / size * Vec2::from_angle(angle) + 0.5).floor();
        let beyond = Vec2::splat((settings.width + settings.height) as f32);
        if offset == Vec2::ZERO || offset.abs().cmpgt(beyond).any() {
            continue;
        }
        let at = pixel + offset.as_ivec2();
        if !surface.picture.contains(at) || area_at(at) == 0.0 {
            continue;
        }
        let area = area_at(at);
        let apart = surface.position_at(at).distance(here).max((area / PI).sqrt());
        let density = profile(radius, d) * size * size / (1.0 - first);
        let weight = area * profile(apart, d) / (density * settings.samples as f32);
        light += weight * at_pixel(at);
        weights += weight;
    }
    light / weights
}
