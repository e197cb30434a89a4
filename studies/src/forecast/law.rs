//! A power law above a floor, by which loss falls with the length of trainings whose rates fall to their end
//! (Hoffmann et al. 2022, "Training compute-optimal large language models", section 3.3, which has the data
//! seen in place of the steps).

/// `floor + scale * steps ^ -exponent`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law {
    /// What is left after any number of steps, 0 or more.
    pub floor: f64,
    /// What is above it after one step, above 0.
    pub scale: f64,
    /// How fast that falls, above 0.
    pub exponent: f64,
}

/// Exponents that are tried, the least and the greatest, and how many between them on a logarithmic scale.
/// Loss falls by less than a percent over a doubling at the least, and to a sixteenth at the greatest.
const EXPONENTS: (f64, f64, u32) = (0.01, 4.0, 2000);

impl Law {
    /// The law without a floor that is nearest to points, (steps, loss) each; `None` where they do not fall.
    pub fn without_floor(points: &[(f64, f64)]) -> Option<Self> {
        Self::nearest(points, |points, exponent| {
            let (products, squares) = sums(points, exponent, |power, loss| (power * loss, power * power));
            Self { floor: 0.0, scale: products / squares, exponent }
        })
    }

    /// The law that is nearest to points; `None` where they do not fall.
    pub fn with_floor(points: &[(f64, f64)]) -> Option<Self> {
        Self::nearest(points, |points, exponent| {
            let count = points.len() as f64;
            let (power_mean, loss_mean) = sums(points, exponent, |power, loss| (power / count, loss / count));
            let (covariance, variance) = sums(points, exponent, |power, loss| {
                ((power - power_mean) * (loss - loss_mean), (power - power_mean).powi(2))
            });
            let scale = covariance / variance;
            Self { floor: loss_mean - scale * power_mean, scale, exponent }
        })
        .filter(|law| law.floor >= 0.0)
        .or_else(|| Self::without_floor(points))
    }

    /// Of the laws that are best for their exponents the nearest one that falls; `None` where it falls no
    /// more than by the least exponent.
    fn nearest(points: &[(f64, f64)], of_exponent: impl Fn(&[(f64, f64)], f64) -> Self) -> Option<Self> {
        let (least, most, count) = EXPONENTS;
        let exponents =
            (0..=count).map(|index| least * (most / least).powf(f64::from(index) / f64::from(count)));
        let laws = exponents.map(|exponent| of_exponent(points, exponent));
        let nearest = laws.min_by(|a, b| a.misfit(points).total_cmp(&b.misfit(points)))?;
        (nearest.scale > 0.0 && nearest.exponent > least).then_some(nearest)
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

/// Two sums over points, of what is made of `steps ^ -exponent` and the loss.
fn sums(points: &[(f64, f64)], exponent: f64, of: impl Fn(f64, f64) -> (f64, f64)) -> (f64, f64) {
    let parts = points.iter().map(|(steps, loss)| of(steps.powf(-exponent), *loss));
    parts.fold((0.0, 0.0), |sum, part| (sum.0 + part.0, sum.1 + part.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEPS: [f64; 3] = [5000.0, 10_000.0, 20_000.0];

    fn points(law: Law, steps: &[f64]) -> Vec<(f64, f64)> {
        steps.iter().map(|steps| (*steps, law.at(*steps))).collect()
    }

    #[test]
    fn a_law_is_found_again_from_three_of_its_points() {
        for (floor, exponent) in [(0.0, 0.3), (0.05, 0.5), (0.15, 1.2)] {
            let law = Law { floor, scale: 3.0, exponent };
            let found = Law::with_floor(&points(law, &STEPS)).expect("falls");
            let far = 320_000.0;
            assert!((found.at(far) - law.at(far)).abs() < 2e-4, "{found:?} for {law:?}");
            assert!((found.floor - floor).abs() < 1e-3, "{found:?} for {law:?}");
        }
    }

    #[test]
    fn without_a_floor_it_falls_for_ever() {
        let law = Law { floor: 0.0, scale: 2.0, exponent: 0.25 };
        let found = Law::without_floor(&points(law, &STEPS)).expect("falls");
        assert!((found.at(1e6) - law.at(1e6)).abs() < 2e-4, "{found:?}");
        // Where ends fall faster and faster a floor would be below 0.
        let faster = [(5000.0, 0.2), (10_000.0, 0.19), (20_000.0, 0.15)];
        assert_eq!(Law::with_floor(&faster), Law::without_floor(&faster));
    }

    #[test]
    fn noise_moves_a_forecast_by_about_as_much() {
        let law = Law { floor: 0.1, scale: 2.0, exponent: 0.5 };
        let mut noisy = points(law, &[1000.0, 2000.0, 4000.0, 8000.0, 16_000.0]);
        noisy.iter_mut().zip([1.0, -1.0, 1.0, -1.0, 1.0]).for_each(|(point, sign)| point.1 += 2e-4 * sign);
        let found = Law::with_floor(&noisy).expect("falls");
        assert!((found.at(64_000.0) - law.at(64_000.0)).abs() < 1e-3, "{found:?}");
    }

    #[test]
    fn what_does_not_fall_follows_no_law() {
        let rising = [(1000.0, 0.2), (2000.0, 0.3), (4000.0, 0.4)];
        let level = rising.map(|(steps, _)| (steps, 0.2));
        for points in [rising, level] {
            assert_eq!((Law::without_floor(&points), Law::with_floor(&points)), (None, None));
        }
    }
}
