//! What colours values have on a contact sheet.

use deepshade_shaders::colour::srgb_byte;

/// A colour of a picture, sRGB.
pub type Rgb = [u8; 3];

/// How the values of a column become colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Paint {
    /// One plane, from black to white.
    Grey,
    /// One plane, blue below 0, black at 0, orange above.
    Signed,
    /// Red, green and blue, encoded as sRGB.
    Colour,
    /// Direction in [0, pi), as hue around the circle, and length, as brightness.
    Motion,
}

impl Paint {
    /// The colour of the mean of some pixels of `planes`; the range goes to the ends of the colours.
    pub fn mean(
        self,
        planes: &[&[f32]],
        pixels: impl Iterator<Item = usize>,
        (low, high): (f32, f32),
    ) -> Rgb {
        let mut count = 0.0;
        let mut sum = [0.0; 3];
        for pixel in pixels {
            count += 1.0;
            match self {
                Self::Motion => {
                    let colour = wheel(planes[0][pixel], planes[1][pixel] / high);
                    (0..3).for_each(|c| sum[c] += colour[c]);
                }
                _ => planes.iter().zip(&mut sum).for_each(|(plane, sum)| *sum += plane[pixel]),
            }
        }
        let mean = sum.map(|sum| sum / count);
        let share = |value: f32| (value - low) / (high - low);
        match self {
            Self::Grey => [byte(share(mean[0])); 3],
            Self::Signed => signed(mean[0] / high),
            Self::Colour => mean.map(|value| srgb_byte(share(value))),
            Self::Motion => mean.map(byte),
        }
    }
}

/// The nearest byte of a number in [0, 1]; what is not a number is 0.
fn byte(value: f32) -> u8 {
    (255.0 * value).round() as u8
}

/// Blue for -1, black for 0, orange for 1.
fn signed(value: f32) -> Rgb {
    let end = if value < 0.0 { [0.25, 0.55, 1.0] } else { [1.0, 0.6, 0.15] };
    end.map(|channel: f32| byte(channel * value.abs()))
}

/// The colour of a direction in [0, pi) and a share of the greatest length. Opposite directions are the same,
/// so that half a turn goes once around the hues.
fn wheel(direction: f32, length: f32) -> [f32; 3] {
    let hue = direction / std::f32::consts::PI;
    [0.0, 2.0 / 3.0, 1.0 / 3.0].map(|offset| {
        let distance = ((hue + offset).rem_euclid(1.0) * 6.0 - 3.0).abs() - 1.0;
        distance.clamp(0.0, 1.0) * length.clamp(0.0, 1.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hues_go_around_once_in_half_a_turn() {
        assert_eq!(wheel(0.0, 1.0), [1.0, 0.0, 0.0]);
        let third = wheel(std::f32::consts::PI / 3.0, 1.0);
        assert!(third[1] > 0.99 && third[0] < 0.01 && third[2] < 0.01, "{third:?}");
        let end = wheel(std::f32::consts::PI - 1e-4, 0.5);
        assert!((end[0] - 0.5).abs() < 1e-3 && end[1] < 1e-3, "{end:?}: as at the beginning, half as bright");
    }

    #[test]
    fn means_are_of_values_and_not_of_numbers() {
        let planes: [&[f32]; 1] = [&[0.0, 1.0, 0.25]];
        assert_eq!(Paint::Grey.mean(&planes, 0..2, (0.0, 1.0)), [128; 3]);
        assert_eq!(Paint::Grey.mean(&planes, 2..3, (0.0, 0.5)), [128; 3]);
        assert_eq!(Paint::Signed.mean(&planes, 0..1, (-1.0, 1.0)), [0; 3]);
        let colour: [&[f32]; 3] = [&[0.214_041_14], &[0.0], &[9.0]];
        assert_eq!(Paint::Colour.mean(&colour, 0..1, (0.0, 1.0)), [128, 0, 255]);
    }
}
