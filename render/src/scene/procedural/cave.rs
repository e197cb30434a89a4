//! Caves: chambers and passages in rock, with dripstones, crystals, pools and rubble.

use super::materials;
use super::noise;
use super::random::Random;
use super::scene_builder::{SceneBuilder, ShapesByMaterial};
use super::shape::Shape;
use super::solids::{icosphere, torus};
use super::surface::{isosurface, sheet, smooth_min};
use super::sweep::{circle, lathe, sweep};
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Half the extent of the rock.
const HALF: Vec3 = Vec3::new(4.2, 2.1, 4.2);

/// The hollow of a cave.
struct Hollow {
    seed: u32,
    rough: f32,
    strata: f32,
    /// Middle and half axes of chambers.
    chambers: Vec<(Vec3, Vec3)>,
}

impl Hollow {
    fn drawn(random: &mut Random) -> Self {
        let chambers = (0..random.count(4, 6))
            .map(|i| {
                let reach = if i == 0 { 0.5 } else { 2.4 };
                let half =
                    Vec3::new(random.within(0.8, 1.7), random.within(0.7, 1.3), random.within(0.8, 1.7));
                (
                    Vec3::new(
                        random.within(-reach, reach),
                        random.within(-0.5, 0.3),
                        random.within(-reach, reach),
                    ),
                    half,
                )
            })
            .collect();
        Self {
            seed: random.bits(),
            rough: random.within(0.25, 0.5),
            strata: random.within(0.03, 0.1),
            chambers,
        }
    }

    /// Positive in the air, negative in rock, about a distance.
    fn air(&self, point: Vec3) -> f32 {
        let ball =
            |(middle, half): &(Vec3, Vec3)| (((point - middle) / half).length() - 1.0) * half.min_element();
        let passage = |pair: &[(Vec3, Vec3)]| {
            let (from, axis) = (pair[0].0, pair[1].0 - pair[0].0);
            let along = ((point - from).dot(axis) / axis.length_squared().max(1e-6)).clamp(0.0, 1.0);
            point.distance(from + axis * along) - 0.55
        };
        let chambers = self.chambers.iter().map(ball).fold(f32::MAX, |a, b| smooth_min(a, b, 0.4));
        let rock = self.chambers.windows(2).map(passage).fold(chambers, |a, b| smooth_min(a, b, 0.4));
        // Most of the time goes into noise, which is not computed where it cannot matter: more than a cell
        // away from where it could move the surface, and where something else bounds the air more tightly.
        let reach = 1.5 * self.rough + self.strata;
        if rock > reach + 0.2 {
            return -rock;
        }
        // Nothing opens to the outside, and rubble levels the floor.
        let mut air = (HALF - Vec3::splat(0.15) - point.abs()).min_element();
        let floor = point.y + 0.75;
        if (floor - 0.17) * 0.8 < air {
            let uneven = 0.15 * noise::fbm(self.seed ^ 3, point.with_y(0.5) * 1.5, 3);
            air = air.min((floor - uneven) * 0.8);
        }
        if rock < -reach - 0.2 {
            air.min(-rock)
        } else if air > -rock - reach {
            air.min(self.bumps(point) - rock)
        } else {
            air
        }
    }

    /// Roughness and layers of the rock: at most 1.5 times the roughness and once the strata, either way.
    fn bumps(&self, point: Vec3) -> f32 {
        let bumps = self.rough
            * (noise::ridged(self.seed, point * 0.9, 3) + 0.35 * noise::gradient(self.seed ^ 9, point * 3.0));
        let layers = self.strata * (11.0 * point.y + 2.0 * noise::gradient(self.seed ^ 5, point * 0.7)).sin();
        bumps + layers
    }

    /// A point of the surface straight above or below a random point in the air.
    fn surface(&self, upwards: bool, random: &mut Random) -> Option<Vec3> {
        let (middle, half) = random.pick(&self.chambers);
        let at = random.in_disc(0.9);
        let start = middle + Vec3::new(at.x * half.x, 0.0, at.y * half.z);
        let step = Vec3::Y * if upwards { 0.04 } else { -0.04 };
        let mut path = (0..90).map(|i| start + step * i as f32);
        if self.air(start) > 0.1 { path.find(|point| self.air(*point) <= 0.0) } else { None }
    }
}

/// Builds a cave.
pub fn build(builder: &mut SceneBuilder, random: &mut Random) {
    let hollow = Hollow::drawn(random);
    let rock = materials::stone(builder, random);
    builder.add("rock", rock, isosurface(-HALF, HALF, 0.09, |point| hollow.air(point)));
    let mut drip = ShapesByMaterial::new(materials::several(2, materials::marble, builder, random));
    for _ in 0..random.count(60, 110) {
        let upwards = random.chance(0.6);
        if let Some(foot) = hollow.surface(upwards, random) {
            let room = clear_height(&hollow, foot, upwards);
            drip.put(dripstone(room, upwards, random).at(foot), random);
        }
    }
    for _ in 0..random.count(5, 10) {
        if let Some(foot) = hollow.surface(true, random) {
            drip.put(flowstone_curtain(random).at(foot + Vec3::Y * 0.1), random);
        }
    }
    drip.add_to(builder, "dripstones");
    let glow = materials::paint(builder, random);
    builder.add("crystals", glow, scattered(&hollow, random.count(8, 16), random, crystals));
    builder.add("rubble", rock, scattered(&hollow, random.count(60, 100), random, rubble));
    let pool = materials::marble(builder, random);
    builder.add("pools", pool, scattered(&hollow, random.count(4, 8), random, pool_rim));
    builder.lamp(hollow.chambers[0].0, random);
    builder.lamp(hollow.chambers[1].0, random);
}

/// Things on the floor.
fn scattered(hollow: &Hollow, count: usize, random: &mut Random, thing: fn(&mut Random) -> Shape) -> Shape {
    (0..count).filter_map(|_| hollow.surface(false, random).map(|foot| thing(random).at(foot))).collect()
}

/// How much air there is above a floor or below a ceiling.
fn clear_height(hollow: &Hollow, foot: Vec3, downwards: bool) -> f32 {
    let step = Vec3::Y * if downwards { -0.08 } else { 0.08 };
    (2..50).find(|i| hollow.air(foot + step * *i as f32) < 0.0).unwrap_or(50) as f32 * 0.08
}

/// A cone of rings: hanging from the origin if `hangs`, else standing on it; sometimes a whole column.
fn dripstone(room: f32, hangs: bool, random: &mut Random) -> Shape {
    let whole = room < 1.6 && random.chance(0.25);
    let length = if whole { room + 0.2 } else { room * random.within(0.15, 0.6) };
    let radius = (length * random.within(0.08, 0.2)).min(0.22);
    let rings = 18;
    let seed = random.bits();
    let outline = |i: usize| {
        let t = i as f32 / rings as f32;
        let taper = if whole { 1.0 - 1.6 * t * (1.0 - t) } else { (1.0 - t).powf(0.8) };
        let ripple =
            1.0 + 0.08 * (TAU * 4.5 * t).sin() + 0.15 * noise::gradient(seed, Vec3::new(0.5, 6.0 * t, 0.5));
        Vec2::new(radius * taper * ripple, length * t - 0.1)
    };
    let mut profile = vec![Vec2::new(0.0, -0.1)];
    profile.extend((0..rings).map(outline));
    profile.push(Vec2::new(if whole { radius } else { 0.0 }, length));
    if whole {
        profile.push(Vec2::new(0.0, length));
    }
    let stone =
        lathe(&profile, 16).welded().bent(|p, n| p + n * radius * 0.35 * noise::fbm(seed, p * 4.0, 2));
    if hangs { stone.pitched(PI) } else { stone }
}

/// A thin wavy sheet of stone that hangs from the origin.
fn flowstone_curtain(random: &mut Random) -> Shape {
    let (width, drop, phase) = (random.within(0.4, 1.0), random.within(0.25, 0.7), random.angle());
    let side = |out: f32| {
        sheet(40, 16, move |u, v| {
            let wave = 0.07 * (9.0 * u + phase).sin() * (0.3 + v);
            let hem = drop * (0.6 + 0.4 * (PI * u).sin() + 0.08 * (31.0 * u).sin());
            // Both sides meet at the hem and at the ends.
            let thick = out * (1.0 - v) * (1.0 - (2.0 * u - 1.0).powi(8));
            Vec3::new((u - 0.5) * width, -hem * v, wave + thick)
        })
    };
    (side(0.035) + side(-0.035).reversed()).turned(phase)
}

/// Six-sided prisms with points, from one foot.
fn crystals(random: &mut Random) -> Shape {
    let size = random.within(0.08, 0.35);
    (0..random.count(6, 14))
        .map(|_| {
            let (radius, length) = (size * random.within(0.08, 0.22), size * random.within(0.5, 1.6));
            let path = [Vec3::NEG_Y * 0.1, Vec3::Y * length, Vec3::Y * (length + 1.4 * radius)];
            let prism = sweep(&circle(radius, 6), &path, |t| if t < 0.9 { 1.0 } else { 0.03 });
            let mut direction = random.direction() + Vec3::Y;
            direction.y = direction.y.abs() + 0.2;
            prism.turned(random.angle()).aimed(direction)
        })
        .collect()
}

fn rubble(random: &mut Random) -> Shape {
    let (radius, seed) = (random.within(0.04, 0.22), random.bits());
    let stone = icosphere(radius, if radius > 0.12 { 3 } else { 2 })
        .bent(|p, n| p + n * radius * 0.5 * noise::ridged(seed, p * (0.9 / radius), 2));
    stone.scaled(1.0, random.within(0.5, 0.9), 1.0).turned(random.angle()).moved(0.0, 0.25 * radius, 0.0)
}

/// Rims of stone one inside the other, as still water leaves them.
fn pool_rim(random: &mut Random) -> Shape {
    let (radius, seed) = (random.within(0.2, 0.5), random.bits());
    let rims = (0..3).map(|i| {
        torus(radius * (1.0 - 0.28 * i as f32), 0.035, 56, 8).welded().moved(0.0, 0.02 + 0.03 * i as f32, 0.0)
    });
    rims.collect::<Shape>().bent(|p, _| {
        let around = p.z.atan2(p.x);
        let lobes = 1.0 + 0.15 * (5.0 * around + seed as f32 % TAU).sin() + 0.06 * (13.0 * around).sin();
        p * Vec3::new(lobes, 1.0, lobes)
    })
}
