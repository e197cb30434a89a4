//! Choice of one of many by their weights, by inversion, which keeps the stratification of the numbers put in.

/// Shares of a whole, summed up.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Cumulative {
    /// From 0 to 1, one more than there are shares.
    borders: Vec<f32>,
}

impl Cumulative {
    /// Shares in proportion to weights, none of them negative; `None` where all of them are 0.
    pub(crate) fn new(weights: impl ExactSizeIterator<Item = f64> + Clone) -> Option<Self> {
        let total: f64 = weights.clone().sum();
        if total <= 0.0 {
            return None;
        }
        let mut sum = 0.0;
        let mut borders = Vec::with_capacity(weights.len() + 1);
        borders.push(0.0);
        borders.extend(weights.map(|weight| {
            sum += weight;
            (sum / total).min(1.0) as f32
        }));
        // Rounding may leave the last border that matters below 1, which no number in [0, 1) may reach.
        let reached = borders.last().copied().unwrap_or_default();
        borders.iter_mut().filter(|border| **border == reached).for_each(|border| *border = 1.0);
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
    fn nothing_can_be_chosen_of_nothing() {
        assert_eq!(Cumulative::new([0.0; 3].into_iter()), None);
        assert_eq!(Cumulative::new(std::iter::empty::<f64>().collect::<Vec<_>>().into_iter()), None);
    }
}
