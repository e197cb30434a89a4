//! How different two colours look: CIEDE2000 (CIE 142-2001), which Figure 8.13 of the thesis states.

use palette::color_difference::Ciede2000;
use palette::{FromColor, Lab, LinSrgb, white_point::D65};

/// The CIEDE2000 difference of two linear sRGB colours, white being luminance 1. Parts outside [0, 1] count as they
/// are.
pub fn ciede2000(a: [f64; 3], b: [f64; 3]) -> f64 {
    let lab = |[red, green, blue]: [f64; 3]| Lab::<D65, f64>::from_color(LinSrgb::new(red, green, blue));
    lab(a).difference(lab(b))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pairs of Sharma, Wu and Dalal 2005, "The CIEDE2000 Color-Difference Formula", Table 1, among them those on both
    /// sides of the hue's jumps.
    #[test]
    fn differences_are_the_published_ones() {
        let pairs = [
            ([50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485], 2.0425),
            ([50.0, -1.3802, -84.2814], [50.0, 0.0, -82.7485], 1.0000),
            ([50.0, 0.0, 0.0], [50.0, -1.0, 2.0], 2.3669),
            ([50.0, 2.4900, -0.0010], [50.0, -2.4900, 0.0009], 7.1792),
            ([50.0, 2.4900, -0.0010], [50.0, -2.4900, 0.0011], 7.2195),
            ([50.0, 2.5, 0.0], [73.0, 25.0, -18.0], 27.1492),
            ([50.0, 2.5, 0.0], [58.0, 24.0, 15.0], 19.4535),
            ([60.2574, -34.0099, 36.2677], [60.4626, -34.1751, 39.4387], 1.2644),
            ([22.7233, 20.0904, -46.6940], [23.0331, 14.9730, -42.5619], 2.0373),
            ([90.8027, -2.0831, 1.4410], [91.1528, -1.6435, 0.0447], 1.4441),
            ([2.0776, 0.0795, -1.1350], [0.9033, -0.0636, -0.5514], 0.9082),
        ];
        for (a, b, expected) in pairs {
            let lab = |[l, a, b]: [f64; 3]| Lab::<D65, f64>::new(l, a, b);
            let difference = lab(a).difference(lab(b));
            assert!((difference - expected).abs() < 1e-4, "{a:?} {b:?}: {difference}");
        }
    }

    #[test]
    fn white_and_black_are_a_hundred_apart() {
        assert!((ciede2000([1.0; 3], [0.0; 3]) - 100.0).abs() < 0.01);
        assert_eq!(ciede2000([0.2, 0.4, 0.1], [0.2, 0.4, 0.1]), 0.0);
        assert!(ciede2000([0.2, 0.4, 0.1], [0.1, 0.4, 0.2]) > 5.0);
    }
}
