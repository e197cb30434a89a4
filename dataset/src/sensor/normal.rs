//! Numbers of a normal distribution.

use crate::random::uniform;
use std::f32::consts::TAU;

/// A number of mean 0 and deviation 1 for some words (Box and Muller 1958); `which` tells numbers for the
/// same words apart.
pub fn gaussian(words: [u64; 3], which: u64) -> f32 {
    let [seed, purpose, pixel] = words;
    // In (0, 1], whose logarithm is finite.
    let share = 1.0 - uniform(&[seed, purpose, pixel, 2 * which]);
    let angle = TAU * uniform(&[seed, purpose, pixel, 2 * which + 1]);
    (-2.0 * share.ln()).sqrt() * angle.cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_normal() {
        let numbers: Vec<f64> = (0..40_000).map(|pixel| f64::from(gaussian([3, 10, pixel], 1))).collect();
        let moment = |power: i32| numbers.iter().map(|number| number.powi(power)).sum::<f64>() / 40_000.0;
        // Four standard errors of each moment: their variances are 1, 2, 15 and 96 over the count.
        for (power, expected, error) in [(1, 0.0, 0.02), (2, 1.0, 0.03), (3, 0.0, 0.08), (4, 3.0, 0.2)] {
            assert!((moment(power) - expected).abs() < error, "moment {power}: {}", moment(power));
        }
        let others: Vec<f64> = (0..40_000).map(|pixel| f64::from(gaussian([3, 10, pixel], 2))).collect();
        let product = numbers.iter().zip(&others).map(|(a, b)| a * b).sum::<f64>() / 40_000.0;
        assert!(product.abs() < 0.02, "{product}");
    }
}
