//! Still lifes: a table in a corner, crowded with vessels, fruit, books and boxes.

use super::furniture::{book, turned_post};
use super::materials;
use super::random::Random;
use super::scene_builder::{SceneBuilder, ShapesByMaterial};
use super::shape::Shape;
use super::solids::{bevelled_box, block, cuboid, cylinder, frustum, rounded_box, sphere};
use super::surface::sheet;
use super::vessels;
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Height of the table top.
const TOP: f32 = 0.72;

/// Builds a still life.
pub fn build(builder: &mut SceneBuilder, random: &mut Random) {
    let size = Vec2::new(random.within(1.0, 1.4), random.within(0.65, 0.85));
    corner(size, builder, random);
    table(size, builder, random);
    let mut shapes = ShapesByMaterial::new(materials::several(7, materials::any, builder, random));
    spread(size, TOP + 0.006, random.count(26, 40), &mut shapes, random);
    let low = size - Vec2::splat(0.12);
    spread(low, 0.222, random.count(10, 16), &mut shapes, random);
    for x in [-1.0, 1.0] {
        let at = Vec3::new(x * (0.5 * size.x + 0.17), 0.0, random.within(-0.2, 0.2));
        shapes.put(vessels::vase(0.14, random.within(0.4, 0.7), random).at(at), random);
    }
    shapes.add_to(builder, "things");
    builder.lamp(Vec3::new(random.within(-0.4, 0.4), 1.5, 0.5), random);
    builder.sun(random);
}

/// Floor and two walls with a shelf.
fn corner(size: Vec2, builder: &mut SceneBuilder, random: &mut Random) {
    let (x, z) = (0.5 * size.x + 0.35, 0.5 * size.y + 0.12);
    let height = 1.6;
    let floor = materials::flooring(builder, random);
    builder.add("floor", floor, block(Vec3::new(-x - 0.05, -0.05, -z - 0.05), Vec3::new(x, 0.0, z + 0.25)));
    let wall = materials::masonry(builder, random);
    let back = block(Vec3::new(-x - 0.05, 0.0, -z - 0.05), Vec3::new(x, height, -z));
    let side = block(Vec3::new(-x - 0.05, 0.0, -z), Vec3::new(-x, height, z + 0.25));
    builder.add("walls", wall, back + side);
    let trim = materials::wood(builder, random);
    let mut boards = Shape::default();
    let boarding = random.count(8, 16);
    let share = 2.0 * x / boarding as f32;
    let top = random.within(0.9, 1.15);
    for i in 0..boarding {
        let left = i as f32 * share - x;
        boards.join(bevelled_box(share - 0.012, top, 0.02, 0.005).moved(left + 0.5 * share, 0.0, -z + 0.01));
    }
    boards.join(block(Vec3::new(-x, top, -z), Vec3::new(x, top + 0.03, -z + 0.05)));
    let shelf = top + 0.2;
    boards.join(block(Vec3::new(-x, shelf, -z), Vec3::new(x, shelf + 0.02, -z + 0.16)));
    let bracket = block(Vec3::new(-0.012, shelf - 0.1, -z), Vec3::new(0.012, shelf, -z + 0.12));
    boards.join(bracket.at_each((0..4).map(|i| Vec3::X * (x * (i as f32 / 2.0 - 0.75)))));
    builder.add("boards", trim, boards);
    let mut shapes = ShapesByMaterial::new(materials::several(3, materials::paint, builder, random));
    let mut at = 0.08 - x;
    while at < x - 0.08 {
        let radius = random.within(0.03, 0.06);
        let thing = upright(radius, random.within(0.08, 0.24), random);
        shapes.put(thing.moved(at, shelf + 0.02, -z + 0.085), random);
        at += 2.0 * radius + random.within(0.01, 0.06);
    }
    shapes.add_to(builder, "on-shelf");
}

/// The table with its cloth and a lower board.
fn table(size: Vec2, builder: &mut SceneBuilder, random: &mut Random) {
    let wood = materials::wood(builder, random);
    let (x, z) = (0.5 * size.x - 0.06, 0.5 * size.y - 0.06);
    let corners = [(x, z), (-x, z), (x, -z), (-x, -z)].map(|(x, z)| Vec3::new(x, 0.0, z));
    let top = bevelled_box(size.x, 0.04, size.y, 0.01).moved(0.0, TOP - 0.04, 0.0);
    let low = bevelled_box(2.0 * x, 0.02, 2.0 * z, 0.006).moved(0.0, 0.2, 0.0);
    let rails = cuboid(2.0 * x, 0.1, 0.02).at_each([-z, z].map(|z| Vec3::new(0.0, TOP - 0.14, z)));
    builder.add("table", wood, top + low + rails + turned_post(TOP - 0.04, 0.035).at_each(corners));
    let cloth = materials::cloth(builder, random);
    let half = random.within(0.25, 0.4) * size.x;
    let (folds, drop) = (random.count(4, 9) as f32, random.within(0.15, 0.35));
    let edge = 0.5 * size.y + 0.012;
    let runner = sheet(90, 120, |u, v| {
        let along = (v - 0.5) * 2.0 * (edge + drop);
        let down = (along.abs() - edge).max(0.0);
        let swing = 0.02 * (down / drop) * (u * folds * TAU).sin();
        let wrinkle = 0.002 * (9.0 * u + 4.0 * (7.0 * v).sin()).sin();
        Vec3::new(
            (u - 0.5) * 2.0 * half,
            TOP + 0.003 + wrinkle - down,
            along.clamp(-edge, edge) + along.signum() * (swing + 0.3 * swing.abs()).max(0.0),
        )
    });
    builder.add("cloth", cloth, runner);
}

/// Puts things on a level area, none into another.
fn spread(area: Vec2, height: f32, count: usize, shapes: &mut ShapesByMaterial, random: &mut Random) {
    let mut taken: Vec<(Vec2, f32)> = Vec::new();
    for _ in 0..count * 12 {
        let radius = if taken.len() < 5 { random.within(0.07, 0.13) } else { random.within(0.025, 0.075) };
        let free = 0.5 * area - Vec2::splat(radius);
        let at = Vec2::new(random.within(-free.x, free.x), random.within(-free.y, free.y));
        if taken.len() < count && taken.iter().all(|(other, reach)| at.distance(*other) > radius + reach) {
            taken.push((at, radius));
            let turn = random.angle();
            thing(radius, height < 0.5, shapes, random, |shape| shape.turned(turn).moved(at.x, height, at.y));
        }
    }
}

/// Something that fits on a disc, lower than the space below a table top if `low`.
fn thing(
    radius: f32,
    low: bool,
    shapes: &mut ShapesByMaterial,
    random: &mut Random,
    place: impl Fn(Shape) -> Shape,
) {
    match random.count(0, 9) {
        0 | 1 if radius > 0.06 => fruit_bowl(radius, shapes, random, place),
        2 | 3 if radius > 0.05 => {
            let mut y = 0.0;
            for _ in 0..random.count(2, 6) {
                let (thickness, twist) = (random.within(0.01, 0.035), random.within(-0.3, 0.3));
                let flat = book(thickness, 1.5 * radius, radius).rolled(0.5 * PI).moved(
                    0.75 * radius,
                    y + 0.5 * thickness,
                    0.0,
                );
                shapes.put(place(flat.turned(twist)), random);
                y += thickness;
            }
        }
        4 => shapes.put(place(vessels::plate(radius)), random),
        5 => shapes.put(place(fruit(radius, random)), random),
        _ => {
            let tall = if low { 0.35 } else { random.within(0.2, 0.5) };
            let height = (radius * random.within(2.0, 4.5)).min(tall);
            let shape = upright(radius, height, random);
            shapes.put(place(shape), random);
        }
    }
}

fn upright(radius: f32, height: f32, random: &mut Random) -> Shape {
    match random.count(0, 6) {
        0 => vessels::vase(radius, height, random),
        1 => vessels::bottle(0.8 * radius, height, random),
        2 => vessels::jug(0.65 * radius, height.min(2.2 * radius), random),
        3 => vessels::candlestick(height),
        4 => rounded_box(1.3 * radius, height, 1.3 * radius, 0.2 * radius, 3),
        5 => {
            let lid = frustum(0.85 * radius, 0.7 * radius, 0.1 * height, 32).moved(0.0, 0.8 * height, 0.0);
            cylinder(0.8 * radius, 0.8 * height, 32)
                + lid
                + sphere(0.15 * radius, 16).moved(0.0, 0.9 * height, 0.0)
        }
        _ => vessels::vase(radius, 0.6 * height, random),
    }
}

fn fruit(radius: f32, random: &mut Random) -> Shape {
    match random.count(0, 4) {
        0 => vessels::apple(radius.min(0.045)),
        1 => vessels::pear(radius.min(0.04)),
        2 => vessels::banana(1.6 * radius),
        3 => vessels::grapes(1.8 * radius, random),
        _ => vessels::ring(radius),
    }
}

/// A bowl heaped with apples.
fn fruit_bowl(
    radius: f32,
    shapes: &mut ShapesByMaterial,
    random: &mut Random,
    place: impl Fn(Shape) -> Shape,
) {
    let height = radius * random.within(0.5, 0.8);
    shapes.put(place(vessels::bowl(radius, height)), random);
    let size = 0.3 * radius;
    let heap = |ring: f32, count: usize, y: f32, start: f32| {
        (0..count).map(move |i| {
            let around = Vec2::from_angle(start + TAU * i as f32 / count as f32) * ring;
            Vec3::new(around.x, y, around.y)
        })
    };
    let start = random.angle();
    let points: Vec<Vec3> =
        heap(0.5 * radius, 5, 0.45 * height, start).chain(heap(0.0, 1, 0.8 * height, start)).collect();
    for point in points {
        let tilt = random.within(-0.6, 0.6);
        let fruit = if random.chance(0.8) { vessels::apple(size) } else { vessels::pear(size) };
        shapes.put(place(fruit.pitched(tilt).at(point)), random);
    }
}
