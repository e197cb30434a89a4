//! Captures to train on: plain and turned things in greys on a table.

use super::capture_table::{self, laid};
use super::furniture::book;
use super::random::Random;
use super::scene_builder::SceneBuilder;
use super::shape::Shape;
use super::solids::{icosphere, rounded_box};
use super::sweep::lathe;
use super::vessels;
use glam::Vec2;
use std::f32::consts::PI;

/// Steps of a rounded edge.
const STEPS: usize = 6;

/// Builds a table with things on it.
pub fn build(builder: &mut SceneBuilder, random: &mut Random) {
    capture_table::build(thing, builder, random);
}

fn thing(random: &mut Random) -> Shape {
    match random.count(0, 11) {
        0 | 1 => {
            let edge = rounded_box(
                random.within(0.5, 1.2),
                random.within(0.4, 2.0),
                random.within(0.5, 1.2),
                random.within(0.02, 0.15),
                STEPS,
            );
            if random.chance(0.3) { edge.pitched(random.within(0.2, 1.2)) } else { edge }
        }
        2 | 3 => {
            let drum = turned(1.0, random.within(0.3, 1.0), random.within(0.4, 3.0));
            if random.chance(0.4) { laid(drum, random) } else { drum }
        }
        4 => turned(1.0, 0.05, random.within(0.8, 2.5)),
        5 | 6 => icosphere(1.0, 4),
        7 => vessels::vase(0.1, random.within(0.15, 0.35), random),
        8 => {
            let bowl = vessels::bowl(0.1, random.within(0.04, 0.1));
            if random.chance(0.5) { bowl.pitched(PI) } else { bowl }
        }
        9 => vessels::jug(0.1, random.within(0.15, 0.25), random),
        10 => book(random.within(0.03, 0.08), 0.25, 0.18).rolled(0.5 * PI),
        _ => vessels::pear(0.1),
    }
}

/// A cylinder or a cone without its tip, with rounded rims.
fn turned(bottom: f32, top: f32, height: f32) -> Shape {
    let rim = 0.08 * height.min(1.0);
    let (bottom_rim, top_rim) = (rim.min(bottom), rim.min(top));
    let quarter = |middle: Vec2, radius: f32, start: f32| {
        (0..=STEPS)
            .map(move |i| middle + Vec2::from_angle(start + 0.5 * PI * i as f32 / STEPS as f32) * radius)
    };
    let mut outline = vec![Vec2::ZERO];
    outline.extend(quarter(Vec2::new(bottom - bottom_rim, bottom_rim), bottom_rim, -0.5 * PI));
    outline.extend(quarter(Vec2::new(top - top_rim, height - top_rim), top_rim, 0.0));
    outline.push(Vec2::new(0.0, height));
    lathe(&outline, 64)
}
