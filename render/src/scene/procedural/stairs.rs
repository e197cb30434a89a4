//! Platforms at many heights joined by stairs, with galleries above, railings and arched openings below.

use super::furniture::turned_post;
use super::materials;
use super::random::Random;
use super::scene_builder::SceneBuilder;
use super::shape::Shape;
use super::solids::{beam, bevelled_box, block, cylinder, frustum, sphere};
use super::sweep::{extrude, rod, tube};
use glam::{IVec2, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Edge of a platform.
const CELL: f32 = 1.8;
/// Height of a level.
const LEVEL: f32 = 0.72;
/// Steps from level to level.
const STEPS: usize = 4;

/// The four directions to a neighbour.
const SIDES: [IVec2; 4] = [IVec2::X, IVec2::Y, IVec2::NEG_X, IVec2::NEG_Y];

/// Levels of platforms on a grid.
struct PlatformGrid {
    size: IVec2,
    levels: Vec<i32>,
}

impl PlatformGrid {
    fn drawn(random: &mut Random) -> Self {
        let size = IVec2::new(random.count(4, 5) as i32, random.count(3, 4) as i32);
        let mut plan = Self { size, levels: vec![0; (size.x * size.y) as usize] };
        let slope = Vec2::from_angle(random.angle()) * random.within(0.2, 0.9);
        for cell in plan.cells().collect::<Vec<_>>() {
            let tilt = slope.dot(cell.as_vec2() - 0.5 * (size - 1).as_vec2());
            let level = tilt + random.within(0.0, 3.2);
            let index = plan.index(cell);
            plan.levels[index] = (level.round() as i32).clamp(0, 4);
        }
        plan
    }

    fn cells(&self) -> impl Iterator<Item = IVec2> + use<> {
        let size = self.size;
        (0..size.y).flat_map(move |z| (0..size.x).map(move |x| IVec2::new(x, z)))
    }

    fn index(&self, cell: IVec2) -> usize {
        (cell.y * self.size.x + cell.x) as usize
    }

    /// The level of a cell; `None` outside.
    fn level(&self, cell: IVec2) -> Option<i32> {
        let inside = cell.cmpge(IVec2::ZERO).all() && cell.cmplt(self.size).all();
        inside.then(|| self.levels[self.index(cell)])
    }

    /// The middle of a cell's platform.
    fn middle(&self, cell: IVec2) -> Vec3 {
        let at = (cell.as_vec2() - 0.5 * (self.size - 1).as_vec2()) * CELL;
        Vec3::new(at.x, self.levels[self.index(cell)] as f32 * LEVEL, at.y)
    }
}

/// Builds the stairs.
pub fn build(builder: &mut SceneBuilder, random: &mut Random) {
    let plan = PlatformGrid::drawn(random);
    let stone = materials::stone(builder, random);
    let wall = materials::masonry(builder, random);
    let metal = materials::metal(builder, random);
    let slab = materials::flooring(builder, random);
    let footing = plan.size.as_vec2() * CELL + Vec2::splat(0.5);
    builder.add("footing", stone, bevelled_box(footing.x, 0.3, footing.y, 0.03).moved(0.0, -0.42, 0.0));
    for cell in plan.cells() {
        let (body, top) = platform(&plan, cell, random);
        builder.add("platform", wall, body);
        builder.add("slab", slab, top);
    }
    let mut steps = Shape::default();
    let mut rails = Shape::default();
    let thick = random.chance(0.5);
    for cell in plan.cells() {
        for (side, step) in SIDES.iter().enumerate() {
            let place = |shape: Shape| shape.turned(-0.5 * PI * side as f32).at(plan.middle(cell));
            let level = plan.levels[plan.index(cell)];
            let drop = level - plan.level(cell + step).unwrap_or(-1);
            if drop <= 0 {
                continue;
            }
            let stairs_fit = plan.level(cell + step).is_some() && drop <= 2 && random.chance(0.75);
            if stairs_fit {
                steps.join(place(flight(drop as usize)));
                rails.join(place(flight_rails(drop as usize)));
            } else {
                rails.join(place(if thick { balustrade() } else { railing() }));
            }
        }
    }
    builder.add("steps", stone, steps);
    builder.add("rails", if thick { stone } else { metal }, rails);
    gallery(&plan, builder, random);
    let corner = plan.middle(IVec2::new(random.count(0, plan.size.x as usize - 1) as i32, 0));
    builder.add("spiral", metal, spiral(random.within(2.6, 4.0), random.pick(&[-1.0, 1.0])).at(corner));
    builder.lamp(Vec3::new(0.0, 4.0, 0.0), random);
    builder.sun(random);
}

/// A block with arched niches on its sides, and the slab on top.
fn platform(plan: &PlatformGrid, cell: IVec2, random: &mut Random) -> (Shape, Shape) {
    let middle = plan.middle(cell);
    let half = 0.5 * CELL;
    let inset = 0.28;
    let core = half - inset;
    let foot = Vec3::new(middle.x, -0.12, middle.z);
    let height = middle.y - 0.08 - foot.y;
    let mut body = block(Vec3::new(-core, 0.0, -core), Vec3::new(core, height, core));
    let pier = block(Vec3::new(-half, 0.0, -half), Vec3::new(0.001 - core, height, 0.001 - core));
    body.join(pier.around(4));
    for side in 0..4 {
        let front = if height > 0.9 {
            niche(2.0 * core, height, inset)
        } else {
            block(Vec3::new(-core, 0.0, 0.0), Vec3::new(core, height, inset))
        };
        body.join(front.moved(0.0, 0.0, core).turned(0.5 * PI * side as f32));
    }
    let mut top = bevelled_box(CELL + 0.06, 0.06, CELL + 0.06, 0.015).moved(0.0, -0.08, 0.0);
    let flags = random.count(2, 4);
    let share = CELL / flags as f32;
    let flag = bevelled_box(share - 0.012, 0.05, share - 0.012, 0.008);
    for i in 0..flags * flags {
        let at = Vec2::new((i % flags) as f32 + 0.5, (i / flags) as f32 + 0.5) * share - Vec2::splat(half);
        top.join(flag.clone().moved(at.x, random.within(-0.054, -0.05), at.y));
    }
    if random.chance(0.35) {
        let urn = turned_post(random.within(0.3, 0.6), 0.12) + sphere(0.11, 18).moved(0.0, 0.25, 0.0);
        top.join(urn.moved(random.within(-0.5, 0.5), 0.0, random.within(-0.5, 0.5)));
    }
    (body.at(foot), top.at(middle))
}

/// A wall with an arched opening that reaches down to the ground, in front of z = 0.
fn niche(width: f32, height: f32, depth: f32) -> Shape {
    let half = 0.5 * width;
    let radius = 0.7 * half;
    let spring = (height - radius - 0.12).clamp(0.1, 1.6);
    let rise = (height - 0.12 - spring).min(radius);
    let mut outline = vec![Vec2::new(-half, height), Vec2::new(-half, 0.0), Vec2::new(-radius, 0.0)];
    outline.extend(
        (0..=14)
            .map(|i| PI * (1.0 - i as f32 / 14.0))
            .map(|a| Vec2::new(radius * a.cos(), spring + rise * a.sin())),
    );
    outline.extend([Vec2::new(radius, 0.0), Vec2::new(half, 0.0), Vec2::new(half, height)]);
    let arch: Vec<Vec3> = (0..=14)
        .map(|i| PI * i as f32 / 14.0)
        .map(|a| Vec3::new((radius + 0.04) * a.cos(), spring + (rise + 0.04) * a.sin(), depth))
        .collect();
    extrude(&outline, depth).moved(0.0, 0.0, 0.5 * depth) + tube(&arch, 0.03, 8)
}

/// Steps down from the platform's edge towards +x, `drop` levels.
fn flight(drop: usize) -> Shape {
    let count = drop * STEPS;
    let rise = LEVEL / STEPS as f32;
    let tread = 0.9 * CELL / (2 * STEPS) as f32;
    let half = 0.36 * CELL;
    let edge = 0.5 * CELL + 0.03;
    let mut shape = Shape::default();
    for step in 0..count - 1 {
        let y = -rise * (step + 1) as f32;
        let x = edge + tread * step as f32;
        let bottom = -rise * count as f32;
        shape.join(block(Vec3::new(x, bottom, -half), Vec3::new(x + tread, y - 0.035, half)));
        shape.join(bevelled_box(tread + 0.03, 0.035, 2.0 * half + 0.06, 0.01).moved(
            x + 0.5 * tread + 0.01,
            y - 0.035,
            0.0,
        ));
    }
    shape
}

/// Handrails along a flight and short pieces of railing beside it.
fn flight_rails(drop: usize) -> Shape {
    let count = drop * STEPS;
    let rise = LEVEL / STEPS as f32;
    let tread = 0.9 * CELL / (2 * STEPS) as f32;
    let edge = 0.5 * CELL + 0.03;
    let mut shape = Shape::default();
    for side in [-1.0, 1.0] {
        let z = side * 0.33 * CELL;
        let on = |step: f32, up: f32| Vec3::new(edge + tread * (step + 0.5), up - rise * (step + 1.0), z);
        for step in 0..count - 1 {
            shape.join(rod(on(step as f32, 0.0), on(step as f32, 0.85), 0.012, 6));
        }
        let last = count as f32 - 2.0;
        shape.join(tube(&[on(-1.0, 0.86), on(last, 0.86), on(last, 0.7) + Vec3::X * 0.12], 0.025, 10));
        for z in [0.4, 0.47] {
            shape.join(rod(
                Vec3::new(0.47 * CELL, 0.0, side * z * CELL),
                Vec3::new(0.47 * CELL, 0.86, side * z * CELL),
                0.014,
                6,
            ));
        }
        shape.join(rod(
            Vec3::new(0.47 * CELL, 0.86, side * 0.33 * CELL),
            Vec3::new(0.47 * CELL, 0.86, side * 0.5 * CELL),
            0.022,
            8,
        ));
    }
    shape
}

/// A railing of thin bars along the edge towards +x.
fn railing() -> Shape {
    let x = 0.47 * CELL;
    let bars = 13;
    let at = |i: usize| (i as f32 / bars as f32 - 0.5) * 0.96 * CELL;
    let bar = |i: usize| {
        rod(
            Vec3::new(x, 0.0, at(i)),
            Vec3::new(x, 0.9, at(i)),
            if i.is_multiple_of(4) { 0.018 } else { 0.009 },
            6,
        )
    };
    let rail = |y: f32| beam(Vec3::new(x, y, -0.49 * CELL), Vec3::new(x, y, 0.49 * CELL), 0.035, 0.03);
    (0..=bars).map(bar).collect::<Shape>() + rail(0.9) + rail(0.12)
}

/// A stone balustrade along the edge towards +x.
fn balustrade() -> Shape {
    let x = 0.45 * CELL;
    let post = turned_post(0.6, 0.06);
    let posts =
        post.at_each((0..8).map(|i| Vec3::new(x, 0.08, ((i as f32 + 0.5) / 8.0 - 0.5) * 0.86 * CELL)));
    let bar = |y: f32, height: f32| bevelled_box(0.16, height, 0.99 * CELL, 0.012).moved(x, y, 0.0);
    let piers =
        bevelled_box(0.17, 0.86, 0.17, 0.015).at_each([-0.45, 0.45].map(|s| Vec3::new(x, 0.0, s * CELL)));
    posts + bar(0.0, 0.08) + bar(0.68, 0.1) + piers
}

/// A deck on posts above the two rows at the back, with railings and joists below.
fn gallery(plan: &PlatformGrid, builder: &mut SceneBuilder, random: &mut Random) {
    let wood = materials::wood(builder, random);
    let y = 5.0 * LEVEL + random.within(0.5, 1.0);
    let rows = 1 + i32::from(random.chance(0.4));
    let mut shape = Shape::default();
    for cell in plan.cells().filter(|cell| cell.y < rows) {
        let middle = plan.middle(cell);
        let deck = Vec3::new(middle.x, y, middle.z);
        let boards = 9;
        let board = bevelled_box(CELL, 0.04, CELL / boards as f32 - 0.012, 0.006);
        shape.join(
            board.at_each(
                (0..boards).map(|i| deck + Vec3::Z * ((i as f32 + 0.5) / boards as f32 - 0.5) * CELL),
            ),
        );
        let joist = beam(
            deck - Vec3::new(0.0, 0.07, 0.5 * CELL),
            deck + Vec3::new(0.0, -0.07, 0.5 * CELL),
            0.06,
            0.14,
        );
        shape.join(joist.at_each([-0.75, -0.25, 0.25, 0.75].map(|s| Vec3::X * (0.5 * s * CELL))));
        let side = Vec3::new(0.42 * CELL, 0.0, 0.42 * CELL);
        for corner in [side, -side, side * Vec3::new(-1.0, 0.0, 1.0), side * Vec3::new(1.0, 0.0, -1.0)] {
            let (foot, head) = (middle + corner, deck + corner - Vec3::Y * 0.02);
            shape.join(beam(foot, head, 0.11, 0.11));
            shape.join(beam(head - Vec3::Y * 0.6, head - corner * 0.7 - Vec3::Y * 0.1, 0.07, 0.07));
        }
        for (turn, step) in SIDES.iter().enumerate() {
            if !(0..plan.size.x).contains(&(cell.x + step.x)) || !(0..rows).contains(&(cell.y + step.y)) {
                shape.join(railing().turned(-0.5 * PI * turn as f32).at(deck + Vec3::Y * 0.04));
            }
        }
    }
    builder.add("gallery", wood, shape);
}

/// A winding stair around a post, turning left or right by `hand`.
fn spiral(height: f32, hand: f32) -> Shape {
    let rise = 0.17;
    let steps = (height / rise) as usize;
    let turn = hand * TAU / 14.0;
    let tread =
        [Vec2::new(0.05, -0.05), Vec2::new(0.72, -0.17), Vec2::new(0.72, 0.17), Vec2::new(0.05, 0.05)];
    let tread = extrude(&tread, 0.04).pitched(-0.5 * PI);
    let mut shape = cylinder(0.07, height + 0.9, 18)
        + frustum(0.14, 0.07, 0.12, 18)
        + sphere(0.09, 16).moved(0.0, height + 0.85, 0.0);
    let mut rail = Vec::new();
    for step in 0..steps {
        let (angle, y) = (turn * step as f32, rise * (step as f32 + 1.0));
        shape.join(tread.clone().moved(0.0, y - 0.02, 0.0).turned(angle));
        let out = Vec2::from_angle(-angle) * 0.68;
        let foot = Vec3::new(out.x, y, out.y);
        shape.join(rod(foot, foot + Vec3::Y * 0.85, 0.012, 6));
        rail.push(foot + Vec3::Y * 0.86);
    }
    shape + tube(&rail, 0.022, 8)
}
