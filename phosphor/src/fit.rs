//! A material from measurements of it (thesis, section 8.4), for one, two or three states.
//!
//! The thesis fits in stages: the spectrum, then the decay, then the excitation. The stages are where the
//! search starts ([`start`]); then one fit explains all measurements together ([`prediction`]), so that what
//! one stage does not know well counts in the intervals of the others. Unknowns stay within their bounds.
//! Intervals are those of the same problem without bounds, cut at them, since an unknown that its bound holds
//! has no slope to tell them from.

pub mod checker;
mod files;
mod interval;
mod measurement;
mod photographs;
mod prediction;
mod simulated;
mod start;
mod warning;

pub use files::FilesError;
pub use interval::{CONFIDENCE, Parameter, ParameterEstimate};
pub use measurement::{Charged, Exposure, Filtered, Measurement, Shot, relative_gain};
pub use photographs::{ExrReader, PhotographsError};
pub use prediction::MeasurementKind;
pub use simulated::Laboratory;
pub use warning::Warning;

use crate::least_squares::{Minimum, SolverError, minimum};
use deepshade_glow::material::{Material, State};
use prediction::{Prediction, Unknowns};

/// The most states that are fitted.
pub const MAX_STATES: usize = 3;

/// What varies by this share of its squares, or less, does not vary: the rest is rounding.
const STEADY: f64 = 1e-20;

/// A material that explains measurements.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The material, its states from the fastest to the slowest.
    pub material: Material,
    /// Its parameters with their intervals.
    pub estimates: Vec<ParameterEstimate>,
    /// Each measured value with what the material explains of it; three a photograph.
    pub values: Vec<Explained>,
    /// Bands, from 0 on, of which no photograph says how their light excites it. Its rates have 0 for them,
    /// or nothing.
    pub unmeasured: Vec<usize>,
    /// Whether somebody stated the noise of all values. Else it is taken for something, and left over noise
    /// means nothing.
    pub noise_is_known: bool,
    /// Reasons to doubt it.
    pub warnings: Vec<Warning>,
}

/// A measured value beside what a fit says.
#[derive(Clone, Copy, Debug)]
pub struct Explained {
    /// Which measurement it is of.
    pub part: MeasurementKind,
    /// Of which filter or band it is, from 0 on; 0 of the decay.
    pub place: usize,
    /// When it was taken: seconds in the dark for decay and spectrum, seconds of light for excitation.
    pub seconds: f64,
    /// Red, green or blue, from 0 on.
    pub channel: usize,
    /// Radiance as measured.
    pub measured: f64,
    /// Radiance of the fit.
    pub fitted: f64,
    /// The standard error of what was measured.
    pub noise: f64,
}

/// Why measurements cannot be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FitError {
    /// A number of states that is not fitted.
    #[error("{0} states: 1 to {MAX_STATES} can be fitted")]
    States(usize),
    /// There is too little of a measurement.
    #[error("{what}: {count} photographs, at least {least} are needed")]
    TooFew {
        /// Of what.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many there must be.
        least: usize,
    },
    /// Lists of the measurement do not fit together, or a number makes no sense.
    #[error("the measurement makes no sense: {0}")]
    Measurement(String),
    /// No light was measured.
    #[error("the decay is dark: no light was measured")]
    Dark,
    /// Light that grows in the dark.
    #[error(
        "the decay grows, from {first:.3e} in the first third of its photographs to {last:.3e} in the last: \
        is `time_s` the time since \
         the light went off, and are exposures right?"
    )]
    Grows {
        /// The mean radiance at first, of all channels together.
        first: f64,
        /// The same at last.
        last: f64,
    },
    /// The solver failed.
    #[error(transparent)]
    Solver(#[from] SolverError),
}

impl Fit {
    /// The material of `states` states that explains a measurement best.
    ///
    /// # Errors
    /// If the number of states is not from 1 to 3, the measurement makes no sense or is too little for so
    /// many unknowns, no light was measured, or it grows in the dark.
    pub fn new(name: &str, measurement: &Measurement, states: usize) -> Result<Self, FitError> {
        if !(1..=MAX_STATES).contains(&states) {
            return Err(FitError::States(states));
        }
        measurement.check(states)?;
        let prediction = Prediction::new(measurement, states);
        let start = start::start(&prediction)?;
        let bounded = best(&prediction, start.unknowns(true))?;
        let found = prediction.unpacked(&bounded.values).unknowns(false);
        let values: Vec<f64> = found.iter().map(|unknown| unknown.start).collect();
        let free = best(&prediction.free(), found)?;
        let mut fit = Self {
            material: material(name, &prediction, &values),
            estimates: interval::estimates(&prediction, &values, &free),
            values: prediction.explained(&values),
            unmeasured: measurement.unmeasured_bands(),
            noise_is_known: measurement.noise_is_known,
            warnings: Vec::new(),
        };
        fit.warnings = warning::warnings(&fit, measurement);
        Ok(fit)
    }

    /// The root mean square of residual over noise: 1 where the material explains all but the noise.
    pub fn residual_over_noise(&self) -> f64 {
        let square = |value: &Explained| ((value.fitted - value.measured) / value.noise).powi(2);
        (self.values.iter().map(square).sum::<f64>() / self.values.len() as f64).sqrt()
    }

    /// The share of the decay's variance, about each channel's mean, that it explains (R squared): 1 at most,
    /// 0 where nothing changes.
    pub fn explained(&self) -> f64 {
        let of_channel = |channel: usize| {
            let is_its =
                move |value: &&Explained| value.part == MeasurementKind::Decay && value.channel == channel;
            let values: Vec<&Explained> = self.values.iter().filter(is_its).collect();
            let mean = values.iter().map(|value| value.measured).sum::<f64>() / values.len() as f64;
            let squares =
                |off: &dyn Fn(&Explained) -> f64| values.iter().map(|value| off(value).powi(2)).sum::<f64>();
            let left = squares(&|value| value.measured - value.fitted);
            [left, squares(&|value| value.measured - mean), squares(&|value| value.measured)]
        };
        let channels = [0, 1, 2].map(of_channel);
        let [left, varying, all] =
            [0, 1, 2].map(|sum: usize| channels.iter().map(|sums| sums[sum]).sum::<f64>());
        if varying > STEADY * all { 1.0 - left / varying } else { 0.0 }
    }
}

fn best(
    prediction: &Prediction,
    unknowns: Vec<crate::least_squares::Unknown>,
) -> Result<Minimum, SolverError> {
    minimum(&unknowns, prediction.count(), |values, residuals| prediction.residuals(values, residuals))
}

fn material(name: &str, prediction: &Prediction, values: &[f64]) -> Material {
    let unknowns: Unknowns = prediction.unpacked(values);
    let state = |index: usize| State {
        decay: unknowns.decays[index],
        excitation: unknowns.excitation[index].clone(),
        emission: unknowns.emission(index),
    };
    let mut states: Vec<State> = (0..unknowns.decays.len()).map(state).collect();
    states.sort_by(|a, b| b.decay.total_cmp(&a.decay));
    Material {
        name: name.into(),
        bands: prediction.measurement.bands,
        doubt: doubt(prediction.measurement),
        states,
    }
}

/// What a material says of bands beside those whose light was seen to excite it.
fn doubt(measurement: &Measurement) -> Option<String> {
    let unmeasured = measurement.unmeasured_bands();
    let some = !unmeasured.is_empty() && unmeasured.len() < measurement.bands.count();
    some.then(|| {
        format!("excitation by {} was not measured and is taken for none", listed_bands(&unmeasured))
    })
}

/// Bands in words, from 1 on: `bands 2, 4 to 8`.
pub fn listed_bands(bands: &[usize]) -> String {
    let runs = bands.chunk_by(|a, b| a + 1 == *b).map(|run| match run {
        [first, .., last] => format!("{} to {}", first + 1, last + 1),
        run => (run[0] + 1).to_string(),
    });
    let runs = runs.collect::<Vec<_>>().join(", ");
    format!("{} {runs}", if bands.len() == 1 { "band" } else { "bands" })
}

#[cfg(test)]
mod tests;
