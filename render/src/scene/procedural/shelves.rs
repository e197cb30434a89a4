//! Store rooms: shelves full of clutter with narrow aisles between them.

use super::furniture::{bookcase, books, cabinet, cushion, table};
use super::materials;
use super::random::Random;
use super::scene_builder::{SceneBuilder, ShapesByMaterial};
use super::shape::Shape;
use super::solids::{beam, bevelled_box, block, cuboid, cylinder, frustum, pipe, rounded_box, sphere, torus};
use super::sweep::{curve, rod, tube};
use super::vessels;
use crate::scene::MaterialId;
use glam::{Affine3A, Quat, Vec3};
use std::f32::consts::PI;

/// Builds a store room.
pub fn build(builder: &mut SceneBuilder, random: &mut Random) {
    let length = random.within(2.6, 3.8);
    let aisle = random.within(0.8, 1.1);
    let depth = random.within(0.32, 0.42);
    let height = random.within(1.7, 2.3);
    let rows = if length > 2.9 { 1 } else { random.count(1, 2) };
    let half_depth = 0.5 * (rows as f32 + 1.0) * aisle + (rows as f32 + 1.0) * depth;
    shell(length, half_depth, height + 0.35, builder, random);
    let boards = [
        materials::wood(builder, random),
        materials::metal(builder, random),
        materials::paint(builder, random),
    ];
    let mut clutter = ShapesByMaterial::new(materials::several(8, materials::any, builder, random));
    // Backs of neighbouring rows touch; the outer rows stand against the walls.
    let mut z = -half_depth;
    for row in 0..=rows {
        let board = random.pick(&boards);
        shelf_row(
            Vec3::new(0.0, 0.0, z),
            false,
            [length, height, depth],
            board,
            &mut clutter,
            builder,
            random,
        );
        z += 2.0 * depth + aisle;
        shelf_row(
            Vec3::new(0.0, 0.0, z),
            true,
            [length, height, depth],
            board,
            &mut clutter,
            builder,
            random,
        );
        if row < rows {
            floor_clutter(z - depth - 0.5 * aisle, 0.5 * length, aisle, &mut clutter, random);
        }
    }
    end_table(length, half_depth, &boards, &mut clutter, builder, random);
    clutter.add_to(builder, "clutter");
    builder.lamp(Vec3::new(0.0, height + 0.2, 0.0), random);
    builder.sun(random);
}

/// Floor, two long walls and a short one, with joists and pipes under the ceiling.
fn shell(length: f32, half_depth: f32, height: f32, builder: &mut SceneBuilder, random: &mut Random) {
    let x = 0.5 * length + 0.1;
    let right = x + 1.0;
    let floor = materials::flooring(builder, random);
    builder.add(
        "floor",
        floor,
        block(Vec3::new(-x - 0.1, -0.1, -half_depth - 0.1), Vec3::new(right, 0.0, half_depth + 0.1)),
    );
    let wall = materials::masonry(builder, random);
    let long = |s: f32| {
        block(
            Vec3::new(-x, 0.0, s * half_depth - 0.05 + 0.05 * s),
            Vec3::new(right, height, s * half_depth + 0.05 + 0.05 * s),
        )
    };
    let short = block(Vec3::new(-x - 0.1, 0.0, -half_depth - 0.1), Vec3::new(-x, height, half_depth + 0.1));
    builder.add("walls", wall, long(1.0) + long(-1.0) + short);
    let timber = materials::wood(builder, random);
    let joists = random.count(5, 9);
    let mut ceiling = block(
        Vec3::new(-x - 0.1, height, -half_depth - 0.1),
        Vec3::new(right, height + 0.08, half_depth + 0.1),
    );
    for i in 0..joists {
        let at = -x + (right + x) * (i as f32 + 0.5) / joists as f32;
        ceiling.join(block(
            Vec3::new(at - 0.05, height - 0.16, -half_depth),
            Vec3::new(at + 0.05, height, half_depth),
        ));
    }
    builder.add("ceiling", timber, ceiling);
    let metal = materials::metal(builder, random);
    let pipes = (0..3).map(|i| {
        rod(
            Vec3::new(-x, height - 0.2 - 0.1 * i as f32, 0.14 * i as f32 - 0.2),
            Vec3::new(right, height - 0.2 - 0.1 * i as f32, 0.14 * i as f32 - 0.2),
            0.03,
            14,
        )
    });
    builder.add("pipes", metal, pipes.collect());
}

/// A row of shelves with its back at `back`, open towards +z or, if turned, -z.
fn shelf_row(
    back: Vec3,
    turned: bool,
    [length, height, depth]: [f32; 3],
    board: MaterialId,
    clutter: &mut ShapesByMaterial,
    builder: &mut SceneBuilder,
    random: &mut Random,
) {
    let turn = Quat::from_rotation_y(if turned { PI } else { 0.0 });
    let units = random.count(2, 3);
    let width = length / units as f32;
    for unit in 0..units {
        let x = (unit as f32 + 0.5) * width - 0.5 * length;
        let place = Affine3A::from_rotation_translation(turn, back) * Affine3A::from_translation(Vec3::X * x);
        let tall = height * random.within(0.75, 1.0);
        let count = random.count(3, 5);
        let (case, heights) = bookcase(Vec3::new(width - 0.01, tall, depth), count);
        builder.add("shelf", board, case.transformed(place));
        for y in heights {
            let space = Vec3::new(width - 0.07, tall / count as f32 - 0.04, depth - 0.02);
            let left = place * Affine3A::from_translation(Vec3::new(-0.5 * space.x, y, 0.01));
            fill(space, left, clutter, random);
        }
        let on_top = place * Affine3A::from_translation(Vec3::new(-0.5 * width + 0.04, tall, 0.01));
        fill(Vec3::new(width - 0.1, 0.3, depth - 0.02), on_top, clutter, random);
    }
}

/// Fills the space above a board, whose lower left back corner is the origin of `place`.
fn fill(space: Vec3, place: Affine3A, clutter: &mut ShapesByMaterial, random: &mut Random) {
    if random.chance(0.2) {
        for book in books(space.x, space.y, random) {
            clutter.put(book.transformed(place), random);
        }
        return;
    }
    let mut x = 0.0;
    while x < space.x - 0.06 {
        let width = random.within(0.12, 0.42).min(space.x - x);
        let height = space.y * random.within(0.35, 0.92);
        let depth = (space.z * random.within(0.5, 0.95)).min(1.6 * width);
        let z = 0.5 * depth + random.within(0.0, 1.0) * (space.z - depth);
        for part in thing(Vec3::new(width, height, depth), random) {
            clutter.put(part.moved(x + 0.5 * width, 0.0, z).transformed(place), random);
        }
        x += width + random.within(0.0, 0.04);
    }
}

/// The parts of a thing that fits into a box on y = 0.
fn thing(size: Vec3, random: &mut Random) -> Vec<Shape> {
    let radius = 0.48 * size.x.min(size.z);
    match random.count(0, 11) {
        0 | 1 => carton(size),
        2 => (0..2)
            .map(|i| {
                bevelled_box(
                    size.x * (1.0 - 0.2 * i as f32),
                    0.48 * size.y,
                    size.z * (1.0 - 0.1 * i as f32),
                    0.006,
                )
                .moved(0.0, 0.48 * size.y * i as f32, 0.0)
            })
            .collect(),
        3 => vec![vessels::vase(radius, size.y, random)],
        4 => vec![vessels::bottle(0.8 * radius, size.y, random)],
        5 => vec![
            cylinder(0.92 * radius, 0.86 * size.y, 20),
            torus(0.88 * radius, 0.05 * radius, 20, 6).moved(0.0, 0.86 * size.y, 0.0),
        ],
        6 => basket(radius, 0.8 * size.y),
        7 => stacked_bowls(radius, size.y),
        8 => vec![vessels::jug(0.6 * radius, size.y.min(2.0 * radius), random)],
        9 => crate_of_slats(size),
        10 => rolls(size),
        _ => folded(size),
    }
}

/// A cardboard box with flaps and tape.
fn carton(size: Vec3) -> Vec<Shape> {
    let body = bevelled_box(size.x - 0.01, size.y - 0.01, size.z - 0.01, 0.004);
    let tape = cuboid(0.2 * size.x, 0.002, size.z).moved(0.0, size.y - 0.011, 0.0)
        + cuboid(0.2 * size.x, 0.3 * size.y, 0.002).moved(0.0, 0.7 * size.y - 0.01, 0.5 * size.z - 0.005);
    vec![body, tape]
}

/// A basket of hoops and stakes.
fn basket(radius: f32, height: f32) -> Vec<Shape> {
    let wire = (0.05 * radius).max(0.003);
    let hoops = ((height / (2.2 * wire)) as usize).clamp(3, 5);
    let at = |share: f32| radius * (0.8 + 0.15 * share);
    let woven: Shape = (0..hoops)
        .map(|i| (i as f32 + 0.5) / hoops as f32)
        .map(|share| {
            torus(at(share) - wire, 0.5 * height / hoops as f32, 16, 5).moved(0.0, height * share, 0.0)
        })
        .collect();
    let stake = rod(Vec3::new(at(0.0), 0.0, 0.0), Vec3::new(at(1.0), height, 0.0), wire, 4).around(10);
    vec![
        woven + stake,
        cylinder(0.8 * radius, 0.1 * height, 20),
        sphere(0.55 * radius, 12).moved(0.0, 0.1 * height, 0.0),
    ]
}

fn stacked_bowls(radius: f32, height: f32) -> Vec<Shape> {
    let deep = 0.6 * radius;
    let gap = 0.25 * deep;
    let count = (((height - deep) / gap) as usize).clamp(1, 3);
    (0..count).map(|i| vessels::bowl(radius, deep).moved(0.0, gap * i as f32, 0.0)).collect()
}

/// A crate of slats with something in it.
fn crate_of_slats(size: Vec3) -> Vec<Shape> {
    let (x, z) = (0.5 * size.x - 0.01, 0.5 * size.z - 0.01);
    let tall = 0.8 * size.y;
    let mut slats = cuboid(2.0 * x, 0.01, 2.0 * z);
    for i in 0..3 {
        let y = tall * (0.15 + 0.3 * i as f32);
        slats
            .join(cuboid(2.0 * x, 0.18 * tall, 0.008).at_each([Vec3::new(0.0, y, z), Vec3::new(0.0, y, -z)]));
        slats
            .join(cuboid(0.008, 0.18 * tall, 2.0 * z).at_each([Vec3::new(x, y, 0.0), Vec3::new(-x, y, 0.0)]));
    }
    let post = cuboid(0.02, tall, 0.02);
    slats.join(
        post.at_each(
            [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)]
                .map(|(a, b)| Vec3::new(a * (x - 0.014), 0.0, b * (z - 0.014))),
        ),
    );
    let ball = 0.3 * x.min(z);
    let balls = sphere(ball, 8).at_each((0..6).map(|i| {
        Vec3::new((i % 3) as f32 - 1.0, 0.0, (i / 3) as f32 - 0.5) * Vec3::new(0.6 * x, 1.0, 0.9 * z)
            + Vec3::Y * (0.01 + 0.02 * i as f32)
    }));
    vec![slats, balls]
}

/// Rolls that lie in a pile, seen from their ends.
fn rolls(size: Vec3) -> Vec<Shape> {
    let radius = (0.24 * size.x).min(0.25 * size.y);
    let roll = pipe(radius, 0.35 * radius, size.z, 20).pitched(0.5 * PI).moved(0.0, radius, -0.5 * size.z);
    vec![
        roll.clone().moved(-radius, 0.0, 0.0),
        roll.clone().moved(radius, 0.0, 0.0),
        roll.moved(0.0, 1.74 * radius, 0.0),
    ]
}

/// Folded cloth in a stack.
fn folded(size: Vec3) -> Vec<Shape> {
    let layer = 0.045;
    let count = ((size.y / layer) as usize).clamp(1, 5);
    (0..count)
        .map(|i| rounded_box(0.95 * size.x, layer, 0.95 * size.z, 0.02, 1).moved(0.0, layer * i as f32, 0.0))
        .collect()
}

/// What stands and lies in an aisle.
fn floor_clutter(z: f32, half: f32, aisle: f32, clutter: &mut ShapesByMaterial, random: &mut Random) {
    let mut x = -half + 0.2;
    while x < half - 0.4 {
        let size = Vec3::new(random.within(0.2, 0.45), random.within(0.2, 0.6), random.within(0.2, 0.4));
        let side = random.pick(&[-1.0, 1.0]) * (0.5 * aisle - 0.25);
        let turn = random.within(-0.4, 0.4);
        for part in thing(size, random) {
            clutter.put(part.turned(turn).moved(x + 0.25, 0.0, z + side), random);
        }
        x += random.within(0.5, 1.0);
    }
    clutter.put(ladder(1.7).pitched(-0.25).moved(random.within(-0.4, 0.4) * half, 0.0, z + 0.3), random);
    let hose = curve(
        &(0..14)
            .map(|i| {
                Vec3::new(
                    0.16 * (1.1 * i as f32).cos(),
                    0.02 + 0.012 * i as f32,
                    0.16 * (1.1 * i as f32).sin(),
                )
            })
            .collect::<Vec<_>>(),
        5,
    );
    clutter.put(tube(&hose, 0.018, 8).moved(random.within(-0.8, 0.8) * half, 0.0, z), random);
}

fn ladder(height: f32) -> Shape {
    let rungs = (height / 0.25) as usize;
    let rail = |x: f32| beam(Vec3::new(x, 0.0, 0.0), Vec3::new(x, height, 0.0), 0.03, 0.06);
    let steps = (1..rungs).map(|i| cuboid(0.4, 0.025, 0.08).moved(0.0, 0.25 * i as f32, 0.0));
    rail(-0.2) + rail(0.2) + steps.collect()
}

/// A packing table at the open end of the room, with things on and below it.
fn end_table(
    length: f32,
    half_depth: f32,
    boards: &[MaterialId],
    clutter: &mut ShapesByMaterial,
    builder: &mut SceneBuilder,
    random: &mut Random,
) {
    let x = 0.5 * length + 0.6;
    let wide = 1.1 * half_depth;
    let place = Affine3A::from_rotation_translation(Quat::from_rotation_y(0.5 * PI), Vec3::X * x);
    builder.add("table", random.pick(boards), table(wide, 0.6, 0.8, random).transformed(place));
    let on = |y: f32| place * Affine3A::from_translation(Vec3::new(-0.48 * wide, y, -0.25));
    fill(Vec3::new(0.95 * wide, 0.45, 0.5), on(0.8), clutter, random);
    fill(Vec3::new(0.9 * wide, 0.55, 0.5), on(0.0), clutter, random);
    let drawers = cabinet(Vec3::new(0.4, 0.75, 0.5), 1, 4)
        .transformed(place * Affine3A::from_translation(Vec3::new(0.5 * wide + 0.25, 0.0, -0.25)));
    builder.add("drawers", random.pick(boards), drawers);
    let stool = cylinder(0.17, 0.04, 28).moved(0.0, 0.5, 0.0)
        + rod(Vec3::new(0.14, 0.51, 0.0), Vec3::new(0.2, 0.0, 0.0), 0.016, 8).around(4);
    clutter.put(stool.moved(x, 0.0, -0.5 * wide - 0.3), random);
    clutter.put(
        (frustum(0.12, 0.16, 0.3, 24) + cushion(0.25, 0.25, 0.1).moved(0.0, 0.25, 0.0)).moved(
            x + 0.1,
            0.0,
            -0.5 * wide - 0.55,
        ),
        random,
    );
}
