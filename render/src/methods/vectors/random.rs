//! Random numbers of neighbouring pixels: those of [`random::random`], bit for bit.

use super::{Lanes, Words};
use deepshade_shaders::random;
use pulp::Simd;

/// What numbers of a row's pixels are drawn by, for a seed and a dimension.
pub fn random_row(y: u32, seed: u32, dimension: u32) -> u32 {
    random::hash(y.wrapping_add(random::hash(seed.wrapping_add(random::hash(dimension)))))
}

/// [`random::random`] for pixels in these columns of a row.
#[inline(always)]
pub fn random<S: Simd>(columns: Words<S>, row: u32) -> Lanes<S> {
    let bits = hash(columns + columns.all(row));
    // 24 bits, of which one more than fits is added for itself.
    let high = bits.shifted_right(bits.all(9)).to_float();
    let lowest = (bits.shifted_right(bits.all(8)) & bits.all(1)).to_float();
    high.mul_add(high.all(2.0), lowest) * high.all(1.0 / 16_777_216.0)
}

/// [`random::hash`].
#[inline(always)]
fn hash<S: Simd>(value: Words<S>) -> Words<S> {
    let state = value * value.all(747_796_405) + value.all(2_891_336_453);
    let amount = state.shifted_right(state.all(28)) + state.all(4);
    let word = (state.shifted_right(amount) ^ state) * state.all(277_803_737);
    word.shifted_right(word.all(22)) ^ word
}

#[cfg(test)]
mod tests {
    use super::*;
    use pulp::{Arch, WithSimd};

    /// Numbers of a row, from a column on.
    struct Draw<'a> {
        row: u32,
        into: &'a mut [f32],
    }

    impl WithSimd for Draw<'_> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) {
            for x in (0..self.into.len()).step_by(S::F32_LANES) {
                random(Words::count_from(simd, x as u32), self.row).store(&mut self.into[x..]);
            }
        }
    }

    #[test]
    fn numbers_are_those_of_single_pixels() {
        for (y, seed, dimension) in [(0, 0, 0), (3, 11, 5), (511, u32::MAX, 48)] {
            let mut found = vec![0.0; 1003];
            Arch::new().dispatch(Draw { row: random_row(y, seed, dimension), into: &mut found });
            let single: Vec<f32> = (0..1003).map(|x| random::random(x, y, seed, dimension)).collect();
            assert_eq!(found, single);
        }
    }
}
