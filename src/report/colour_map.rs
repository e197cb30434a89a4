//! Colour maps whose lightness grows evenly with what they show: straight lines in Oklab (Ottosson 2020),
//! given by lightness, chroma and hue. Both are dark where there is no error.

use deepshade_shaders::colour::srgb_byte;
use glam::{Mat3, Vec3};
use std::fmt::Write;

/// A colour in Oklab's cylinder: lightness in [0, 1], chroma, hue in degrees.
type Lch = [f32; 3];

const DARKEST: f32 = 0.12;

/// Errors from 0 to 1: black, violet, red, orange, pale yellow.
const SEQUENTIAL: [Lch; 5] = [
    [DARKEST, 0.02, 285.0],
    [0.33, 0.15, 300.0],
    [0.54, 0.2, 370.0],
    [0.76, 0.16, 415.0],
    [0.97, 0.07, 460.0],
];
/// Differences below 0: ever lighter blue.
const NEGATIVE: [Lch; 3] = [[DARKEST, 0.0, 250.0], [0.54, 0.14, 250.0], [0.93, 0.05, 215.0]];
/// Differences above 0: ever lighter orange, as light as the blue for the same size.
const POSITIVE: [Lch; 3] = [[DARKEST, 0.0, 45.0], [0.54, 0.14, 50.0], [0.93, 0.07, 85.0]];

/// The linear colour of an error in [0, 1].
pub fn sequential(value: f32) -> Vec3 {
    along(&SEQUENTIAL, value)
}

/// The linear colour of a difference in [-1, 1].
pub fn diverging(value: f32) -> Vec3 {
    if value < 0.0 { along(&NEGATIVE, -value) } else { along(&POSITIVE, value) }
}

/// A colour map from `from` to `to` as a list of stops for a CSS gradient.
pub fn css_stops(map: impl Fn(f32) -> Vec3, from: f32, to: f32) -> String {
    const STOPS: usize = 24;
    let mut css = String::new();
    for stop in 0..=STOPS {
        let at = from + (to - from) * stop as f32 / STOPS as f32;
        let [r, g, b] = map(at).to_array().map(srgb_byte);
        let comma = if stop == 0 { "" } else { "," };
        write!(css, "{comma}#{r:02x}{g:02x}{b:02x}").expect("a string takes everything");
    }
    css
}

/// The linear colour at a share of a way through evenly spaced colours.
fn along(colours: &[Lch], share: f32) -> Vec3 {
    let steps = colours.len() - 1;
    // What is not a number is not above 0 either.
    let share = if share > 0.0 { share.min(1.0) } else { 0.0 };
    let at = share * steps as f32;
    let step = (at as usize).min(steps - 1);
    let lch = Vec3::from(colours[step]).lerp(Vec3::from(colours[step + 1]), at - step as f32);
    linear_from_oklab(lch)
}

/// Linear sRGB, in [0, 1], from Oklab's cylinder.
fn linear_from_oklab(lch: Vec3) -> Vec3 {
    let (sin, cos) = lch.z.to_radians().sin_cos();
    let lab = Vec3::new(lch.x, lch.y * cos, lch.y * sin);
    let roots = Mat3::from_cols(
        Vec3::ONE,
        Vec3::new(0.396_337_78, -0.105_561_346, -0.089_484_18),
        Vec3::new(0.215_803_76, -0.063_854_17, -1.291_485_5),
    ) * lab;
    let linear = Mat3::from_cols(
        Vec3::new(4.076_741_7, -1.268_438, -0.004_196_086_3),
        Vec3::new(-3.307_711_6, 2.609_757_4, -0.703_418_6),
        Vec3::new(0.230_969_94, -0.341_319_38, 1.707_614_7),
    ) * (roots * roots * roots);
    linear.clamp(Vec3::ZERO, Vec3::ONE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_shaders::colour::luminance;

    #[test]
    fn oklab_white_is_white() {
        let white = linear_from_oklab(Vec3::new(1.0, 0.0, 0.0));
        assert!((white - Vec3::ONE).abs().max_element() < 1e-3, "{white}");
    }

    #[test]
    fn larger_errors_are_lighter() {
        for map in [sequential, diverging, |value: f32| diverging(-value)] {
            let steps: Vec<f32> = (0..=20).map(|i| luminance(map(i as f32 / 20.0).into())).collect();
            assert!(steps.windows(2).all(|pair| pair[1] > pair[0]), "{steps:?}");
        }
    }

    #[test]
    fn signs_are_told_apart_and_ends_are_clamped() {
        let (below, above) = (diverging(-0.5), diverging(0.5));
        assert!(below.z > below.x && above.x > above.z);
        assert_eq!(sequential(7.0), sequential(1.0));
        assert_eq!(sequential(f32::NAN), sequential(0.0));
    }
}
