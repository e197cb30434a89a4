//! Machines on a floor: gears, motors, tanks and valves, joined by pipes with flanges and bolts.

use super::materials;
use super::random::Random;
use super::scene_builder::{SceneBuilder, ShapesByMaterial};
use super::shape::Shape;
use super::solids::{beam, bevelled_box, block, cuboid, cylinder, frustum, pipe, rounded_box, sphere, torus};
use super::sweep::{circle, curve, extrude, lathe, rod, sweep, tube};
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Distance of machines.
const CELL: f32 = 1.15;

/// Builds a machine hall.
pub fn build(builder: &mut SceneBuilder, random: &mut Random) {
    let (columns, rows) = (random.count(3, 4), random.count(2, 3));
    let half = 0.5 * CELL * Vec2::new(columns as f32, rows as f32);
    let height = random.within(2.2, 2.8);
    hall(half, height, builder, random);
    let mut materials = materials::several(3, materials::metal, builder, random);
    materials.extend(materials::several(3, materials::paint, builder, random));
    let mut shapes = ShapesByMaterial::new(materials);
    for column in 0..columns {
        for row in 0..rows {
            let at =
                Vec3::new((column as f32 + 0.5) * CELL - half.x, 0.0, (row as f32 + 0.5) * CELL - half.y);
            let quarter = random.count(0, 3) as f32;
            for part in machine(random) {
                shapes.put(part.turned(0.5 * PI * quarter).at(at), random);
            }
        }
    }
    for _ in 0..random.count(8, 14) {
        let route = route(half, height, random);
        shapes.put(pipeline(&route, random.within(0.03, 0.07)), random);
    }
    for _ in 0..random.count(4, 8) {
        let ends = [0, 1]
            .map(|_| Vec3::new(random.within(-half.x, half.x), height - 0.2, random.within(-half.y, half.y)));
        let low = 0.5 * (ends[0] + ends[1]) - Vec3::Y * random.within(0.2, 0.6);
        shapes.put(tube(&curve(&[ends[0], low, ends[1]], 12), 0.014, 7), random);
    }
    shapes.add_to(builder, "machines");
    builder.lamp(Vec3::new(0.0, height - 0.3, 0.0), random);
    builder.sun(random);
}

/// Floor of plates, two walls of panels, and girders overhead on posts.
fn hall(half: Vec2, height: f32, builder: &mut SceneBuilder, random: &mut Random) {
    let concrete = materials::stone(builder, random);
    let (x, z) = (half.x + 0.35, half.y + 0.35);
    let mut shell = block(Vec3::new(-x - 0.1, -0.1, -z - 0.1), Vec3::new(x, -0.03, z));
    let wall = materials::masonry(builder, random);
    builder.add(
        "walls",
        wall,
        block(Vec3::new(-x - 0.1, -0.03, -z - 0.1), Vec3::new(x, height, -z))
            + block(Vec3::new(-x - 0.1, -0.03, -z), Vec3::new(-x, height, z)),
    );
    let plate = random.within(0.45, 0.8);
    let counts = (2.0 * Vec2::new(x, z) / plate).ceil();
    let size = 2.0 * Vec2::new(x, z) / counts;
    for i in 0..counts.x as usize {
        for k in 0..counts.y as usize {
            let at = size * (Vec2::new(i as f32, k as f32) + Vec2::splat(0.5)) - Vec2::new(x, z);
            shell.join(bevelled_box(size.x - 0.015, 0.03, size.y - 0.015, 0.006).moved(at.x, -0.03, at.y));
        }
    }
    builder.add("floor", concrete, shell);
    let steel = materials::metal(builder, random);
    let mut frame = Shape::default();
    let posts = [
        (-half.x - 0.15, -half.y - 0.15),
        (half.x + 0.15, -half.y - 0.15),
        (-half.x - 0.15, half.y + 0.15),
        (half.x + 0.15, half.y + 0.15),
    ];
    for (x, z) in posts {
        frame.join(girder(Vec3::new(x, 0.0, z), Vec3::new(x, height, z), 0.14));
        frame.join(flange(0.12, 6).moved(x, 0.0, z));
    }
    for z in [-half.y - 0.15, 0.0, half.y + 0.15] {
        frame.join(girder(Vec3::new(-x, height, z), Vec3::new(x, height, z), 0.16));
    }
    for i in 0..5 {
        let x = (i as f32 / 4.0 - 0.5) * 2.0 * half.x;
        frame.join(girder(Vec3::new(x, height + 0.13, -z), Vec3::new(x, height + 0.13, z), 0.1));
    }
    builder.add("frame", steel, frame);
}

/// A beam of I section.
fn girder(from: Vec3, to: Vec3, size: f32) -> Shape {
    let (h, web, rim) = (0.5 * size, 0.05 * size, 0.4 * size);
    let section = [
        (-h, -h),
        (h, -h),
        (h, -rim),
        (web, -rim),
        (web, rim),
        (h, rim),
        (h, h),
        (-h, h),
        (-h, rim),
        (-web, rim),
        (-web, -rim),
        (-h, -rim),
    ];
    sweep(&section.map(|(x, y)| Vec2::new(x, y)), &[from, to], |_| 1.0)
}

/// The parts of one machine, which may be of different materials, around the y axis.
fn machine(random: &mut Random) -> Vec<Shape> {
    match random.count(0, 5) {
        0 => gear_train(random),
        1 => motor(random),
        2 => tank(random),
        3 => valves(random),
        4 => engine(random),
        _ => cabinet(random),
    }
}

/// A toothed wheel that lies on y = 0, with a hub and holes between spokes suggested by rims.
fn gear(radius: f32, teeth: usize, thickness: f32) -> Shape {
    let depth = 0.9 * TAU * radius / teeth as f32 / 2.0;
    let outline: Vec<Vec2> = (0..teeth * 4)
        .map(|i| {
            let (tooth, part) = (i / 4, i % 4);
            let angle = (tooth as f32 + [0.0, 0.18, 0.42, 0.6][part]) * TAU / teeth as f32;
            Vec2::from_angle(angle)
                * if part == 1 || part == 2 { radius + 0.5 * depth } else { radius - 0.5 * depth }
        })
        .collect();
    let wheel = extrude(&outline, thickness).pitched(-0.5 * PI).moved(0.0, 0.5 * thickness, 0.0);
    let rim = pipe(radius - depth, 0.75 * radius, 1.35 * thickness, 40).moved(0.0, -0.175 * thickness, 0.0);
    let hub = cylinder(0.25 * radius, 2.0 * thickness, 24).moved(0.0, -0.5 * thickness, 0.0);
    let spoke =
        cuboid(0.55 * radius, 1.3 * thickness, 0.1 * radius).moved(0.48 * radius, -0.15 * thickness, 0.0);
    wheel + rim + hub + spoke.around(6)
}

/// A hexagonal bolt head on y = 0, with a washer.
fn bolt(size: f32) -> Shape {
    cylinder(1.5 * size, 0.25 * size, 12) + cylinder(size, 0.9 * size, 6)
}

/// A disc with bolts on it.
fn flange(radius: f32, bolts: usize) -> Shape {
    let thickness = 0.22 * radius;
    let on_top = bolt(0.1 * radius).moved(0.78 * radius, thickness, 0.0).around(bolts);
    cylinder(radius, thickness, 28) + on_top
}

/// Meshing gears on axles between two plates.
fn gear_train(random: &mut Random) -> Vec<Shape> {
    let module = random.within(0.016, 0.024);
    let mut gears = Shape::default();
    let mut axles = Shape::default();
    let mut at = Vec2::new(-0.28, 0.5);
    let mut radius = module * random.count(8, 12) as f32;
    for _ in 0..random.count(3, 5) {
        let teeth = (2.0 * radius / module).round() as usize;
        let thickness = random.within(0.05, 0.08);
        let wheel = gear(radius, teeth, thickness).pitched(0.5 * PI);
        gears.join(wheel.moved(at.x, at.y, -0.5 * thickness));
        axles.join(rod(Vec3::new(at.x, at.y, -0.2), Vec3::new(at.x, at.y, 0.2), 0.12 * radius + 0.01, 14));
        let bearing = flange(0.3 * radius + 0.03, 6).pitched(0.5 * PI);
        axles.join(bearing.moved(at.x, at.y, 0.17));
        let next = module * random.count(6, 14) as f32;
        let up = random.within(-0.9, 0.9);
        at += Vec2::new(up.cos(), up.sin()) * (radius + next);
        at = at.clamp(Vec2::new(-0.4, 0.3), Vec2::new(0.42, 0.8));
        radius = next;
    }
    let plate = bevelled_box(1.0, 0.85, 0.03, 0.008);
    let mut housing = plate.clone().moved(0.0, 0.1, -0.2);
    housing.join(bevelled_box(1.05, 0.1, 0.5, 0.015));
    let pillar = rod(Vec3::new(0.0, 0.0, -0.2), Vec3::new(0.0, 0.0, 0.22), 0.02, 10);
    housing.join(pillar.at_each(
        [(-0.46, 0.15), (0.46, 0.15), (-0.46, 0.9), (0.46, 0.9)].map(|(x, y)| Vec3::new(x, y, 0.0)),
    ));
    housing.join(beam(Vec3::new(-0.48, 0.15, 0.2), Vec3::new(-0.48, 0.9, 0.2), 0.04, 0.05));
    housing.join(beam(Vec3::new(0.48, 0.15, 0.2), Vec3::new(0.48, 0.9, 0.2), 0.04, 0.05));
    vec![gears, axles, housing]
}

/// An electric motor with cooling fins and a coupling to a pump.
fn motor(random: &mut Random) -> Vec<Shape> {
    let (radius, length) = (random.within(0.16, 0.24), random.within(0.45, 0.65));
    let y = radius + 0.18;
    let body = cylinder(radius, length, 36);
    let fin =
        cuboid(0.05, length - 0.08, 0.008).moved(radius + 0.015, 0.04, 0.0).around(random.count(28, 44));
    let ends = torus(radius - 0.02, 0.03, 36, 10).at_each([Vec3::ZERO, Vec3::Y * length]);
    let grille: Shape = (1..5).map(|i| torus(0.2 * radius * i as f32, 0.008, 28, 6)).collect();
    let turned = (body + fin + ends + grille.moved(0.0, -0.03, 0.0)).rolled(-0.5 * PI).moved(-0.5, y, 0.0);
    let shaft = cylinder(0.03, 0.25, 16).rolled(-0.5 * PI).moved(length - 0.5, y, 0.0);
    let coupling = flange(0.09, 8).rolled(-0.5 * PI).moved(length - 0.42, y, 0.0);
    let casing = pipe(0.2, 0.05, 0.14, 32).rolled(-0.5 * PI).moved(length - 0.33, y, 0.0);
    let spout = rod(Vec3::new(length - 0.26, y, 0.12), Vec3::new(length - 0.26, y + 0.4, 0.12), 0.055, 20);
    let top = flange(0.095, 8).moved(length - 0.26, y + 0.38, 0.12);
    let foot = bevelled_box(1.1, 0.08, 0.5, 0.012)
        + bevelled_box(0.12, y, 0.34, 0.015)
            .at_each([-0.38, length - 0.62, length - 0.26].map(|x| Vec3::X * x));
    let bolts = bolt(0.018)
        .at_each([(-0.5, 0.2), (0.5, 0.2), (-0.5, -0.2), (0.5, -0.2)].map(|(x, z)| Vec3::new(x, 0.08, z)));
    let terminal = bevelled_box(0.16, 0.1, 0.14, 0.01).moved(-0.25, y + radius, 0.0);
    vec![turned, shaft + coupling + bolts, casing + spout + top, foot + terminal]
}

/// A tank on legs with hoops, rungs, a lid and a gauge.
fn tank(random: &mut Random) -> Vec<Shape> {
    let (radius, height, foot) = (random.within(0.3, 0.42), random.within(0.8, 1.2), random.within(0.2, 0.4));
    let arc = |i: usize, up: f32| {
        let angle = 0.5 * PI * i as f32 / 8.0;
        Vec2::new(radius * angle.cos(), 0.35 * radius * angle.sin() * up)
    };
    let mut outline: Vec<Vec2> = (0..=8).rev().map(|i| arc(i, -1.0)).collect();
    outline.extend((0..=8).map(|i| arc(i, 1.0) + Vec2::Y * height));
    outline[0].x = 0.0;
    outline[17].x = 0.0;
    let body = lathe(&outline, 44).moved(0.0, foot, 0.0);
    let hoops = torus(radius, 0.016, 44, 8)
        .at_each((0..4).map(|i| Vec3::Y * (foot + height * (i as f32 + 0.5) / 4.0)));
    let leg = rod(Vec3::new(radius * 0.85, 0.0, 0.0), Vec3::new(radius * 0.85, foot + 0.1, 0.0), 0.03, 10)
        + flange(0.06, 4).moved(0.85 * radius, 0.0, 0.0);
    let lid = flange(0.5 * radius, 10).moved(0.0, foot + height + 0.3 * radius, 0.0);
    let stub = cylinder(0.12, 0.3, 18) + flange(0.16, 8).moved(0.0, 0.26, 0.0);
    let side = stub.rolled(-0.5 * PI).moved(radius - 0.05, foot + 0.3 * height, 0.0).turned(random.angle());
    let ladder: Shape = (0..((height + foot) / 0.18) as usize)
        .map(|i| {
            rod(
                Vec3::new(-0.12, 0.18 * i as f32 + 0.15, radius + 0.09),
                Vec3::new(0.12, 0.18 * i as f32 + 0.15, radius + 0.09),
                0.01,
                6,
            )
        })
        .collect();
    let rails = [-0.12, 0.12]
        .map(|x| rod(Vec3::new(x, 0.0, radius + 0.09), Vec3::new(x, foot + height, radius + 0.09), 0.014, 8));
    let gauge = cylinder(0.07, 0.04, 24).pitched(0.5 * PI).turned(0.8).moved(
        0.7 * (radius + 0.03),
        foot + 0.7 * height,
        0.7 * (radius + 0.03),
    );
    vec![body, hoops + lid + side, leg.around(4), ladder + rails.into_iter().collect() + gauge]
}

/// A row of valves with hand wheels on a pipe.
fn valves(random: &mut Random) -> Vec<Shape> {
    let (y, radius) = (random.within(0.35, 0.6), random.within(0.05, 0.08));
    let main = rod(Vec3::new(-0.55, y, 0.0), Vec3::new(0.55, y, 0.0), radius, 24);
    let mut bodies = Shape::default();
    let mut wheels = Shape::default();
    for i in 0..random.count(2, 4) {
        let x = -0.38 + 0.25 * i as f32;
        bodies.join(sphere(1.5 * radius, 24).moved(x, y - 1.5 * radius, 0.0));
        let neck = random.within(0.12, 0.22);
        bodies.join(frustum(radius, 0.5 * radius, neck, 18).moved(x, y + radius, 0.0));
        let ring = flange(1.8 * radius, 8).rolled(-0.5 * PI);
        bodies.join(ring.at_each([-1.7, 1.3].map(|s| Vec3::new(x + s * radius, y, 0.0))));
        let rim = random.within(0.07, 0.11);
        let spokes = rod(Vec3::ZERO, Vec3::X * rim, 0.009, 6).around(5);
        let wheel = torus(rim, 0.013, 32, 10) + spokes + sphere(0.022, 12).moved(0.0, -0.022, 0.0);
        wheels.join(wheel.moved(x, y + radius + neck + 0.04, 0.0));
        wheels.join(cylinder(0.01, 0.12, 8).moved(x, y + radius + neck - 0.05, 0.0));
        let drop = tube(
            &curve(
                &[
                    Vec3::new(x, y, 0.0),
                    Vec3::new(x, y, 0.25),
                    Vec3::new(x, y - 0.08, 0.33),
                    Vec3::new(x, 0.0, 0.34),
                ],
                5,
            ),
            0.6 * radius,
            16,
        );
        bodies.join(drop + flange(1.1 * radius, 6).moved(x, 0.0, 0.34));
    }
    let saddle = bevelled_box(0.08, y, 0.2, 0.015) + bevelled_box(0.2, 0.04, 0.3, 0.01);
    vec![main, bodies, wheels, saddle.at_each([-0.5, 0.5].map(|x| Vec3::X * x))]
}

/// An engine block with cylinders, pulleys and a belt.
fn engine(random: &mut Random) -> Vec<Shape> {
    let cylinders = random.count(2, 4);
    let length = 0.2 * cylinders as f32 + 0.15;
    let block = rounded_box(length, 0.35, 0.34, 0.03, 2).moved(0.0, 0.15, 0.0);
    let head: Shape = (0..8)
        .map(|i| {
            cylinder(if i % 2 == 0 { 0.085 } else { 0.07 }, 0.03, 24).moved(0.0, 0.5 + 0.03 * i as f32, 0.0)
        })
        .collect();
    let place = |i: usize| Vec3::X * (0.2 * (i as f32 - 0.5 * (cylinders - 1) as f32));
    let heads = (head + bolt(0.014).moved(0.05, 0.74, 0.0).around(4)).at_each((0..cylinders).map(place));
    let exhaust: Shape = (0..cylinders)
        .map(|i| {
            let x = place(i).x;
            tube(
                &curve(
                    &[
                        Vec3::new(x, 0.55, 0.05),
                        Vec3::new(x, 0.55, 0.2),
                        Vec3::new(x * 0.7, 0.35, 0.32),
                        Vec3::new(0.0, 0.18, 0.4),
                    ],
                    5,
                ),
                0.03,
                12,
            )
        })
        .collect();
    let end = 0.5 * length + 0.03;
    let pulleys = [(0.32, 0.0, 0.12), (0.52, 0.12, 0.06), (0.45, -0.13, 0.07)];
    let wheel = |radius: f32| {
        lathe(
            &[(0.0, 0.0), (1.0, 0.0), (0.85, 0.02), (1.0, 0.04), (0.0, 0.04)]
                .map(|(x, y)| Vec2::new(x * radius, y)),
            32,
        )
    };
    let pulleys_shape: Shape = pulleys
        .iter()
        .map(|(y, z, radius)| wheel(*radius).rolled(-0.5 * PI).moved(end - 0.03, *y, *z))
        .collect();
    let belt: Vec<Vec3> = (0..=48)
        .map(|i| {
            let around = Vec2::from_angle(TAU * (i % 48) as f32 / 48.0);
            // The support point of the pulleys in each direction gives the belt around all of them.
            let reach = |pulley: &&(f32, f32, f32)| around.dot(Vec2::new(pulley.1, pulley.0)) + pulley.2;
            let outer =
                pulleys.iter().max_by(|a, b| reach(a).total_cmp(&reach(b))).expect("there are three pulleys");
            Vec3::new(end - 0.01, outer.0 + around.y * outer.2, outer.1 + around.x * outer.2)
        })
        .collect();
    let feet = bevelled_box(0.1, 0.16, 0.42, 0.01).at_each([-0.4, 0.4].map(|s| Vec3::X * (s * length)));
    let sump = bevelled_box(length - 0.1, 0.1, 0.24, 0.02).moved(0.0, 0.06, 0.0);
    vec![block + feet, heads, exhaust, pulleys_shape + sweep(&circle(0.008, 6), &belt, |_| 1.0), sump]
}

/// A control cabinet with doors, louvres, lamps and levers.
fn cabinet(random: &mut Random) -> Vec<Shape> {
    let (width, height, depth) = (random.within(0.6, 0.9), random.within(1.0, 1.7), random.within(0.3, 0.45));
    let z = 0.5 * depth;
    let body = bevelled_box(width, height - 0.08, depth, 0.012).moved(0.0, 0.08, 0.0)
        + cuboid(width - 0.06, 0.1, depth - 0.06);
    let door = bevelled_box(0.5 * width - 0.02, height - 0.14, 0.03, 0.006);
    let doors = door.at_each([-0.25, 0.25].map(|s| Vec3::new(s * width, 0.11, z)));
    let louvre = cuboid(0.36 * width, 0.012, 0.04).pitched(0.6);
    let louvres = louvre.at_each((0..10).map(|i| Vec3::new(-0.25 * width, 0.2 + 0.03 * i as f32, z + 0.012)));
    let mut small = Shape::default();
    for row in 0..random.count(2, 4) {
        for column in 0..4 {
            let at =
                Vec3::new((0.1 + 0.1 * column as f32) * width, height * (0.85 - 0.1 * row as f32), z + 0.012);
            let lamp = if random.chance(0.6) {
                cylinder(0.02, 0.025, 14).pitched(0.5 * PI)
            } else {
                rod(Vec3::ZERO, Vec3::new(0.0, 0.04, 0.06), 0.008, 8)
            };
            small.join(lamp.at(at));
        }
    }
    let screen = block(
        Vec3::new(-0.42 * width, 0.65 * height, z + 0.01),
        Vec3::new(-0.08 * width, 0.9 * height, z + 0.03),
    );
    let conduits: Shape = (0..5)
        .map(|i| {
            rod(
                Vec3::new((0.15 * i as f32 - 0.3) * width, height - 0.03, 0.0),
                Vec3::new((0.15 * i as f32 - 0.3) * width, height + 0.5, 0.0),
                0.018,
                10,
            )
        })
        .collect();
    vec![body, doors, louvres + screen, small + conduits]
}

/// A way for a pipe: up from the floor, along the axes overhead, and down again.
fn route(half: Vec2, height: f32, random: &mut Random) -> Vec<Vec3> {
    let spot = |random: &mut Random| {
        // Pipes rise between the machines.
        let line = |half: f32, random: &mut Random| {
            CELL * (random.count(0, (2.0 * half / CELL).round() as usize) as f32) - half
        };
        Vec2::new(line(half.x, random), line(half.y, random)) + random.in_disc(0.12)
    };
    let (from, to) = (spot(random), spot(random));
    let y = height - random.within(0.3, 1.0);
    let corner = if random.chance(0.5) { Vec2::new(to.x, from.y) } else { Vec2::new(from.x, to.y) };
    let mut points = vec![Vec3::new(from.x, 0.0, from.y), Vec3::new(from.x, y, from.y)];
    points.push(Vec3::new(corner.x, y, corner.y));
    points.push(Vec3::new(to.x, y, to.y));
    points.push(Vec3::new(to.x, 0.0, to.y));
    points.dedup_by(|a, b| a.distance(*b) < 0.3);
    points
}

/// A pipe with rounded elbows, a flange at each end of a straight piece, and collars.
fn pipeline(route: &[Vec3], radius: f32) -> Shape {
    let bend = 3.0 * radius;
    let mut path = vec![route[0]];
    let mut fittings = flange(1.9 * radius, 6).at(route[0]);
    for corner in route.windows(3) {
        let (into, out) = ((corner[1] - corner[0]).normalize(), (corner[2] - corner[1]).normalize());
        let (start, end) = (corner[1] - into * bend, corner[1] + out * bend);
        for i in 0..=5 {
            let t = i as f32 / 5.0;
            path.push(start.lerp(corner[1], t).lerp(corner[1].lerp(end, t), t));
        }
        fittings.join(
            flange(1.9 * radius, 6).aimed(into).at(start) + flange(1.9 * radius, 6).aimed(-out).at(end),
        );
    }
    path.push(route[route.len() - 1]);
    for piece in route.windows(2) {
        let middle = 0.5 * (piece[0] + piece[1]);
        fittings.join(cylinder(1.35 * radius, 2.0 * radius, 18).aimed(piece[1] - piece[0]).at(middle));
    }
    tube(&path, radius, 18) + fittings
}
