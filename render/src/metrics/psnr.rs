//! Peak signal-to-noise ratio.

use super::mean_over_values;
use deepshade_shaders::Planes;

/// Peak signal-to-noise ratio of values in a range of 1, decibels: `10 log10(1 / mean squared error)`; infinite
/// where the images are equal.
///
/// # Panics
/// If the images differ in shape.
pub fn psnr(a: &Planes, b: &Planes) -> f64 {
    -10.0 * mean_over_values(a, b, |a, b| (a - b) * (a - b)).log10()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_offset_has_its_closed_form() {
        let a = Planes::from_fn(3, 5, 7, |c, y, x| (c + y * x) as f32 / 64.0);
        let b = Planes::from_fn(3, 5, 7, |c, y, x| (c + y * x) as f32 / 64.0 + 0.125);
        assert!((psnr(&a, &b) - 20.0 * 8f64.log10()).abs() < 1e-12);
        assert_eq!(psnr(&a, &a), f64::INFINITY);
    }
}
