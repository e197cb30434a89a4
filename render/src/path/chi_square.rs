//! Pearson's chi-square test of samplers of directions and of distances against the densities that they
//! claim, for tests.
//!
//! Directions are counted in bins over the sphere, and what a bin should hold is the density's integral over
//! it. Samples that give no direction are a bin of their own, so that the density's total is checked as well.
//! Sidak's correction keeps the probability that any of several right samplers is rejected at 1 %.

use super::proving::Comparison;
use crate::sampler::{PixelSampler, Stream, frame};
use glam::Vec3;
use std::f64::consts::PI;

/// Bins from pole to pole, of equal solid angle.
const ROWS: usize = 32;
/// Bins around.
const COLUMNS: usize = 64;
/// Bins along a line.
const STEPS: usize = 60;
/// Points along both edges of a bin at which the density is read.
const POINTS: usize = 12;
const SAMPLES: u32 = 100_000;
/// Bins that should hold fewer are counted together.
const FEWEST: f64 = 5.0;
/// Densities whose integral is larger are none, whatever the integral misses.
const LARGEST_TOTAL: f64 = 1.005;
/// Probability that at least one of several right samplers is rejected.
const SIGNIFICANCE: f64 = 0.01;

/// Whether a probability of [`p_value`] is too small for a right sampler, `tests` of which are looked at.
pub fn rejects(p: f64, tests: usize) -> bool {
    p < least(tests)
}

/// Asserts that it is not.
pub fn proves(name: &str, p: f64, tests: usize) {
    compared(name, p, tests, false).record_and_assert();
}

/// Asserts that it is: the control of a proof.
pub fn refutes(name: &str, p: f64, tests: usize) {
    compared(name, p, tests, true).record_and_assert();
}

fn compared(name: &str, p: f64, tests: usize, control: bool) -> Comparison<'_> {
    let within = !rejects(p, tests);
    Comparison { name, value: p, expected: least(tests), standard_error: None, within, control }
}

/// Sidak's correction.
fn least(tests: usize) -> f64 {
    1.0 - (1.0 - SIGNIFICANCE).powf(1.0 / tests as f64)
}

/// Probability of counts at least as far from what they should be if the density is the sampler's. Bins turn
/// about `pole`: densities that are steep there, or end within bins, need better placed ones.
pub fn p_value(
    pole: Vec3,
    mut sample: impl FnMut(&mut Stream) -> Option<Vec3>,
    density: impl Fn(Vec3) -> f32,
) -> f64 {
    let to_world = frame(pole);
    p_value_of_bins(
        ROWS * COLUMNS,
        |stream| sample(stream).map(|direction| bin(to_world.transpose() * direction)),
        |bin| integral(bin, |direction| density(to_world * direction)),
    )
}

/// As [`p_value`], of a sampler of distances up to a length and their density, 1/m.
pub fn p_value_of_distances(
    length: f32,
    mut sample: impl FnMut(&mut Stream) -> Option<f32>,
    density: impl Fn(f32) -> f64,
) -> f64 {
    let width = length / STEPS as f32;
    let middle = |bin: usize, point: usize| (bin as f32 + (point as f32 + 0.5) / POINTS as f32) * width;
    p_value_of_bins(
        STEPS,
        |stream| sample(stream).map(|distance| ((distance / width) as usize).min(STEPS - 1)),
        |bin| {
            let sum: f64 = (0..POINTS).map(|point| density(middle(bin, point))).sum();
            sum * f64::from(width) / POINTS as f64
        },
    )
}

/// Of a sampler of `bins` numbered bins, or none, and the probability of each.
fn p_value_of_bins(
    bins: usize,
    mut sample: impl FnMut(&mut Stream) -> Option<usize>,
    probability_of: impl Fn(usize) -> f64,
) -> f64 {
    let mut counts = vec![0.0; bins + 1];
    for i in 0..SAMPLES {
        // Independent numbers, as the test asks for: the first of a sequence of its own each time.
        let mut stream = Stream::new(PixelSampler::new(i as usize, 0, 1), 0);
        counts[sample(&mut stream).unwrap_or(bins)] += 1.0;
    }
    let mut pairs: Vec<(f64, f64)> =
        (0..bins).map(|bin| (probability_of(bin) * f64::from(SAMPLES), counts[bin])).collect();
    let total: f64 = pairs.iter().map(|(expected, _)| expected).sum();
    if total > LARGEST_TOTAL * f64::from(SAMPLES) {
        return 0.0;
    }
    pairs.push(((f64::from(SAMPLES) - total).max(0.0), counts[bins]));
    probability(pairs)
}

/// Of bins with what they should hold and what they do.
fn probability(mut bins: Vec<(f64, f64)>) -> f64 {
    if bins.iter().any(|(expected, count)| *expected < 1e-3 && *count > 3.0) {
        return 0.0;
    }
    bins.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut statistic, mut terms) = (0.0, 0);
    let (mut expected, mut count) = (0.0, 0.0);
    for bin in bins {
        (expected, count) = (expected + bin.0, count + bin.1);
        if expected >= FEWEST {
            statistic += (count - expected) * (count - expected) / expected;
            terms += 1;
            (expected, count) = (0.0, 0.0);
        }
    }
    upper_gamma(0.5 * f64::from(terms - 1), 0.5 * statistic)
}

/// The bin of a direction in the frame of the pole.
fn bin(direction: Vec3) -> usize {
    let turn = f64::from(direction.y).atan2(f64::from(direction.x)) / (2.0 * PI);
    let column = (turn.rem_euclid(1.0) * COLUMNS as f64) as usize;
    let row = (0.5 * (f64::from(direction.z) + 1.0) * ROWS as f64) as usize;
    row.min(ROWS - 1) * COLUMNS + column.min(COLUMNS - 1)
}

/// Integral of a density over a bin, by the rule of midpoints.
fn integral(bin: usize, density: impl Fn(Vec3) -> f32) -> f64 {
    let (row, column) = (bin / COLUMNS, bin % COLUMNS);
    let at = |index: usize, point: usize, count: usize| {
        (index as f64 + (point as f64 + 0.5) / POINTS as f64) / count as f64
    };
    let mut sum = 0.0;
    for down in 0..POINTS {
        let z = 2.0 * at(row, down, ROWS) - 1.0;
        let radius = (1.0 - z * z).sqrt();
        for around in 0..POINTS {
            let (sin, cos) = (2.0 * PI * at(column, around, COLUMNS)).sin_cos();
            let direction = Vec3::new((radius * cos) as f32, (radius * sin) as f32, z as f32);
            sum += f64::from(density(direction));
        }
    }
    sum * 4.0 * PI / (ROWS * COLUMNS * POINTS * POINTS) as f64
}

/// The regularised upper incomplete gamma function `Q(a, x)`: its series below `a + 1`, its continued
/// fraction (by Lentz's algorithm) above (Press et al., "Numerical Recipes", 6.2).
fn upper_gamma(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    let front = (a * x.ln() - x - ln_gamma(a)).exp();
    if x < a + 1.0 {
        let (mut term, mut sum, mut n) = (1.0 / a, 1.0 / a, a);
        while term > sum * 1e-15 {
            n += 1.0;
            term *= x / n;
            sum += term;
        }
        return 1.0 - front * sum;
    }
    let mut b = x + 1.0 - a;
    let mut c = 1e300;
    let mut d = 1.0 / b;
    let mut fraction = d;
    for i in 1..100_000 {
        let n = -f64::from(i) * (f64::from(i) - a);
        b += 2.0;
        d = 1.0 / (n * d + b);
        c = b + n / c;
        fraction *= d * c;
        if (d * c - 1.0).abs() < 1e-15 {
            break;
        }
    }
    front * fraction
}

/// By Stirling's series, after the recurrence has made the argument large.
fn ln_gamma(a: f64) -> f64 {
    if a < 12.0 {
        return ln_gamma(a + 1.0) - a.ln();
    }
    let series = 1.0 / (12.0 * a) - 1.0 / (360.0 * a.powi(3)) + 1.0 / (1260.0 * a.powi(5));
    (a - 0.5) * a.ln() - a + 0.5 * (2.0 * PI).ln() + series
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampler::cosine_hemisphere;
    use std::f32::consts::FRAC_1_PI;

    #[test]
    fn probabilities_are_those_of_tables() {
        // Critical values of the chi-square distribution at 5 % and 1 %.
        for (degrees, statistic, p) in [
            (1.0, 3.841_459, 0.05),
            (10.0, 18.307_038, 0.05),
            (10.0, 23.209_251, 0.01),
            (100.0, 135.806_723, 0.01),
        ] {
            let found = upper_gamma(0.5 * degrees, 0.5 * statistic);
            assert!((found - p).abs() < 1e-8, "{found} is not {p}");
        }
        assert!((upper_gamma(1.0, 0.3) - (-0.3f64).exp()).abs() < 1e-10);
    }

    #[test]
    fn the_cosine_hemisphere_has_its_density() {
        let cosine = |stream: &mut Stream| {
            let square = stream.next_2d();
            Some(cosine_hemisphere(square.x, square.y))
        };
        let p = |density: fn(Vec3) -> f32| p_value(Vec3::Z, cosine, density);
        let name = "chi_square/cosine_hemisphere";
        proves(name, p(|direction| direction.z.max(0.0) * FRAC_1_PI), 1);
        // Uniform over the hemisphere, over the sphere, a density that is 2 % too high, and a little that is
        // missing.
        for wrong in [
            |direction: Vec3| f32::from(direction.z > 0.0) * 0.5 * FRAC_1_PI,
            |_: Vec3| 0.25 * FRAC_1_PI,
            |direction: Vec3| direction.z.max(0.0) * 1.02 * FRAC_1_PI,
            |direction: Vec3| if direction.x > 0.98 { 0.0 } else { direction.z.max(0.0) * FRAC_1_PI },
        ] {
            refutes(name, p(wrong), 1);
        }
    }

    #[test]
    fn more_tests_ask_for_smaller_probabilities() {
        assert!(rejects(0.009, 1) && !rejects(0.011, 1));
        assert!(rejects(0.000_9, 10) && !rejects(0.001_1, 10));
    }
}
