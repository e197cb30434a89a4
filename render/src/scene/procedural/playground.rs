//! Playgrounds: slides, climbing frames, swings and ride-on vehicles of swept and lofted forms.

use super::materials;
use super::noise;
use super::random::Random;
use super::rides;
use super::scene_builder::{SceneBuilder, ShapesByMaterial};
use super::shape::Shape;
use super::solids::{beam, bevelled_box, cylinder, frustum, icosphere, sphere, torus};
use super::surface::ground;
use super::sweep::{circle, curve, rod, sweep, tube};
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Distance of the pieces of equipment.
const CELL: f32 = 2.6;

/// Builds a playground.
pub fn build(builder: &mut SceneBuilder, random: &mut Random) {
    let (columns, rows) = (random.count(2, 3), 2);
    let half = 0.5 * CELL * Vec2::new(columns as f32, rows as f32) + Vec2::splat(0.15);
    yard(half, builder, random);
    let mut shapes = ShapesByMaterial::new(materials::several(5, materials::paint, builder, random));
    let steel = materials::metal(builder, random);
    let wood = materials::wood(builder, random);
    // The tower is in every playground; what else there is comes in any order without repeating soon.
    let mut next = random.count(0, 5);
    for index in 0..columns * rows {
        let at = Vec3::new((index % columns) as f32 + 0.5, 0.0, (index / columns) as f32 + 0.5) * CELL
            - Vec3::new(half.x - 0.15, 0.0, half.y - 0.15);
        let turn = 0.5 * PI * random.count(0, 3) as f32 + random.within(-0.15, 0.15);
        let place = |shape: Shape| shape.turned(turn).at(at);
        let piece = if index == 0 { tower(random) } else { equipment(next, random) };
        next += random.count(1, 2);
        builder.add("frame", steel, place(piece.steel));
        builder.add("boards", wood, place(piece.wood));
        for part in piece.painted {
            shapes.put(place(part), random);
        }
        for _ in 0..2 {
            let out = Vec2::from_angle(random.angle()) * 0.46 * CELL;
            shapes.put(rides::toy(random).at(at + Vec3::new(out.x, 0.0, out.y)), random);
        }
    }
    shapes.add_to(builder, "painted");
    builder.sun(random);
}

/// A piece of equipment around the y axis by material.
#[derive(Default)]
pub struct Piece {
    /// Tubes, chains and springs.
    pub steel: Shape,
    /// Boards and posts.
    pub wood: Shape,
    /// Plastic parts, each of a colour of its own.
    pub painted: Vec<Shape>,
}

/// A mat of tiles with a kerb of half-buried posts, and a sandpit.
fn yard(half: Vec2, builder: &mut SceneBuilder, random: &mut Random) {
    let rubber = materials::checker(builder, random);
    let mut mat = Shape::default();
    let counts = (2.0 * half / 0.55).ceil();
    let size = 2.0 * half / counts;
    let tile = bevelled_box(size.x - 0.008, 0.06, size.y - 0.008, 0.012);
    for i in 0..(counts.x * counts.y) as usize {
        let at = size
            * (Vec2::new((i % counts.x as usize) as f32, (i / counts.x as usize) as f32) + Vec2::splat(0.5))
            - half;
        mat.join(tile.clone().moved(at.x, -0.06, at.y));
    }
    builder.add("mat", rubber, mat);
    let bark = materials::wood(builder, random);
    let mut kerb = Shape::default();
    for (side, length, out) in [(0, half.x, half.y), (1, half.y, half.x)] {
        let count = (2.0 * length / 0.16) as usize;
        for i in 0..count {
            let along = (2.0 * (i as f32 + 0.5) / count as f32 - 1.0) * length;
            for s in [-1.0, 1.0] {
                let tall = random.within(0.18, 0.42);
                let post = frustum(0.078, 0.07, tall, 12).moved(0.0, -0.06, 0.0);
                let at = if side == 0 {
                    Vec3::new(along, 0.0, s * (out + 0.08))
                } else {
                    Vec3::new(s * (out + 0.08), 0.0, along)
                };
                kerb.join(post.at(at));
            }
        }
    }
    builder.add("kerb", bark, kerb);
    let sand = materials::earth(builder, random);
    let seed = random.bits();
    let heap = ground(Vec2::new(1.1, 1.1), 60, -0.05, |x, z| {
        let border = (1.0 - (x.abs().max(z.abs()) / 0.55).powi(4)).max(0.0);
        0.03 + border * 0.16 * (0.5 + noise::fbm(seed, Vec3::new(2.2 * x, 0.5, 2.2 * z), 4))
    });
    let at = Vec3::new(random.within(-0.5, 0.5) * half.x, 0.0, random.pick(&[-0.02, 0.02]));
    let board = beam(Vec3::new(-0.62, 0.07, 0.58), Vec3::new(0.62, 0.07, 0.58), 0.07, 0.16);
    builder.add("sand", sand, heap.at(at));
    builder.add("pit", bark, board.around(4).at(at));
}

fn equipment(kind: usize, random: &mut Random) -> Piece {
    match kind % 7 {
        0 => dome(random),
        1 => swings(random),
        2 => rides::train(random),
        3 => climbing_net(random),
        4 => rides::springs(random),
        5 => rides::roundabout(random),
        _ => tyres_and_pipe(random),
    }
}

/// A tower with a roof, a slide and a ladder.
fn tower(random: &mut Random) -> Piece {
    let (deck, half) = (random.within(1.0, 1.5), 0.5);
    let mut wood = Shape::default();
    let corners =
        [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)].map(|(x, z)| Vec3::new(x * half, 0.0, z * half));
    wood.join(bevelled_box(0.1, deck + 1.5, 0.1, 0.012).at_each(corners));
    wood.join(
        bevelled_box(0.16, 0.03, 1.1, 0.006)
            .at_each((0..6).map(|i| Vec3::new(0.175 * i as f32 - 0.44, deck, 0.0))),
    );
    let brace = beam(Vec3::new(-half, 0.25, half), Vec3::new(half, deck - 0.15, half), 0.05, 0.08);
    wood.join(brace.around(4));
    let slat = bevelled_box(0.07, 0.6, 0.02, 0.005);
    wood.join(slat.at_each((0..9).map(|i| Vec3::new(0.11 * i as f32 - 0.44, deck + 0.1, -half))));
    wood.join(
        slat.clone()
            .turned(0.5 * PI)
            .at_each((0..9).map(|i| Vec3::new(-half, deck + 0.1, 0.11 * i as f32 - 0.44))),
    );
    let roof = sweep(
        &circle(0.9, 4),
        &[Vec3::Y * (deck + 1.4), Vec3::Y * (deck + 1.46), Vec3::Y * (deck + 2.0)],
        |t| [1.0, 1.0, 0.06][(2.0 * t) as usize],
    );
    let slide = if random.chance(0.5) { straight_slide(deck, half) } else { winding_slide(deck, half) };
    let mut steel = Shape::default();
    for z in [-0.22, 0.22] {
        steel.join(tube(
            &curve(
                &[Vec3::new(-1.05, 0.0, z), Vec3::new(-0.56, deck, z), Vec3::new(-0.56, deck + 0.6, z)],
                6,
            ),
            0.022,
            10,
        ));
    }
    let rungs = (deck / 0.2) as usize;
    for i in 1..=rungs {
        let share = i as f32 / (rungs as f32 + 0.5);
        let at = Vec3::new(-1.03 + 0.47 * share, deck * share, 0.0);
        steel.join(rod(at - Vec3::Z * 0.22, at + Vec3::Z * 0.22, 0.017, 8));
    }
    Piece { steel, wood, painted: vec![roof.turned(0.25 * PI), slide] }
}

/// The section of a slide: a channel with rims, open above.
fn channel() -> Vec<Vec2> {
    let inner = (0..=10)
        .map(|i| PI * (1.0 + i as f32 / 10.0))
        .map(|a| Vec2::new(0.24 * a.cos(), 0.17 * a.sin() + 0.2));
    let outer = (0..=10)
        .rev()
        .map(|i| PI * (1.0 + i as f32 / 10.0))
        .map(|a| Vec2::new(0.275 * a.cos(), 0.205 * a.sin() + 0.2));
    let mut outline: Vec<Vec2> = inner.chain(outer).collect();
    outline.reverse();
    outline
}

fn straight_slide(deck: f32, edge: f32) -> Shape {
    let knots = [(0.0, 0.0), (0.15, 0.0), (0.6, -0.42), (0.9, -0.55), (1.25, -0.92), (1.55, -0.95)];
    let path: Vec<Vec3> =
        knots.iter().map(|(x, y)| Vec3::new(edge + 0.75 * x, deck * (1.0 + y), 0.0)).collect();
    let under = curve(&path, 8);
    let legs = rod(Vec3::new(edge + 0.65, 0.0, 0.0), Vec3::new(edge + 0.65, deck * 0.45, 0.0), 0.04, 12);
    sweep(&channel(), &under, |_| 1.0) + legs
}

/// A slide around a post.
fn winding_slide(deck: f32, edge: f32) -> Shape {
    let radius = 0.45;
    let mut path = vec![Vec3::new(edge - 0.05, deck, 0.0), Vec3::new(edge + 0.1, deck, 0.0)];
    for i in 0..=44 {
        let t = i as f32 / 44.0;
        let around = Vec2::from_angle(1.4 * TAU * t - 0.5 * PI) * radius;
        path.push(Vec3::new(edge + 0.35 + around.x, deck * (1.0 - 0.93 * t), radius + around.y));
    }
    sweep(&channel(), &path, |_| 1.0) + cylinder(0.06, deck + 0.3, 18).moved(edge + 0.35, 0.0, radius)
}

/// Half of a geodesic ball of bars with balls at the joints.
fn dome(random: &mut Random) -> Piece {
    let radius = random.within(0.95, 1.15);
    let net = icosphere(radius, random.pick(&[1, 1, 2]));
    let bar = if net.triangles.len() > 100 { 0.016 } else { 0.024 };
    let mut steel = Shape::default();
    let mut joints = Shape::default();
    let stands = |vertex: u32| net.positions[vertex as usize].y > -0.12 * radius;
    let on_ground = |vertex: u32| {
        net.positions[vertex as usize]
            * Vec3::new(1.0, f32::from(net.positions[vertex as usize].y > 0.12 * radius), 1.0)
    };
    for triangle in &net.triangles {
        for (a, b) in [(0, 1), (1, 2), (2, 0)] {
            let (a, b) = (triangle[a], triangle[b]);
            // Each edge belongs to two triangles, which pass it in opposite directions.
            if a < b && stands(a) && stands(b) {
                steel.join(rod(on_ground(a), on_ground(b), bar, 8));
            }
        }
    }
    for vertex in (0..net.positions.len() as u32).filter(|vertex| stands(*vertex)) {
        joints.join(sphere(2.0 * bar, 12).at(on_ground(vertex) - Vec3::Y * bar));
    }
    Piece { steel, painted: vec![joints], ..Piece::default() }
}

/// Two or three seats on chains.
fn swings(random: &mut Random) -> Piece {
    let height = random.within(1.7, 2.1);
    let mut steel = rod(Vec3::new(-1.1, height, 0.0), Vec3::new(1.1, height, 0.0), 0.04, 14);
    for x in [-1.0, 1.0] {
        for z in [-0.6, 0.6] {
            steel.join(rod(Vec3::new(1.1 * x, 0.0, z), Vec3::new(x, height, 0.0), 0.035, 12));
        }
        steel.join(rod(
            Vec3::new(1.05 * x, 0.5 * height, -0.3),
            Vec3::new(1.05 * x, 0.5 * height, 0.3),
            0.022,
            10,
        ));
    }
    let mut painted = Vec::new();
    for x in [-0.5, 0.5] {
        let swung = random.within(-0.5, 0.5);
        let length = 0.72 * height;
        let link = torus(0.022, 0.006, 10, 5).scaled(1.0, 1.0, 1.6).pitched(0.5 * PI);
        let links = (length / 0.056) as usize;
        let chain: Shape = (0..links)
            .map(|i| {
                link.clone().turned(0.5 * PI * (i % 2) as f32).moved(0.0, -0.056 * (i as f32 + 0.5), 0.0)
            })
            .collect();
        let hang = |shape: Shape| shape.pitched(swung).moved(x, height - 0.04, 0.0);
        steel.join(hang(chain.at_each([-0.2, 0.2].map(|x| Vec3::X * x))));
        let seat = rides::loft(
            0.46,
            12,
            |t| Vec2::new(0.1, 0.018 + 0.01 * (PI * t).sin()),
            |t| -0.05 * (PI * t).sin(),
        );
        painted.push(hang(seat.turned(0.5 * PI).moved(0.0, -length, 0.0)));
    }
    Piece { steel, painted, ..Piece::default() }
}

/// A mast with ropes to a ring and ropes between them.
fn climbing_net(random: &mut Random) -> Piece {
    let (height, radius, spokes) = (random.within(1.7, 2.3), 1.05, random.count(6, 9));
    let corner = |i: usize| Vec2::from_angle(TAU * (i % spokes) as f32 / spokes as f32);
    let on = |i: usize, t: f32| {
        let out = corner(i) * radius * (1.0 - t);
        Vec3::new(out.x, height * t * (0.85 + 0.15 * t), out.y)
    };
    let mut ropes = Shape::default();
    let rings = random.count(6, 9);
    for i in 0..spokes {
        ropes.join(tube(&(0..=10).map(|k| on(i, k as f32 / 10.0)).collect::<Vec<_>>(), 0.014, 7));
        for ring in 1..rings {
            let t = ring as f32 / rings as f32;
            let sag = Vec3::Y * -0.03;
            ropes.join(tube(&[on(i, t), 0.5 * (on(i, t) + on(i + 1, t)) + sag, on(i + 1, t)], 0.01, 6));
            ropes.join(icosphere(0.022, 1).at(on(i, t)));
        }
    }
    let steel = cylinder(0.05, height, 18)
        + frustum(0.16, 0.05, 0.15, 18)
        + frustum(0.09, 0.05, 0.1, 12).at_each((0..spokes).map(|i| on(i, 0.0)));
    Piece { steel, painted: vec![ropes, sphere(0.09, 20).moved(0.0, height - 0.02, 0.0)], ..Piece::default() }
}

/// Tyres, lying in a stack and standing half buried, and a pipe to crawl through.
fn tyres_and_pipe(random: &mut Random) -> Piece {
    let mut tyres = Shape::default();
    let tyre = rides::tyre(0.33);
    for i in 0..random.count(2, 4) {
        let off = random.in_disc(0.05);
        tyres.join(tyre.clone().turned(random.angle()).moved(
            -0.7 + off.x,
            0.11 + 0.2 * i as f32,
            -0.5 + off.y,
        ));
    }
    for i in 0..4 {
        tyres.join(tyre.clone().rolled(0.5 * PI).moved(0.28 * i as f32 - 0.3, 0.1, -0.7));
    }
    let shell: Vec<Vec2> = (0..=40).map(|i| Vec2::from_angle(TAU * (i % 40) as f32 / 40.0)).collect();
    let ring = [0.0, 0.06];
    let tunnel: Shape = ring
        .iter()
        .map(|inset| {
            let path: Vec<Vec3> =
                shell.iter().map(|p| Vec3::new(p.x * (0.42 - inset), p.y * (0.42 - inset), 0.0)).collect();
            let wall = super::surface::sheet(40, 14, |u, v| {
                path[(u * 40.0).round() as usize] + Vec3::Z * (1.7 * (v - 0.5))
            });
            if *inset > 0.0 { wall } else { wall.reversed() }
        })
        .collect();
    let rims = torus(0.39, 0.045, 40, 10).pitched(0.5 * PI).at_each([-0.85, 0.85].map(|z| Vec3::Z * z));
    let pipe = (tunnel + rims).turned(0.5 * PI).moved(0.1, 0.43, 0.45);
    let chocks = bevelled_box(0.3, 0.14, 0.25, 0.03)
        .at_each([(-0.5, 0.13), (0.6, 0.13), (-0.5, 0.77), (0.6, 0.77)].map(|(x, z)| Vec3::new(x, 0.0, z)));
    Piece { wood: chocks, painted: vec![tyres, pipe], ..Piece::default() }
}
