//! Things on their own, wide apart on a plain floor: bodies with limbs, shells and hoses, vessels, furniture.
//!
//! Most of what is seen of them is open: smooth faces, with a few creases and gaps. It is what a file of one
//! thing looks like, which the fuller families have little of.

use super::furniture::{cabinet, chair, sofa};
use super::materials;
use super::noise;
use super::random::Random;
use super::scene_builder::{SceneBuilder, ShapesByMaterial};
use super::shape::Shape;
use super::solids::{icosphere, rounded_box};
use super::surface::{isosurface, sheet, smooth_min};
use super::sweep::{circle, curve, sweep};
use super::vessels;
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// Distance of the things' middles from that of the floor, metres, where there are several.
const RING: f32 = 1.7;
/// How far the floor reaches beyond the things' middles, metres.
const FLOOR: f32 = 1.4;

/// Builds a floor with one to five things.
pub fn build(builder: &mut SceneBuilder, random: &mut Random) {
    let count = random.count(1, 5);
    let ring = if count == 1 { 0.0 } else { RING };
    let half = ring + FLOOR;
    let base = materials::paint(builder, random);
    let (seed, swell) = (random.bits(), random.within(0.0, 0.12));
    let height = |x: f32, z: f32| swell * noise::fbm(seed, Vec3::new(x, 0.5, z) * 0.5, 2);
    let point = |u: f32, v: f32| {
        let (x, z) = (half * (2.0 * u - 1.0), half * (2.0 * v - 1.0));
        Vec3::new(x, height(x, z), z)
    };
    builder.add("floor", base, sheet(80, 80, point));
    let mut shapes = ShapesByMaterial::new(materials::several(5, materials::paint, builder, random));
    for i in 0..count {
        let foot = Vec2::from_angle(TAU * i as f32 / count as f32 + 0.3) * ring;
        let (turn, size) = (random.angle(), random.within(0.8, 1.4));
        for part in thing(i, random) {
            let placed = part.turned(turn).scaled(size, size, size);
            shapes.put(placed.moved(foot.x, height(foot.x, foot.y), foot.y), random);
        }
    }
    shapes.add_to(builder, "specimens");
    builder.lamp(Vec3::new(1.0, 4.0, 1.5), random);
    builder.sun(random);
}

/// The parts of a thing that stands on the origin, one to two metres high; the first is always a body.
fn thing(index: usize, random: &mut Random) -> Vec<Shape> {
    let kind = if index == 0 { random.count(0, 1) } else { random.count(0, 6) };
    match kind {
        0 => helmet(random),
        1 => vec![creature(random)],
        2 => {
            let (frame, cushions) = sofa(1.8, random);
            vec![frame, cushions]
        }
        3 => vec![chair(random).scaled(1.5, 1.5, 1.5)],
        4 => vec![cabinet(Vec3::new(1.1, 1.5, 0.5), random.count(1, 3), random.count(2, 5))],
        5 => vec![vessels::jug(0.45, 1.3, random)],
        _ => vec![rounded_box(1.2, random.within(0.5, 1.4), 0.9, random.within(0.03, 0.2), 6)],
    }
}

/// A trunk, a head and limbs, smoothly merged.
fn creature(random: &mut Random) -> Shape {
    let (hip, neck) = (Vec3::Y * random.within(0.7, 0.9), Vec3::Y * random.within(1.25, 1.5));
    let mut bones = vec![(hip, neck, random.within(0.13, 0.24)), (neck, neck + Vec3::Y * 0.3, 0.14)];
    for side in [-1.0, 1.0] {
        let knee = Vec3::new(side * random.within(0.1, 0.3), 0.45, random.within(-0.15, 0.3));
        let foot = Vec3::new(side * random.within(0.1, 0.35), 0.06, random.within(-0.25, 0.25));
        let elbow = Vec3::new(side * random.within(0.3, 0.5), random.within(0.9, 1.3), 0.0);
        let hand = elbow + random.direction() * 0.35;
        let (leg, arm) = (random.within(0.07, 0.12), random.within(0.05, 0.09));
        bones.extend([(hip, knee, leg), (knee, foot, leg)]);
        bones.extend([(neck - Vec3::Y * 0.1, elbow, arm), (elbow, hand.max(Vec3::splat(-0.9)), arm)]);
    }
    let blend = random.within(0.03, 0.09);
    let field = |p: Vec3| {
        bones.iter().fold(f32::MAX, |near, (from, to, radius)| {
            let axis = *to - *from;
            let along = ((p - *from).dot(axis) / axis.length_squared().max(1e-9)).clamp(0.0, 1.0);
            smooth_min(near, p.distance(*from + axis * along) - radius, blend)
        })
    };
    isosurface(Vec3::new(-1.1, -0.3, -1.0), Vec3::new(1.1, 2.1, 1.0), 0.035, field)
}

/// A rounded body below shells that stand off it, with a hose from its front.
fn helmet(random: &mut Random) -> Vec<Shape> {
    let (seed, dent) = (random.bits(), random.within(0.05, 0.2));
    let size = Vec3::new(random.within(0.5, 0.8), random.within(0.6, 0.9), random.within(0.5, 0.8));
    let middle = Vec3::Y * size.y;
    let surface = |direction: Vec3, off: f32| {
        middle + size * direction * (1.0 + off + dent * noise::fbm(seed, direction * 1.7, 3))
    };
    let body = icosphere(1.0, 5).bent(|p, _| surface(p, 0.0));
    let mut parts = vec![body];
    for _ in 0..random.count(2, 4) {
        let (middle, width) = (random.direction(), random.within(0.4, 1.1));
        parts.push(shell(middle, width, [0.0, random.within(0.02, 0.12)], surface));
    }
    let (from, out) = (Vec3::new(0.0, 0.5, 0.86).normalize(), random.within(0.5, 0.9));
    let start = surface(from, -0.05);
    let knots = [
        start,
        start + from * 0.3 * out,
        Vec3::new(random.within(-0.6, 0.6), 0.5 * size.y, size.z + 0.6 * out),
        Vec3::new(random.within(-0.9, 0.9), 0.1, size.z + 0.3 * out),
    ];
    let (radius, folds) = (random.within(0.04, 0.09), random.within(12.0, 30.0));
    let ribbed = |share: f32| 1.0 + 0.18 * (TAU * folds * share).sin();
    parts.push(sweep(&circle(radius, 16), &curve(&knots, 60), ribbed));
    parts
}

/// A shell over a cap of a body, from its rim that lies at the first height above it to its middle at the
/// second, with an edge that goes back below it.
fn shell(middle: Vec3, width: f32, [rim, top]: [f32; 2], surface: impl Fn(Vec3, f32) -> Vec3) -> Shape {
    let across = middle.any_orthonormal_vector();
    let beside = middle.cross(across);
    sheet(64, 24, |u, v| {
        // The last two rows are the edge, and the shell's inner side for a little.
        let (turn, reach) = (TAU * u, width * (v / 0.92).clamp(0.004, 1.0));
        let around = across * turn.cos() + beside * turn.sin();
        let direction = middle * reach.cos() + around * reach.sin();
        let height = if v > 0.92 { rim - 0.05 } else { top + (rim - top) * (v / 0.92).powi(6) + 0.02 };
        surface(direction, height)
    })
    .welded()
    .smoothed()
}
