//! How different two colours look: CIEDE2000 (CIE 142-2001), which Figure 8.13 of the thesis states.

use palette::color_difference::Ciede2000;
use palette::{FromColor, Lab, LinSrgb, white_point::D65};

/// The CIEDE2000 difference of two linear sRGB colours, white being luminance 1. Parts outside [0, 1] count
/// as they are.
pub fn ciede2000(a: [f64; 3], b: [f64; 3]) -> f64 {
    let lab = |[red, green, blue]: [f64; 3]| Lab::<D65, f64>::from_color(LinSrgb::new(red, green, blue));
    lab(a).difference(lab(b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_and_black_are_a_hundred_apart() {
        assert!((ciede2000([1.0; 3], [0.0; 3]) - 100.0).abs() < 0.01);
        assert_eq!(ciede2000([0.2, 0.4, 0.1], [0.2, 0.4, 0.1]), 0.0);
        assert!(ciede2000([0.2, 0.4, 0.1], [0.1, 0.4, 0.2]) > 5.0);
    }
}
