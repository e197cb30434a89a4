//! Spectra of the lamps that the thesis excites materials with (Figure 8.3), and of two more.

use super::{Axis, Bands};
use deepshade_shaders::colour::luminance;
use serde::{Deserialize, Serialize};

/// A source of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Light {
    /// A halogen lamp: a black body of 3200 K.
    Halogen,
    /// An incandescent lamp: a black body of 2856 K, as CIE illuminant A is (CIE 15:2004, equation 2.1).
    Incandescent,
    /// A mercury vapour lamp: its five strong visible lines.
    Mercury,
    /// A white light-emitting diode: a blue die and a phosphor.
    Led,
    /// Daylight of 6504 K, CIE illuminant D65.
    Daylight,
}

/// Strong lines of neutral mercury between 400 and 700 nm: wavelength in nm, relative intensity (Sansonetti
/// and Martin 2005, Handbook of Basic Atomic Spectroscopic Data, NIST). Intensities are of one laboratory
/// lamp; those of lamps for lighting depend on their pressure.
const MERCURY_LINES: [(f64, f64); 5] =
    [(404.656, 1800.0), (435.833, 4000.0), (546.074, 1100.0), (576.960, 240.0), (579.066, 280.0)];

/// Daylight's mean and two directions of change at 400, 410, ... 700 nm (CIE 15:2004, Table T.2).
const DAYLIGHT: [[f64; 31]; 3] = [
    [
        94.8, 104.8, 105.9, 96.8, 113.9, 125.6, 125.5, 121.3, 121.3, 113.5, 113.1, 110.8, 106.5, 108.8,
        105.3, 104.4, 100.0, 96.0, 95.1, 89.1, 90.5, 90.3, 88.4, 84.0, 85.1, 81.9, 82.6, 84.9, 81.3, 71.9,
        74.3,
    ],
    [
        43.4, 46.3, 43.9, 37.1, 36.7, 35.9, 32.6, 27.9, 24.3, 20.1, 16.2, 13.2, 8.6, 6.1, 4.2, 1.9, 0.0,
        -1.6, -3.5, -3.5, -5.8, -7.2, -8.6, -9.5, -10.9, -10.7, -12.0, -14.0, -13.6, -12.0, -13.3,
    ],
    [
        -1.1, -0.5, -0.7, -1.2, -2.6, -2.9, -2.8, -2.6, -2.6, -1.8, -1.5, -1.3, -1.2, -1.0, -0.5, -0.3, 0.0,
        0.2, 0.5, 2.1, 3.2, 4.1, 4.7, 5.1, 6.7, 7.3, 8.6, 9.8, 10.2, 8.3, 9.6,
    ],
];

impl Light {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Halogen, Self::Incandescent, Self::Mercury, Self::Led, Self::Daylight];

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Halogen => "halogen",
            Self::Incandescent => "incandescent",
            Self::Mercury => "mercury",
            Self::Led => "led",
            Self::Daylight => "daylight",
        }
    }

    /// Its relative power in each band; the mean over bands is 1.
    pub fn spectrum(self, axis: Axis) -> Vec<f64> {
        let power = match self {
            Self::Halogen => axis.means(|wavelength| black_body(wavelength, 3200.0)),
            Self::Incandescent => axis.means(|wavelength| black_body(wavelength, 2856.0)),
            Self::Mercury => lines(axis),
            Self::Led => axis.means(diode),
            Self::Daylight => axis.means(|wavelength| daylight(wavelength, 6504.0)),
        };
        let mean = power.iter().sum::<f64>() / axis.count as f64;
        power.into_iter().map(|power| power / mean).collect()
    }

    /// Its light in such bands, of luminance 1.
    pub fn of_luminance_one(self, bands: Bands) -> Vec<f64> {
        let spectrum = self.spectrum(Axis::EIGHT);
        let colour = Bands::Eight.linear_srgb(&spectrum);
        let luminance = f64::from(luminance(colour.map(|part| part as f32)));
        let light = match bands {
            Bands::Rgb => colour.to_vec(),
            Bands::Eight => spectrum,
        };
        light.into_iter().map(|part| part / luminance).collect()
    }
}

/// Planck's law, relative: `1 / (l^5 (exp(c2 / l T) - 1))` with c2 = 1.4388e-2 m K.
fn black_body(wavelength: f64, kelvin: f64) -> f64 {
    let exponent = 1.4388e7 / (wavelength * kelvin);
    (560.0 / wavelength).powi(5) / exponent.exp_m1()
}

fn lines(axis: Axis) -> Vec<f64> {
    let mut power = vec![0.0; axis.count];
    for (wavelength, intensity) in MERCURY_LINES {
        if let Some(band) = axis.band_of(wavelength) {
            power[band] += intensity;
        }
    }
    power
}

/// A die at 450 nm of the form that Ohno 2005 ("Spectral design considerations for white LED color
/// rendering", Optical Engineering 44(11), equation 1) gives diodes, and a phosphor as a Gaussian at 570 nm.
/// Heights and widths are typical of white diodes of some 5000 K, not of one that was measured.
fn diode(wavelength: f64) -> f64 {
    let bell = |centre: f64, width: f64| (-((wavelength - centre) / width).powi(2)).exp();
    let die = bell(450.0, 20.0);
    (die + 2.0 * die.powi(5)) / 3.0 + 0.62 * bell(570.0, 80.0)
}

/// Daylight of a correlated colour temperature from 4000 to 7000 K (CIE 15:2004, equations 3.2 to 3.6),
/// between the table's wavelengths linear, as the standard says.
fn daylight(wavelength: f64, kelvin: f64) -> f64 {
    let per = 1e3 / kelvin;
    let x = -4.6070 * per.powi(3) + 2.9678 * per.powi(2) + 0.099_11 * per + 0.244_063;
    let y = -3.0 * x * x + 2.87 * x - 0.275;
    let below = 0.0241 + 0.2562 * x - 0.7341 * y;
    let first = (-1.3515 - 1.7703 * x + 5.9114 * y) / below;
    let second = (0.03 - 31.4424 * x + 30.0717 * y) / below;
    let at = |index: usize| DAYLIGHT[0][index] + first * DAYLIGHT[1][index] + second * DAYLIGHT[2][index];
    let place = ((wavelength - 400.0) / 10.0).clamp(0.0, 30.0);
    let index = (place as usize).min(29);
    let share = place - index as f64;
    (1.0 - share) * at(index) + share * at(index + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// CIE x and y.
    fn chromaticity(light: Light) -> [f64; 2] {
        let spectrum = light.spectrum(Axis::FINE);
        let xyz =
            Axis::FINE.xyz().map(|weights| weights.iter().zip(&spectrum).map(|(a, b)| a * b).sum::<f64>());
        let sum: f64 = xyz.iter().sum();
        [xyz[0] / sum, xyz[1] / sum]
    }

    #[test]
    fn lamps_have_the_chromaticities_of_the_standard() {
        let near = |light, expected: [f64; 2], tolerance| {
            let found = chromaticity(light);
            let off = (found[0] - expected[0]).hypot(found[1] - expected[1]);
            assert!(off < tolerance, "{light:?}: {found:?}, not {expected:?}");
        };
        near(Light::Daylight, [0.3127, 0.3290], 0.004);
        near(Light::Incandescent, [0.4476, 0.4074], 0.004);
        near(Light::Halogen, [0.4234, 0.3990], 0.004);
        near(Light::Led, [0.345, 0.355], 0.02);
    }

    /// D65 of the standard's own table (CIE 15:2004, Table T.1).
    #[test]
    fn daylight_is_d65() {
        for (wavelength, expected) in
            [(400.0, 82.75), (460.0, 117.81), (560.0, 100.0), (650.0, 80.03), (700.0, 71.61)]
        {
            let value = daylight(wavelength, 6504.0);
            assert!((value - expected).abs() < 0.2, "{wavelength} nm: {value}");
        }
    }

    #[test]
    fn black_bodies_are_illuminant_a() {
        for (wavelength, expected) in [(400.0, 14.708), (500.0, 59.861), (700.0, 198.261)] {
            let value = 100.0 * black_body(wavelength, 2856.0) / black_body(560.0, 2856.0);
            assert!((value / expected - 1.0).abs() < 3e-3, "{wavelength} nm: {value}");
        }
    }

    #[test]
    fn mercury_is_in_its_lines_only() {
        let spectrum = Light::Mercury.spectrum(Axis::EIGHT);
        assert!(spectrum[0] > 6.0 && spectrum[3] > 1.0 && spectrum[4] > 0.5, "{spectrum:?}");
        assert_eq!([spectrum[1], spectrum[2], spectrum[5], spectrum[6], spectrum[7]], [0.0; 5]);
    }
}
