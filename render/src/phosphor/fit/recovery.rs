//! A spectrum from photographs through filters (thesis, section 8.4.2, after Kirk and O'Brien 2011).

use super::super::least_squares::non_negative;
use super::measurement::{Filtered, Measurement};

/// The spectrum that explains photographs through filters best, none of it negative: one value a band of the filters
/// and the sensor, which may be finer than a material's. `None` if there is no photograph.
///
/// `decay` says how much of the light at the start is left while a photograph is taken.
///
/// # Panics
/// If a photograph's filter is not among `filters`.
pub fn spectrum(
    shots: &[Filtered],
    filters: &[Vec<f64>],
    sensor: &[Vec<f64>; 3],
    decay: impl Fn(&Filtered) -> f64,
) -> Option<Vec<f64>> {
    let (mut rows, mut wanted) = (Vec::new(), Vec::new());
    for filtered in shots {
        let (radiance, noise) = (filtered.shot.radiance(), filtered.shot.radiance_noise());
        for channel in 0..3 {
            let weight = decay(filtered) / noise[channel];
            let pairs = filters[filtered.filter].iter().zip(&sensor[channel]);
            rows.push(pairs.map(|(filter, sensor)| filter * sensor * weight).collect());
            wanted.push(radiance[channel] / noise[channel]);
        }
    }
    (!rows.is_empty()).then(|| non_negative(&rows, &wanted))
}

impl Measurement {
    /// The spectrum that its photographs through filters show, where the light went off; `None` without them.
    pub(super) fn spectrum_at_start(&self, decay: impl Fn(&Filtered) -> f64) -> Option<Vec<f64>> {
        spectrum(&self.spectrum, &self.filters, &self.sensor, decay)
    }
}
