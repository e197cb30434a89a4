//! Cloth: draped over furniture and figures, hung from lines and rods, folded and heaped.

use super::cloth::{Cloth, Solid};
use super::furniture::cushion;
use super::materials;
use super::random::Random;
use super::scene_builder::SceneBuilder;
use super::shape::Shape;
use super::solids::{block, cylinder, rounded_box, sphere, torus};
use super::surface::sheet;
use super::sweep::{curve, rod, sweep, tube};
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Distance of the draped groups.
const CELL: f32 = 1.5;

/// Builds a room full of cloth.
pub fn build(builder: &mut SceneBuilder, random: &mut Random) {
    let columns = random.count(2, 3);
    let half = 0.5 * CELL * columns as f32 + 0.2;
    room(half, builder, random);
    for column in 0..columns {
        for row in 0..2 {
            let x = (column as f32 + 0.5) * CELL - 0.5 * CELL * columns as f32;
            let middle = Vec3::new(x, 0.0, (row as f32 - 0.5) * CELL + 0.15) + jitter(random, 0.1);
            if row == 1 && random.chance(0.4) {
                loose_things(middle, builder, random);
            } else {
                draped_group(middle, builder, random);
            }
        }
    }
    line_with_washing(half, builder, random);
    builder.lamp(Vec3::new(0.0, 2.2, 1.0), random);
    builder.sun(random);
}

fn jitter(random: &mut Random, reach: f32) -> Vec3 {
    let at = random.in_disc(reach);
    Vec3::new(at.x, 0.0, at.y)
}

/// Floor with a rumpled rug, a wall, and curtains along it.
fn room(half: f32, builder: &mut SceneBuilder, random: &mut Random) {
    let (depth, height) = (CELL + 0.25, 2.2);
    let floor = materials::flooring(builder, random);
    builder.add("floor", floor, block(Vec3::new(-half, -0.08, -depth), Vec3::new(half, 0.0, depth + 0.15)));
    let wall = materials::masonry(builder, random);
    builder.add(
        "wall",
        wall,
        block(Vec3::new(-half, 0.0, -depth - 0.1), Vec3::new(half, height + 0.1, -depth)),
    );
    let metal = materials::metal(builder, random);
    let z = 0.14 - depth;
    let rail = rod(Vec3::new(-half + 0.05, height, z), Vec3::new(half - 0.05, height, z), 0.018, 12);
    builder.add(
        "rail",
        metal,
        rail + sphere(0.04, 16).at_each([-half + 0.05, half - 0.05].map(|x| Vec3::new(x, height - 0.04, z))),
    );
    let mut left = 0.08 - half;
    while left < half - 0.4 {
        let width = random.within(0.6, 1.3).min(half - 0.08 - left);
        let cloth = materials::cloth(builder, random);
        let tied = random.chance(0.4);
        builder.add("curtain", cloth, curtain(width, height - 0.03, tied, random).moved(left, 0.0, z));
        let rings = (0..8).map(|i| Vec3::new(left + width * (i as f32 + 0.5) / 8.0, height - 0.008, z));
        builder.add("rings", metal, torus(0.025, 0.005, 16, 6).rolled(0.5 * PI).at_each(rings));
        left += width + random.within(0.02, 0.15);
    }
    let rug = materials::cloth(builder, random);
    let (fold, phase) = (random.within(3.0, 7.0), random.angle());
    let wavy = move |x: f32, z: f32| {
        let wave = (fold * x + 1.3 * (2.1 * z + phase).sin()).sin();
        0.006 + 0.05 * wave.max(0.0).powi(3)
    };
    let size = Vec2::new(1.7 * half, 1.5 * depth);
    let surface = sheet(120, 90, |u, v| {
        let at = size * (Vec2::new(u, v) - Vec2::splat(0.5));
        Vec3::new(at.x, wavy(at.x, at.y), at.y + 0.2)
    });
    builder.add("rug", rug, surface);
}

/// A pleated curtain from x = 0 to `width` and from `height` down to just above the floor, gathered at its
/// middle if tied.
fn curtain(width: f32, height: f32, tied: bool, random: &mut Random) -> Shape {
    let pleats = (width / random.within(0.09, 0.16)).round();
    let (phase, sway) = (random.angle(), random.within(0.5, 1.5));
    sheet(pleats as usize * 10, 60, |u, v| {
        let knot = if tied { (-((v - 0.6) * 6.0).powi(2)).exp() } else { 0.0 };
        let deep = 0.035 + 0.025 * v + 0.02 * knot;
        let drift = 0.5 * sway * v * (3.0 * u + phase).sin();
        let fold = (TAU * pleats * u + drift + 0.8 * v * (TAU * u + phase).sin()).sin();
        let x = width * (u * (1.0 - 0.75 * knot) + 0.1 * knot) + 0.015 * v * (TAU * pleats * u).cos();
        Vec3::new(x, height * (1.0 - v) + 0.01, deep * fold + 0.03 * knot)
    })
}

/// Some solids with a cloth thrown over them.
fn draped_group(middle: Vec3, builder: &mut SceneBuilder, random: &mut Random) {
    let solids = group(random);
    let top = solids.iter().fold(0f32, |top, solid| top.max(solid.top()));
    let size = (1.1 * top + random.within(0.4, 0.7)).min(1.7);
    let mut cloth = Cloth::square(size, 34, Vec3::new(0.0, top + 0.03, 0.0), random.angle());
    cloth.settle(&solids, 95);
    let body = materials::any(builder, random);
    let fabric = materials::cloth(builder, random);
    builder.add("body", body, solids.iter().map(Solid::shape).collect::<Shape>().at(middle));
    builder.add("drape", fabric, cloth.shape(3).at(middle));
}

/// Solids that stand on the floor around the y axis.
fn group(random: &mut Random) -> Vec<Solid> {
    match random.count(0, 4) {
        0 => figure(random),
        1 => armchair(random),
        2 => small_table(random),
        3 => heap(random),
        _ => steles(random),
    }
}

fn ball(middle: Vec3, radius: f32) -> Solid {
    Solid::Bar { from: middle, to: middle, radius }
}

/// A person with arms more or less spread.
fn figure(random: &mut Random) -> Vec<Solid> {
    let tall = random.within(0.75, 1.0);
    let bar = |from: Vec3, to: Vec3, radius: f32| Solid::Bar {
        from: from * tall,
        to: to * tall,
        radius: radius * tall,
    };
    let shoulder = |s: f32| Vec3::new(0.2 * s, 1.32, 0.0);
    let mut solids = vec![
        bar(Vec3::new(0.0, 0.85, 0.0), Vec3::new(0.0, 1.28, 0.0), 0.15),
        bar(shoulder(-1.0), shoulder(1.0), 0.07),
        ball(Vec3::new(0.0, 1.62, 0.02) * tall, 0.12 * tall),
    ];
    for s in [-1.0, 1.0] {
        let spread = random.within(0.15, 0.55);
        let hand = shoulder(s) + Vec3::new(s * spread, -0.5 + 0.8 * spread, random.within(0.0, 0.3));
        solids.push(bar(shoulder(s), hand, 0.05));
        solids.push(bar(Vec3::new(0.1 * s, 0.08, 0.0), Vec3::new(0.09 * s, 0.9, 0.0), 0.08));
    }
    solids
}

fn armchair(random: &mut Random) -> Vec<Solid> {
    let half = random.within(0.32, 0.42);
    let part = |middle: Vec3, half: Vec3| Solid::Box { middle, half };
    let side = |s: f32| part(Vec3::new(s * half, 0.3, 0.0), Vec3::new(0.08, 0.3, 0.38));
    vec![
        part(Vec3::new(0.0, 0.21, 0.0), Vec3::new(half, 0.21, 0.38)),
        side(-1.0),
        side(1.0),
        part(Vec3::new(0.0, 0.45, -0.33), Vec3::new(half, 0.45, 0.09)),
    ]
}

/// A table with things on it.
fn small_table(random: &mut Random) -> Vec<Solid> {
    let (half, top) = (random.within(0.25, 0.4), random.within(0.45, 0.7));
    let mut solids =
        vec![Solid::Box { middle: Vec3::new(0.0, top - 0.02, 0.0), half: Vec3::new(half, 0.02, half) }];
    for (x, z) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        let foot = Vec3::new(x, 0.0, z) * (half - 0.05);
        solids.push(Solid::Bar { from: foot.with_y(0.025), to: foot.with_y(top - 0.03), radius: 0.025 });
    }
    for _ in 0..random.count(1, 4) {
        let radius = random.within(0.06, 0.14);
        let at = random.in_disc(half - 0.08);
        solids.push(ball(Vec3::new(at.x, top + radius, at.y), radius));
    }
    solids
}

/// Balls and boxes on the floor.
fn heap(random: &mut Random) -> Vec<Solid> {
    (0..random.count(4, 7))
        .map(|i| {
            let at = random.in_disc(0.35);
            let size = random.within(0.1, 0.26);
            if i % 2 == 0 {
                ball(Vec3::new(at.x, size, at.y), size)
            } else {
                let tall = random.within(0.1, 0.4);
                Solid::Box {
                    middle: Vec3::new(at.x, tall, at.y),
                    half: Vec3::new(0.6 * size, tall, 0.6 * size),
                }
            }
        })
        .collect()
}

/// Posts with round heads.
fn steles(random: &mut Random) -> Vec<Solid> {
    let count = random.count(3, 5);
    (0..count)
        .flat_map(|i| {
            let around = Vec2::from_angle(TAU * i as f32 / count as f32) * random.within(0.2, 0.42);
            let (tall, radius) = (random.within(0.35, 1.0), random.within(0.09, 0.16));
            let foot = Vec3::new(around.x, 0.0, around.y);
            [
                Solid::Bar { from: foot.with_y(0.05), to: foot.with_y(tall), radius: 0.05 },
                ball(foot.with_y(tall), radius),
            ]
        })
        .collect()
}

/// Cushions, folded blankets, rolls and rope on the floor.
fn loose_things(middle: Vec3, builder: &mut SceneBuilder, random: &mut Random) {
    let fabrics = materials::several(3, materials::cloth, builder, random);
    let fold = random.within(0.35, 0.5);
    let layers = random.count(3, 7);
    for i in 0..layers {
        let blanket = folded(fold * random.within(0.9, 1.0), 0.35, 0.055).turned(random.within(-0.08, 0.08));
        builder.add("folded", fabrics[i % 3], blanket.at(middle + Vec3::new(-0.4, 0.056 * i as f32, -0.2)));
    }
    let mut y = 0.0;
    for _ in 0..random.count(2, 4) {
        let thick = random.within(0.12, 0.2);
        let pillow = cushion(random.within(0.38, 0.5), random.within(0.35, 0.45), thick)
            .turned(random.within(-0.5, 0.5));
        builder.add("cushion", random.pick(&fabrics), pillow.at(middle + Vec3::new(0.3, y, -0.25)));
        y += 0.85 * thick;
    }
    for i in 0..random.count(2, 3) {
        let radius = random.within(0.06, 0.09);
        builder.add(
            "roll",
            random.pick(&fabrics),
            roll(radius, 0.7).moved(0.19 * i as f32 - 0.3, radius + 0.01, 0.35).at(middle),
        );
    }
    let knots: Vec<Vec3> = (0..40)
        .map(|i| {
            Vec3::new((0.5 * i as f32).cos(), 0.0, (0.5 * i as f32).sin())
                * (0.1 + 0.02 * (i as f32 * 0.37).sin())
        })
        .enumerate()
        .map(|(i, point)| point + Vec3::Y * (0.014 + 0.0025 * i as f32))
        .collect();
    builder.add(
        "rope",
        fabrics[0],
        tube(&curve(&knots, 4), 0.013, 8).at(middle + Vec3::new(0.42, 0.0, 0.35)),
    );
}

/// A blanket folded twice: its edge shows the folds.
fn folded(width: f32, depth: f32, height: f32) -> Shape {
    let layer = height / 4.0;
    (0..4)
        .map(|i| {
            rounded_box(width - 0.01 * (i % 2) as f32, 0.97 * layer, depth, 0.45 * layer, 3).moved(
                0.004 * (i % 3) as f32,
                layer * i as f32,
                0.0,
            )
        })
        .collect()
}

/// A rolled up mat along z: a spiral pulled straight.
fn roll(radius: f32, length: f32) -> Shape {
    let turns = 4.0;
    let thickness = 0.3 * radius / turns;
    let spiral = |t: f32, out: f32| Vec2::from_angle(TAU * turns * t) * (radius * (0.2 + 0.8 * t) - out);
    let mut outline: Vec<Vec2> = (0..=96).map(|i| spiral(i as f32 / 96.0, 0.0)).collect();
    outline.extend((0..=96).rev().map(|i| spiral(i as f32 / 96.0, thickness)));
    sweep(&outline, &[Vec3::Z * -0.5 * length, Vec3::Z * 0.5 * length], |_| 1.0)
}

/// A line between two posts with cloths pinned to it.
fn line_with_washing(half: f32, builder: &mut SceneBuilder, random: &mut Random) {
    let (height, z) = (random.within(1.5, 1.9), CELL + 0.22);
    let metal = materials::metal(builder, random);
    let mut posts = Shape::default();
    for x in [0.1 - half, half - 0.1] {
        posts.join(
            cylinder(0.03, height + 0.05, 14).moved(x, 0.0, z) + cylinder(0.14, 0.03, 24).moved(x, 0.0, z),
        );
    }
    let sag = |x: f32| height - 0.06 * (1.0 - (x / half).powi(2));
    let points: Vec<Vec3> =
        (0..=24).map(|i| (i as f32 / 12.0 - 1.0) * (half - 0.1)).map(|x| Vec3::new(x, sag(x), z)).collect();
    builder.add("line", metal, posts + tube(&points, 0.006, 6));
    let mut x = 0.35 - half;
    while x < half - 0.8 {
        let size = random.within(0.5, 0.9);
        let mut cloth = Cloth::hanging(size, 23, Vec3::new(x, 0.0, z), sag);
        cloth.settle(&[], 60);
        let fabric = materials::cloth(builder, random);
        builder.add("washing", fabric, cloth.shape(3));
        x += size + random.within(0.08, 0.4);
    }
}
