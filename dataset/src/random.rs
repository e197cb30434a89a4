//! Counter-based random numbers: a value is a hash of what it is for, so that nothing depends on order or
//! threads.

use deepshade_shaders::split_mix::{STEP, finalised};

/// A hash of some words.
pub fn mix(words: &[u64]) -> u64 {
    words.iter().fold(0, |hash, word| finalised((hash ^ word).wrapping_add(STEP)))
}

/// A number in [0, 1) for some words.
pub fn uniform(words: &[u64]) -> f32 {
    (mix(words) >> 40) as f32 / (1u32 << 24) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_uniform_and_neighbours_independent() {
        let values: Vec<f32> = (0..10_000).map(|i| uniform(&[7, i])).collect();
        let mean = values.iter().sum::<f32>() / 10_000.0;
        let product = values.windows(2).map(|pair| pair[0] * pair[1]).sum::<f32>() / 9_999.0;
        // Four standard deviations of the mean (0.0029 each) and of the products.
        assert!((mean - 0.5).abs() < 0.012, "{mean}");
        assert!((product - 0.25).abs() < 0.01, "{product}");
    }
}
