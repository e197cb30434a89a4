//! Rooms with furniture along the walls and in the middle.

use super::furniture::{bed, bookcase, books, cabinet, chair, cushion, rosette, sofa, table};
use super::materials;
use super::random::Random;
use super::scene_builder::{SceneBuilder, ShapesByMaterial};
use super::shape::Shape;
use super::solids::{bevelled_box, block, cuboid, cylinder, pipe, sphere};
use super::surface::sheet;
use super::sweep::lathe;
use crate::scene::MaterialId;
use glam::{Affine3A, Quat, Vec2, Vec3};
use std::f32::consts::PI;

/// Thickness of the walls.
const WALL: f32 = 0.15;

/// A hole in a wall, in the wall's x and y.
#[derive(Clone, Copy)]
struct Opening {
    low: Vec2,
    high: Vec2,
}

/// What things are made of here.
struct Looks {
    wall: MaterialId,
    wood: MaterialId,
    trim: MaterialId,
    metal: MaterialId,
    cloth: MaterialId,
    leaves: MaterialId,
    small: Vec<MaterialId>,
}

/// Builds a room.
pub fn build(builder: &mut SceneBuilder, random: &mut Random) {
    let size = Vec3::new(random.within(3.4, 5.0), random.within(2.3, 2.8), random.within(3.0, 4.4));
    let looks = Looks {
        wall: materials::plaster(builder, random),
        wood: materials::wood(builder, random),
        trim: materials::paint(builder, random),
        metal: materials::metal(builder, random),
        cloth: materials::cloth(builder, random),
        leaves: materials::foliage(builder, random),
        small: materials::several(5, materials::any, builder, random),
    };
    floor_and_ceiling(size, &looks, builder, random);
    for side in 0..4 {
        let (length, place) = wall_place(side, size);
        let opening = match side {
            0 => Some(window(length, size.y, random)),
            2 => Some(Opening { low: Vec2::new(0.4, 0.0), high: Vec2::new(1.3, 2.0) }),
            _ => None,
        };
        walls(length, size.y, opening, &looks, builder, place, random);
        furnish_wall(length, size.y, opening, &looks, builder, place, random);
    }
    middle(size, &looks, builder, random);
    ceiling_lamp(size.y, &looks, builder, random);
    builder.sun(random);
}

/// Length of a wall and where it is: its x runs along the floor from left to right as seen from inside, its z
/// into the room.
fn wall_place(side: usize, size: Vec3) -> (f32, Affine3A) {
    let length = if side.is_multiple_of(2) { size.x } else { size.z };
    let depth = if side.is_multiple_of(2) { size.z } else { size.x };
    let turn = Quat::from_rotation_y(0.5 * PI * side as f32);
    let origin = turn * Vec3::new(-0.5 * length, 0.0, -0.5 * depth);
    (length, Affine3A::from_rotation_translation(turn, origin))
}

fn window(length: f32, height: f32, random: &mut Random) -> Opening {
    let middle = length * random.within(0.35, 0.65);
    let half = random.within(0.5, 0.95);
    let low = random.within(0.75, 1.0);
    Opening { low: Vec2::new(middle - half, low), high: Vec2::new(middle + half, height - 0.35) }
}

fn floor_and_ceiling(size: Vec3, looks: &Looks, builder: &mut SceneBuilder, random: &mut Random) {
    let (x, z) = (size.x + 2.0 * WALL, size.z + 2.0 * WALL);
    let floor = materials::flooring(builder, random);
    builder.add("floor", floor, cuboid(x, 0.1, z).moved(0.0, -0.1, 0.0));
    builder.add("ceiling", looks.wall, cuboid(x, 0.1, z).moved(0.0, size.y, 0.0));
    let across = random.count(3, 6);
    let along = if random.chance(0.5) { random.count(2, 5) } else { 0 };
    let depth = random.within(0.1, 0.22);
    let beam = |length: f32| bevelled_box(length, depth, 0.12, 0.01).moved(0.0, size.y - depth, 0.0);
    let mut beams = Shape::default();
    for i in 0..across {
        let x = size.x * ((i as f32 + 0.5) / across as f32 - 0.5);
        beams.join(beam(size.z).turned(0.5 * PI).moved(x, 0.0, 0.0));
    }
    for i in 0..along {
        beams.join(beam(size.x).moved(0.0, 0.01, size.z * ((i as f32 + 0.5) / along as f32 - 0.5)));
    }
    builder.add("beams", looks.wood, beams);
}

/// A wall with its opening, skirting board, cornice and panels.
fn walls(
    length: f32,
    height: f32,
    opening: Option<Opening>,
    looks: &Looks,
    builder: &mut SceneBuilder,
    place: Affine3A,
    random: &mut Random,
) {
    let part = |x0: f32, x1: f32, y0: f32, y1: f32| block(Vec3::new(x0, y0, -WALL), Vec3::new(x1, y1, 0.0));
    let board = |x0: f32, x1: f32| {
        block(Vec3::new(x0, 0.0, 0.0), Vec3::new(x1, 0.1, 0.018))
            + block(Vec3::new(x0, 0.1, 0.0), Vec3::new(x1, 0.115, 0.009))
    };
    let cornice = [(0.0, 0.0), (0.03, 0.02), (0.05, 0.04), (0.09, 0.06), (0.1, 0.08)];
    let mut trim: Shape = cornice
        .windows(2)
        .map(|step| {
            let (out, low, high) = (step[1].0, step[0].1, step[1].1);
            block(Vec3::new(0.0, height - 0.08 + low, 0.0), Vec3::new(length, height - 0.08 + high, out))
        })
        .collect();
    let mut wall = Shape::default();
    match opening {
        None => {
            wall.join(part(-WALL, length, 0.0, height));
            trim.join(board(0.0, length));
            trim.join(panels(length, random));
        }
        Some(Opening { low, high }) => {
            wall.join(part(-WALL, low.x, 0.0, height));
            wall.join(part(high.x, length, 0.0, height));
            wall.join(part(low.x, high.x, high.y, height));
            trim.join(board(0.0, low.x) + board(high.x, length));
            if low.y > 0.0 {
                wall.join(part(low.x, high.x, 0.0, low.y));
                trim.join(board(low.x, high.x) + radiator(low, high));
                trim.join(block(
                    Vec3::new(low.x - 0.06, low.y - 0.03, -WALL),
                    Vec3::new(high.x + 0.06, low.y, 0.08),
                ));
            }
            trim.join(frame(low, high, random));
        }
    }
    builder.add("wall", looks.wall, wall.transformed(place));
    builder.add("trim", looks.trim, trim.transformed(place));
}

/// The frame in an opening: a grid of bars for a window, a panelled leaf for a door.
fn frame(low: Vec2, high: Vec2, random: &mut Random) -> Shape {
    let bar =
        |x0: f32, y0: f32, x1: f32, y1: f32, z: f32| block(Vec3::new(x0, y0, z - 0.05), Vec3::new(x1, y1, z));
    let lining = |z: f32| {
        bar(low.x, low.y, low.x + 0.05, high.y, z)
            + bar(high.x - 0.05, low.y, high.x, high.y, z)
            + bar(low.x, high.y - 0.05, high.x, high.y, z)
    };
    let architrave = bar(low.x - 0.08, low.y, low.x, high.y + 0.08, 0.03)
        + bar(high.x, low.y, high.x + 0.08, high.y + 0.08, 0.03)
        + bar(low.x, high.y, high.x, high.y + 0.08, 0.03);
    let mut shape = lining(-0.05) + architrave;
    if low.y > 0.0 {
        let (columns, rows) = (random.count(2, 4), random.count(1, 4));
        for i in 1..columns {
            let x = low.x + (high.x - low.x) * i as f32 / columns as f32;
            shape.join(bar(x - 0.02, low.y, x + 0.02, high.y, -0.06));
        }
        for i in 0..rows {
            let y = low.y + (high.y - low.y) * i as f32 / rows as f32;
            shape.join(bar(low.x, y, high.x, y + 0.035, -0.065));
        }
        return shape;
    }
    shape.join(bar(low.x + 0.05, 0.01, high.x - 0.05, high.y - 0.05, -0.08));
    for (y0, y1) in [(0.15, 0.85), (1.0, 1.8)] {
        let middle = 0.5 * (low.x + high.x);
        shape.join(relief(Vec2::new(low.x + 0.15, y0), Vec2::new(middle - 0.05, y1)).moved(0.0, 0.0, -0.08));
        shape.join(relief(Vec2::new(middle + 0.05, y0), Vec2::new(high.x - 0.15, y1)).moved(0.0, 0.0, -0.08));
    }
    shape + sphere(0.03, 12).moved(high.x - 0.12, 0.98, -0.06)
}

/// A flat frame on the plane z = 0.
fn relief(low: Vec2, high: Vec2) -> Shape {
    let bar = |x0: f32, y0: f32, x1: f32, y1: f32| block(Vec3::new(x0, y0, 0.0), Vec3::new(x1, y1, 0.015));
    let width = 0.035;
    bar(low.x, low.y, high.x, low.y + width)
        + bar(low.x, high.y - width, high.x, high.y)
        + bar(low.x, low.y + width, low.x + width, high.y - width)
        + bar(high.x - width, low.y + width, high.x, high.y - width)
}

/// Framed panels along a wall, in one or two rows.
fn panels(length: f32, random: &mut Random) -> Shape {
    let count = random.count(3, 7);
    let share = length / count as f32;
    let rows = if random.chance(0.6) { vec![(0.2, 0.85), (1.0, 2.05)] } else { vec![(0.2, 1.0)] };
    let mut shape = block(Vec3::new(0.0, 0.9, 0.0), Vec3::new(length, 0.94, 0.025));
    for i in 0..count {
        let x = i as f32 * share;
        for (low, high) in &rows {
            shape.join(relief(Vec2::new(x + 0.09, *low), Vec2::new(x + share - 0.09, *high)));
        }
    }
    shape
}

/// A ribbed radiator below a window.
fn radiator(low: Vec2, high: Vec2) -> Shape {
    let ribs = ((high.x - low.x) / 0.07) as usize;
    let rib = bevelled_box(0.045, low.y - 0.25, 0.1, 0.015);
    rib.at_each((0..ribs).map(|i| Vec3::new(low.x + 0.035 + 0.07 * i as f32, 0.12, 0.1)))
        + block(Vec3::new(low.x, 0.15, 0.085), Vec3::new(high.x, 0.18, 0.115))
        + cuboid(0.03, 0.13, 0.06).at_each([low.x + 0.1, high.x - 0.1].map(|x| Vec3::new(x, 0.0, 0.1)))
}

/// Furniture side by side along a wall, out of the way of its opening.
fn furnish_wall(
    length: f32,
    height: f32,
    opening: Option<Opening>,
    looks: &Looks,
    builder: &mut SceneBuilder,
    place: Affine3A,
    random: &mut Random,
) {
    let is_window = opening.is_some_and(|opening| opening.low.y > 0.0);
    let mut x = match opening {
        Some(Opening { low, high }) if low.y == 0.0 => high.x + 0.2,
        _ => 0.75,
    };
    loop {
        let width = random.within(0.5, 1.9).min(length - 0.75 - x);
        if width < 0.35 {
            return;
        }
        let at = place * Affine3A::from_translation(Vec3::new(x + 0.5 * width, 0.0, 0.03));
        if is_window {
            low_piece(width, looks, builder, at * Affine3A::from_translation(Vec3::Z * 0.16), random);
        } else {
            tall_piece(width, height, looks, builder, at, random);
        }
        x += width + random.within(0.04, 0.3);
    }
}

/// Something that may stand below a window.
fn low_piece(width: f32, looks: &Looks, builder: &mut SceneBuilder, at: Affine3A, random: &mut Random) {
    match random.count(0, 2) {
        0 if width > 0.7 => add_sofa(width, looks, builder, at, random),
        1 => builder.add("chest", looks.wood, cabinet(Vec3::new(width, 0.6, 0.4), 2, 2).transformed(at)),
        _ => {
            let bench = table(width, 0.4, 0.45, random).moved(0.0, 0.0, 0.22);
            let pads = cushion(width - 0.05, 0.36, 0.08).moved(0.0, 0.44, 0.22);
            builder.add("bench", looks.wood, bench.transformed(at));
            builder.add("pad", looks.cloth, pads.transformed(at));
        }
    }
}

/// Something that stands against a wall, with something above if it is low.
fn tall_piece(
    width: f32,
    height: f32,
    looks: &Looks,
    builder: &mut SceneBuilder,
    at: Affine3A,
    random: &mut Random,
) {
    let top = match random.count(0, 5) {
        0 | 1 => {
            let size = Vec3::new(width, random.within(1.2, height - 0.3), 0.28);
            full_bookcase(size, looks, builder, at, random);
            size.y
        }
        2 => {
            let size = Vec3::new(width, random.within(1.7, height - 0.25), 0.55);
            let doors = if width > 1.2 { 3 } else { 2 };
            builder.add("wardrobe", looks.wood, cabinet(size, doors, 1).transformed(at));
            size.y
        }
        3 => {
            let size = Vec3::new(width, random.within(0.7, 1.1), 0.45);
            builder.add(
                "chest",
                looks.wood,
                cabinet(size, 1 + usize::from(width > 0.9), random.count(3, 5)).transformed(at),
            );
            ornaments(width, size.y, looks, builder, at, random);
            size.y + 0.3
        }
        4 if width > 1.0 => {
            let (frame, bedding) = bed(width, random);
            builder.add("bed", looks.wood, frame.transformed(at));
            builder.add("bedding", looks.cloth, bedding.transformed(at));
            1.2
        }
        4 => {
            plant(width, looks, builder, at, random);
            1.6
        }
        _ => {
            add_sofa(width.max(0.8), looks, builder, at, random);
            1.0
        }
    };
    if top < height - 0.9 {
        let high = height - 0.3;
        let low = top + 0.15;
        let picture =
            relief(Vec2::new(-0.4 * width, low), Vec2::new(0.4 * width, high)).scaled(1.0, 1.0, 2.0);
        let canvas = block(Vec3::new(-0.39 * width, low, 0.0), Vec3::new(0.39 * width, high, 0.012));
        builder.add("picture", looks.trim, picture.transformed(at));
        builder.add("canvas", random.pick(&looks.small), canvas.transformed(at));
    }
}

fn add_sofa(width: f32, looks: &Looks, builder: &mut SceneBuilder, at: Affine3A, random: &mut Random) {
    let (frame, cushions) = sofa(width, random);
    builder.add("sofa", looks.trim, frame.transformed(at));
    builder.add("cushions", looks.cloth, cushions.transformed(at));
}

fn full_bookcase(size: Vec3, looks: &Looks, builder: &mut SceneBuilder, at: Affine3A, random: &mut Random) {
    let boards = ((size.y / 0.33) as usize).max(2);
    let (case, heights) = bookcase(size, boards);
    builder.add("bookcase", looks.wood, case.transformed(at));
    let mut shapes = ShapesByMaterial::new(looks.small.clone());
    for y in heights {
        let length = (size.x - 0.06) * random.within(0.4, 1.0);
        for book in books(length, size.y / boards as f32 - 0.04, random) {
            shapes.put(book.moved(0.03 - 0.5 * size.x, y, 0.01).transformed(at), random);
        }
    }
    shapes.add_to(builder, "books");
}

/// Small things on top of a piece.
fn ornaments(
    width: f32,
    height: f32,
    looks: &Looks,
    builder: &mut SceneBuilder,
    at: Affine3A,
    random: &mut Random,
) {
    let mut shapes = ShapesByMaterial::new(looks.small.clone());
    let count = (width / 0.22) as usize;
    for i in 0..count {
        let x = (i as f32 + 0.5) * width / count as f32 - 0.5 * width;
        let radius = random.within(0.04, 0.085);
        let thing = match random.count(0, 2) {
            0 => vase(radius, random.within(0.1, 0.35)),
            1 => bevelled_box(2.0 * radius, random.within(0.05, 0.2), 1.5 * radius, 0.008)
                .turned(random.within(-0.5, 0.5)),
            _ => sphere(radius, 20),
        };
        shapes.put(thing.moved(x, height, random.within(0.12, 0.3)).transformed(at), random);
    }
    shapes.add_to(builder, "ornaments");
}

fn vase(radius: f32, height: f32) -> Shape {
    let outline = [
        (0.0, 0.0),
        (0.6, 0.0),
        (1.0, 0.3),
        (0.9, 0.5),
        (0.45, 0.8),
        (0.6, 1.0),
        (0.5, 1.0),
        (0.35, 0.8),
        (0.0, 0.3),
    ];
    lathe(&outline.map(|(x, y)| Vec2::new(x * radius, y * height)), 24)
}

fn plant(width: f32, looks: &Looks, builder: &mut SceneBuilder, at: Affine3A, random: &mut Random) {
    let (radius, height) = (0.35 * width.min(0.6), random.within(0.25, 0.45));
    let outline = [(0.0, 0.0), (0.7, 0.0), (1.0, 0.9), (1.05, 1.0), (0.95, 1.0), (0.9, 0.85), (0.0, 0.85)];
    let pot = lathe(&outline.map(|(x, y)| Vec2::new(x * radius, y * height)), 28);
    let leaves = rosette(random.count(25, 50), random.within(0.5, 0.9), random).scaled(0.5, 1.0, 0.5);
    builder.add("pot", random.pick(&looks.small), pot.moved(0.0, 0.0, 0.3).transformed(at));
    builder.add("plant", looks.leaves, leaves.moved(0.0, 0.85 * height, 0.3).transformed(at));
}

/// A table with chairs on a rug.
fn middle(size: Vec3, looks: &Looks, builder: &mut SceneBuilder, random: &mut Random) {
    let (width, depth) = (0.34 * size.x, random.within(0.7, 0.95));
    let turn = random.within(-0.4, 0.4);
    let rug = sheet(96, 64, |u, v| {
        let ripple = 0.004 * ((17.0 * u).sin() + (13.0 * v + 5.0 * u).sin());
        Vec3::new((u - 0.5) * (width + 1.1), 0.012 + ripple, (v - 0.5) * (depth + 1.1))
    });
    builder.add("rug", looks.cloth, rug.turned(turn));
    builder.add("table", looks.wood, table(width, depth, 0.74, random).turned(turn).moved(0.0, 0.01, 0.0));
    let model = chair(random);
    let mut chairs = Shape::default();
    for side in [-1.0, 1.0] {
        for x in [-0.25, 0.25] {
            let facing = if side > 0.0 { PI } else { 0.0 };
            let askew = facing + random.within(-0.25, 0.25);
            let out = side * (0.5 * depth + random.within(0.05, 0.25));
            chairs.join(model.clone().turned(askew).moved(x * width, 0.01, out));
        }
    }
    builder.add("chairs", looks.wood, chairs.turned(turn));
    let on_table =
        Affine3A::from_rotation_translation(Quat::from_rotation_y(turn), Vec3::new(0.0, 0.01, 0.0));
    ornaments(
        0.8 * width,
        0.74,
        looks,
        builder,
        on_table * Affine3A::from_translation(Vec3::Z * -0.2),
        random,
    );
}

fn ceiling_lamp(height: f32, looks: &Looks, builder: &mut SceneBuilder, random: &mut Random) {
    let shade = random.within(0.15, 0.3);
    let low = height - random.within(0.7, 0.95);
    let lamp = pipe(shade, shade - 0.01, 0.2, 32).moved(0.0, low, 0.0)
        + sphere(0.05, 16).moved(0.0, low + 0.05, 0.0)
        + cylinder(0.006, height - low - 0.14, 8).moved(0.0, low + 0.14, 0.0)
        + cuboid(2.0 * shade - 0.01, 0.008, 0.012).moved(0.0, low + 0.15, 0.0);
    builder.add("lamp", looks.metal, lamp);
    builder.lamp(Vec3::new(0.0, low - 0.05, 0.0), random);
}
