//! Linear values as a picture: exposure and tone curve.

use crate::report::images::painted;
use deepshade_render::scotopic::Scotopic;
use deepshade_shaders::colour::luminance;
use deepshade_shaders::effect::LitBy;
use deepshade_shaders::{Effect, Planes};
use glam::Vec3;
use image::RgbImage;
use std::fmt;

/// How linear values become those of a screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exposure {
    /// As they are.
    Plain,
    /// Light, divided by `middle` and multiplied by 0.18, then compressed so that `white` becomes 1 (Reinhard
    /// et al. 2002, equations 2 and 4; their key is 0.18).
    Tone {
        /// Luminance that becomes a middle grey: the logarithmic mean.
        middle: f32,
        /// Luminance that becomes 1.
        white: f32,
    },
}

/// What is shown of a colour of luminance L: the colour times `scale` (1 + `stretch` l) / (1 + `compression`
/// l), where l is L times `scale`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curve {
    /// Factor of all light.
    pub scale: f32,
    /// How much brightness is compressed: 0 or 1.
    pub compression: f32,
    /// How much of that is taken back, so that white is white.
    pub stretch: f32,
}

/// What a middle grey reflects.
const KEY: f32 = 0.18;

impl Exposure {
    /// The exposure of an image: plain for what is no light, by its own brightness for light, and so
    /// that `white` becomes 1, without compression, where that is given.
    pub fn new(effect: Effect, image: &Planes, white: Option<f32>) -> Self {
        if let Some(white) = white {
            return Self::Tone { middle: KEY * white, white: f32::INFINITY };
        }
        if effect.lit_by() == LitBy::Nothing {
            return Self::Plain;
        }
        let luminances = (0..image.pixels()).map(|pixel| luminance(colour(image, pixel).into()));
        let lit: Vec<f32> = luminances.filter(|value| *value > 0.0 && value.is_finite()).collect();
        if lit.is_empty() {
            return Self::Plain;
        }
        let logarithms = lit.iter().map(|value| f64::from(value.ln()));
        let middle = (logarithms.sum::<f64>() / lit.len() as f64).exp() as f32;
        let white = lit.iter().copied().fold(0.0, f32::max);
        Self::Tone { middle, white }
    }

    /// The same, brighter by so many stops.
    #[cfg(feature = "view")]
    pub fn brighter(self, stops: f32) -> Self {
        match self {
            Self::Plain if stops == 0.0 => Self::Plain,
            Self::Plain => Self::Tone { middle: KEY * (-stops).exp2(), white: f32::INFINITY },
            Self::Tone { middle, white } => Self::Tone { middle: middle * (-stops).exp2(), white },
        }
    }

    /// The picture of an image, sRGB, and by which eyes in the dark it is seen, if any.
    pub fn picture(self, image: &Planes, eyes: Option<&Scotopic>) -> RgbImage {
        let Some(eyes) = eyes else { return painted(image, |pixel| self.shown(colour(image, pixel))) };
        let width = image.width();
        let pixels: Vec<Vec3> = (0..image.pixels()).map(|pixel| self.shown(colour(image, pixel))).collect();
        let screen = Planes::from_fn(3, image.height(), width, |c, y, x| pixels[y * width + x][c].min(1.0));
        let seen = eyes.seen(&screen);
        painted(&seen, |pixel| colour(&seen, pixel))
    }

    /// The curve, for whoever draws by it.
    pub fn curve(self) -> Curve {
        match self {
            Self::Plain => Curve { scale: 1.0, compression: 0.0, stretch: 0.0 },
            Self::Tone { middle, white } if white.is_infinite() => {
                Curve { scale: KEY / middle, compression: 0.0, stretch: 0.0 }
            }
            Self::Tone { middle, white } => {
                let scale = KEY / middle;
                Curve { scale, compression: 1.0, stretch: (white * scale).max(1.0).powi(-2) }
            }
        }
    }

    /// The linear colour on the screen.
    fn shown(self, colour: Vec3) -> Vec3 {
        let Curve { scale, compression, stretch } = self.curve();
        let bright = luminance(colour.into()) * scale;
        colour * scale * (1.0 + bright * stretch) / (1.0 + bright * compression)
    }
}

impl fmt::Display for Exposure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Plain => f.write_str("linear values as they are"),
            Self::Tone { middle, white } if white.is_infinite() => {
                write!(f, "exposed so that {} is white", middle / KEY)
            }
            Self::Tone { middle, white } => {
                write!(
                    f,
                    "exposed so that {middle:.4} is middle grey, compressed so that {white:.3} is white"
                )
            }
        }
    }
}

/// A pixel's colour; grey where there is one channel.
fn colour(image: &Planes, pixel: usize) -> Vec3 {
    let last = image.channels() - 1;
    Vec3::from_array([0, 1, 2].map(|channel: usize| image.plane(channel.min(last))[pixel]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(values: &[f32]) -> Planes {
        Planes::from_fn(3, 1, values.len(), |_, _, x| values[x])
    }

    #[test]
    fn brightness_of_the_scene_does_not_matter() {
        let (dim, bright) = (grey(&[0.01, 0.02, 0.08]), grey(&[10.0, 20.0, 80.0]));
        let picture = |image: &Planes| Exposure::new(Effect::Path, image, None).picture(image, None);
        assert_eq!(picture(&dim), picture(&bright));
        let levels: Vec<u8> = picture(&dim).pixels().map(|pixel| pixel.0[0]).collect();
        assert!(levels.is_sorted() && levels[0] > 20 && levels[2] < 255, "{levels:?}");
    }

    #[test]
    fn white_is_white_and_hue_stays() {
        let exposure = Exposure::Tone { middle: 0.1, white: 50.0 };
        assert!((luminance(exposure.shown(Vec3::splat(50.0)).into()) - 1.0).abs() < 1e-5);
        let shown = exposure.shown(Vec3::new(2.0, 1.0, 0.5));
        assert!((shown.x / shown.y - 2.0).abs() < 1e-5 && (shown.y / shown.z - 2.0).abs() < 1e-5);
        let asked = Exposure::new(Effect::Path, &grey(&[1.0]), Some(4.0));
        assert!((asked.shown(Vec3::splat(2.0)) - Vec3::splat(0.5)).length() < 1e-6);
    }

    #[test]
    fn shares_and_darkness_are_shown_as_they_are() {
        assert_eq!(Exposure::new(Effect::Ao, &Planes::filled(1, 1, 2, 0.3), None), Exposure::Plain);
        assert_eq!(Exposure::new(Effect::Path, &grey(&[0.0, 0.0]), None), Exposure::Plain);
        let picture = Exposure::Plain.picture(&Planes::from_data(1, 1, 2, vec![0.0, 1.0]), None);
        assert_eq!((picture.get_pixel(0, 0).0, picture.get_pixel(1, 0).0), ([0; 3], [255; 3]));
    }
}
