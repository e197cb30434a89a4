//! Linear colours of Rec. 709 (ITU-R BT.709) primaries, as files and screens want them.

use std::sync::LazyLock;

/// The sRGB encoding (IEC 61966-2-1) of a linear value, both in [0, 1]; what is outside is taken as the
/// nearer end.
pub fn srgb_encoded(linear: f32) -> f32 {
    let linear = linear.clamp(0.0, 1.0);
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// The sRGB byte of a linear value; what is not a number is 0.
pub fn srgb_byte(linear: f32) -> u8 {
    (255.0 * srgb_encoded(linear)).round() as u8
}

/// The linear value of an sRGB encoded one (IEC 61966-2-1), both in [0, 1].
pub fn srgb_decoded(encoded: f32) -> f32 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// Linear values of the 256 sRGB bytes, from 0 to 1.
pub static LINEAR_OF_SRGB: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|byte| srgb_decoded(byte as f32 / 255.0)));

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
    fn every_byte_is_what_its_linear_value_is_encoded_as() {
        assert!((0..=255u8).all(|byte| srgb_byte(LINEAR_OF_SRGB[byte as usize]) == byte));
        assert_eq!((LINEAR_OF_SRGB[0], LINEAR_OF_SRGB[255]), (0.0, 1.0));
    }

    #[test]
    fn white_has_a_luminance_of_one_and_green_most_of_it() {
        assert!((luminance([1.0; 3]) - 1.0).abs() < 1e-6);
        assert!(luminance([0.0, 1.0, 0.0]) > 2.0 * luminance([1.0, 0.0, 1.0]));
    }
}
