//! Bridges over a gorge: steel trusses, timber trestles, and decks hung from cables.

use super::materials;
use super::noise;
use super::random::Random;
use super::scene_builder::SceneBuilder;
use super::shape::Shape;
use super::solids::{beam, bevelled_box, cylinder, icosphere, sphere};
use super::surface::ground;
use super::sweep::{rod, tube};
use crate::scene::MaterialId;
use glam::{Vec2, Vec3};

/// Sizes of a bridge along x.
struct BridgeSizes {
    /// Half the length between the abutments.
    half: f32,
    /// Half the width of the deck.
    wide: f32,
    /// Depth of the gorge below the deck, which is at y = 0.
    deep: f32,
    /// Number of panels.
    panels: usize,
    seed: u32,
}

impl BridgeSizes {
    /// The x of a panel point.
    fn x(&self, panel: usize) -> f32 {
        self.half * (2.0 * panel as f32 / self.panels as f32 - 1.0)
    }

    /// Height of the ground.
    fn ground(&self, x: f32, z: f32) -> f32 {
        let rise = ((x.abs() - 0.25 * self.half) / (0.75 * self.half)).clamp(0.0, 1.0);
        let bank = rise * rise * (3.0 - 2.0 * rise);
        let rough = noise::fbm(self.seed, Vec3::new(0.5 * x, 0.5, 0.5 * z), 5);
        self.deep * (0.85 * bank - 1.0) + 0.5 * rough
    }
}

/// Builds a bridge.
pub fn build(builder: &mut SceneBuilder, random: &mut Random) {
    let panels = random.count(7, 11);
    let plan = BridgeSizes {
        half: 0.5 * panels as f32 * random.within(0.95, 1.2),
        wide: random.within(1.0, 1.5),
        deep: random.within(2.0, 3.2),
        panels,
        seed: random.bits(),
    };
    gorge(&plan, builder, random);
    let steel = materials::metal(builder, random);
    let wood = materials::wood(builder, random);
    let paint = materials::paint(builder, random);
    abutments(&plan, builder, random);
    builder.add("deck", wood, deck(&plan, random));
    match random.count(0, 2) {
        0 => truss(&plan, [steel, paint], builder, random),
        1 => trestle(&plan, wood, builder),
        _ => suspended(&plan, [steel, paint], builder, random),
    }
    if random.chance(0.6) {
        builder.add("rails", steel, track(&plan));
    }
    builder.sun(random);
}

/// Banks and a bed with boulders.
fn gorge(plan: &BridgeSizes, builder: &mut SceneBuilder, random: &mut Random) {
    let size = Vec2::new(2.0 * plan.half + 2.4, 2.0 * plan.wide + 2.6);
    let earth = materials::earth(builder, random);
    builder.add("ground", earth, ground(size, 100, -plan.deep - 0.6, |x, z| plan.ground(x, z)));
    let stone = materials::stone(builder, random);
    let boulders = (0..random.count(70, 120)).map(|_| {
        let (x, z) = (random.within(-0.48, 0.48) * size.x, random.within(-0.48, 0.48) * size.y);
        let (radius, seed) = (random.within(0.06, 0.4) * random.within(0.5, 1.0), random.bits());
        let rock = icosphere(radius, if radius > 0.2 { 3 } else { 2 })
            .bent(|p, n| p + n * radius * 0.4 * noise::fbm(seed, p * (1.5 / radius), 3));
        rock.scaled(1.0, 0.75, 1.0).turned(random.angle()).moved(x, plan.ground(x, z) + 0.25 * radius, z)
    });
    builder.add("boulders", stone, boulders.collect());
}

/// Courses of rough blocks at both ends, with wings.
fn abutments(plan: &BridgeSizes, builder: &mut SceneBuilder, random: &mut Random) {
    let stone = materials::stone(builder, random);
    let course = 0.3;
    let mut shape = Shape::default();
    for side in [-1.0, 1.0] {
        let courses = ((plan.deep * 0.75) / course) as usize;
        for row in 0..courses {
            let y = -0.32 - course * (row as f32 + 1.0);
            let width = 2.0 * plan.wide + 0.5 + 0.1 * row as f32;
            let blocks = 5 + row % 2;
            for i in 0..blocks {
                let share = width / blocks as f32;
                let z = (i as f32 + 0.5) * share - 0.5 * width;
                let out = random.within(0.0, 0.05) + 0.05 * row as f32;
                shape.join(bevelled_box(1.1 + 2.0 * out, course - 0.01, share - 0.012, 0.03).moved(
                    side * (plan.half + 0.5),
                    y,
                    z,
                ));
            }
        }
        let cap =
            bevelled_box(1.3, 0.12, 2.0 * plan.wide + 0.8, 0.03).moved(side * (plan.half + 0.5), -0.32, 0.0);
        let bearing = bevelled_box(0.3, 0.14, 0.3, 0.02)
            .at_each([-1.0, 1.0].map(|s| Vec3::new(side * (plan.half + 0.1), -0.22, s * 0.8 * plan.wide)));
        let pillar = bevelled_box(0.4, 1.3, 0.4, 0.03)
            + bevelled_box(0.5, 0.1, 0.5, 0.03).moved(0.0, 1.3, 0.0)
            + sphere(0.17, 20).moved(0.0, 1.38, 0.0);
        let pillars = pillar
            .at_each([-1.0, 1.0].map(|s| Vec3::new(side * (plan.half + 0.85), -0.22, s * (plan.wide + 0.2))));
        shape.join(cap + bearing + pillars);
    }
    builder.add("abutments", stone, shape);
}

/// Stringers, cross beams and uneven planks.
fn deck(plan: &BridgeSizes, random: &mut Random) -> Shape {
    let end = plan.half + 0.7;
    let planks = (2.0 * end / 0.2) as usize;
    let mut shape = Shape::default();
    for i in 0..planks {
        let x = (2.0 * (i as f32 + 0.5) / planks as f32 - 1.0) * end;
        let length = 2.0 * plan.wide + random.within(-0.12, 0.05);
        let plank = bevelled_box(0.18, 0.05, length, 0.008).turned(random.within(-0.01, 0.01));
        shape.join(plank.moved(x, random.within(-0.052, -0.046), random.within(-0.03, 0.03)));
    }
    for i in 0..4 {
        let z = (i as f32 / 1.5 - 1.0) * 0.8 * plan.wide;
        shape.join(beam(Vec3::new(-end, -0.13, z), Vec3::new(end, -0.13, z), 0.09, 0.16));
    }
    for panel in 0..=plan.panels {
        shape.join(beam(
            Vec3::new(plan.x(panel), -0.26, -plan.wide - 0.1),
            Vec3::new(plan.x(panel), -0.26, plan.wide + 0.1),
            0.12,
            0.14,
        ));
    }
    shape
}

/// Two rails on sleepers.
fn track(plan: &BridgeSizes) -> Shape {
    let end = plan.half + 0.7;
    let sleepers = (2.0 * end / 0.4) as usize;
    let sleeper = bevelled_box(0.14, 0.08, 1.5, 0.01);
    let mut shape = sleeper
        .at_each((0..sleepers).map(|i| Vec3::X * (2.0 * (i as f32 + 0.5) / sleepers as f32 - 1.0) * end));
    for z in [-0.5, 0.5] {
        for (y, width, height) in [(0.09, 0.1, 0.02), (0.13, 0.02, 0.08), (0.175, 0.05, 0.03)] {
            shape.join(beam(Vec3::new(-end, y, z), Vec3::new(end, y, z), width, height));
        }
    }
    shape
}

/// A bar of a truss: two flats with lacing between them, as old bridges have.
fn laced(from: Vec3, to: Vec3, size: f32) -> Shape {
    let axis = (to - from).normalize();
    let across = Vec3::Z * 0.5 * size;
    let side = axis.cross(Vec3::Z) * 0.35 * size;
    let mut shape = beam(from + across, to + across, 0.12 * size, size)
        + beam(from - across, to - across, 0.12 * size, size);
    let bays = (from.distance(to) / (1.4 * size)) as usize;
    for i in 0..bays {
        let (a, b) = (from.lerp(to, i as f32 / bays as f32), from.lerp(to, (i + 1) as f32 / bays as f32));
        let flip = if i % 2 == 0 { across } else { -across };
        for face in [side, -side] {
            shape.join(beam(a + flip + face, b - flip + face, 0.15 * size, 0.06 * size));
        }
    }
    shape
}

/// A plate with rivets where bars meet.
fn gusset(at: Vec3, size: f32) -> Shape {
    let plate = bevelled_box(2.6 * size, 2.2 * size, 0.03, 0.008).moved(0.0, -1.1 * size, 0.0);
    let rivet = icosphere(0.018, 0);
    let rivets = (0..12).map(|i| Vec3::new((i % 4) as f32 - 1.5, (i / 4) as f32 - 1.0, 0.0) * 0.65 * size);
    let side = plate
        + rivet.at_each(rivets.clone().map(|p| p + Vec3::Z * 0.015))
        + rivet.at_each(rivets.map(|p| p - Vec3::Z * 0.015));
    side.at_each([-0.58, 0.58].map(|s| at + Vec3::Z * (s * size)))
}

/// Side trusses (Pratt or Warren) with bracing below the top.
fn truss(
    plan: &BridgeSizes,
    [steel, paint]: [MaterialId; 2],
    builder: &mut SceneBuilder,
    random: &mut Random,
) {
    let (height, size, warren) = (random.within(1.5, 2.1), random.within(0.13, 0.18), random.chance(0.5));
    let arched = random.chance(0.4);
    let top = |panel: usize| {
        let share = 2.0 * panel as f32 / plan.panels as f32 - 1.0;
        Vec3::new(plan.x(panel), height * if arched { 1.25 - 0.55 * share * share } else { 1.0 } - 0.2, 0.0)
    };
    let low = |panel: usize| Vec3::new(plan.x(panel), -0.24, 0.0);
    let mut side = Shape::default();
    for panel in 0..plan.panels {
        side.join(laced(low(panel), low(panel + 1), size));
        let left = panel < plan.panels / 2;
        let ends = if panel == 0 {
            (low(0), top(1))
        } else if panel + 1 == plan.panels {
            (low(plan.panels), top(panel))
        } else {
            side.join(laced(top(panel), top(panel + 1), size));
            if (warren && panel % 2 == 0) || (!warren && !left) {
                (low(panel), top(panel + 1))
            } else {
                (top(panel), low(panel + 1))
            }
        };
        side.join(laced(ends.0, ends.1, 0.8 * size));
        if panel > 0 {
            side.join(laced(low(panel), top(panel), 0.7 * size) + gusset(top(panel), size));
        }
        side.join(gusset(low(panel), size));
    }
    let z = plan.wide + 0.15;
    builder.add("trusses", paint, side.at_each([-z, z].map(|z| Vec3::Z * z)));
    let mut bracing = Shape::default();
    for panel in 1..plan.panels {
        let (left, right) = (top(panel) - Vec3::Z * z, top(panel) + Vec3::Z * z);
        bracing.join(laced(left, right, 0.7 * size).at(Vec3::ZERO));
        for (corner, inward) in [(left, Vec3::Z), (right, Vec3::NEG_Z)] {
            bracing.join(rod(corner - Vec3::Y * 0.5, corner + inward * 0.5, 0.025, 8));
        }
        if panel + 1 < plan.panels {
            let next = top(panel + 1);
            bracing.join(rod(left, next + Vec3::Z * z, 0.022, 8) + rod(right, next - Vec3::Z * z, 0.022, 8));
        }
    }
    for panel in 0..plan.panels {
        let (a, b) = (low(panel) - Vec3::Y * 0.12, low(panel + 1) - Vec3::Y * 0.12);
        bracing.join(
            rod(a - Vec3::Z * z, b + Vec3::Z * z, 0.02, 7) + rod(a + Vec3::Z * z, b - Vec3::Z * z, 0.02, 7),
        );
    }
    builder.add("bracing", steel, bracing + railing(plan, 0.95 * plan.wide));
}

/// Rails on posts along both sides.
fn railing(plan: &BridgeSizes, z: f32) -> Shape {
    let posts = plan.panels * 3;
    let mut shape = Shape::default();
    for side in [-z, z] {
        for i in 0..=posts {
            let x = plan.half * (2.0 * i as f32 / posts as f32 - 1.0);
            shape.join(rod(Vec3::new(x, -0.05, side), Vec3::new(x, 0.75, side), 0.018, 7));
        }
        for y in [0.25, 0.5, 0.75] {
            shape.join(rod(Vec3::new(-plan.half, y, side), Vec3::new(plan.half, y, side), 0.016, 8));
        }
    }
    shape
}

/// Bents of leaning posts down to the ground, braced crosswise, with guard rails above.
fn trestle(plan: &BridgeSizes, wood: MaterialId, builder: &mut SceneBuilder) {
    let post = |x: f32, z: f32| {
        let foot = Vec3::new(x, 0.0, 1.5 * z);
        (Vec3::new(x, -0.33, z), foot.with_y(plan.ground(foot.x, foot.z) - 0.15))
    };
    let at = |(head, foot): (Vec3, Vec3), y: f32| {
        head.lerp(foot, ((head.y - y) / (head.y - foot.y)).clamp(0.0, 1.0))
    };
    let places = [-0.9, -0.3, 0.3, 0.9].map(|s| s * plan.wide);
    let storey = 0.85;
    let mut shape = Shape::default();
    for panel in 1..plan.panels {
        let x = plan.x(panel);
        let (outer, other) = (post(x, places[0]), post(x, places[3]));
        for z in places {
            let (head, foot) = post(x, z);
            shape.join(beam(head, foot, 0.15, 0.15));
        }
        let lowest = outer.1.y.max(other.1.y);
        let mut y = -0.45;
        while y - storey > lowest {
            let below = y - storey;
            for out in [-0.1, 0.1] {
                let off = Vec3::X * out;
                shape.join(beam(at(outer, y) + off, at(other, y) + off, 0.05, 0.12));
                let (a, b) = if out < 0.0 { (outer, other) } else { (other, outer) };
                shape.join(beam(at(a, y) + off * 1.4, at(b, below) + off * 1.4, 0.04, 0.1));
            }
            if panel + 1 < plan.panels {
                let next = plan.x(panel + 1);
                for z in [places[0], places[3]] {
                    let (near, far) =
                        (at(post(x, z), y), at(post(next, z), below.max(post(next, z).1.y + 0.2)));
                    let out = Vec3::Z * (0.1 * z.signum());
                    shape.join(
                        beam(near + out, at(post(next, z), y) + out, 0.06, 0.12)
                            + beam(near + out * 1.5, far + out * 1.5, 0.04, 0.1),
                    );
                }
            }
            y = below;
        }
        for z in places {
            let bolt = cylinder(0.025, 0.34, 6).rolled(0.5 * std::f32::consts::PI);
            shape.join(bolt.at(at(post(x, z), -0.45) + Vec3::X * 0.17));
        }
    }
    for side in [-1.0, 1.0] {
        let z = side * (plan.wide + 0.02);
        for panel in 0..=plan.panels * 2 {
            let x = plan.half * (panel as f32 / plan.panels as f32 - 1.0);
            shape.join(beam(Vec3::new(x, -0.3, z), Vec3::new(x, 0.85, z), 0.08, 0.08));
            shape.join(beam(Vec3::new(x, -0.2, z + side * 0.4), Vec3::new(x, 0.6, z), 0.06, 0.06));
        }
        for y in [0.3, 0.85] {
            shape.join(beam(Vec3::new(-plan.half, y, z), Vec3::new(plan.half, y, z), 0.1, 0.09));
        }
    }
    builder.add("trestle", wood, shape);
}

/// Towers, cables in a parabola, hangers with clamps, and stiffening trusses.
fn suspended(
    plan: &BridgeSizes,
    [steel, paint]: [MaterialId; 2],
    builder: &mut SceneBuilder,
    random: &mut Random,
) {
    let (tall, low) = (random.within(2.2, 3.0), random.within(0.35, 0.6));
    let tower_x = 0.82 * plan.half;
    let z = plan.wide + 0.12;
    let cable = |x: f32| {
        let share = x.abs() / tower_x;
        if share <= 1.0 {
            low + (tall - low) * share * share
        } else {
            tall - (tall + 0.1) * (x.abs() - tower_x) / (plan.half + 0.8 - tower_x)
        }
    };
    let mut cables = Shape::default();
    let mut towers = Shape::default();
    for side in [-z, z] {
        let end = plan.half + 0.8;
        let points: Vec<Vec3> =
            (0..=60).map(|i| (i as f32 / 30.0 - 1.0) * end).map(|x| Vec3::new(x, cable(x), side)).collect();
        cables.join(
            tube(&points, 0.05, 12)
                + tube(&points.iter().map(|p| p + Vec3::Y * 0.11).collect::<Vec<_>>(), 0.03, 8),
        );
        let hangers = plan.panels * 3;
        for i in 1..hangers {
            let x = plan.half * (2.0 * i as f32 / hangers as f32 - 1.0);
            cables.join(rod(Vec3::new(x, -0.3, side), Vec3::new(x, cable(x), side), 0.016, 7));
            cables.join(cylinder(0.075, 0.1, 12).rolled(0.5 * std::f32::consts::PI).moved(
                x + 0.05,
                cable(x),
                side,
            ));
        }
        for x in [-tower_x, tower_x] {
            let foot = plan.ground(x, side) - 0.3;
            for lean in [-0.16, 0.16] {
                towers.join(laced(
                    Vec3::new(x + 2.0 * lean, foot, side),
                    Vec3::new(x + 0.4 * lean, tall, side),
                    0.16,
                ));
            }
            towers.join(
                bevelled_box(0.5, 0.2, 0.36, 0.03).moved(x, tall - 0.12, side)
                    + bevelled_box(0.9, 0.5, 0.6, 0.04).moved(x, foot, side),
            );
            for level in 0..5 {
                let y = foot + (tall - foot) * (level as f32 + 0.5) / 5.0;
                towers.join(beam(Vec3::new(x - 0.25, y, side), Vec3::new(x + 0.25, y, side), 0.1, 0.06));
            }
        }
    }
    for x in [-tower_x, tower_x] {
        for y in [0.55 * tall, tall - 0.1, -0.6] {
            towers.join(beam(Vec3::new(x, y, -z), Vec3::new(x, y, z), 0.2, 0.22));
        }
        towers.join(
            rod(Vec3::new(x, 0.6 * tall, -z), Vec3::new(x, tall, z), 0.04, 8)
                + rod(Vec3::new(x, 0.6 * tall, z), Vec3::new(x, tall, -z), 0.04, 8),
        );
    }
    let mut stiffening = railing(plan, plan.wide);
    let bays = plan.panels * 2;
    for side in [-z, z] {
        for bay in 0..bays {
            let at = |i: usize, y: f32| {
                Vec3::new(plan.half * (2.0 * i as f32 / bays as f32 - 1.0), y, side * 0.985)
            };
            stiffening.join(
                beam(at(bay, -0.3), at(bay + 1, -0.3), 0.07, 0.07)
                    + beam(at(bay, 0.3), at(bay + 1, 0.3), 0.06, 0.06),
            );
            let (a, b) = if bay % 2 == 0 { (-0.3, 0.3) } else { (0.3, -0.3) };
            stiffening.join(
                beam(at(bay, a), at(bay + 1, b), 0.04, 0.05) + beam(at(bay, -0.3), at(bay, 0.3), 0.04, 0.05),
            );
        }
    }
    builder.add("cables", steel, cables);
    builder.add("towers", paint, towers);
    builder.add("stiffening", steel, stiffening);
}
