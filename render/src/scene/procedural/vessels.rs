//! Things turned on a potter's wheel or a lathe, and fruit.

use super::random::Random;
use super::shape::Shape;
use super::solids::{frustum, icosphere, torus};
use super::sweep::{curve, lathe, tapered_tube, tube};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// A vessel with a wall of 4 % of its radius, from the outline of its outside, bottom to rim, radius first,
/// in shares of `radius` and `height`.
pub fn vessel(outline: &[(f32, f32)], radius: f32, height: f32) -> Shape {
    let knots: Vec<Vec3> = outline.iter().map(|(x, y)| Vec3::new(x * radius, y * height, 0.0)).collect();
    let wall = (0.05 * radius).max(0.003);
    let steps = ((height * 14.0) as usize).clamp(2, 5);
    let outside: Vec<Vec2> =
        curve(&knots, steps).iter().map(|point| point.truncate().max(Vec2::ZERO)).collect();
    let inside = outside.iter().rev().map(|point| Vec2::new((point.x - wall).max(0.0), point.y.max(wall)));
    let mut profile = vec![Vec2::new(0.0, outside[0].y)];
    profile.extend(&outside);
    profile.extend(inside);
    profile.push(Vec2::new(0.0, wall.max(outside[0].y)));
    profile.dedup_by(|a, b| a.distance(*b) < 1e-5);
    lathe(&profile, ((radius * 280.0) as usize).clamp(14, 32))
}

/// A vase of any form.
pub fn vase(radius: f32, height: f32, random: &mut Random) -> Shape {
    let foot = random.within(0.4, 0.8);
    let neck = random.within(0.2, 0.6);
    let lip = neck + random.within(0.05, 0.4);
    let belly = random.within(0.25, 0.6);
    vessel(&[(foot, 0.0), (0.5 * (foot + 1.0), 0.12), (1.0, belly), (neck, 0.82), (lip, 1.0)], radius, height)
}

/// A bowl.
pub fn bowl(radius: f32, height: f32) -> Shape {
    vessel(&[(0.42, 0.0), (0.42, 0.06), (0.75, 0.3), (0.95, 0.7), (1.0, 1.0)], radius, height)
}

/// A plate.
pub fn plate(radius: f32) -> Shape {
    vessel(&[(0.55, 0.0), (0.6, 0.2), (0.68, 0.55), (0.9, 0.85), (1.0, 1.0)], radius, 0.16 * radius)
}

/// A bottle.
pub fn bottle(radius: f32, height: f32, random: &mut Random) -> Shape {
    let shoulder = random.within(0.45, 0.7);
    let neck = random.within(0.25, 0.35);
    let outline = [
        (0.9, 0.0),
        (1.0, 0.04),
        (1.0, 0.3),
        (1.0, shoulder),
        (neck, shoulder + 0.18),
        (neck, 0.97),
        (neck * 1.2, 1.0),
    ];
    vessel(&outline, radius, height)
}

/// A mug or jug with a handle towards +x.
pub fn jug(radius: f32, height: f32, random: &mut Random) -> Shape {
    let waist = random.within(0.7, 1.0);
    let body = vessel(&[(0.8, 0.0), (1.0, 0.1), (waist, 0.6), (0.9, 1.0)], radius, height);
    let knots = [(0.85, 0.85), (1.35, 0.85), (1.5, 0.55), (1.3, 0.25), (0.9, 0.18)];
    let path = knots.map(|(x, y)| Vec3::new(x * radius, y * height, 0.0));
    body + tube(&curve(&path, 6), 0.09 * radius, 10)
}

/// A candlestick with its candle.
pub fn candlestick(height: f32) -> Shape {
    let outline = [
        (1.0, 0.0),
        (1.0, 0.04),
        (0.4, 0.1),
        (0.22, 0.2),
        (0.4, 0.28),
        (0.2, 0.36),
        (0.25, 0.55),
        (0.55, 0.62),
    ];
    vessel(&outline, 0.22 * height, height)
        + frustum(0.04 * height, 0.036 * height, 0.95 * height, 20).moved(0.0, 0.05 * height, 0.0)
}

/// An apple with its stalk.
pub fn apple(radius: f32) -> Shape {
    let point = |i: usize| {
        let angle = PI * (i as f32 / 16.0 - 0.5);
        let dent = 0.22 * angle.sin().abs().powi(6);
        Vec2::new(
            radius * angle.cos().max(0.0) * (1.0 + 0.06 * angle.sin()),
            radius * (0.9 + 0.9 * angle.sin() - dent * angle.sin()),
        )
    };
    let mut profile: Vec<Vec2> = (0..=16).map(point).collect();
    profile[0].x = 0.0;
    profile[16].x = 0.0;
    let lowest = profile.iter().fold(f32::MAX, |lowest, point| lowest.min(point.y));
    let top = Vec3::Y * (profile[16].y - 0.1 * radius);
    let stalk = [top, top + Vec3::new(0.02, 0.25, 0.0) * radius, top + Vec3::new(0.12, 0.5, 0.03) * radius];
    (lathe(&profile, 28) + tube(&curve(&stalk, 3), 0.05 * radius, 6)).moved(0.0, -lowest, 0.0)
}

/// A pear.
pub fn pear(radius: f32) -> Shape {
    let knots = [(0.0, 0.05), (0.5, 0.0), (1.0, 0.75), (0.62, 1.6), (0.4, 2.1), (0.0, 2.35)];
    let knots = knots.map(|(x, y)| Vec3::new(x * radius, y * radius, 0.0));
    let mut profile: Vec<Vec2> =
        curve(&knots, 5).iter().map(|point| point.truncate().max(Vec2::ZERO)).collect();
    let last = profile.len() - 1;
    profile[0].x = 0.0;
    profile[last].x = 0.0;
    lathe(&profile, 28)
}

/// A banana that lies on y = 0.
pub fn banana(length: f32) -> Shape {
    let radius = 0.1 * length;
    let path: Vec<Vec3> = (0..=14)
        .map(|i| Vec2::from_angle(PI * (0.15 + 0.7 * i as f32 / 14.0)) * 0.55 * length)
        .map(|point| Vec3::new(point.x, radius, point.y - 0.4 * length))
        .collect();
    tapered_tube(&path, radius, 10, |t| 0.25 + 0.75 * (PI * (0.06 + 0.88 * t)).sin().sqrt())
}

/// A bunch of grapes that lies on y = 0, a heap that grows narrower towards +x.
pub fn grapes(length: f32, random: &mut Random) -> Shape {
    let radius = 0.075 * length;
    let grape = icosphere(radius, 2);
    let mut shape = Shape::default();
    for layer in 0..3 {
        for _ in 0..[22, 12, 5][layer] {
            let along = random.unit();
            let wide = 0.28 * length * (1.0 - along) * (1.0 - 0.3 * layer as f32);
            let at = Vec3::new(
                length * (along * (1.0 - 0.2 * layer as f32) - 0.5),
                radius * (1.0 + 1.5 * layer as f32),
                random.within(-wide, wide),
            );
            shape.join(grape.clone().at(at));
        }
    }
    shape
}

/// A ring-shaped loaf or coil that lies on y = 0.
pub fn ring(radius: f32) -> Shape {
    let tube = 0.32 * radius;
    torus(radius - tube, tube, 36, 16).moved(0.0, tube, 0.0)
}
