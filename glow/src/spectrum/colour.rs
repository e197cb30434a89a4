//! From bands to linear sRGB and back.

use super::observer::matching;
use super::{Axis, Bands};

/// Linear sRGB of XYZ (IEC 61966-2-1; white is D65 of luminance 1).
const SRGB_OF_XYZ: [[f64; 3]; 3] = [
    [3.240_625_5, -1.537_208, -0.498_628_6],
    [-0.968_930_7, 1.875_756_1, 0.041_517_5],
    [0.055_710_1, -0.204_021_1, 1.056_995_9],
];

/// The spectra of [`Bands::Eight`] whose colours are red, green and blue: of those that are nowhere negative
/// the smoothest ones (`deepshade-phosphor` solves for them in a test).
const PRIMARIES: [[f64; 8]; 3] = [
    [
        0.052_220_832_823_951_31,
        0.010_632_023_131_250_818,
        0.0,
        0.0,
        0.040_366_914_495_453_335,
        0.697_607_011_981_374_8,
        0.991_702_351_450_567_5,
        1.015_882_250_867_357_3,
    ],
    [
        0.0,
        0.0,
        0.616_279_569_809_966_9,
        1.188_353_770_233_273_2,
        0.837_529_106_438_383_2,
        0.147_956_442_799_867_78,
        0.0,
        0.0,
    ],
    [
        1.194_957_696_351_201_6,
        1.014_406_474_987_081_1,
        0.470_624_688_898_365_2,
        0.005_027_678_925_265_823,
        0.0,
        0.006_095_325_851_632_808,
        0.039_601_302_747_050_54,
        0.040_959_281_446_567_464,
    ],
];

impl Axis {
    /// XYZ of one unit in each band: a spectrum of 1 everywhere has luminance 1.
    pub fn xyz(&self) -> [Vec<f64>; 3] {
        let mut means: [Vec<f64>; 3] =
            std::array::from_fn(|i| self.means(|wavelength| matching(wavelength)[i]));
        let luminance: f64 = means[1].iter().sum();
        means.iter_mut().flatten().for_each(|value| *value /= luminance);
        means
    }

    /// The linear sRGB colour of a spectrum, one value a band. Colours that screens lack have negative parts.
    pub fn linear_srgb(&self, spectrum: &[f64]) -> [f64; 3] {
        let xyz = self.xyz().map(|weights| weights.iter().zip(spectrum).map(|(a, b)| a * b).sum::<f64>());
        SRGB_OF_XYZ.map(|row| row.iter().zip(xyz).map(|(a, b)| a * b).sum())
    }
}

impl Bands {
    /// The linear sRGB colour of a spectrum in these bands.
    pub fn linear_srgb(self, spectrum: &[f64]) -> [f64; 3] {
        match self {
            Self::Rgb => std::array::from_fn(|channel| spectrum[channel]),
            Self::Eight => Axis::EIGHT.linear_srgb(spectrum),
        }
    }

    /// A smooth spectrum in these bands that has a linear sRGB colour; negative parts of the colour are taken
    /// for 0.
    pub fn of_linear_srgb(self, colour: [f64; 3]) -> Vec<f64> {
        let colour = colour.map(|part| part.max(0.0));
        match self {
            Self::Rgb => colour.to_vec(),
            Self::Eight => {
                let sum =
                    |band: usize| (0..3).map(|channel| colour[channel] * PRIMARIES[channel][band]).sum();
                (0..self.count()).map(sum).collect()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::lights::Light;

    #[test]
    fn daylight_is_white_and_flat_spectra_have_luminance_one() {
        let daylight = Light::Daylight.spectrum(Axis::FINE);
        let [red, green, blue] = Axis::FINE.linear_srgb(&daylight);
        assert!(
            (red / green - 1.0).abs() < 0.02 && (blue / green - 1.0).abs() < 0.02,
            "{red} {green} {blue}"
        );
        let [red, green, blue] = Axis::EIGHT.linear_srgb(&[1.0; 8]);
        assert!((0.2126 * red + 0.7152 * green + 0.0722 * blue - 1.0).abs() < 1e-3);
    }

    #[test]
    fn colours_are_found_again() {
        for colour in [[1.0, 1.0, 1.0], [0.8, 0.1, 0.02], [0.0, 0.5, 0.0], [0.1, 0.2, 0.9]] {
            let spectrum = Bands::Eight.of_linear_srgb(colour);
            assert!(spectrum.iter().all(|value| *value >= 0.0));
            let found = Bands::Eight.linear_srgb(&spectrum);
            assert!(
                colour.iter().zip(found).all(|(a, b)| (a - b).abs() < 1e-4),
                "{colour:?} became {found:?}"
            );
        }
    }

    #[test]
    fn bands_have_the_colours_of_their_light() {
        let colour = |band: usize| {
            let mut spectrum = [0.0; 8];
            spectrum[band] = 1.0;
            Bands::Eight.linear_srgb(&spectrum)
        };
        let strongest = |band| (0..3).max_by(|a, b| colour(band)[*a].total_cmp(&colour(band)[*b]));
        assert_eq!([1, 3, 6].map(strongest), [Some(2), Some(1), Some(0)]);
    }
}
