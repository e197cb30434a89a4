//! Blocks of houses along narrow streets.

use super::materials;
use super::random::Random;
use super::scene_builder::{SceneBuilder, ShapesByMaterial};
use super::shape::Shape;
use super::solids::{beam, bevelled_box, block, cuboid, cylinder, frustum, icosphere, pipe, sphere};
use super::sweep::{extrude, rod, tube};
use crate::scene::MaterialId;
use glam::{Affine3A, Quat, Vec2, Vec3};
use std::f32::consts::PI;

/// Height of a storey.
const STOREY: f32 = 3.0;

/// What the houses are made of.
struct Looks {
    walls: Vec<MaterialId>,
    trim: MaterialId,
    metal: MaterialId,
    roofs: Vec<MaterialId>,
    glass: MaterialId,
}

/// What all windows of a house have in common.
struct Style {
    bay: f32,
    window: Vec2,
    shutters: bool,
    balconies: f32,
    pilasters: bool,
    bars: usize,
}

/// Builds some blocks.
pub fn build(builder: &mut SceneBuilder, random: &mut Random) {
    let looks = Looks {
        walls: materials::several(4, materials::masonry, builder, random),
        trim: materials::plaster(builder, random),
        metal: materials::metal(builder, random),
        roofs: materials::several(2, materials::tiles, builder, random),
        glass: materials::metal(builder, random),
    };
    let street = random.within(3.5, 5.5);
    let columns = (0..3).map(|_| random.within(5.0, 8.0)).collect::<Vec<_>>();
    let rows = (0..random.count(2, 3)).map(|_| random.within(5.0, 7.5)).collect::<Vec<_>>();
    let total =
        Vec2::new(columns.iter().sum(), rows.iter().sum()) + street * Vec2::new(2.0, rows.len() as f32 - 1.0);
    let mut corner = -0.5 * total;
    for depth in &rows {
        corner.x = -0.5 * total.x;
        for width in &columns {
            // Houses stand a little back from the middle of their plots, so that streets have bends and
            // nooks.
            let size = Vec2::new(width - random.within(0.0, 0.8), depth - random.within(0.0, 0.8));
            let middle = corner + 0.5 * Vec2::new(*width, *depth);
            plot(middle, Vec2::new(*width, *depth), size, &looks, builder, random);
            corner.x += width + street;
        }
        corner.y += depth + street;
    }
    let asphalt = materials::stone(builder, random);
    let margin = total + Vec2::splat(2.6);
    builder.add("street", asphalt, cuboid(margin.x, 0.3, margin.y).moved(0.0, -0.3, 0.0));
    let mut shapes = ShapesByMaterial::new(materials::several(4, materials::paint, builder, random));
    parked(total, street, &columns, &mut shapes, random);
    shapes.add_to(builder, "cars");
    builder.sun(random);
}

/// A house with its pavement and what stands on it.
fn plot(
    middle: Vec2,
    plot: Vec2,
    size: Vec2,
    looks: &Looks,
    builder: &mut SceneBuilder,
    random: &mut Random,
) {
    let at = Vec3::new(middle.x, 0.15, middle.y);
    let pavement = bevelled_box(plot.x + 1.8, 0.15, plot.y + 1.8, 0.03);
    builder.add("pavement", looks.trim, pavement.at(at - Vec3::Y * 0.15));
    let floors = random.count(2, 4);
    house(at, size, floors, looks, builder, random);
    let edge = 0.5 * plot + Vec2::splat(0.65);
    let mut street = Shape::default();
    for x in [-edge.x, edge.x] {
        street.join(lamp_post().turned(if x > 0.0 { 0.0 } else { PI }).moved(
            x,
            0.0,
            random.within(-1.0, 1.0),
        ));
        let first = random.within(-edge.y, edge.y - 2.0);
        let bollard = frustum(0.1, 0.07, 0.7, 12) + sphere(0.09, 12).moved(0.0, 0.66, 0.0);
        street.join(bollard.at_each((0..3).map(|i| Vec3::new(x, 0.0, first + i as f32))));
    }
    let bin = pipe(0.28, 0.25, 0.8, 16) + cylinder(0.26, 0.7, 16);
    street.join(bin.moved(random.within(-0.4, 0.4) * plot.x, 0.0, 0.5 * size.y + 0.45));
    builder.add("furniture", looks.metal, street.at(at));
}

fn lamp_post() -> Shape {
    let path = [Vec3::Y * 0.4, Vec3::Y * 3.6, Vec3::new(0.1, 4.0, 0.0), Vec3::new(0.5, 4.1, 0.0)];
    frustum(0.14, 0.09, 0.5, 12) + tube(&path, 0.05, 8) + frustum(0.22, 0.06, 0.22, 12).moved(0.55, 3.92, 0.0)
}

/// A house: core, facades and roof.
fn house(
    at: Vec3,
    size: Vec2,
    floors: usize,
    looks: &Looks,
    builder: &mut SceneBuilder,
    random: &mut Random,
) {
    let height = floors as f32 * STOREY;
    let wall = random.pick(&looks.walls);
    let style = Style {
        bay: random.within(1.3, 2.0),
        window: Vec2::new(random.within(0.75, 0.95), random.within(1.3, 1.9)),
        shutters: random.chance(0.4),
        balconies: random.within(0.0, 0.5),
        pilasters: random.chance(0.5),
        bars: random.count(1, 3),
    };
    // The facades stand this far in front of the core, so deep are the windows.
    let depth = random.within(0.22, 0.4);
    let core = size - Vec2::splat(2.0 * depth);
    builder.add("core", looks.glass, cuboid(core.x, height, core.y).at(at));
    let mut parts = Facade::default();
    for side in 0..4 {
        let turn = Quat::from_rotation_y(0.5 * PI * side as f32);
        let (length, out) = if side % 2 == 0 { (size.x, core.y) } else { (size.y, core.x) };
        let place = Affine3A::from_rotation_translation(turn, at + turn * Vec3::Z * (0.5 * out));
        let facade =
            facade(length - if side % 2 == 0 { 0.0 } else { 2.0 * depth }, floors, depth, &style, random);
        parts.wall.join(facade.wall.transformed(place));
        parts.trim.join(facade.trim.transformed(place));
        parts.metal.join(facade.metal.transformed(place));
    }
    builder.add("facades", wall, parts.wall);
    builder.add("trim", looks.trim, parts.trim);
    builder.add("metal", looks.metal, parts.metal);
    let top = at + Vec3::Y * height;
    if random.chance(0.5) {
        flat_roof(top, size, wall, looks, builder, random);
    } else {
        gabled_roof(top, size, wall, looks, builder, random);
    }
}

/// The parts of a facade, with its back on z = 0 and its front towards +z.
#[derive(Default)]
struct Facade {
    wall: Shape,
    trim: Shape,
    metal: Shape,
}

fn facade(length: f32, floors: usize, depth: f32, style: &Style, random: &mut Random) -> Facade {
    let mut parts = Facade::default();
    let bays = ((length / style.bay) as usize).max(2);
    let bay = length / bays as f32;
    let height = floors as f32 * STOREY;
    let half = 0.5 * style.window.x;
    let middle = |i: usize| (i as f32 + 0.5) * bay - 0.5 * length;
    // Piers from the ground to the top, and parapets and lintels between them.
    for i in 0..=bays {
        let left = if i == 0 { -0.5 * length } else { middle(i - 1) + half };
        let right = if i == bays { 0.5 * length } else { middle(i) - half };
        parts.wall.join(block(Vec3::new(left, 0.0, 0.0), Vec3::new(right, height, depth)));
        if style.pilasters && i > 0 && i < bays {
            let pilaster = bevelled_box(0.6 * (right - left), height - STOREY, 0.1, 0.02);
            parts.trim.join(pilaster.moved(0.5 * (left + right), STOREY, depth + 0.04));
        }
    }
    let entrance = random.count(0, bays - 1);
    for floor in 0..floors {
        let y = floor as f32 * STOREY;
        let sill = if floor == 0 { 0.7 } else { 0.85 };
        let head = (sill + style.window.y).min(STOREY - 0.3);
        for i in 0..bays {
            let x = middle(i);
            let part = |y0: f32, y1: f32| {
                block(Vec3::new(x - half, y + y0, 0.0), Vec3::new(x + half, y + y1, depth))
            };
            parts.wall.join(part(head, STOREY));
            if floor == 0 && i == entrance {
                parts.trim.join(doorway(x, style.window.x, head, depth));
                continue;
            }
            let balcony = floor > 0 && random.chance(style.balconies);
            if !balcony {
                parts.wall.join(part(0.0, sill));
                parts.trim.join(cuboid(style.window.x + 0.2, 0.08, 0.2).moved(x, y + sill, depth));
            }
            let low = if balcony { 0.08 } else { sill + 0.08 };
            parts.trim.join(window(style, Vec2::new(x, y + low), head - low));
            parts.trim.join(bevelled_box(style.window.x + 0.3, 0.14, 0.14, 0.02).moved(
                x,
                y + head,
                depth + 0.05,
            ));
            if balcony {
                parts.wall.join(bevelled_box(bay - 0.1, 0.14, 0.9, 0.02).moved(x, y - 0.06, depth + 0.44));
                parts.metal.join(railing(bay - 0.16, 0.82).moved(x, y + 0.08, depth));
            } else if style.shutters {
                parts.metal.join(shutters(half, head - sill).moved(x, y + sill + 0.08, depth));
            }
        }
        if floor > 0 {
            parts.trim.join(block(
                Vec3::new(-0.5 * length, y - 0.12, depth - 0.02),
                Vec3::new(0.5 * length, y + 0.04, depth + 0.07),
            ));
        }
    }
    let gutter = 0.5 * length - 0.25;
    parts.metal.join(rod(
        Vec3::new(gutter, 0.0, depth + 0.07),
        Vec3::new(gutter, height, depth + 0.07),
        0.05,
        8,
    ));
    parts
}

/// Frame and bars in an opening, whose lowest middle is `foot`.
fn window(style: &Style, foot: Vec2, height: f32) -> Shape {
    let half = 0.5 * style.window.x;
    let bar = |x0: f32, y0: f32, x1: f32, y1: f32| {
        block(Vec3::new(foot.x + x0, foot.y + y0, 0.0), Vec3::new(foot.x + x1, foot.y + y1, 0.07))
    };
    let mut shape = bar(-half, 0.0, 0.06 - half, height) + bar(half - 0.06, 0.0, half, height);
    shape.join(bar(0.06 - half, 0.0, half - 0.06, 0.06) + bar(-0.03, 0.06, 0.03, height));
    for i in 1..=style.bars {
        let y = height * i as f32 / style.bars as f32;
        shape.join(bar(0.06 - half, y - 0.05, -0.03, y) + bar(0.03, y - 0.05, half - 0.06, y));
    }
    shape
}

fn doorway(x: f32, width: f32, height: f32, depth: f32) -> Shape {
    let half = 0.5 * width;
    let mut shape = block(Vec3::new(x - half, 0.0, 0.0), Vec3::new(x + half, height, 0.08));
    for (y0, y1) in [(0.2, 0.9), (1.1, height - 0.2)] {
        shape.join(block(Vec3::new(x - half + 0.12, y0, 0.08), Vec3::new(x - 0.05, y1, 0.12)));
        shape.join(block(Vec3::new(x + 0.05, y0, 0.08), Vec3::new(x + half - 0.12, y1, 0.12)));
    }
    for step in 0..2 {
        let out = 0.3 * (2 - step) as f32;
        shape.join(cuboid(width + 2.0 * out, 0.12, 2.0 * out).moved(
            x,
            0.12 * step as f32 - 0.02,
            depth + 0.0,
        ));
    }
    shape + bevelled_box(width + 0.7, 0.12, 0.9, 0.03).moved(x, height + 0.1, depth + 0.4)
}

/// A railing around a platform that reaches from z = 0 to `depth`.
fn railing(width: f32, depth: f32) -> Shape {
    let bar = cylinder(0.014, 0.95, 5);
    let along = (width / 0.13) as usize;
    let side = (depth / 0.13) as usize;
    let mut shape =
        bar.at_each((0..=along).map(|i| Vec3::new(width * (i as f32 / along as f32 - 0.5), 0.0, depth)));
    for x in [-0.5 * width, 0.5 * width] {
        shape.join(bar.at_each((1..side).map(|i| Vec3::new(x, 0.0, depth * i as f32 / side as f32))));
        shape.join(beam(Vec3::new(x, 0.95, 0.0), Vec3::new(x, 0.95, depth), 0.05, 0.04));
    }
    shape + beam(Vec3::new(-0.5 * width, 0.95, depth), Vec3::new(0.5 * width, 0.95, depth), 0.05, 0.04)
}

/// Open shutters of slats on both sides of a window.
fn shutters(half: f32, height: f32) -> Shape {
    let width = 0.42;
    let slats = (height / 0.12) as usize;
    let slat = cuboid(width - 0.06, 0.02, 0.05).pitched(0.5);
    let one = slat
        .at_each((0..slats).map(|i| Vec3::new(0.0, (i as f32 + 0.5) * height / slats as f32, 0.03)))
        + cuboid(0.04, height, 0.05)
            .at_each([-1.0, 1.0].map(|s| Vec3::new(s * 0.5 * (width - 0.04), 0.0, 0.03)));
    one.at_each([-1.0, 1.0].map(|s| Vec3::new(s * (half + 0.5 * width), 0.0, 0.0)))
}

/// A parapet around chimneys, tanks, ducts and an exit.
fn flat_roof(
    top: Vec3,
    size: Vec2,
    wall: MaterialId,
    looks: &Looks,
    builder: &mut SceneBuilder,
    random: &mut Random,
) {
    let (x, z) = (0.5 * size.x, 0.5 * size.y);
    let mut walls = cuboid(size.x, 0.2, size.y);
    for s in [-1.0, 1.0] {
        walls.join(cuboid(size.x, 0.7, 0.2).moved(0.0, 0.2, s * (z - 0.1)));
        walls.join(cuboid(0.2, 0.7, size.y - 0.4).moved(s * (x - 0.1), 0.2, 0.0));
    }
    walls.join(cuboid(2.0, 2.2, 1.8).moved(random.within(-0.4, 0.4) * x, 0.2, -0.4 * z));
    builder.add("roof", wall, walls.at(top));
    let mut trim = bevelled_box(size.x + 0.5, 0.16, size.y + 0.5, 0.05).moved(0.0, -0.16, 0.0);
    for s in [-1.0, 1.0] {
        trim.join(cuboid(size.x + 0.1, 0.06, 0.3).moved(0.0, 0.9, s * (z - 0.1)));
        trim.join(cuboid(0.3, 0.06, size.y - 0.4).moved(s * (x - 0.1), 0.9, 0.0));
    }
    builder.add("cornice", looks.trim, trim.at(top));
    let mut metal = Shape::default();
    let pieces = random.count(2, 4);
    for i in 0..pieces {
        let share = (i as f32 + random.within(0.3, 0.7)) / pieces as f32;
        let at = Vec3::new((1.5 * share - 0.75) * x, 0.2, random.within(0.1, 0.7) * z);
        metal.join(match random.count(0, 2) {
            0 => water_tank().at(at),
            1 => (bevelled_box(1.1, 0.8, 0.8, 0.05) + pipe(0.3, 0.27, 0.1, 20).moved(0.0, 0.8, 0.0)).at(at),
            _ => tube(
                &[at, at + Vec3::Y * 0.7, at + Vec3::new(0.2, 0.9, 0.0), at + Vec3::new(0.5, 0.9, 0.0)],
                0.14,
                10,
            ),
        });
    }
    builder.add("plant", looks.metal, metal.at(top));
}

fn water_tank() -> Shape {
    let legs =
        [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].map(|(x, z)| Vec3::new(0.45 * x, 0.0, 0.45 * z));
    let brace = |s: f32| rod(Vec3::new(-0.45, 0.1, s * 0.45), Vec3::new(0.45, 0.9, s * 0.45), 0.025, 5);
    cylinder(0.05, 1.0, 6).at_each(legs)
        + brace(1.0)
        + brace(-1.0)
        + cuboid(1.3, 0.08, 1.3).moved(0.0, 1.0, 0.0)
        + cylinder(0.65, 1.3, 24).moved(0.0, 1.08, 0.0)
        + frustum(0.72, 0.0, 0.5, 24).moved(0.0, 2.38, 0.0)
}

/// A gable roof of overlapping courses, with dormers and chimneys.
fn gabled_roof(
    top: Vec3,
    size: Vec2,
    wall: MaterialId,
    looks: &Looks,
    builder: &mut SceneBuilder,
    random: &mut Random,
) {
    let (half, slope) = (0.5 * size.y, random.within(0.6, 1.1));
    let rise = half * slope;
    let outline = [Vec2::new(-half, 0.0), Vec2::new(half, 0.0), Vec2::new(0.0, rise)];
    let mut walls = extrude(&outline, size.x - 0.1).turned(0.5 * PI);
    let length = (half + 0.35) * (1.0 + slope * slope).sqrt();
    let courses = (length / 0.35) as usize;
    let pitch = slope.atan();
    let course = bevelled_box(size.x + 0.5, 0.07, 0.5, 0.015).pitched(0.07);
    let mut tiles = Shape::default();
    for side in [0.0, PI] {
        let rows = course
            .at_each((0..courses).map(|i| Vec3::new(0.0, 0.04, length * (i as f32 + 0.5) / courses as f32)));
        tiles.join(rows.pitched(pitch).moved(0.0, rise, 0.0).turned(side));
    }
    tiles.join(rod(
        Vec3::new(-0.5 * size.x - 0.3, rise + 0.08, 0.0),
        Vec3::new(0.5 * size.x + 0.3, rise + 0.08, 0.0),
        0.13,
        10,
    ));
    let dormers = random.count(0, 3);
    let mut trim = bevelled_box(size.x + 0.3, 0.14, size.y + 0.4, 0.04).moved(0.0, -0.14, 0.0);
    for i in 0..dormers {
        let x = ((i as f32 + 0.5) / dormers as f32 - 0.5) * size.x;
        let (z, y) = (0.62 * half, 0.38 * rise);
        let body = [
            Vec2::new(-0.5, -0.9),
            Vec2::new(0.5, -0.9),
            Vec2::new(0.5, 0.8),
            Vec2::new(0.0, 1.25),
            Vec2::new(-0.5, 0.8),
        ];
        walls.join(extrude(&body, 1.6).moved(x, y, z - 0.4));
        let board = |s: f32| {
            beam(Vec3::new(x + s * 0.7, y + 0.66, z + 0.46), Vec3::new(x, y + 1.3, z + 0.46), 0.16, 0.08)
        };
        trim.join(board(1.0) + board(-1.0));
        for (x0, x1) in [(-0.36, -0.04), (0.04, 0.36)] {
            trim.join(block(Vec3::new(x + x0, y - 0.1, z + 0.38), Vec3::new(x + x1, y + 0.75, z + 0.45)));
        }
    }
    for _ in 0..random.count(1, 3) {
        let x = random.within(-0.42, 0.42) * size.x;
        let z = random.within(-0.5, 0.1) * half;
        let stack = bevelled_box(0.7, 1.3 + z.abs() * slope, 0.5, 0.02)
            + bevelled_box(0.82, 0.12, 0.62, 0.02).moved(0.0, 1.2 + z.abs() * slope, 0.0);
        let pots = frustum(0.12, 0.09, 0.4, 10)
            .at_each([-0.18, 0.18].map(|x| Vec3::new(x, 1.3 + z.abs() * slope, 0.0)));
        walls.join((stack + pots).moved(x, rise - 0.4 - z.abs() * slope, z));
    }
    builder.add("gable", wall, walls.at(top));
    builder.add("tiles", random.pick(&looks.roofs), tiles.at(top));
    builder.add("eaves", looks.trim, trim.at(top));
}

/// Cars and trees in the streets that run along z.
fn parked(total: Vec2, street: f32, columns: &[f32], shapes: &mut ShapesByMaterial, random: &mut Random) {
    let mut x = -0.5 * total.x;
    for width in &columns[..columns.len() - 1] {
        x += width + 0.5 * street;
        let mut z = -0.5 * total.y + 2.5;
        while z < 0.5 * total.y - 2.0 {
            if random.chance(0.75) {
                shapes.put(
                    car(random).turned(random.within(-0.05, 0.05)).moved(
                        x + random.within(-0.2, 0.2),
                        0.0,
                        z,
                    ),
                    random,
                );
            } else {
                let crown =
                    icosphere(0.8, 3).bent(|p, n| p + n * 0.25 * super::noise::fbm(z as u32 + 7, p * 3.0, 3));
                let tree = frustum(0.14, 0.1, 2.4, 8) + crown.moved(0.0, 2.7, 0.0) + pipe(0.5, 0.4, 0.3, 16);
                shapes.put(tree.moved(x, 0.0, z), random);
            }
            z += random.within(4.6, 6.5);
        }
        x += 0.5 * street;
    }
}

/// A car that points along z.
fn car(random: &mut Random) -> Shape {
    let (roof, bonnet) = (random.within(1.35, 1.7), random.within(0.75, 0.9));
    let side = [
        (-2.05, 0.3),
        (2.05, 0.3),
        (2.1, 0.55),
        (2.0, bonnet - 0.05),
        (1.0, bonnet + 0.05),
        (0.45, roof - 0.03),
        (-1.1, roof),
        (-1.75, bonnet + 0.1),
        (-2.1, bonnet),
    ];
    let body = extrude(&side.map(|(x, y)| Vec2::new(x, y)), 1.6).turned(0.5 * PI);
    let wheel = (pipe(0.33, 0.2, 0.22, 20) + cylinder(0.2, 0.16, 20).moved(0.0, 0.03, 0.0)).rolled(0.5 * PI);
    let wheels = [(0.95, 1.3), (0.95, -1.3), (-0.73, 1.3), (-0.73, -1.3)].map(|(x, z)| Vec3::new(x, 0.33, z));
    let bumper = bevelled_box(1.66, 0.2, 0.2, 0.05).at_each([-2.08, 2.08].map(|z| Vec3::new(0.0, 0.38, z)));
    let mirror =
        bevelled_box(0.2, 0.14, 0.1, 0.03).at_each([-0.88, 0.88].map(|x| Vec3::new(x, bonnet + 0.05, 0.7)));
    body + wheel.at_each(wheels) + bumper + mirror
}
