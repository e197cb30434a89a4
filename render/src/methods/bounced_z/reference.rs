//! The bounced z-buffer in plain Rust: every ray against every disk, without a tree, and the filter.

use super::{BouncedZParameters, Reflector};
use crate::methods::Surface;
use crate::methods::surfel::shells;
use crate::screen::View;
use crate::surfels::reference::Disk;
use deepshade_shaders::random::{hash, random};
use deepshade_shaders::wgsl::uniforms;
use deepshade_shaders::{Effect, Planes};
use glam::{IVec2, UVec2, Vec2, Vec3};
use rayon::prelude::*;

/// The pixels of a square of 4 x 4 share one spiral of directions.
pub(super) const SQUARE: u32 = 2;
pub(super) const IN_SQUARE: u32 = 16;
/// Angle between a direction of the spiral and the next, turns.
const GOLDEN_TURN: f32 = 0.381_966;
/// Sine of the least angle between the way to a disk and either surface. Surfels' normals are rounded by
/// nearly as much.
pub const LEAST_SINE: f32 = 4.2e-3;
/// A neighbour counts the cosine of its normal to the pixel's to this power.
const NORMAL_POWER: i32 = 8;

/// A direction that a pixel looks into, and what arrives from there.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Unit vector, camera space.
    pub direction: Vec3,
    /// Radiance.
    pub arrived: Vec3,
}

/// One of a pixel's rays.
#[derive(Clone, Copy, Debug)]
pub struct PixelRay {
    /// The pixel.
    pub pixel: UVec2,
    /// Which of its rays.
    pub number: u32,
    /// Unit vector, camera space.
    pub direction: Vec3,
}

/// Where a ray starts, with the normal there, and its direction.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Camera space, metres.
    pub origin: Vec3,
    /// Unit vector; zero between surfaces.
    pub normal: Vec3,
    /// Unit vector.
    pub direction: Vec3,
}

impl Ray {
    /// How far along the ray it meets a disk whose radius is `enlarged` times as large, if it does. Disks
    /// that the origin's surface hides, and those that lie along the way to them, are not met.
    pub fn distance(&self, disk: &Disk, enlarged: f32) -> Option<f32> {
        let way = disk.place - self.origin;
        let (height, least) = (way.dot(disk.normal), LEAST_SINE * way.length());
        let slope = self.direction.dot(disk.normal);
        let is_behind = self.normal != Vec3::ZERO && way.dot(self.normal) <= least;
        if is_behind || height.abs() <= least || slope.abs() < 1e-6 {
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
    shells::permuted(inside.x | inside.y << level, level, shells::key(place, level, seed))
}

/// A place on the disk that a number of a pixel has, of so many and by a seed: its radius squared, and its
/// angle, turns.
pub fn place_on_disk(pixel: UVec2, number: u32, [directions, seed]: [u32; 2]) -> Vec2 {
    let square = pixel >> SQUARE;
    let which = (IN_SQUARE * number + number_in_square(pixel, SQUARE, hash(seed))) as f32;
    let draw = |dimension| random(square.x, square.y, seed, dimension);
    let squared = (which + draw(0)) / (IN_SQUARE * directions) as f32;
    Vec2::new(squared, (GOLDEN_TURN * which + draw(1)).fract() - 0.5)
}

/// The disk that a ray meets: the nearest, and of two as near the first.
pub fn met<'a>(bounces: &uniforms::Bounces, disks: &'a [Disk], ray: &Ray) -> Option<&'a Disk> {
    let hits = disks.iter().filter_map(|disk| Some((ray.distance(disk, bounces.cover)?, disk)));
    let within = hits.filter(|(distance, _)| *distance < bounces.reach);
    within.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, disk)| disk)
}

/// The samples of a pixel.
fn samples(
    surface: &Surface,
    disks: &[Disk],
    bounces: &uniforms::Bounces,
    reflector: &impl Reflector,
    (at, arriving): (IVec2, &Arriving<'_>),
) -> Vec<Sample> {
    let (origin, normal) = (surface.position_at(at), surface.normal_at(at));
    let sample = |number| {
        let place = place_on_disk(at.as_uvec2(), number, [bounces.directions, bounces.seed]);
        let direction = reflector.direction(place);
        let met = met(bounces, disks, &Ray { origin, normal, direction });
        let ray = PixelRay { pixel: at.as_uvec2(), number, direction };
        Sample { direction, arrived: (arriving.of)(met, &ray) }
    };
    (0..bounces.directions).map(sample).collect()
}

/// What rays bring.
#[derive(Clone, Copy)]
pub struct Arriving<'a> {
    /// Of which effect.
    pub effect: Effect,
    /// The radiance that arrives along a ray, of the disk that it meets or of none.
    pub of: &'a (dyn Fn(Option<&Disk>, &PixelRay) -> Vec3 + Sync),
}

/// The effect, `[channels, height, width]`; `reflectors` says how each pixel's surface reflects, if it does.
pub fn shade<R: Reflector>(
    surface: &Surface,
    reflectors: &(impl Fn(IVec2) -> Option<R> + Sync),
    disks: &[Disk],
    arriving: &Arriving<'_>,
    (parameters, view): (&BouncedZParameters, &View),
) -> Planes {
    let bounces = parameters.bounces(arriving.effect, view);
    let window = super::window(&parameters.filter, parameters.directions, arriving.effect, view);
    reconstruction(surface, &window, arriving.effect, reflectors, |at, reflector| {
        samples(surface, disks, &bounces, reflector, (at, arriving))
    })
}

/// An effect by the samples of all pixels, `[channels, height, width]`.
pub fn reconstruction<R: Reflector>(
    surface: &Surface,
    window: &uniforms::BounceWindow,
    effect: Effect,
    reflectors: &(impl Fn(IVec2) -> Option<R> + Sync),
    samples: impl Fn(IVec2, &R) -> Vec<Sample> + Sync,
) -> Planes {
    let (height, width) = (surface.height, surface.width);
    let traced = |index: usize| {
        let at = IVec2::new((index % width) as i32, (index / width) as i32);
        let reflector = surface.valid_at(at).then(|| reflectors(at)).flatten()?;
        Some((reflector, samples(at, &reflector)))
    };
    let traced: Vec<Traced<R>> = (0..height * width).into_par_iter().map(traced).collect();
    let image = surface.image(window.background, |at| reconstructed(surface, &traced, window, at));
    Planes::from_fn(effect.channels(), height, width, |c, y, x| image.at(c, y, x))
}

/// How a pixel's surface reflects, and its samples; none where it does not.
type Traced<R> = Option<(R, Vec<Sample>)>;

/// What the samples of a pixel and of those around it say of it: `filter.wgsl`.
fn reconstructed<R: Reflector>(
    surface: &Surface,
    traced: &[Traced<R>],
    window: &uniforms::BounceWindow,
    centre: IVec2,
) -> [f32; 3] {
    let of = |at: IVec2| &traced[at.y as usize * surface.width + at.x as usize];
    let Some((reflector, _)) = of(centre) else { return [window.background; 3] };
    let (position, normal) = (surface.position_at(centre), surface.normal_at(centre));
    let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
    let reach = -window.radius..=window.radius;
    for step in reach.clone().flat_map(|y| reach.clone().map(move |x| IVec2::new(x, y))) {
        let at = centre + step;
        let Some((other, samples)) = surface.contains(at).then(|| of(at)).and_then(Option::as_ref) else {
            continue;
        };
        let off_plane = window.sharpness * normal.dot(surface.position_at(at) - position);
        let near = (-(window.falloff * step.length_squared() as f32 + off_plane * off_plane)).exp();
        let alike = near * normal.dot(surface.normal_at(at)).max(0.0).powi(NORMAL_POWER);
        for Sample { direction, arrived } in samples {
            let weight = alike * reflector.density(*direction) / other.density(*direction);
            sum += weight * reflector.weight(*direction) * *arrived;
            weights += weight;
        }
    }
    (sum / weights).to_array()
}
