//! A material from measurements of it (thesis, section 8.4), for one, two or three states.
//!
//! The thesis fits in stages: the spectrum, then the decay, then the excitation. The stages are where the search
//! starts ([`start`]); then one fit explains all measurements together ([`prediction`]), so that what one stage does
//! not know well counts in the intervals of the others. Unknowns stay within their bounds. Intervals are those of the
//! same problem without bounds, cut at them, since an unknown that its bound holds has no slope to tell them from.

mod files;
mod interval;
mod measurement;
mod photographs;
mod prediction;
mod recovery;
mod simulated;
mod start;

pub use files::FilesError;
pub use interval::{CONFIDENCE, Estimate, Parameter};
pub use measurement::{Charged, Exposure, Filtered, Measurement, PhotographError, Shot, relative_gain};
pub use photographs::PhotographsError;
pub use prediction::Part;
pub use recovery::spectrum;
pub use simulated::Laboratory;

use super::least_squares::{Minimum, SolverError, minimum};
use super::material::{Material, State};
use prediction::{Prediction, Unknowns};

/// The most states that are fitted.
pub const MAX_STATES: usize = 3;

/// A material that explains measurements.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The material, its states from the fastest to the slowest.
    pub material: Material,
    /// Its parameters with their intervals.
    pub estimates: Vec<Estimate>,
    /// Each measured value with what the material explains of it.
    pub values: Vec<Explained>,
}

/// A measured value beside what a fit says.
#[derive(Clone, Copy, Debug)]
pub struct Explained {
    /// Which measurement it is of.
    pub part: Part,
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
    /// The solver failed.
    #[error(transparent)]
    Solver(#[from] SolverError),
}

impl Fit {
    /// The material of `states` states that explains a measurement best.
    ///
    /// # Errors
    /// If the number of states is not from 1 to 3, the measurement makes no sense or is too little for so many
    /// unknowns, or no light was measured.
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
        Ok(Self {
            material: material(name, &prediction, &values),
            estimates: interval::estimates(&prediction, &values, &free),
            values: prediction.explained(&values),
        })
    }

    /// The root mean square of residual over noise: 1 where the material explains all but the noise.
    pub fn residual_over_noise(&self) -> f64 {
        let square = |value: &Explained| ((value.fitted - value.measured) / value.noise).powi(2);
        (self.values.iter().map(square).sum::<f64>() / self.values.len() as f64).sqrt()
    }
}

fn best(
    prediction: &Prediction,
    unknowns: Vec<super::least_squares::Unknown>,
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
    Material { name: name.into(), bands: prediction.measurement.bands, doubt: None, states }
}

#[cfg(test)]
mod tests;
