//! Trees, bushes, ferns and grass on a small piece of ground.

use super::materials;
use super::noise;
use super::random::Random;
use super::scene_builder::SceneBuilder;
use super::shape::Shape;
use super::solids::{beam, cylinder, frustum, icosphere};
use super::surface::{ground, sheet};
use super::sweep::{curve, lathe, tapered_tube};
use crate::scene::MaterialId;
use glam::{Quat, Vec2, Vec3};
use std::f32::consts::PI;

/// A rolling piece of ground.
#[derive(Clone, Copy)]
struct Ground {
    seed: u32,
    size: f32,
    relief: f32,
}

impl Ground {
    fn height(self, x: f32, z: f32) -> f32 {
        self.relief * noise::fbm(self.seed, Vec3::new(0.25 * x, 0.5, 0.25 * z), 5)
    }

    /// The point of the ground at a place.
    fn at(self, place: Vec2) -> Vec3 {
        Vec3::new(place.x, self.height(place.x, place.y), place.y)
    }

    /// A place away from the border.
    fn place(self, random: &mut Random) -> Vec2 {
        let half = 0.5 * self.size - 0.3;
        Vec2::new(random.within(-half, half), random.within(-half, half))
    }
}

/// Builds a grove.
pub fn build(builder: &mut SceneBuilder, random: &mut Random) {
    let land = Ground { seed: random.bits(), size: random.within(6.0, 8.5), relief: random.within(0.4, 1.2) };
    let earth = materials::earth(builder, random);
    let soil = ground(Vec2::splat(land.size), 120, -0.2 - land.relief, |x, z| land.height(x, z));
    builder.add("soil", earth, soil);
    let bark = [materials::wood(builder, random), materials::stone(builder, random)];
    let trees = random.count(4, 7);
    for _ in 0..trees {
        let foot = land.at(land.place(random) * 0.85);
        let bark = random.pick(&bark);
        match random.count(0, 3) {
            0 => conifer(foot, bark, builder, random),
            _ => broadleaf(foot, bark, builder, random),
        }
    }
    let green = materials::several(3, materials::foliage, builder, random);
    builder.add("grass", green[0], grass(land, random));
    builder.add("bushes", green[1], (0..random.count(4, 8)).map(|_| bush(land, random)).collect());
    builder.add("ferns", green[2], (0..random.count(8, 20)).map(|_| fern(land, random)).collect());
    let stone = materials::stone(builder, random);
    builder.add("stones", stone, (0..random.count(12, 30)).map(|_| boulder(land, random)).collect());
    let pale = materials::paint(builder, random);
    builder.add("mushrooms", pale, (0..random.count(10, 30)).map(|_| mushroom(land, random)).collect());
    builder.add("fence", bark[0], fence(land, random));
    let log = random.within(0.15, 0.3);
    let place = land.at(land.place(random) * 0.7) + Vec3::Y * (0.7 * log);
    builder.add(
        "log",
        bark[1],
        cylinder(log, 2.2, 20).moved(0.0, -1.1, 0.0).rolled(0.5 * PI).turned(random.angle()).at(place),
    );
    builder.sun(random);
}

/// How a tree branches.
struct Growth<'a> {
    wood: Shape,
    leaves: Shape,
    leaf: Shape,
    random: &'a mut Random,
    crooked: f32,
}

impl Growth<'_> {
    /// A branch with all that grows on it.
    fn branch(&mut self, from: Vec3, direction: Vec3, length: f32, radius: f32, level: usize) {
        let mut knots = vec![from];
        let mut heading = direction;
        for _ in 0..3 {
            heading = (heading + self.random.direction() * self.crooked + Vec3::Y * 0.12).normalize();
            knots.push(knots[knots.len() - 1] + heading * length / 3.0);
        }
        let path = curve(&knots, if level == 0 { 4 } else { 2 });
        let sides = [12, 8, 5, 4][level.min(3)];
        self.wood.join(tapered_tube(&path, radius, sides, |t| 1.0 - 0.6 * t));
        if level == 3 {
            self.twig_leaves(&path);
            return;
        }
        let count = [5, 4, 4][level];
        for i in 0..self.random.count(count - 1, count + 1) {
            let share = if i == 0 { 1.0 } else { self.random.within(0.4, 1.0) };
            let start = path[((path.len() - 1) as f32 * share) as usize];
            let outward = self.random.direction().reject_from_normalized(heading).normalize_or(Vec3::X);
            let spread = if i == 0 { 0.3 } else { self.random.within(0.7, 1.3) };
            let shorter = self.random.within(0.5, 0.72);
            self.branch(
                start,
                (heading + outward * spread).normalize(),
                length * shorter,
                radius * 0.4,
                level + 1,
            );
        }
    }

    fn twig_leaves(&mut self, path: &[Vec3]) {
        for point in path.iter().skip(1) {
            for _ in 0..2 {
                let direction = (self.random.direction() + Vec3::Y * 0.2).normalize_or(Vec3::Y);
                let size = self.random.within(0.7, 1.3);
                let spun =
                    Quat::from_rotation_arc(Vec3::Y, direction) * Quat::from_rotation_y(self.random.angle());
                self.leaves.join(self.leaf.clone().scaled(size, size, size).rotated(spun).at(*point));
            }
        }
    }
}

/// A leaf that rises from the origin, folded along its middle. Its texture coordinates cover a whole texture
/// of 1 m.
fn leaf(length: f32, width: f32) -> Shape {
    let mut shape = sheet(2, 2, |u, v| {
        let fold = 0.25 * width * (1.0 - (2.0 * u - 1.0).abs());
        Vec3::new((u - 0.5) * width, length * (1.0 - v), fold - 0.3 * length * (1.0 - v) * (1.0 - v))
    });
    for (index, uv) in shape.uvs.iter_mut().enumerate() {
        *uv = Vec2::new((index % 3) as f32, (index / 3) as f32) * 0.5;
    }
    shape
}

fn broadleaf(foot: Vec3, bark: MaterialId, builder: &mut SceneBuilder, random: &mut Random) {
    let leaves = materials::leaves(builder, random);
    let (length, radius) = (random.within(1.2, 1.9), random.within(0.09, 0.17));
    let (size, crooked) = (random.within(0.14, 0.24), random.within(0.1, 0.35));
    let lean = (Vec3::Y + random.direction() * 0.15).normalize();
    let leaf = leaf(size, size * random.within(0.5, 0.9));
    let mut growth = Growth { wood: roots(radius, random), leaves: Shape::default(), leaf, random, crooked };
    growth.branch(Vec3::NEG_Y * 0.1, lean, length, radius, 0);
    let Growth { wood, leaves: crown, .. } = growth;
    builder.add("tree", bark, wood.at(foot));
    builder.add("crown", leaves, crown.at(foot));
}

/// Roots that leave the trunk and go into the ground.
fn roots(radius: f32, random: &mut Random) -> Shape {
    (0..random.count(4, 7))
        .map(|_| {
            let out = Quat::from_rotation_y(random.angle());
            let reach = random.within(0.3, 0.7);
            let knots = [
                Vec3::new(0.0, 0.3, 0.0),
                Vec3::new(0.3 * reach, 0.1, 0.0),
                Vec3::new(0.7 * reach, 0.0, 0.0),
                Vec3::new(reach, -0.2, 0.0),
            ];
            tapered_tube(&curve(&knots, 3), 0.6 * radius, 7, |t| 1.0 - 0.7 * t).rotated(out)
        })
        .collect()
}

/// A trunk with whorls of drooping branches of needles.
fn conifer(foot: Vec3, bark: MaterialId, builder: &mut SceneBuilder, random: &mut Random) {
    let height = random.within(2.8, 4.5);
    let needles = materials::foliage(builder, random);
    let mut wood = frustum(0.05 * height.sqrt() + 0.03, 0.01, height, 10).moved(0.0, -0.1, 0.0);
    let mut green = Shape::default();
    let whorls = random.count(11, 16);
    for whorl in 0..whorls {
        let share = whorl as f32 / whorls as f32;
        let y = height * (0.12 + 0.84 * share);
        let reach = 0.32 * height * (1.0 - share) + 0.08;
        for _ in 0..random.count(6, 9) {
            let turn = Quat::from_rotation_y(random.angle());
            let droop = random.within(0.1, 0.35) * reach;
            let tip = Vec3::new(reach * random.within(0.8, 1.1), -droop, 0.0);
            wood.join(
                tapered_tube(&[Vec3::ZERO, 0.5 * tip + Vec3::Y * 0.1 * reach, tip], 0.014, 4, |t| {
                    1.0 - 0.8 * t
                })
                .rotated(turn)
                .moved(0.0, y, 0.0),
            );
            let spray = sheet(4, 1, |u, v| {
                tip * u
                    + Vec3::Y * 0.1 * reach * (PI * u).sin()
                    + Vec3::new(0.0, -0.06, (v - 0.5) * 0.3 * reach * (PI * (0.2 + 0.75 * u)).sin())
            });
            let comb = (0..6).map(|i| {
                let at = tip * (i as f32 + 1.0) / 7.0;
                let blade = |s: f32| {
                    let end = at + Vec3::new(0.1 * reach, -0.05 * reach, s * 0.22 * reach);
                    let mut shape = Shape::default();
                    shape.polygon(&[at, end, at + Vec3::new(0.12 * reach, 0.02, 0.0)]);
                    shape
                };
                blade(1.0) + blade(-1.0)
            });
            green.join((spray + comb.collect()).rotated(turn).moved(0.0, y, 0.0));
        }
    }
    builder.add("trunk", bark, wood.at(foot));
    builder.add("needles", needles, green.at(foot));
}

/// Tufts of bent blades.
fn grass(land: Ground, random: &mut Random) -> Shape {
    let mut shape = Shape::default();
    let tufts = random.count(250, 450);
    let density = random.bits();
    for _ in 0..tufts {
        let place = land.place(random);
        if noise::fbm(density, (place * 0.6).extend(0.5), 2) < -0.15 {
            continue;
        }
        let tall = random.within(0.15, 0.5);
        for _ in 0..random.count(14, 30) {
            let foot = land.at(place + random.in_disc(0.12)) - Vec3::Y * 0.01;
            let bend = random.in_disc(0.6 * tall);
            let height = tall * random.within(0.5, 1.0);
            let side = Vec2::from_angle(random.angle()) * random.within(0.004, 0.01);
            let (side, bend) = (Vec3::new(side.x, 0.0, side.y), Vec3::new(bend.x, 0.0, bend.y));
            let blade = sheet(1, 3, |u, v| {
                foot + side * (2.0 * u - 1.0) * (1.0 - 0.8 * v) + Vec3::Y * height * v + bend * v * v
            });
            shape.join(blade);
        }
    }
    shape
}

/// A dome of leaves on thin stems.
fn bush(land: Ground, random: &mut Random) -> Shape {
    let foot = land.at(land.place(random));
    let radius = random.within(0.3, 0.7);
    let size = random.within(0.07, 0.14);
    let leaf = leaf(size, 0.6 * size);
    let mut shape = Shape::default();
    for _ in 0..random.count(350, 600) {
        let mut direction = random.direction();
        direction.y = direction.y.abs();
        let at = direction * radius * random.within(0.6, 1.0);
        let facing = (direction + random.direction() * 0.8).normalize_or(Vec3::Y);
        shape.join(leaf.clone().turned(random.angle()).aimed(facing).at(at));
    }
    for _ in 0..12 {
        let tip = random.direction() * 0.8 * radius;
        shape.join(tapered_tube(&[Vec3::NEG_Y * 0.05, tip.with_y(tip.y.abs() + 0.1)], 0.015, 5, |t| {
            1.0 - 0.6 * t
        }));
    }
    shape.at(foot)
}

/// Fronds with leaflets around a point.
fn fern(land: Ground, random: &mut Random) -> Shape {
    let foot = land.at(land.place(random));
    let length = random.within(0.35, 0.8);
    let mut shape = Shape::default();
    for _ in 0..random.count(7, 12) {
        let rise = random.within(0.6, 1.2);
        let spine = |t: f32| Vec3::new(length * t, length * rise * (t - 0.6 * t * t), 0.0);
        let mut frond =
            tapered_tube(&(0..=5).map(|i| spine(i as f32 / 5.0)).collect::<Vec<_>>(), 0.006, 4, |t| {
                1.0 - 0.7 * t
            });
        for i in 2..14 {
            let t = i as f32 / 14.0;
            let wide = 0.28 * length * (PI * t).sin() * (1.1 - t);
            let base = spine(t);
            for side in [-1.0, 1.0] {
                let end = base + Vec3::new(0.35 * wide, -0.1 * wide, side * wide);
                frond.polygon(&[base, end, spine(t + 0.05)]);
            }
        }
        shape.join(frond.turned(random.angle()));
    }
    shape.at(foot)
}

/// A stone that lies half in the ground.
fn boulder(land: Ground, random: &mut Random) -> Shape {
    let radius = random.within(0.06, 0.35) * random.within(0.5, 1.2);
    let seed = random.bits();
    let stone =
        icosphere(radius, 3).bent(|p, n| p + n * radius * 0.45 * noise::fbm(seed, p * (1.6 / radius), 3));
    let flat = random.within(0.5, 0.9);
    stone
        .scaled(1.0, flat, random.within(0.7, 1.2))
        .turned(random.angle())
        .at(land.at(land.place(random)) + Vec3::Y * 0.2 * radius)
}

fn mushroom(land: Ground, random: &mut Random) -> Shape {
    let size = random.within(0.04, 0.12);
    let outline = [
        (0.0, -0.3),
        (0.2, -0.3),
        (0.16, 0.4),
        (0.14, 0.8),
        (0.6, 0.75),
        (0.7, 0.85),
        (0.5, 1.15),
        (0.2, 1.3),
        (0.0, 1.33),
    ];
    lathe(&outline.map(|(x, y)| Vec2::new(x * size, y * size)), 18).at(land.at(land.place(random)))
}

/// Posts and rails along one side.
fn fence(land: Ground, random: &mut Random) -> Shape {
    let z = 0.5 * land.size - 0.5;
    let posts = (land.size / 1.1) as usize;
    let post = |i: usize| land.at(Vec2::new(((i as f32 + 0.5) / posts as f32 - 0.5) * land.size, z));
    let mut shape = Shape::default();
    for i in 0..posts {
        shape.join(
            frustum(0.06, 0.05, 1.2, 8).moved(0.0, -0.2, 0.0).rolled(random.within(-0.06, 0.06)).at(post(i)),
        );
        if i + 1 < posts {
            for y in [0.35, 0.75] {
                let sag = Vec3::Y * (y + random.within(-0.05, 0.05));
                shape.join(beam(post(i) + sag, post(i + 1) + sag, 0.04, 0.1));
            }
        }
    }
    shape
}
