//! Spectra in bands of wavelength, and their colours.

pub mod colour;

pub mod lights;
pub mod observer;

use serde::{Deserialize, Serialize};

/// What a material has values for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Bands {
    /// Red, green and blue: linear, Rec. 709 primaries.
    Rgb,
    /// Eight bands of 37.5 nm from 400 to 700 nm, as in the thesis (section 8.4.1).
    Eight,
}

impl Bands {
    /// How many there are.
    pub const fn count(self) -> usize {
        match self {
            Self::Rgb => 3,
            Self::Eight => Axis::EIGHT.count,
        }
    }
}

/// Bands of equal width, side by side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    /// Where the first begins, in nm.
    pub from: f64,
    /// How wide each is, in nm.
    pub width: f64,
    /// How many there are.
    pub count: usize,
}

impl Axis {
    /// The bands of [`Bands::Eight`].
    pub const EIGHT: Self = Self { from: 400.0, width: 37.5, count: 8 };
    /// Thirty bands of 10 nm over the same range.
    #[cfg(test)]
    pub(crate) const FINE: Self = Self { from: 400.0, width: 10.0, count: 30 };

    /// The mean of a function of wavelength (nm) over each band: the midpoint rule in steps of at most half a
    /// nanometre.
    pub fn means(&self, function: impl Fn(f64) -> f64) -> Vec<f64> {
        let parts = (2.0 * self.width).ceil() as usize;
        let mean = |band: usize| {
            let at =
                |part: usize| self.from + (band as f64 + (part as f64 + 0.5) / parts as f64) * self.width;
            (0..parts).map(|part| function(at(part))).sum::<f64>() / parts as f64
        };
        (0..self.count).map(mean).collect()
    }

    /// The band that a wavelength (nm) falls in.
    pub fn band_of(&self, wavelength: f64) -> Option<usize> {
        let band = ((wavelength - self.from) / self.width).floor();
        (band >= 0.0 && band < self.count as f64).then_some(band as usize)
    }

    /// The middle of each band, in nm.
    pub fn centres(&self) -> Vec<f64> {
        (0..self.count).map(|band| self.from + (band as f64 + 0.5) * self.width).collect()
    }

    /// Where the last band ends, in nm.
    pub fn end(&self) -> f64 {
        self.from + self.width * self.count as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_are_those_of_the_function() {
        let linear = Axis::EIGHT.means(|wavelength| wavelength);
        assert!(linear.iter().zip(Axis::EIGHT.centres()).all(|(mean, centre)| (mean - centre).abs() < 1e-9));
        let square = Axis::FINE.means(|wavelength| wavelength * wavelength)[3];
        let expected = (440.0f64.powi(3) - 430.0f64.powi(3)) / 30.0;
        assert!((square - expected).abs() < 0.05, "{square} {expected}");
    }

    #[test]
    fn wavelengths_fall_into_their_bands() {
        let band = |wavelength| Axis::EIGHT.band_of(wavelength);
        assert_eq!(
            [band(399.9), band(400.0), band(437.4), band(437.5), band(699.9), band(700.0)],
            [None, Some(0), Some(0), Some(1), Some(7), None]
        );
        assert_eq!(Axis::EIGHT.end(), 700.0);
    }
}
