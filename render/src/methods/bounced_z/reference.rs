//! The bounced z-buffer in plain Rust: every ray against every disk of its sub-buffers, without a tree, and the filter.

use super::{BouncedEffect, Parameters};
use crate::methods::Surface;
use crate::methods::surfel::shells;
use crate::screen::View;
use crate::surfels::reference::Disk;
use deepshade_shaders::random::{hash, random};
use deepshade_shaders::wgsl::uniforms;
use deepshade_shaders::{Effect, Planes};
use glam::{IVec2, UVec2, Vec2, Vec3};
use rayon::prelude::*;
use std::f32::consts::TAU;

/// The pixels of a square of 4 x 4 share one spiral of directions.
const SQUARE: u32 = 2;
const IN_SQUARE: u32 = 16;
/// Angle between a direction of the spiral and the next, turns.
const GOLDEN_TURN: f32 = 0.381_966;
/// Sine of the least angle between the way to a disk and either surface.
const LEAST_SINE: f32 = 1e-3;
/// A neighbour counts the cosine of its normal to the pixel's to this power.
const NORMAL_POWER: i32 = 8;
/// Below this a cosine is rounding.
const LEAST_COSINE: f32 = 1e-3;

/// A direction that a pixel looks into, and what arrives from there.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Unit vector, camera space.
    pub direction: Vec3,
    /// Radiance.
    pub arrived: Vec3,
}

/// Where a ray starts, with the normal there, and its direction.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Camera space, metres.
    pub origin: Vec3,
    /// Unit vector.
    pub normal: Vec3,
    /// Unit vector.
    pub direction: Vec3,
}

impl Ray {
    /// How far along the ray it meets a disk whose radius is `enlarged` times as large, if it does. Disks that the origin's
    /// surface hides, and those that lie along the way to them, are not met.
    pub fn distance(&self, disk: &Disk, enlarged: f32) -> Option<f32> {
        let way = disk.place - self.origin;
        let (height, least) = (way.dot(disk.normal), LEAST_SINE * way.length());
        let slope = self.direction.dot(disk.normal);
        if way.dot(self.normal) <= least || height.abs() <= least || slope.abs() < 1e-6 {
            return None;
        }
        let distance = height / slope;
        let off = (distance * self.direction - way).length_squared();
        (distance > 0.0 && off < (disk.radius * enlarged).powi(2)).then_some(distance)
    }
}

/// The number of a pixel among those of its square of 2^level x 2^level: `shared/interleaved.wgsl`.
pub fn number_in_square(pixel: UVec2, level: u32, seed: u32) -> u32 {
    let (place, inside) = (pixel >> level, pixel & UVec2::splat((1 << level) - 1));
    let rest = hash(level.wrapping_add(hash(seed)));
    let key = hash(place.x.wrapping_add(hash(place.y.wrapping_add(rest))));
    shells::permuted(inside.x | inside.y << level, level, key)
}

/// The direction of a number that a pixel with a normal looks into, of so many and by a seed.
pub fn direction_of(pixel: UVec2, number: u32, [directions, seed]: [u32; 2], normal: Vec3) -> Vec3 {
    let square = pixel >> SQUARE;
    let which = (IN_SQUARE * number + number_in_square(pixel, SQUARE, hash(seed))) as f32;
    let draw = |dimension| random(square.x, square.y, seed, dimension);
    let squared = (which + draw(0)) / (IN_SQUARE * directions) as f32;
    let angle = TAU * ((GOLDEN_TURN * which + draw(1)).fract() - 0.5);
    let disk = squared.sqrt() * Vec2::new(angle.cos(), angle.sin());
    // Two tangents (Duff et al. 2017, "Building an Orthonormal Basis, Revisited").
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    disk.x * tangent + disk.y * bitangent + (1.0 - squared).sqrt() * normal
}

/// The disk that a pixel's ray meets: the nearest of the finest level that has one.
pub fn met<'a>(bounces: &uniforms::Bounces, disks: &'a [Disk], ray: &Ray, pixel: UVec2) -> Option<&'a Disk> {
    let of_level = |level: u32| {
        let first = number_in_square(pixel, level, bounces.seed) as usize;
        let its = disks.iter().enumerate().skip(first).step_by(1 << (2 * level));
        its.filter_map(move |(index, disk)| {
            let (shell, distance) = hit(bounces, level, disk, ray)?;
            Some((shell, distance, index))
        })
    };
    let hits = (0..bounces.levels).flat_map(of_level);
    let first = hits.min_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
    first.map(|(_, _, index)| &disks[index])
}

/// On which level a ray meets a disk of a sub-buffer of `level`, and how far along.
fn hit(bounces: &uniforms::Bounces, level: u32, disk: &Disk, ray: &Ray) -> Option<(u32, f32)> {
    let away = disk.place.distance(ray.origin);
    let size = |level: u32| (1u32 << level) as f32;
    let last = level + 1 == bounces.levels;
    if !last && away >= disk.radius * bounces.shell * size(level) {
        return None;
    }
    let inside = |shell: &u32| away <= disk.radius * bounces.shell * size(*shell);
    let shell = (0..level).find(inside).unwrap_or(level);
    let distance = ray.distance(disk, size(shell) * bounces.cover)?;
    (distance < bounces.reach).then_some((shell, distance))
}

/// The samples of a pixel.
fn samples<E: BouncedEffect>(
    surface: &Surface,
    disks: &[Disk],
    bounces: &uniforms::Bounces,
    at: IVec2,
) -> Vec<Sample> {
    let (origin, normal) = (surface.position_at(at), surface.normal_at(at));
    let sample = |number| {
        let direction = direction_of(at.as_uvec2(), number, [bounces.directions, bounces.seed], normal);
        let met = met(bounces, disks, &Ray { origin, normal, direction }, at.as_uvec2());
        Sample { direction, arrived: E::arriving(met, direction) }
    };
    (0..bounces.directions).map(sample).collect()
}

/// The effect, `[channels, height, width]`.
pub fn shade<E: BouncedEffect>(
    surface: &Surface,
    disks: &[Disk],
    parameters: &Parameters,
    view: &View,
) -> Planes {
    let bounces = parameters.bounces(view);
    let window = super::window(&parameters.filter, parameters.directions, E::EFFECT, view);
    reconstruction(surface, &window, E::EFFECT, |at| samples::<E>(surface, disks, &bounces, at))
}

/// An effect by the samples of all pixels, `[channels, height, width]`.
pub fn reconstruction(
    surface: &Surface,
    window: &uniforms::BounceWindow,
    effect: Effect,
    samples: impl Fn(IVec2) -> Vec<Sample> + Sync,
) -> Planes {
    let (height, width) = (surface.height, surface.width);
    let pixel = |index: usize| IVec2::new((index % width) as i32, (index / width) as i32);
    let seen = |at: IVec2| if surface.valid_at(at) { samples(at) } else { Vec::new() };
    let traced: Vec<Vec<Sample>> =
        (0..height * width).into_par_iter().map(|index| seen(pixel(index))).collect();
    let image = surface.image(window.background, |at| reconstructed(surface, &traced, window, at));
    Planes::from_fn(effect.channels(), height, width, |c, y, x| image.at(c, y, x))
}

/// What the samples of a pixel and of those around it say of it: `filter.wgsl`.
fn reconstructed(
    surface: &Surface,
    traced: &[Vec<Sample>],
    window: &uniforms::BounceWindow,
    centre: IVec2,
) -> [f32; 3] {
    let (position, normal) = (surface.position_at(centre), surface.normal_at(centre));
    let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
    let reach = -window.radius..=window.radius;
    for step in reach.clone().flat_map(|y| reach.clone().map(move |x| IVec2::new(x, y))) {
        let at = centre + step;
        if !surface.contains(at) || !surface.valid_at(at) {
            continue;
        }
        let other_normal = surface.normal_at(at);
        let off_plane = window.sharpness * normal.dot(surface.position_at(at) - position);
        let near = (-(window.falloff * step.length_squared() as f32 + off_plane * off_plane)).exp();
        let alike = near * normal.dot(other_normal).max(0.0).powi(NORMAL_POWER);
        for sample in &traced[at.y as usize * surface.width + at.x as usize] {
            let drawn = other_normal.dot(sample.direction).max(LEAST_COSINE);
            let weight = alike * normal.dot(sample.direction).max(LEAST_COSINE) / drawn;
            sum += weight * sample.arrived;
            weights += weight;
        }
    }
    (sum / weights).to_array()
}
