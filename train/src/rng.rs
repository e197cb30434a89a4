//! Counter-based random numbers: a number is a function of its seed and of what it is for, so that a run that
//! is resumed draws what it would have drawn.

use deepshade_shaders::split_mix::{STEP, finalised};

/// What a number is drawn for; two purposes never share a number.
#[derive(Clone, Copy, Debug)]
pub enum Purpose {
    /// First weights; the counter is the layer.
    Weights,
    /// The order of pairs; the counter is the epoch.
    Order,
    /// Crop and symmetry; the counter is the position in the run.
    Crop,
}

/// A stream of random numbers.
#[derive(Clone, Debug)]
pub struct Rng {
    state: u64,
}

impl Rng {
    /// The stream of a seed, a purpose and a counter.
    pub fn new(seed: u64, purpose: Purpose, counter: u64) -> Self {
        Self { state: finalised(finalised(finalised(seed) ^ purpose as u64) ^ counter) }
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(STEP);
        finalised(self.state)
    }

    /// A number in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A whole number below `end`, which is far below 2^53.
    pub fn below(&mut self, end: usize) -> usize {
        (self.unit() * end as f64) as usize
    }

    /// A number of the standard normal distribution (Box and Muller 1958).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.unit()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.unit()).cos()
    }

    /// The numbers from 0 to `count - 1` in random order (Fisher and Yates).
    pub fn permutation(&mut self, count: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..count).collect();
        for last in (1..count).rev() {
            order.swap(last, self.below(last + 1));
        }
        order
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_those_of_the_normal_distribution() {
        let mut rng = Rng::new(1, Purpose::Weights, 0);
        let draws: Vec<f64> = (0..20_000).map(|_| rng.normal()).collect();
        let mean = draws.iter().sum::<f64>() / draws.len() as f64;
        let variance = draws.iter().map(|d| d * d).sum::<f64>() / draws.len() as f64;
        assert!(mean.abs() < 0.03 && (variance - 1.0).abs() < 0.05, "mean {mean}, variance {variance}");
    }

    #[test]
    fn a_permutation_holds_everything_once_and_streams_differ() {
        let order = Rng::new(3, Purpose::Order, 0).permutation(50);
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, (0..50).collect::<Vec<_>>());
        assert_ne!(order, Rng::new(3, Purpose::Order, 1).permutation(50));
        assert_ne!(order, Rng::new(4, Purpose::Order, 0).permutation(50));
        assert_ne!(order, Rng::new(3, Purpose::Crop, 0).permutation(50));
    }
}
