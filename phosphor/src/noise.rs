//! Random numbers of the measurements that are simulated: a function of seed and counter.

use deepshade_shaders::split_mix::{STEP, finalised};

/// Numbers drawn one after the other.
#[derive(Clone, Debug)]
pub struct Noise {
    state: u64,
}

impl Noise {
    /// The numbers of a seed.
    pub const fn new(seed: u64) -> Self {
        Self { state: finalised(seed.wrapping_add(STEP)) }
    }

    /// A number in (0, 1), evenly.
    pub fn uniform(&mut self) -> f64 {
        self.state = self.state.wrapping_add(STEP);
        ((finalised(self.state) >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }

    /// A number of the standard normal distribution (Box and Muller 1958).
    pub fn normal(&mut self) -> f64 {
        let (radius, angle) = ((-2.0 * self.uniform().ln()).sqrt(), std::f64::consts::TAU * self.uniform());
        radius * angle.cos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_numbers_are_normal() {
        let mut noise = Noise::new(5);
        let numbers: Vec<f64> = (0..100_000).map(|_| noise.normal()).collect();
        let mean = |power: i32| numbers.iter().map(|n| n.powi(power)).sum::<f64>() / numbers.len() as f64;
        // Four standard errors each.
        assert!(mean(1).abs() < 0.0127 && (mean(2) - 1.0).abs() < 0.018 && (mean(4) - 3.0).abs() < 0.124);
        let inside = numbers.iter().filter(|n| n.abs() < 1.959_964).count();
        assert!((94_720..95_280).contains(&inside), "{inside}");
    }

    #[test]
    fn seeds_differ() {
        assert_ne!(Noise::new(1).uniform(), Noise::new(2).uniform());
        assert_eq!(Noise::new(3).uniform(), Noise::new(3).uniform());
    }
}
