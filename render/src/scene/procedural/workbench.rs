//! Captures to test on: things in greys on the table of [`super::tabletop`], none of a shape that lies there.

use super::capture_table::{self, laid};
use super::noise;
use super::random::Random;
use super::rides::tyre;
use super::scene_builder::SceneBuilder;
use super::shape::Shape;
use super::solids::{icosphere, torus};
use super::surface::{isosurface, smooth_min};
use super::sweep::{extrude, tube};
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Builds a table with things on it.
pub fn build(builder: &mut SceneBuilder, random: &mut Random) {
    capture_table::build(thing, builder, random);
}

fn thing(random: &mut Random) -> Shape {
    match random.count(0, 7) {
        0 => {
            let ring = torus(1.0, random.within(0.2, 0.45), 64, 24);
            if random.chance(0.5) { laid(ring, random) } else { ring }
        }
        1 => laid(knot(random), random),
        2 => spring(random),
        3 => {
            let star = star(random);
            if random.chance(0.5) { laid(star, random) } else { star }
        }
        4 => arch(random),
        5 => boulder(random),
        6 => figure(random),
        _ => tyre(1.0),
    }
}

/// A trefoil knot.
fn knot(random: &mut Random) -> Shape {
    let point = |i: usize| {
        let angle = TAU * (i % 96) as f32 / 96.0;
        let ring = 2.0 + (3.0 * angle).cos();
        Vec3::new(ring * (2.0 * angle).cos(), ring * (2.0 * angle).sin(), 1.3 * (3.0 * angle).sin())
    };
    tube(&(0..=96).map(point).collect::<Vec<_>>(), random.within(0.35, 0.6), 18)
}

/// A wide coil that stands.
fn spring(random: &mut Random) -> Shape {
    let (turns, pitch) = (random.within(2.5, 4.5), random.within(0.45, 0.8));
    let point = |i: usize| {
        let angle = TAU * turns * i as f32 / 120.0;
        Vec3::new(angle.cos(), pitch * angle / TAU, angle.sin())
    };
    tube(&(0..=120).map(point).collect::<Vec<_>>(), random.within(0.12, 0.2), 14)
}

/// A star with blunt points.
fn star(random: &mut Random) -> Shape {
    let (points, inner) = (random.count(4, 7), random.within(0.45, 0.75));
    let corner = |i: usize| {
        let angle = TAU * i as f32 / (2 * points) as f32;
        Vec2::from_angle(angle) * if i.is_multiple_of(2) { 1.0 } else { inner }
    };
    let corners: Vec<Vec2> = (0..2 * points).map(corner).collect();
    // Corner by corner the middle of two neighbouring edges' points, which blunts it.
    let blunt = |i: usize| {
        let [before, here, after] = [i + 2 * points - 1, i, i + 1].map(|i| corners[i % (2 * points)]);
        [here.lerp(before, 0.15), here.lerp(after, 0.15)]
    };
    extrude(&(0..2 * points).flat_map(blunt).collect::<Vec<_>>(), random.within(0.4, 1.0))
}

/// An arch on two feet.
fn arch(random: &mut Random) -> Shape {
    let (inner, foot) = (random.within(0.5, 0.75), random.within(0.0, 0.6));
    let half = |radius: f32, forwards: bool| {
        (0..=32)
            .map(move |i| if forwards { i } else { 32 - i })
            .map(move |i| Vec2::from_angle(PI * i as f32 / 32.0) * radius + Vec2::Y * foot)
    };
    let mut outline: Vec<Vec2> = vec![Vec2::new(1.0, 0.0)];
    outline.extend(half(1.0, true));
    outline.extend([Vec2::new(-1.0, 0.0), Vec2::new(-inner, 0.0)]);
    outline.extend(half(inner, false));
    outline.push(Vec2::new(inner, 0.0));
    outline.dedup_by(|a, b| a.distance(*b) < 1e-5);
    extrude(&outline, random.within(0.5, 1.0))
}

/// A ball with soft folds.
fn boulder(random: &mut Random) -> Shape {
    let (seed, depth) = (random.bits(), random.within(0.3, 0.6));
    let body = icosphere(1.0, 4).bent(|p, n| p + n * depth * noise::fbm(seed, p * 1.3, 3));
    body.scaled(1.0, random.within(0.7, 1.6), random.within(0.7, 1.3))
}

/// Limbs that grow from a middle, smoothly merged.
fn figure(random: &mut Random) -> Shape {
    let limbs: Vec<Vec3> =
        (0..random.count(4, 6)).map(|_| random.direction() * random.within(0.7, 1.1)).collect();
    let radius = random.within(0.18, 0.28);
    let field = |p: Vec3| {
        limbs.iter().fold(p.length() - 1.6 * radius, |near, tip| {
            let along = (p.dot(*tip) / tip.length_squared()).clamp(0.0, 1.0);
            smooth_min(near, p.distance(*tip * along) - radius, 0.2)
        })
    };
    isosurface(Vec3::splat(-1.5), Vec3::splat(1.5), 0.07, field)
}
