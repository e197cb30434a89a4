//! Random numbers of a pixel, counter based: the same as `shaders/wgsl/shared/random.wgsl`, bit for bit.

/// PCG's output permutation as a hash (Jarzynski and Olano 2020, "Hash Functions for GPU Rendering").
pub const fn hash(value: u32) -> u32 {
    let state = value.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

/// A number in [0, 1) for each pixel, seed and dimension.
pub const fn random(x: u32, y: u32, seed: u32, dimension: u32) -> f32 {
    let row = hash(y.wrapping_add(hash(seed.wrapping_add(hash(dimension)))));
    let bits = hash(x.wrapping_add(row));
    (bits >> 8) as f32 / 16_777_216.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_fill_the_unit_interval_evenly() {
        let numbers: Vec<f32> = (0..100u32).flat_map(|y| (0..100).map(move |x| random(x, y, 7, 1))).collect();
        let mean = numbers.iter().sum::<f32>() / numbers.len() as f32;
        // Standard error of the mean of 10,000 uniform numbers: 0.0029.
        assert!((mean - 0.5).abs() < 0.012, "mean {mean}");
        for tenth in 0..10 {
            let inside = numbers.iter().filter(|n| (**n * 10.0) as usize == tenth).count();
            assert!((850..1150).contains(&inside), "{inside} of 10,000 in tenth {tenth}");
        }
    }

    #[test]
    fn pixel_seed_and_dimension_each_matter() {
        let base = random(3, 5, 7, 1);
        for other in [random(4, 5, 7, 1), random(3, 6, 7, 1), random(3, 5, 8, 1), random(3, 5, 7, 0)] {
            assert!((base - other).abs() > 1e-6);
        }
        assert!((base - random(5, 3, 7, 1)).abs() > 1e-6, "x and y are not interchangeable");
    }
}
