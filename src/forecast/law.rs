//! A power law above a floor, and its fit: how loss falls with the steps or the data that a network is trained for (Hestness et
//! al. 2017).

use std::fmt;

/// `floor + scale * steps ^ -exponent`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law {
    /// What is left after any number of steps.
    pub floor: f64,
    /// What is above it after one step.
    pub scale: f64,
    /// How fast that falls, above 0.
    pub exponent: f64,
}

/// Floors that are tried below the lowest point.
const FLOORS: u32 = 4000;

impl Law {
    /// The law with this floor, below all points, that is nearest to points on logarithmic axes; `None` where they do not fall.
    pub fn fitted(points: &[(f64, f64)], floor: f64) -> Option<Self> {
        let logarithms = || points.iter().map(|(steps, loss)| (steps.ln(), (loss - floor).ln()));
        let count = points.len() as f64;
        let mean = |of: fn((f64, f64)) -> f64| logarithms().map(of).sum::<f64>() / count;
        let (x, y) = (mean(|point| point.0), mean(|point| point.1));
        let covariance: f64 = logarithms().map(|point| (point.0 - x) * (point.1 - y)).sum();
        let variance: f64 = logarithms().map(|point| (point.0 - x).powi(2)).sum();
        let exponent = -covariance / variance;
        let is_falling = exponent.is_finite() && exponent > 0.0;
        is_falling.then(|| Self { floor, scale: (y + exponent * x).exp(), exponent })
    }

    /// The law whose floor makes it nearest to points; `None` where they do not fall.
    pub fn best(points: &[(f64, f64)]) -> Option<Self> {
        let lowest = points.iter().map(|point| point.1).fold(f64::INFINITY, f64::min);
        let floors = (0..FLOORS).map(|index| lowest * f64::from(index) / f64::from(FLOORS));
        let laws = floors.filter_map(|floor| Self::fitted(points, floor));
        laws.min_by(|a, b| a.misfit(points).total_cmp(&b.misfit(points)))
    }

    /// The loss after so many steps.
    pub fn at(&self, steps: f64) -> f64 {
        self.floor + self.scale * steps.powf(-self.exponent)
    }

    /// Sum of the squared distances from points.
    fn misfit(&self, points: &[(f64, f64)]) -> f64 {
        points.iter().map(|(steps, loss)| (self.at(*steps) - loss).powi(2)).sum()
    }
}

impl fmt::Display for Law {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { floor, scale, exponent } = self;
        match *floor > 0.0 {
            true => write!(f, "{floor:.4} + {scale:.4} * steps ^ -{exponent:.3}"),
            false => write!(f, "{scale:.4} * steps ^ -{exponent:.3}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(law: Law, steps: &[f64]) -> Vec<(f64, f64)> {
        steps.iter().map(|steps| (*steps, law.at(*steps))).collect()
    }

    #[test]
    fn a_law_is_found_again_from_three_of_its_points() {
        for (floor, exponent) in [(0.0, 0.3), (0.05, 0.5), (0.15, 1.2)] {
            let law = Law { floor, scale: 3.0, exponent };
            let found = Law::best(&points(law, &[1000.0, 2000.0, 4000.0])).expect("falls");
            let far = 64_000.0;
            assert!((found.at(far) - law.at(far)).abs() < 2e-4, "{found} for {law}");
            assert!((found.floor - floor).abs() < 2e-3, "{found} for {law}");
        }
    }

    #[test]
    fn noise_moves_a_forecast_by_about_as_much() {
        let law = Law { floor: 0.1, scale: 2.0, exponent: 0.5 };
        let mut noisy = points(law, &[1000.0, 2000.0, 4000.0, 8000.0, 16_000.0]);
        noisy.iter_mut().zip([1.0, -1.0, 1.0, -1.0, 1.0]).for_each(|(point, sign)| point.1 += 2e-4 * sign);
        let found = Law::best(&noisy).expect("falls");
        assert!((found.at(64_000.0) - law.at(64_000.0)).abs() < 4e-3, "{found}");
    }

    #[test]
    fn what_does_not_fall_follows_no_law() {
        let rising = [(1000.0, 0.2), (2000.0, 0.3), (4000.0, 0.4)];
        assert!(Law::fitted(&rising, 0.0).is_none() && Law::best(&rising).is_none());
        let level = rising.map(|(steps, _)| (steps, 0.2));
        assert!(Law::fitted(&level, 0.0).is_none());
    }
}
