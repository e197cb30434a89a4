//! Environment maps convolved with the lobes `cos^e` for a row of exponents, on the CPU, once for an
//! environment.
//!
//! The exponents are powers of two from 1, which is the cosine and gives irradiance over pi. Each map is as
//! fine as its lobe needs, up to a given height, and made from the environment filtered to the same height:
//! the sum over its texels by lobe and solid angle. Lobe and solid angle depend on two rows and the distance
//! of two columns.

use crate::methods::environment_map::EnvironmentMap;
use crate::scene::Environment;
use glam::Vec3;
use rayon::prelude::*;
use std::f32::consts::PI;

/// Maps, of the exponents `2^level`: the smoothest surface has 4,998.
pub const LEVELS: usize = 14;

/// Rows of the coarsest map: bilinear interpolation of the cosine errs by a thousandth.
const COARSEST: usize = 32;

/// Rows of a map within a lobe's standard deviation, `1 / sqrt(e + 1)`: they widen it by a 30th.
const ROWS_A_DEVIATION: f32 = 2.0;

/// Less of a lobe's peak does not count.
const NEGLIGIBLE: f32 = 1e-4;

/// The maps of an environment, none higher than `tallest` rows, or the coarsest if that is more.
pub fn maps(environment: &Environment, tallest: usize) -> Vec<EnvironmentMap> {
    let heights = || (0..LEVELS).map(|level| height(level, tallest));
    let mut sources = vec![EnvironmentMap::new(environment, heights().max().unwrap_or(COARSEST))];
    while let Some(coarser) = sources.last().filter(|map| map.height() > COARSEST).map(EnvironmentMap::halved)
    {
        sources.push(coarser);
    }
    let source = |height| sources.iter().find(|map| map.height() == height).expect("powers of two");
    heights().enumerate().map(|(level, height)| convolved(source(height), exponent(level))).collect()
}

/// Irradiance over pi for every normal: the coarsest map alone.
pub fn diffuse(environment: &Environment) -> EnvironmentMap {
    convolved(&EnvironmentMap::new(environment, COARSEST), exponent(0))
}

fn exponent(level: usize) -> f32 {
    (level as f32).exp2()
}

/// Rows of a level's map, a power of two.
fn height(level: usize, tallest: usize) -> usize {
    let wanted = (ROWS_A_DEVIATION * PI * (exponent(level) + 1.0).sqrt()) as usize;
    let tallest = if tallest.is_power_of_two() { tallest } else { tallest.next_power_of_two() / 2 };
    wanted.next_power_of_two().min(tallest).max(COARSEST)
}

/// Means of a map weighed by a lobe around each of its texels.
fn convolved(source: &EnvironmentMap, exponent: f32) -> EnvironmentMap {
    let height = source.height();
    let rows = (0..height).into_par_iter().flat_map_iter(|row| convolved_row(source, exponent, row));
    EnvironmentMap::of_texels(height, rows.collect())
}

fn convolved_row(source: &EnvironmentMap, exponent: f32, row: usize) -> Vec<Vec3> {
    let width = 2 * source.height();
    let mut sums = vec![Vec3::ZERO; width];
    let mut whole = 0.0;
    for (other, texels) in source.texels().chunks_exact(width).enumerate() {
        let weights = weights(source.height(), exponent, row, other);
        // Columns on either side have the same weight.
        let others = weights.iter().enumerate().skip(1).map(|(distance, weight)| (width - distance, weight));
        let others = others.filter(|(distance, _)| *distance > width / 2);
        for (distance, weight) in weights.iter().enumerate().chain(others) {
            whole += weight;
            let (before, after) = texels.split_at(distance);
            for (sum, texel) in sums.iter_mut().zip(after.iter().chain(before)) {
                *sum += *weight * *texel;
            }
        }
    }
    sums.iter().map(|sum| *sum / whole).collect()
}

/// Lobe times solid angle between a texel of one row and those of another, by their distance in columns, up
/// to half the width or where it is negligible.
fn weights(height: usize, exponent: f32, row: usize, other: usize) -> Vec<f32> {
    let step = PI / height as f32;
    let [(sin, cos), (other_sin, other_cos)] = [row, other].map(|row| ((row as f32 + 0.5) * step).sin_cos());
    let lobe = |distance: usize| {
        let cosine = sin * other_sin * (distance as f32 * step).cos() + cos * other_cos;
        cosine.clamp(0.0, 1.0).powf(exponent)
    };
    let counts = (0..=height).map(lobe).take_while(|lobe| *lobe > NEGLIGIBLE);
    counts.map(|lobe| lobe * other_sin).collect()
}
