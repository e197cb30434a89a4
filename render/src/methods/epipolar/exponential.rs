//! The exponential function as loops can have it that the compiler puts into vectors.

/// Added to a number, it leaves the nearest whole one in the lowest bits: `1.5 * 2^23`.
const ROUND: f32 = 12_582_912.0;
/// Of the Taylor series of `2^x`: `ln(2)^k / k!`, highest first.
const COEFFICIENTS: [f32; 6] =
    [1.540_353e-4, 1.333_355_8e-3, 9.618_129e-3, 5.550_411e-2, 2.402_265e-1, 6.931_472e-1];

/// `exp(x)`, to a few units in the last place of what `x / ln 2` is rounded to; of less than -87 the least
/// normal number or so, of more than 87 the largest power of two.
#[inline(always)]
pub fn exp(x: f32) -> f32 {
    let power = (x * std::f32::consts::LOG2_E).clamp(-126.0, 126.0);
    let rounded = power + ROUND;
    let rest = power - (rounded - ROUND);
    let mantissa = COEFFICIENTS.iter().fold(0.0, |sum, coefficient| (sum + coefficient) * rest) + 1.0;
    f32::from_bits(mantissa.to_bits().wrapping_add(rounded.to_bits() << 23))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_standard_librarys() {
        for i in -8600..=8600 {
            let x = i as f32 * 0.01;
            let expected = x.exp();
            let off = (exp(x) / expected - 1.0).abs();
            assert!(off < 3e-7 + 2e-7 * x.abs(), "{x}: {} is not {expected}", exp(x));
        }
        assert_eq!(exp(0.0), 1.0);
        assert!(exp(-1e30) < 2e-38 && exp(f32::INFINITY) > 8e37 && exp(f32::INFINITY).is_finite());
    }
}
