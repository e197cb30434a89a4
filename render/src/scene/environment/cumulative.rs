//! Choice of one of many by their weights, by inversion, which keeps the stratification of the numbers put
//! in.
//!
//! Those numbers are multiples of 2^-23 or finer ones in [0, 1). Borders between shares are multiples of it
//! too, so that a share is taken with exactly the probability that is told, and each positive weight gets one
//! at least, so that nothing that shines is never taken; beyond four million weights some of the smallest may
//! go without, and are told to.

/// How many numbers there are.
const NUMBERS: f64 = (1u32 << 23) as f64;

/// The least share of a positive weight, before all are scaled to add up to 1: two numbers, of which scaling
/// and rounding leave one.
const LEAST: f64 = 2.0 / NUMBERS;

/// Shares of a whole, summed up.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Cumulative {
    /// From 0 to 1, one more than there are shares.
    borders: Vec<f32>,
}

impl Cumulative {
    /// Shares in proportion to weights, none of them negative; `None` where all of them are 0, or their sum
    /// is no number.
    pub(crate) fn new(weights: impl ExactSizeIterator<Item = f64> + Clone) -> Option<Self> {
        let total: f64 = weights.clone().sum();
        if !(total > 0.0 && total.is_finite()) {
            return None;
        }
        let share = |weight: f64| if weight > 0.0 { (weight / total).max(LEAST) } else { 0.0 };
        let whole: f64 = weights.clone().map(share).sum();
        let mut sum = 0.0;
        let mut borders = Vec::with_capacity(weights.len() + 1);
        borders.push(0.0);
        borders.extend(weights.map(|weight| {
            sum += share(weight);
            ((sum / whole * NUMBERS).round() / NUMBERS) as f32
        }));
        Some(Self { borders })
    }

    /// Which share a number in [0, 1) falls into, and where within it, in [0, 1).
    pub(crate) fn sample(&self, number: f32) -> (usize, f32) {
        let index =
            self.borders.partition_point(|border| *border <= number).clamp(1, self.borders.len() - 1) - 1;
        let (low, high) = (self.borders[index], self.borders[index + 1]);
        (index, ((number - low) / (high - low)).min(1.0 - f32::EPSILON))
    }

    /// With which [`Cumulative::sample`] takes a share.
    pub(crate) fn probability(&self, index: usize) -> f32 {
        self.borders[index + 1] - self.borders[index]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_follow_weights_and_empty_ones_are_never_taken() {
        let shares = Cumulative::new([0.0, 1.0, 0.0, 3.0, 0.0].into_iter()).expect("a total");
        let probabilities: Vec<f32> = (0..5).map(|index| shares.probability(index)).collect();
        assert_eq!(probabilities, [0.0, 0.25, 0.0, 0.75, 0.0]);
        assert_eq!(shares.sample(0.0), (1, 0.0));
        assert_eq!(shares.sample(0.125), (1, 0.5));
        assert_eq!(shares.sample(0.25), (3, 0.0));
        assert_eq!(shares.sample(1.0 - f32::EPSILON).0, 3);
    }

    #[test]
    fn every_weight_is_taken_with_the_probability_that_is_told() {
        let weights = [1e-30, 3.0, 0.0, 1e-9, 0.7, 1e-12, 1e-300, 0.0];
        let shares = Cumulative::new(weights.into_iter()).expect("a total");
        let mut taken = [0u32; 8];
        for number in 0..1u32 << 23 {
            taken[shares.sample(number as f32 / (1u32 << 23) as f32).0] += 1;
        }
        for (index, (weight, count)) in weights.into_iter().zip(taken).enumerate() {
            assert_eq!(count as f32 / (1u32 << 23) as f32, shares.probability(index), "{weight:e}");
            assert_eq!(count > 0, weight > 0.0, "{weight:e} is taken {count} times");
        }
        assert!((shares.probability(1) - 3.0 / 3.7).abs() < 1e-6);
    }

    #[test]
    fn many_small_weights_beside_a_large_one_are_all_taken() {
        let weights = || (0..300_000).map(|i: u32| if i == 150_000 { 1e12 } else { 1.0 });
        let shares = Cumulative::new(weights()).expect("a total");
        assert!((0..300_000).all(|index| shares.probability(index) > 0.0));
        let total: f64 = (0..300_000).map(|index| f64::from(shares.probability(index))).sum();
        assert_eq!(total, 1.0);
    }

    #[test]
    fn nothing_can_be_chosen_of_nothing() {
        for weights in [[0.0; 3], [1.0, f64::NAN, 1.0], [1.0, f64::INFINITY, 1.0], [f64::MAX; 3]] {
            assert_eq!(Cumulative::new(weights.into_iter()), None);
        }
        assert_eq!(Cumulative::new(std::iter::empty::<f64>().collect::<Vec<_>>().into_iter()), None);
    }
}
