//! At which values of `gamma` the light rays of all slices are: denser towards the line from the eye to the
//! light, since view rays near it cross none that are farther away.

use super::super::shafts::TOGETHER;
use super::prefilter::SAMPLES;

/// Where light rays are.
#[derive(Clone, Debug)]
pub struct Spacing {
    /// The least `gamma` of what is seen,
    first: f32,
    /// and from there to the greatest.
    reach: f32,
    /// How many light rays there are.
    pub count: usize,
    /// `gamma` in the middle of the first sample of each light ray, of the second, and so on; of whole
    /// blocks, the last of which may go on behind the last light ray.
    pub samples: [Vec<f32>; SAMPLES],
    /// `gamma` in the middle of each light ray.
    pub middles: Vec<f32>,
}

/// How far light rays are from each other at the first, as a share of what they are on average; from there it
/// grows linearly.
const DENSEST: f32 = 0.1;

impl Spacing {
    /// `count` light rays between two values.
    pub fn between([first, last]: [f32; 2], count: usize) -> Self {
        let mut spacing =
            Self { first, reach: last - first, count, samples: Default::default(), middles: Vec::new() };
        spacing.samples = std::array::from_fn(|sample| {
            let part = (sample as f32 + 0.5) / SAMPLES as f32;
            (0..count.next_multiple_of(TOGETHER)).map(|ray| spacing.gamma(ray as f32 + part)).collect()
        });
        spacing.middles = (0..count).map(|ray| spacing.gamma(ray as f32 + 0.5)).collect();
        spacing
    }

    /// `gamma` of a fractional number of light rays.
    #[inline(always)]
    pub fn gamma(&self, number: f32) -> f32 {
        let share = number / self.count as f32;
        self.first + self.reach * share * (DENSEST + (1.0 - DENSEST) * share)
    }

    /// Which fractional light ray is at a value of `gamma`.
    #[inline(always)]
    pub fn number(&self, gamma: f32) -> f32 {
        let passed = ((gamma - self.first) / self.reach).max(0.0);
        let root = (DENSEST * DENSEST + 4.0 * (1.0 - DENSEST) * passed).sqrt();
        // The quadratic formula without a difference of almost equal numbers.
        self.count as f32 * 2.0 * passed / (DENSEST + root)
    }

    /// From the beginning of a light ray to its end, in units of `gamma`.
    pub fn width(&self, ray: usize) -> f32 {
        self.gamma(ray as f32 + 1.0) - self.gamma(ray as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_found_again_and_rays_are_densest_at_the_first() {
        let spacing = Spacing::between([0.7, 5.2], 1000);
        for i in 0..=2000 {
            let number = 0.5 * i as f32;
            let found = spacing.number(spacing.gamma(number));
            assert!((found - number).abs() < 2e-2, "{found} is not {number}");
        }
        assert!((spacing.gamma(0.0) - 0.7).abs() < 1e-6 && (spacing.gamma(1000.0) - 5.2).abs() < 1e-5);
        let mean = 4.5e-3;
        assert!((spacing.width(0) / mean - DENSEST).abs() < 0.01, "{}", spacing.width(0));
        assert!((spacing.width(999) / mean - (2.0 - DENSEST)).abs() < 0.01, "{}", spacing.width(999));
        let all: f32 = (0..1000).map(|ray| spacing.width(ray)).sum();
        assert!((all - 4.5).abs() < 1e-3, "{all}");
        assert!(spacing.samples[3][999] < 5.2 && spacing.samples[3][999] > spacing.middles[999]);
    }
}
