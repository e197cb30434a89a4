//! Random numbers for building scenes, by SplitMix64: a seed gives the same whole numbers on every machine.

use deepshade_shaders::split_mix::{STEP, finalised};
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// A seeded stream of random numbers.
#[derive(Clone, Debug)]
pub struct Random {
    counter: u64,
}

impl Random {
    /// The stream number `stream` of `seed`; streams of one seed have nothing to do with each other.
    pub fn new(stream: u64, seed: u64) -> Self {
        Self { counter: finalised(finalised(seed.wrapping_add(STEP)) ^ stream.wrapping_mul(STEP)) }
    }

    /// 32 random bits.
    pub fn bits(&mut self) -> u32 {
        self.counter = self.counter.wrapping_add(STEP);
        (finalised(self.counter) >> 32) as u32
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 8) as f32 / (1 << 24) as f32
    }

    /// Uniform in [low, high).
    pub fn within(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// A whole number from low to high, both possible.
    pub fn count(&mut self, low: usize, high: usize) -> usize {
        low + ((u64::from(self.bits()) * (high - low + 1) as u64) >> 32) as usize
    }

    /// True with this probability.
    pub fn chance(&mut self, probability: f32) -> bool {
        self.unit() < probability
    }

    /// One of the things in a list that is not empty.
    pub fn pick<T: Copy>(&mut self, things: &[T]) -> T {
        things[self.count(0, things.len() - 1)]
    }

    /// An angle of a full turn, radians.
    pub fn angle(&mut self) -> f32 {
        self.within(0.0, TAU)
    }

    /// Uniform on the unit sphere.
    pub fn direction(&mut self) -> Vec3 {
        let y = self.within(-1.0, 1.0);
        let around = Vec2::from_angle(self.angle()) * (1.0 - y * y).max(0.0).sqrt();
        Vec3::new(around.x, y, around.y)
    }

    /// Uniform in a disc around the origin.
    pub fn in_disc(&mut self, radius: f32) -> Vec2 {
        let distance = radius * self.unit().sqrt();
        Vec2::from_angle(self.angle()) * distance
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stay_in_range_with_the_right_mean() {
        let mut random = Random::new(1, 2);
        let values: Vec<f32> = (0..10_000).map(|_| random.within(-1.0, 3.0)).collect();
        assert!(values.iter().all(|value| (-1.0..3.0).contains(value)));
        assert!((values.iter().sum::<f32>() / 10_000.0 - 1.0).abs() < 0.05);
        let mut seen = [0; 4];
        (0..1000).for_each(|_| seen[random.count(2, 5) - 2] += 1);
        assert!(seen.iter().all(|times| *times > 180));
        assert!((0..100).all(|_| (random.direction().length() - 1.0).abs() < 1e-5));
    }

    #[test]
    fn streams_and_seeds_differ() {
        let first = |stream, seed| Random::new(stream, seed).bits();
        assert_ne!(first(0, 1), first(1, 1));
        assert_ne!(first(0, 1), first(0, 2));
        assert_ne!(first(0, 1), first(1, 0));
        assert_eq!(first(3, 4), first(3, 4));
    }
}
