//! Furniture. Pieces that stand against a wall have their back on z = 0 and reach to +z, centred in x.

use super::random::Random;
use super::shape::Shape;
use super::solids::{bevelled_box, block, cuboid, frustum, rounded_box};
use super::surface::sheet;
use super::sweep::{lathe, rod};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// A chair that faces +z, standing around the y axis.
pub fn chair(random: &mut Random) -> Shape {
    let (width, seat, back) = (random.within(0.4, 0.5), random.within(0.42, 0.48), random.within(0.8, 1.05));
    let half = 0.5 * width - 0.03;
    let mut shape = bevelled_box(width, 0.04, width, 0.01).moved(0.0, seat, 0.0);
    for (x, z) in [(-half, half), (half, half)] {
        shape.join(frustum(0.014, 0.02, seat, 8).moved(x, 0.0, z));
    }
    for x in [-half, half] {
        shape.join(rod(Vec3::new(x, 0.0, -half), Vec3::new(x, back, -half - 0.06), 0.018, 8));
    }
    if random.chance(0.5) {
        for i in 0..random.count(2, 4) {
            let y = seat + 0.14 + 0.12 * i as f32;
            shape.join(bevelled_box(2.0 * half, 0.05, 0.02, 0.006).moved(0.0, y, -half - 0.03));
        }
    } else {
        let bars = random.count(3, 7);
        for i in 1..bars {
            let x = half * (2.0 * i as f32 / bars as f32 - 1.0);
            shape.join(rod(Vec3::new(x, seat, -half), Vec3::new(x, back - 0.05, -half - 0.055), 0.009, 6));
        }
        shape.join(bevelled_box(width, 0.08, 0.025, 0.01).moved(0.0, back - 0.08, -half - 0.05));
    }
    let rail = 0.45 * seat;
    for x in [-half, half] {
        shape.join(rod(Vec3::new(x, rail, -half), Vec3::new(x, rail, half), 0.01, 6));
    }
    shape
}

/// A table around the y axis.
pub fn table(width: f32, depth: f32, height: f32, random: &mut Random) -> Shape {
    let (x, z) = (0.5 * width - 0.06, 0.5 * depth - 0.06);
    let mut shape = bevelled_box(width, 0.035, depth, 0.008).moved(0.0, height - 0.035, 0.0);
    let apron = height - 0.035 - 0.09;
    shape.join(cuboid(2.0 * x, 0.09, 0.02).at_each([Vec3::new(0.0, apron, z), Vec3::new(0.0, apron, -z)]));
    shape.join(cuboid(0.02, 0.09, 2.0 * z).at_each([Vec3::new(x, apron, 0.0), Vec3::new(-x, apron, 0.0)]));
    let corners = [(x, z), (-x, z), (x, -z), (-x, -z)].map(|(x, z)| Vec3::new(x, 0.0, z));
    let leg = if random.chance(0.5) {
        turned_post(height - 0.035, 0.035)
    } else {
        bevelled_box(0.06, height - 0.035, 0.06, 0.008)
    };
    shape + leg.at_each(corners)
}

/// A post turned on a lathe.
pub fn turned_post(height: f32, radius: f32) -> Shape {
    let outline = [
        (0.0, 0.0),
        (0.7, 0.0),
        (0.8, 0.06),
        (0.5, 0.12),
        (0.9, 0.3),
        (1.0, 0.42),
        (0.6, 0.6),
        (0.45, 0.75),
        (0.9, 0.8),
        (0.9, 1.0),
        (0.0, 1.0),
    ];
    lathe(&outline.map(|(x, y)| Vec2::new(x * radius, y * height)), 12)
}

/// A box with `columns` x `rows` drawers or doors in front, with knobs.
pub fn cabinet(size: Vec3, columns: usize, rows: usize) -> Shape {
    let foot = 0.06;
    let body = Vec3::new(size.x, size.y - foot, size.z - 0.02);
    let mut shape = bevelled_box(body.x, body.y, body.z, 0.008).moved(0.0, foot, 0.5 * body.z);
    let foot_at = |x: f32, z: f32| Vec3::new(x * (0.5 * size.x - 0.05), 0.0, z);
    let feet =
        [(-1.0, 0.05), (1.0, 0.05), (-1.0, body.z - 0.05), (1.0, body.z - 0.05)].map(|(x, z)| foot_at(x, z));
    shape.join(frustum(0.02, 0.03, foot, 8).at_each(feet));
    let front = Vec2::new((size.x - 0.04) / columns as f32, (body.y - 0.04) / rows as f32);
    for column in 0..columns {
        for row in 0..rows {
            let x = (column as f32 + 0.5) * front.x - 0.5 * size.x + 0.02;
            let y = foot + 0.02 + row as f32 * front.y;
            let panel = bevelled_box(front.x - 0.015, front.y - 0.015, 0.022, 0.006);
            shape.join(panel.moved(x, y + 0.0075, body.z + 0.009));
            let knob = lathe(
                &[(0.0, 0.0), (0.007, 0.0), (0.006, 0.012), (0.014, 0.02), (0.0, 0.028)]
                    .map(|(x, y)| Vec2::new(x, y)),
                10,
            );
            shape.join(knob.pitched(0.5 * PI).moved(x, y + 0.5 * front.y, body.z + 0.018));
        }
    }
    shape
}

/// A frame of boards with `boards` shelves, open in front, and the heights on which things can stand.
pub fn bookcase(size: Vec3, boards: usize) -> (Shape, Vec<f32>) {
    let board = 0.022;
    let gap = (size.y - board) / boards as f32;
    let (x, z) = (0.5 * size.x, size.z);
    let mut shape = block(Vec3::new(-x, 0.0, 0.0), Vec3::new(board - x, size.y, z));
    shape.join(block(Vec3::new(x - board, 0.0, 0.0), Vec3::new(x, size.y, z)));
    shape.join(block(Vec3::new(board - x, 0.0, 0.0), Vec3::new(x - board, size.y, 0.008)));
    let heights: Vec<f32> = (0..=boards).map(|i| i as f32 * gap + 0.05 * f32::from(i == 0)).collect();
    for y in &heights {
        shape.join(block(Vec3::new(board - x, *y, 0.008), Vec3::new(x - board, y + board, z - 0.003)));
    }
    (shape, heights.iter().take(boards).map(|y| y + board).collect())
}

/// A book that stands on y = 0 with its spine towards +z: covers and a block of pages, set back a little.
pub fn book(thickness: f32, height: f32, depth: f32) -> Shape {
    let cover = 0.003;
    let side =
        cuboid(cover, height, depth).at_each([-1.0, 1.0].map(|s| Vec3::X * (s * 0.5 * (thickness - cover))));
    let pages = cuboid(thickness - 2.0 * cover, height - 0.008, depth - 0.008).moved(0.0, 0.004, 0.0);
    let spine = cuboid(thickness, height, cover).moved(0.0, 0.0, 0.5 * (depth + cover));
    side + pages + spine
}

/// Books side by side from x = 0 to at most `length`, some leaning, some lying in stacks, backs on z = 0.
pub fn books(length: f32, room_above: f32, random: &mut Random) -> Vec<Shape> {
    let mut row = Vec::new();
    let mut x = 0.0;
    loop {
        let (thickness, height) = (random.within(0.015, 0.05), room_above * random.within(0.6, 0.92));
        let depth = random.within(0.13, 0.2);
        if random.chance(0.08) && x + height < length {
            let stack = (0..random.count(2, 4)).scan(0.0, |y, _| {
                let (thick, wide) = (random.within(0.015, 0.035), height * random.within(0.8, 1.0));
                *y += thick;
                Some(book(thick, wide, depth).rolled(0.5 * PI).moved(
                    0.5 * (height + wide),
                    *y - 0.5 * thick,
                    0.5 * depth,
                ))
            });
            row.extend(stack.collect::<Vec<_>>());
            x += height + 0.005;
            continue;
        }
        let lean = if random.chance(0.12) { random.within(0.08, 0.25) } else { 0.0 };
        let footprint = thickness * lean.cos() + height * lean.sin();
        if x + footprint > length {
            return row;
        }
        let pulled = 0.5 * depth + random.within(0.005, 0.03);
        // Leaning to the left: the lower left corner is what touches the board.
        let upright = book(thickness, height, depth).moved(0.5 * thickness, 0.0, 0.0).rolled(lean);
        row.push(upright.moved(x + height * lean.sin(), 0.0, pulled));
        x += footprint + 0.001;
    }
}

/// A sofa or, if narrow, an armchair: frame and cushions.
pub fn sofa(width: f32, random: &mut Random) -> (Shape, Shape) {
    let (depth, seat, arm) = (random.within(0.8, 0.95), 0.26, random.within(0.14, 0.22));
    let back = random.within(0.75, 0.95);
    let side =
        |s: f32| rounded_box(arm, 0.58, depth, 0.05, 3).moved(s * 0.5 * (width - arm), 0.08, 0.5 * depth);
    let base =
        rounded_box(width - 2.0 * arm, seat - 0.08, depth - 0.05, 0.02, 2).moved(0.0, 0.08, 0.5 * depth);
    let rest = rounded_box(width - 2.0 * arm, back - 0.1, 0.2, 0.06, 3).moved(0.0, 0.1, 0.1);
    let feet = [(-1.0, 0.08), (1.0, 0.08), (-1.0, depth - 0.08), (1.0, depth - 0.08)];
    let feet = feet.map(|(s, z)| Vec3::new(s * (0.5 * width - 0.08), 0.0, z));
    let frame = side(-1.0) + side(1.0) + base + rest + frustum(0.018, 0.028, 0.09, 8).at_each(feet);
    let places = (((width - 2.0 * arm) / 0.65) as usize).max(1);
    let share = (width - 2.0 * arm) / places as f32;
    let cushions = (0..places).map(|i| {
        let x = (i as f32 + 0.5) * share - 0.5 * width + arm;
        let flat = cushion(share - 0.01, depth - 0.25, 0.16).moved(x, seat, 0.2 + 0.5 * (depth - 0.25));
        let upright = cushion(share - 0.03, 0.45, 0.16).pitched(0.5 * PI - 0.2);
        flat + upright.moved(x, seat + 0.39, 0.26)
    });
    (frame, cushions.collect())
}

/// A stuffed cushion that lies on y = 0.
pub fn cushion(width: f32, depth: f32, thickness: f32) -> Shape {
    let mut shape = rounded_box(width, thickness, depth, 0.48 * thickness, 4);
    // Thin at the border, as if sewn: pulled towards the middle plane.
    let half = Vec2::new(0.5 * width, 0.5 * depth);
    for position in &mut shape.positions {
        let edge = (position.x / half.x).powi(4).max((position.z / half.y).powi(4)).min(1.0);
        position.y = 0.5 * thickness + (position.y - 0.5 * thickness) * (1.0 - 0.5 * edge);
    }
    shape.moved(0.0, 0.0, 0.0)
}

/// A bed with its head against the wall: frame and bedding.
pub fn bed(width: f32, random: &mut Random) -> (Shape, Shape) {
    let (length, height) = (2.0, random.within(0.3, 0.42));
    let head = bevelled_box(width, height + random.within(0.4, 0.7), 0.05, 0.015).moved(0.0, 0.0, 0.025);
    let frame = bevelled_box(width, 0.16, length, 0.01).moved(0.0, height - 0.16, 0.5 * length + 0.03);
    let corners = [(-1.0, 0.15), (1.0, 0.15), (-1.0, length - 0.05), (1.0, length - 0.05)];
    let legs = cuboid(0.06, height - 0.16, 0.06)
        .at_each(corners.map(|(s, z)| Vec3::new(s * (0.5 * width - 0.06), 0.0, z)));
    let mattress =
        rounded_box(width - 0.04, 0.2, length - 0.06, 0.05, 3).moved(0.0, height, 0.5 * length + 0.04);
    let quilt =
        rounded_box(width + 0.02, 0.12, length * 0.62, 0.05, 3).moved(0.0, height + 0.13, 0.66 * length);
    let pillows = if width > 1.2 { vec![-0.25, 0.25] } else { vec![0.0] };
    let pillow = cushion(0.42 * width.min(1.6), 0.38, 0.14);
    let bedding =
        mattress + quilt + pillow.at_each(pillows.iter().map(|x| Vec3::new(x * width, height + 0.18, 0.3)));
    (head + frame + legs, bedding)
}

/// Long leaves around the y axis that rise and bend over.
pub fn rosette(leaves: usize, length: f32, random: &mut Random) -> Shape {
    let mut shape = Shape::default();
    for _ in 0..leaves {
        let (reach, rise) = (length * random.within(0.5, 1.0), length * random.within(0.4, 1.1));
        let width = length * random.within(0.05, 0.12);
        let leaf = sheet(2, 8, |u, v| {
            let across = (u - 0.5) * 2.0 * width * (PI * (0.1 + 0.9 * v)).sin();
            let keel = 0.4 * across.abs();
            Vec3::new(across, rise * (1.6 * v - v * v) + keel, reach * v)
        });
        shape.join(leaf.turned(random.angle()));
    }
    shape
}
