//! Peak signal-to-noise ratio.

use super::mean_over_values;
use deepshade_shaders::Planes;

/// Most that is given, decibels: 32-bit floats hardly tell images apart that differ by less, and one infinite
/// value would make every mean infinite.
pub const MOST: f64 = 100.0;

/// Peak signal-to-noise ratio of values in a range of 1, decibels: `10 log10(1 / mean squared error)`,
/// [`MOST`] at most, which is what equal images have.
///
/// # Panics
/// If the images differ in shape.
pub fn psnr(a: &Planes, b: &Planes) -> f64 {
    let error = mean_over_values(a, b, |a, b| (a - b) * (a - b));
    // A comparison, not `min`, which would hide that an error is no number.
    let decibels = -10.0 * error.log10();
    if decibels > MOST { MOST } else { decibels }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_offset_has_its_closed_form() {
        let a = Planes::from_fn(3, 5, 7, |c, y, x| (c + y * x) as f32 / 64.0);
        let b = Planes::from_fn(3, 5, 7, |c, y, x| (c + y * x) as f32 / 64.0 + 0.125);
        assert!((psnr(&a, &b) - 20.0 * 8f64.log10()).abs() < 1e-12);
        assert_eq!(psnr(&a, &a), MOST);
        let nearly = Planes::from_fn(3, 5, 7, |c, y, x| a.at(c, y, x) + 1e-6);
        assert_eq!(psnr(&a, &nearly), MOST);
        let broken = Planes::filled(3, 5, 7, f32::NAN);
        assert!(psnr(&a, &broken).is_nan());
    }
}
