//! Eroded mountains with boulders, trees and a few huts.

use super::materials;
use super::noise;
use super::random::Random;
use super::scene_builder::SceneBuilder;
use super::shape::Shape;
use super::solids::{beam, bevelled_box, cuboid, frustum, icosphere};
use super::surface::ground;
use super::sweep::extrude;
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// Points along the side of the height field.
const SIDE: usize = 160;

/// Heights on a square grid around the origin.
struct Heightfield {
    size: f32,
    heights: Vec<f32>,
}

/// Builds a landscape.
pub fn build(builder: &mut SceneBuilder, random: &mut Random) {
    let land = Heightfield::drawn(random);
    let (low, high) = land.range();
    let rock = materials::stone(builder, random);
    let surface =
        ground(Vec2::splat(land.size), SIDE - 1, low - 0.02 * land.size, |x, z| land.height(Vec2::new(x, z)));
    let earth = materials::earth(builder, random);
    builder.add("land", if random.chance(0.5) { rock } else { earth }, surface);
    builder.add("boulders", rock, boulders(&land, random));
    let green = materials::foliage(builder, random);
    builder.add("trees", green, trees(&land, 0.5 * (low + high), random));
    let wood = materials::wood(builder, random);
    builder.add("huts", wood, (0..random.count(3, 7)).map(|_| hut(&land, random)).collect());
    builder.add("logs", wood, (0..random.count(8, 20)).map(|_| log(&land, random)).collect());
    builder.sun(random);
}

impl Heightfield {
    fn drawn(random: &mut Random) -> Self {
        let size = random.within(24.0, 40.0);
        let (seed, steep) = (random.bits(), random.within(0.22, 0.38) * size);
        let (frequency, terraces) = (random.within(3.0, 5.0), random.chance(0.5));
        let step = random.within(0.05, 0.09);
        let level = |at: Vec2| {
            let point = (at * frequency).extend(0.5);
            let warp = 0.3 * noise::fbm(seed ^ 1, point, 3);
            let height = 0.5 * noise::ridged(seed, point + Vec3::splat(warp), 6)
                + 0.4 * noise::fbm(seed ^ 2, 0.6 * point, 3);
            if terraces { cut_into_steps(height, step) } else { height }
        };
        let share = |index: usize| index as f32 / (SIDE - 1) as f32;
        let heights =
            (0..SIDE * SIDE).map(|i| steep * level(Vec2::new(share(i % SIDE), share(i / SIDE)))).collect();
        let mut land = Self { size, heights };
        for _ in 0..random.count(3000, 9000) {
            land.drop_of_rain(random);
        }
        land
    }

    /// Lets a drop of water run down: it carries earth from steep places to level ones (Beyer 2015,
    /// shortened).
    fn drop_of_rain(&mut self, random: &mut Random) {
        let inner = (SIDE - 4) as f32;
        let mut at = Vec2::new(random.within(2.0, inner), random.within(2.0, inner));
        let (mut heading, mut carried) = (Vec2::ZERO, 0f32);
        let cell = self.size / (SIDE - 1) as f32;
        for _ in 0..40 {
            let (column, row) = (at.x as usize, at.y as usize);
            let index = row * SIDE + column;
            let slope = Vec2::new(
                self.heights[index + 1] - self.heights[index - 1],
                self.heights[index + SIDE] - self.heights[index - SIDE],
            );
            heading = (heading * 0.4 - slope).normalize_or_zero();
            let next = at + heading;
            if heading == Vec2::ZERO || next.min_element() < 2.0 || next.max_element() > inner {
                break;
            }
            let fall = self.heights[index] - self.heights[next.y as usize * SIDE + next.x as usize];
            let capacity = fall.clamp(0.0, 0.4 * cell);
            let moved = if fall < 0.0 { carried.min(-fall) } else { 0.2 * (carried - capacity) };
            let moved = moved.clamp(-0.1 * fall.max(0.0), carried);
            self.spread(index, moved);
            carried -= moved;
            at = next;
        }
    }

    /// Adds to the height around a point, most in the middle.
    fn spread(&mut self, index: usize, amount: f32) {
        self.heights[index] += 0.4 * amount;
        for neighbour in [index - 1, index + 1, index - SIDE, index + SIDE] {
            self.heights[neighbour] += 0.15 * amount;
        }
    }

    /// Height at a place, bilinear.
    fn height(&self, place: Vec2) -> f32 {
        let at = (place / self.size + Vec2::splat(0.5)) * (SIDE - 1) as f32;
        let at = at.clamp(Vec2::ZERO, Vec2::splat((SIDE - 1) as f32 - 1e-3));
        let (cell, inside) = (at.floor(), at.fract());
        let index = cell.y as usize * SIDE + cell.x as usize;
        let row = |index: usize| self.heights[index] * (1.0 - inside.x) + self.heights[index + 1] * inside.x;
        row(index) * (1.0 - inside.y) + row(index + SIDE) * inside.y
    }

    /// The point of the ground at a place.
    fn at(&self, place: Vec2) -> Vec3 {
        Vec3::new(place.x, self.height(place), place.y)
    }

    /// How steep it is at a place, rise over run.
    fn slope(&self, place: Vec2) -> f32 {
        let reach = 0.01 * self.size;
        let across = |step: Vec2| self.height(place + step) - self.height(place - step);
        Vec2::new(across(Vec2::X * reach), across(Vec2::Y * reach)).length() / (2.0 * reach)
    }

    fn range(&self) -> (f32, f32) {
        self.heights
            .iter()
            .fold((f32::MAX, f32::MIN), |(low, high), height| (low.min(*height), high.max(*height)))
    }

    fn place(&self, random: &mut Random) -> Vec2 {
        let half = 0.47 * self.size;
        Vec2::new(random.within(-half, half), random.within(-half, half))
    }

    /// The flattest of some places.
    fn level_place(&self, random: &mut Random) -> Vec2 {
        let places: Vec<Vec2> = (0..24).map(|_| self.place(random)).collect();
        let flattest = places.iter().min_by(|a, b| self.slope(**a).total_cmp(&self.slope(**b)));
        *flattest.expect("there are 24 places")
    }
}

/// Makes cliffs and ledges of a slope.
fn cut_into_steps(height: f32, step: f32) -> f32 {
    let level = (height / step).floor();
    let inside = height / step - level;
    let steep = inside * inside * inside * (inside * (inside * 6.0 - 15.0) + 10.0);
    step * (level + 0.2 * inside + 0.8 * steep)
}

fn boulders(land: &Heightfield, random: &mut Random) -> Shape {
    let count = random.count(160, 260);
    let stones: Vec<Shape> = [2, 2, 2, 3, 3]
        .into_iter()
        .map(|divisions| {
            let seed = random.bits();
            icosphere(1.0, divisions).bent(|p, n| {
                p + n * (0.4 * noise::fbm(seed, p * 1.5, 4) - 0.1 * noise::ridged(seed ^ 1, p * 2.0, 2))
            })
        })
        .collect();
    let mut shape = Shape::default();
    for _ in 0..count {
        let radius = random.within(0.15, 0.6) * random.within(0.4, 1.6);
        let stone = &stones[if radius < 0.35 { random.count(0, 2) } else { random.count(3, 4) }];
        let (tilt, flat) = (random.within(-0.6, 0.6), random.within(0.6, 1.0));
        let place = land.place(random);
        shape.join(
            stone
                .clone()
                .scaled(radius, radius * flat, radius)
                .pitched(tilt)
                .turned(random.angle())
                .at(land.at(place) + Vec3::Y * 0.2 * radius),
        );
    }
    shape
}

/// Conifers where it is low and not too steep.
fn trees(land: &Heightfield, below: f32, random: &mut Random) -> Shape {
    let mut shape = Shape::default();
    for _ in 0..random.count(150, 350) {
        let place = land.place(random);
        let foot = land.at(place);
        if foot.y > below || land.slope(place) > 1.0 {
            continue;
        }
        let height = random.within(1.2, 3.2);
        let mut tree = frustum(0.04 * height, 0.02 * height, 0.4 * height, 6).moved(0.0, -0.1 * height, 0.0);
        let tiers = random.count(3, 5);
        for tier in 0..tiers {
            let share = tier as f32 / tiers as f32;
            let cone = frustum(0.24 * height * (1.0 - 0.75 * share), 0.0, 0.42 * height, 9);
            tree.join(cone.turned(random.angle()).moved(0.0, height * (0.15 + 0.62 * share), 0.0));
        }
        shape.join(tree.at(foot));
    }
    shape
}

/// A hut of logs on a footing.
fn hut(land: &Heightfield, random: &mut Random) -> Shape {
    let size = Vec2::new(random.within(1.6, 2.6), random.within(1.4, 2.0));
    let wall = random.within(1.2, 1.8);
    let mut shape = cuboid(size.x + 0.1, 1.3, size.y + 0.1).moved(0.0, -1.0, 0.0);
    shape.join(cuboid(size.x - 0.1, wall, size.y - 0.1));
    let logs = (wall / 0.16) as usize;
    for i in 0..logs {
        let y = 0.16 * (i as f32 + 0.5);
        for side in [-0.5, 0.5] {
            let (x, z) = (side * size.x, side * size.y);
            shape.join(beam(
                Vec3::new(-0.5 * size.x - 0.12, y, z),
                Vec3::new(0.5 * size.x + 0.12, y, z),
                0.12,
                0.13,
            ));
            shape.join(beam(
                Vec3::new(x, y + 0.08, -0.5 * size.y - 0.12),
                Vec3::new(x, y + 0.08, 0.5 * size.y + 0.12),
                0.12,
                0.13,
            ));
        }
    }
    let (half, rise) = (0.5 * size.y + 0.3, random.within(0.7, 1.2));
    let roof = [
        Vec2::new(-half, -0.1),
        Vec2::new(0.0, rise),
        Vec2::new(half, -0.1),
        Vec2::new(half, 0.03),
        Vec2::new(0.0, rise + 0.15),
        Vec2::new(-half, 0.03),
    ];
    shape.join(extrude(&roof, size.x + 0.6).turned(0.5 * PI).moved(0.0, wall, 0.0));
    let gable = [Vec2::new(0.4 - half, 0.0), Vec2::new(half - 0.4, 0.0), Vec2::new(0.0, rise - 0.15)];
    shape.join(extrude(&gable, size.x - 0.2).turned(0.5 * PI).moved(0.0, wall, 0.0));
    shape.join(bevelled_box(0.35, 1.0, 0.35, 0.03).moved(0.3 * size.x, wall + 0.4 * rise, 0.1 * size.y));
    shape.join(bevelled_box(0.6, 1.1, 0.1, 0.02).moved(0.0, 0.0, 0.5 * size.y + 0.05));
    let foot = land.at(land.level_place(random));
    shape.turned(random.angle()).at(foot + Vec3::Y * 0.2)
}

/// A fallen trunk that follows the slope.
fn log(land: &Heightfield, random: &mut Random) -> Shape {
    let place = land.place(random);
    let along = Vec2::from_angle(random.angle()) * random.within(0.6, 1.4);
    let (from, to) = (land.at(place - along), land.at(place + along));
    let radius = random.within(0.08, 0.16);
    let length = from.distance(to);
    let axis = (to - from) / length;
    frustum(radius, 0.7 * radius, length, 10)
        .turned(PI * random.unit())
        .aimed(axis)
        .at(from + Vec3::Y * 0.6 * radius)
}
