//! Linear colours of Rec. 709 (ITU-R BT.709) primaries, as files and screens want them.

/// The sRGB encoding (IEC 61966-2-1) of a linear value, both in [0, 1]; what is outside is taken as the nearer end.
pub fn srgb_encoded(linear: f32) -> f32 {
    let linear = linear.clamp(0.0, 1.0);
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// The sRGB byte of a linear value; what is not a number is 0.
pub fn srgb_byte(linear: f32) -> u8 {
    (255.0 * srgb_encoded(linear)).round() as u8
}

/// Luminance of a linear colour, relative to that of white.
pub fn luminance([red, green, blue]: [f32; 3]) -> f32 {
    0.2126 * red + 0.7152 * green + 0.0722 * blue
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_srgb() {
        let values = [-1.0, 0.0, 0.001, 0.214_041_14, 1.0, 7.0, f32::NAN];
        assert_eq!(values.map(srgb_byte), [0, 0, 3, 128, 255, 255, 0]);
    }

    #[test]
    fn white_has_a_luminance_of_one_and_green_most_of_it() {
        assert!((luminance([1.0; 3]) - 1.0).abs() < 1e-6);
        assert!(luminance([0.0, 1.0, 0.0]) > 2.0 * luminance([1.0, 0.0, 1.0]));
    }
}
