//! Soft forms: merged balls and pierced bodies growing out of a bumpy floor, with tentacles and beads.

use super::materials;
use super::noise;
use super::random::Random;
use super::scene_builder::{SceneBuilder, ShapesByMaterial};
use super::shape::Shape;
use super::solids::{icosphere, torus};
use super::surface::{ground, isosurface, smooth_min};
use super::sweep::{curve, tapered_tube};
use glam::{Quat, Vec2, Vec3};
use std::f32::consts::TAU;

/// Half the width of the floor.
const HALF: f32 = 1.7;

/// A ball or, between two points, a rounded bar of a merged body.
struct Limb {
    from: Vec3,
    to: Vec3,
    radius: f32,
}

impl Limb {
    /// Distance to the limb's surface, negative inside.
    fn distance(&self, point: Vec3) -> f32 {
        let axis = self.to - self.from;
        let along = ((point - self.from).dot(axis) / axis.length_squared().max(1e-9)).clamp(0.0, 1.0);
        point.distance(self.from + axis * along) - self.radius
    }
}

/// Builds a garden of blobs.
pub fn build(builder: &mut SceneBuilder, random: &mut Random) {
    let floor = Floor { seed: random.bits(), bump: random.within(0.1, 0.2), pitch: random.within(1.6, 3.2) };
    let base = materials::paint(builder, random);
    builder.add("floor", base, ground(Vec2::splat(2.0 * HALF), 110, -0.4, |x, z| floor.height(x, z)));
    let skins = materials::several(6, materials::paint, builder, random);
    let mut shapes = ShapesByMaterial::new(skins);
    for _ in 0..random.count(2, 3) {
        let body = merged(&floor, random);
        shapes.put(barnacles(&body, random.count(50, 110), random), random);
        shapes.put(body, random);
    }
    for _ in 0..random.count(2, 4) {
        shapes.put(pierced(&floor, random), random);
    }
    for _ in 0..random.count(22, 34) {
        let wrinkled = wrinkled(random);
        shapes.put(wrinkled.at(floor.place(random)), random);
    }
    for _ in 0..random.count(4, 8) {
        let foot = floor.place(random);
        for _ in 0..random.count(4, 8) {
            shapes.put(tentacle(foot, random), random);
        }
    }
    for _ in 0..random.count(80, 140) {
        let radius = random.within(0.02, 0.1);
        let bead = if random.chance(0.75) {
            icosphere(radius, 2)
        } else {
            torus(radius, 0.35 * radius, 24, 10).pitched(random.angle())
        };
        shapes.put(bead.at(floor.place(random) + Vec3::Y * 0.6 * radius), random);
    }
    shapes.add_to(builder, "blobs");
    builder.lamp(Vec3::new(0.0, 2.5, 0.0), random);
    builder.sun(random);
}

/// The floor's height: a field of soft bumps.
struct Floor {
    seed: u32,
    bump: f32,
    pitch: f32,
}

impl Floor {
    fn height(&self, x: f32, z: f32) -> f32 {
        let at = Vec3::new(x, 0.5, z) * self.pitch;
        let dimple = noise::gradient(self.seed ^ 1, at * 3.0).abs();
        self.bump * (noise::fbm(self.seed, at, 3) * 1.6 - 0.8 * dimple)
    }

    /// A point of the floor.
    fn place(&self, random: &mut Random) -> Vec3 {
        let half = HALF - 0.25;
        let (x, z) = (random.within(-half, half), random.within(-half, half));
        Vec3::new(x, self.height(x, z), z)
    }
}

/// Limbs that grow upwards and sideways from each other, smoothly merged.
fn merged(floor: &Floor, random: &mut Random) -> Shape {
    let foot = floor.place(random) * 0.7;
    let mut limbs = vec![Limb { from: foot, to: foot + Vec3::Y * 0.3, radius: random.within(0.22, 0.35) }];
    for _ in 0..random.count(9, 16) {
        let parent = &limbs[random.count(0, limbs.len() - 1)];
        let mut direction = random.direction() + Vec3::Y * 0.35;
        if parent.to.y < 0.3 {
            direction.y = direction.y.abs();
        }
        let to = parent.to + direction.normalize() * random.within(0.25, 0.5);
        let radius = random.within(0.07, 0.24);
        limbs.push(Limb { from: parent.to, to: to.with_y(to.y.max(0.0)), radius });
    }
    let blend = random.within(0.08, 0.22);
    let field = |p: Vec3| limbs.iter().fold(f32::MAX, |near, limb| smooth_min(near, limb.distance(p), blend));
    let (low, high) =
        limbs.iter().fold((foot, foot), |(low, high), limb| (low.min(limb.to), high.max(limb.to)));
    let reach = Vec3::splat(0.6);
    isosurface(low - reach, high + reach, 0.05, field)
}

/// Small rings and warts that sit on a body.
fn barnacles(body: &Shape, count: usize, random: &mut Random) -> Shape {
    let ring = torus(1.0, 0.45, 14, 6);
    let wart = icosphere(1.0, 1);
    (0..count)
        .map(|_| {
            let vertex = random.count(0, body.positions.len() - 1);
            let size = random.within(0.015, 0.05);
            let thing = if random.chance(0.5) { &ring } else { &wart };
            thing.clone().scaled(size, size, size).aimed(body.normals[vertex]).at(body.positions[vertex])
        })
        .collect()
}

/// A ball with the channels of a gyroid through it (Schoen 1970), standing in the floor.
fn pierced(floor: &Floor, random: &mut Random) -> Shape {
    let radius = random.within(0.3, 0.55);
    let (frequency, wall) = (random.within(6.0, 9.0), random.within(0.6, 0.95));
    let phase = random.direction() * 5.0;
    let field = |p: Vec3| {
        let q = p * frequency + phase;
        let gyroid = q.x.sin() * q.y.cos() + q.y.sin() * q.z.cos() + q.z.sin() * q.x.cos();
        -smooth_min(radius - p.length(), (wall - gyroid.abs()) / frequency, 0.06)
    };
    let box_half = Vec3::splat(radius + 0.1);
    isosurface(-box_half, box_half, 0.028, field).at(floor.place(random) * 0.85 + Vec3::Y * 0.75 * radius)
}

/// A ball with folds, warts or ribs.
fn wrinkled(random: &mut Random) -> Shape {
    let (radius, seed) = (random.within(0.08, 0.3), random.bits());
    let (depth, fine) = (random.within(0.15, 0.45), random.within(1.2, 3.0));
    let ribs = random.count(5, 11) as f32;
    let kind = random.count(0, 2);
    let body = icosphere(radius, if radius > 0.23 { 4 } else { 3 }).bent(|p, n| {
        let q = p * (fine / radius);
        let height = match kind {
            0 => noise::ridged(seed, q, 3),
            1 => noise::fbm(seed, q, 3),
            _ => (p.z.atan2(p.x) * ribs).sin() * (1.0 - n.y * n.y),
        };
        p + n * radius * depth * height
    });
    let tall = random.within(0.7, 1.5);
    body.scaled(1.0, tall, 1.0).moved(0.0, 0.55 * tall * radius, 0.0)
}

/// A tapering arm that rises from a foot and curls.
fn tentacle(foot: Vec3, random: &mut Random) -> Shape {
    let turn = Quat::from_rotation_y(random.angle());
    let (length, curl) = (random.within(0.5, 1.4), random.within(1.0, 4.5));
    let steps = 26;
    let mut at = Vec3::NEG_Y * 0.05;
    let mut path = vec![at];
    for i in 0..steps {
        let t = i as f32 / steps as f32;
        let angle = 0.25 * TAU - 0.6 - curl * t * t;
        at += Vec3::new(angle.cos(), angle.sin(), 0.25 * (4.0 * t).sin()) * (length / steps as f32);
        path.push(at.with_y(at.y.max(-0.05)));
    }
    let knots = curve(&path, 1);
    tapered_tube(&knots, random.within(0.05, 0.1), 12, |t| 1.0 - 0.85 * t).rotated(turn).at(foot)
}
