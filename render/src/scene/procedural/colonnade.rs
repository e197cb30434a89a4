//! Halls of columns with arches between them and groin vaults above.

use super::furniture::turned_post;
use super::materials;
use super::random::Random;
use super::scene_builder::SceneBuilder;
use super::shape::Shape;
use super::solids::{bevelled_box, block, cuboid, sphere, torus};
use super::surface::sheet;
use super::sweep::{circle, extrude, lathe, sweep, tube};
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Sizes of a hall.
struct HallSizes {
    /// Bays along x and z.
    bays: [usize; 2],
    /// Distance of columns.
    bay: f32,
    /// Height at which arches begin.
    spring: f32,
    /// Thickness of arches.
    wall: f32,
    /// How far above the spring the top of an arch is.
    rise: f32,
    /// Whether arches have a point.
    pointed: bool,
}

impl HallSizes {
    fn drawn(random: &mut Random) -> Self {
        let bay = random.within(1.9, 2.6);
        let pointed = random.chance(0.5);
        let half = 0.5 * bay - 0.2;
        let rise = if pointed { half * random.within(1.15, 1.5) } else { half };
        let bays = [random.count(3, 4), random.count(2, 3)];
        Self { bays, bay, spring: random.within(2.0, 2.8), wall: random.within(0.3, 0.42), rise, pointed }
    }

    /// Half the clear width of an arch.
    fn half(&self) -> f32 {
        0.5 * self.bay - 0.2
    }

    /// Height above the spring of an arch at a distance from its middle, in shares of half its width.
    fn arch(&self, share: f32) -> f32 {
        let share = share.abs().min(1.0);
        // A pointed arch is two arcs around the opposite springs, drawn out to its rise.
        let round = if self.pointed {
            (4.0 - (1.0 + share) * (1.0 + share)).max(0.0).sqrt() / 3f32.sqrt()
        } else {
            (1.0 - share * share).sqrt()
        };
        self.rise * round
    }

    /// Height of the tops of the walls.
    fn top(&self) -> f32 {
        self.spring + self.rise + 0.3
    }

    /// Middle of a column.
    fn column(&self, i: usize, k: usize) -> Vec3 {
        let along = |index: usize, bays: usize| (index as f32 - 0.5 * bays as f32) * self.bay;
        Vec3::new(along(i, self.bays[0]), 0.0, along(k, self.bays[1]))
    }

    /// The middles of all columns.
    fn columns(&self) -> impl Iterator<Item = Vec3> {
        (0..=self.bays[0]).flat_map(move |i| (0..=self.bays[1]).map(move |k| self.column(i, k)))
    }

    /// The middles of all bays.
    fn middles(&self) -> impl Iterator<Item = Vec3> {
        let to_middle = Vec3::new(0.5 * self.bay, 0.0, 0.5 * self.bay);
        (0..self.bays[0]).flat_map(move |i| (0..self.bays[1]).map(move |k| self.column(i, k) + to_middle))
    }
}

/// Builds a hall.
pub fn build(builder: &mut SceneBuilder, random: &mut Random) {
    let plan = HallSizes::drawn(random);
    let [stone, wall, vault, floor] =
        [materials::stone, materials::masonry, materials::plaster, materials::flooring]
            .map(|make| make(builder, random));
    let column = column(&plan, random);
    builder.add("columns", stone, column.at_each(plan.columns()));
    builder.add("arches", wall, arches(&plan));
    builder.add("mouldings", stone, mouldings(&plan));
    builder.add("vaults", vault, plan.middles().map(|middle| groin_vault(&plan).at(middle)).collect());
    builder.add("ribs", stone, plan.middles().map(|middle| ribs(&plan).at(middle)).collect());
    builder.add("floor", floor, floor_and_steps(&plan, random));
    builder.add("roof", wall, roof(&plan));
    builder.add("back", wall, back_wall(&plan, random));
    builder.add("balustrades", stone, balustrades(&plan, random));
    for _ in 0..3 {
        let middle = plan.column(random.count(0, plan.bays[0]), random.count(0, plan.bays[1]));
        builder.lamp(middle + Vec3::new(0.4 * plan.bay, 0.8 * plan.spring, 0.4 * plan.bay), random);
    }
    builder.sun(random);
}

/// A column with base, shaft and capital.
fn column(plan: &HallSizes, random: &mut Random) -> Shape {
    let radius = random.within(0.13, 0.19);
    let mut shape = bevelled_box(0.46, 0.12, 0.46, 0.015);
    shape.join(torus(radius + 0.015, 0.035, 32, 12).moved(0.0, 0.155, 0.0));
    shape.join(torus(radius, 0.02, 32, 10).moved(0.0, 0.21, 0.0));
    let top = plan.spring - 0.32;
    let outline = match random.count(0, 3) {
        0 => circle(radius, 32),
        1 => circle(radius, 8),
        2 => fluted(radius, random.count(12, 20)),
        _ => fluted(radius * 1.05, 4),
    };
    let twist = if random.chance(0.3) { random.within(1.0, 3.0) } else { 0.0 };
    let shaft = sweep(&outline, &rising(0.18, top, 12), |t| 1.0 - 0.16 * t * t);
    if twist > 0.0 {
        let wound = |position: Vec3, _| turned_about(position, twist * (position.y - 0.18) / (top - 0.18));
        shape.join(shaft.welded().bent(wound));
    } else {
        shape.join(shaft);
    }
    let capital =
        [(0.84, 0.0), (0.9, 0.03), (0.84, 0.06), (0.86, 0.1), (1.1, 0.2), (1.25, 0.24), (0.0, 0.24)];
    let mut profile = vec![Vec2::ZERO];
    profile.extend(capital.map(|(x, y)| Vec2::new(x * radius, y)));
    shape.join(lathe(&profile, 32).moved(0.0, top, 0.0));
    if random.chance(0.6) {
        let leaf = leaf(radius);
        shape.join(leaf.around(random.count(6, 10)).moved(0.0, top + 0.03, 0.0));
    }
    shape + bevelled_box(0.44, 0.09, 0.44, 0.012).moved(0.0, plan.spring - 0.09, 0.0)
}

/// A leaf of a capital, at +x, bending outwards.
fn leaf(radius: f32) -> Shape {
    let path: Vec<Vec3> = (0..=6)
        .map(|i| i as f32 / 6.0)
        .map(|t| Vec3::new(radius * (0.85 + 0.45 * t * t), 0.2 * t - 0.06 * t * t * t, 0.0))
        .collect();
    let section = [Vec2::new(-0.03, -0.008), Vec2::new(0.03, -0.008), Vec2::new(0.0, 0.012)];
    sweep(&section, &path, |t| 1.15 - 0.8 * t * t)
}

/// A circle with hollows.
fn fluted(radius: f32, flutes: usize) -> Vec<Vec2> {
    let points = flutes * 5;
    (0..points)
        .map(|i| {
            let hollow = (PI * (i % 5) as f32 / 5.0).sin();
            Vec2::from_angle(TAU * i as f32 / points as f32) * radius * (1.0 - 0.7 / flutes as f32 * hollow)
        })
        .collect()
}

fn rising(from: f32, to: f32, steps: usize) -> Vec<Vec3> {
    (0..=steps).map(|i| Vec3::Y * (from + (to - from) * i as f32 / steps as f32)).collect()
}

fn turned_about(position: Vec3, angle: f32) -> Vec3 {
    let turned = Vec2::from_angle(angle).rotate(Vec2::new(position.x, position.z));
    Vec3::new(turned.x, position.y, turned.y)
}

/// The points of an arch from left to right, x from its middle, y above the spring.
fn arch_points(plan: &HallSizes, grown: f32) -> Vec<Vec2> {
    (0..=20)
        .map(|i| -(PI * i as f32 / 20.0).cos())
        .map(|share| Vec2::new(share * (plan.half() + grown), plan.arch(share) + grown * (1.0 - share.abs())))
        .collect()
}

/// A wall with an arch in it, along x.
fn arch(plan: &HallSizes) -> Shape {
    let (side, top) = (0.5 * plan.bay, plan.top() - plan.spring);
    let mut outline = arch_points(plan, 0.0);
    outline.reverse();
    outline.extend([
        Vec2::new(-side, 0.0),
        Vec2::new(-side, top),
        Vec2::new(side, top),
        Vec2::new(side, 0.0),
    ]);
    outline.reverse();
    extrude(&outline, plan.wall).moved(0.0, plan.spring, 0.0)
}

/// Places a thing that spans x between all neighbouring columns.
fn on_every_span(plan: &HallSizes, thing: &Shape) -> Shape {
    let half = 0.5 * plan.bay;
    let turned = thing.clone().turned(0.5 * PI);
    let mut shape = Shape::default();
    for i in 0..=plan.bays[0] {
        for k in 0..=plan.bays[1] {
            let column = plan.column(i, k);
            if i < plan.bays[0] {
                shape.join(thing.clone().at(column + Vec3::X * half));
            }
            if k < plan.bays[1] {
                shape.join(turned.clone().at(column + Vec3::Z * half));
            }
        }
    }
    shape
}

fn arches(plan: &HallSizes) -> Shape {
    on_every_span(plan, &arch(plan))
}

/// Round mouldings along the arches' edges.
fn mouldings(plan: &HallSizes) -> Shape {
    let along = |grown: f32, z: f32| -> Vec<Vec3> {
        arch_points(plan, grown).iter().map(|point| Vec3::new(point.x, plan.spring + point.y, z)).collect()
    };
    let out = 0.5 * plan.wall;
    let bars = [-out, out].map(|z| tube(&along(0.06, z), 0.025, 6) + tube(&along(0.14, z), 0.035, 6));
    on_every_span(plan, &bars.into_iter().collect())
}

/// The ceiling of a bay: where two barrel vaults meet, the higher counts.
fn groin_vault(plan: &HallSizes) -> Shape {
    let inner = 0.5 * (plan.bay - plan.wall);
    let height = |x: f32, z: f32| {
        let share = |v: f32| (v / inner).clamp(-1.0, 1.0);
        plan.spring + plan.arch(share(x)).max(plan.arch(share(z)))
    };
    let spread = |t: f32| -inner * (PI * t).cos();
    sheet(24, 24, |u, v| Vec3::new(spread(u), height(spread(u), spread(v)), spread(v))).reversed()
}

/// Diagonal ribs of a bay with a boss where they meet.
fn ribs(plan: &HallSizes) -> Shape {
    let inner = 0.5 * (plan.bay - plan.wall);
    let path = |sign: f32| -> Vec<Vec3> {
        let shares = (0..=16).map(|i| -(PI * i as f32 / 16.0).cos());
        shares
            .map(|share| {
                Vec3::new(share * inner, plan.spring + plan.arch(share) - 0.02, sign * share * inner)
            })
            .collect()
    };
    let boss = sphere(0.11, 14).moved(0.0, plan.spring + plan.rise - 0.17, 0.0);
    tube(&path(1.0), 0.05, 8) + tube(&path(-1.0), 0.05, 8) + boss
}

/// Half the length of the hall along x and z, to the middles of the outer columns.
fn extent(plan: &HallSizes) -> Vec2 {
    Vec2::new(plan.bays[0] as f32, plan.bays[1] as f32) * 0.5 * plan.bay
}

/// Steps all around, and flagstones of slightly different heights.
fn floor_and_steps(plan: &HallSizes, random: &mut Random) -> Shape {
    let half = extent(plan) + Vec2::splat(0.35);
    let steps = random.count(2, 4);
    let mut shape = Shape::default();
    for step in 0..steps {
        let (out, y) = (0.28 * step as f32, -0.14 * step as f32);
        let size = 2.0 * (half + Vec2::splat(out));
        shape.join(bevelled_box(size.x, 0.14, size.y, 0.012).moved(0.0, y - 0.16, 0.0));
    }
    let flag = random.within(0.4, 0.7);
    let counts = (2.0 * half / flag).ceil();
    let size = 2.0 * half / counts;
    for column in 0..counts.x as usize {
        for row in 0..counts.y as usize {
            let at = size * (Vec2::new(column as f32, row as f32) + Vec2::splat(0.5)) - half;
            let stone = bevelled_box(size.x - 0.012, 0.06, size.y - 0.012, 0.01);
            shape.join(stone.moved(at.x, -0.06 + random.within(-0.008, 0.0), at.y));
        }
    }
    shape
}

/// A slab on the walls with a cornice and a parapet of merlons.
fn roof(plan: &HallSizes) -> Shape {
    let half = extent(plan) + Vec2::splat(0.5 * plan.wall);
    let mut shape = Shape::default();
    for (out, y, height) in [(0.0, 0.0, 0.06), (0.06, 0.06, 0.06), (0.14, 0.12, 0.08)] {
        let size = 2.0 * (half + Vec2::splat(out));
        shape.join(cuboid(size.x, height, size.y).moved(0.0, plan.top() + y, 0.0));
    }
    let merlon = bevelled_box(0.3, 0.35, 0.16, 0.015);
    let places = |length: f32| {
        let count = (length / 0.55) as usize;
        (0..count).map(move |i| ((i as f32 + 0.5) / count as f32 - 0.5) * length)
    };
    let y = plan.top() + 0.2;
    for side in [-1.0, 1.0] {
        shape.join(merlon.at_each(places(2.0 * half.x).map(|x| Vec3::new(x, y, side * half.y))));
        shape.join(
            merlon
                .clone()
                .turned(0.5 * PI)
                .at_each(places(2.0 * half.y).map(|z| Vec3::new(side * half.x, y, z))),
        );
    }
    shape
}

/// A wall along one side with a niche in each bay and something in it.
fn back_wall(plan: &HallSizes, random: &mut Random) -> Shape {
    let half = 0.3 * plan.bay;
    let niche_top = plan.spring - 0.6;
    let z = plan.column(0, 0).z;
    let mut shape = Shape::default();
    for i in 0..plan.bays[0] {
        let x = plan.column(i, 0).x + 0.5 * plan.bay;
        let part = |x0: f32, x1: f32, y0: f32, y1: f32, out: f32| {
            block(Vec3::new(x + x0, y0, z - 0.15), Vec3::new(x + x1, y1, z + out))
        };
        let side = 0.5 * plan.bay;
        shape.join(part(-side, -half, 0.0, plan.spring, 0.05) + part(half, side, 0.0, plan.spring, 0.05));
        shape.join(part(-half, half, 0.0, 0.7, 0.08) + part(-half, half, niche_top, plan.spring, 0.05));
        shape.join(part(-half, half, 0.7, niche_top, -0.1));
        shape.join(part(-side, side, niche_top + 0.15, niche_top + 0.22, 0.1));
        let bust = random.within(0.35, 0.6) * (niche_top - 0.7);
        let figure = turned_post(bust, 0.13) + sphere(0.09, 20).moved(0.0, bust - 0.02, 0.0);
        shape.join(figure.moved(x, 0.7, z));
        let lintel = plan.arch(0.0);
        shape.join(part(-side, side, plan.spring, plan.spring + lintel, -0.1));
    }
    shape
}

/// Balusters with a rail between the columns of the other sides, with gaps to walk through.
fn balustrades(plan: &HallSizes, random: &mut Random) -> Shape {
    let clear = plan.bay - 0.46;
    let count = (clear / 0.19) as usize;
    let post = turned_post(0.62, 0.065);
    let places = (0..count).map(|i| Vec3::new(((i as f32 + 0.5) / count as f32 - 0.5) * clear, 0.1, 0.0));
    let rails =
        bevelled_box(clear, 0.1, 0.2, 0.012) + bevelled_box(clear, 0.1, 0.22, 0.02).moved(0.0, 0.71, 0.0);
    let one = post.at_each(places) + rails;
    let half = 0.5 * plan.bay;
    let mut shape = Shape::default();
    let front = plan.bays[1];
    for i in 0..plan.bays[0] {
        if random.chance(0.75) {
            shape.join(one.clone().at(plan.column(i, front) + Vec3::X * half));
        }
    }
    for i in [0, plan.bays[0]] {
        for k in 0..plan.bays[1] {
            if random.chance(0.75) {
                shape.join(one.clone().turned(0.5 * PI).at(plan.column(i, k) + Vec3::Z * half));
            }
        }
    }
    shape
}
