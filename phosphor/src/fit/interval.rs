//! Intervals of a material's parameters: the fit's covariance, carried to them to first order, and Student's
//! t.
//!
//! They are cut at 0. Where the true value is 0, only an interval that lies above it misses it, so that 97.5
//! % of those hold it and not 95 %. What no measurement depends on may be anything from 0 on.

use super::prediction::{Prediction, Unknowns};
use crate::least_squares::Minimum;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// How often an interval is to hold the true value.
pub const CONFIDENCE: f64 = 0.95;

/// A rate that may be so many times as fast, or as slow, is not known.
const UNKNOWN: f64 = 1e6;

/// What a fit estimates of a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Parameter {
    /// The rate at which it decays.
    Decay,
    /// The rate at which a band excites it; bands from 0 on.
    Excitation(usize),
    /// What it sends in a band.
    Emission(usize),
}

/// A parameter of a material.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterEstimate {
    /// Of which state, from 0 on.
    pub state: usize,
    /// Which.
    pub parameter: Parameter,
    /// Its value in the fit.
    pub value: f64,
    /// The ends of its interval of [`CONFIDENCE`]; from 0 to infinity where it is not known.
    pub interval: [f64; 2],
}

/// Estimates of a material's parameters, states from the fastest to the slowest, from the solver's unknowns
/// within their bounds and from those without.
pub fn estimates(prediction: &Prediction, bounded: &[f64], free: &Minimum) -> Vec<ParameterEstimate> {
    let measured = prediction.measurement.measured_bands();
    // Nothing was fitted to what no measurement depends on.
    let unmeasured = prediction.measurement.excited_bands() - measured.len();
    let fitted = free.values.len() - prediction.states * unmeasured;
    let freedom = (prediction.count() - fitted).max(1) as f64;
    let student = StudentsT::new(0.0, 1.0, freedom).expect("one degree of freedom at least");
    let reach = student.inverse_cdf(0.5 + 0.5 * CONFIDENCE) * (free.cost() / freedom).sqrt();
    // Times infinity it is infinite, however exact the fit is.
    let reach = reach.max(f64::MIN_POSITIVE);
    let (held, loose) = (prediction.unpacked(bounded), prediction.free().unpacked(&free.values));
    let layout =
        Layout { states: prediction.states, bands: held.total.len(), excited: held.excitation[0].len() };
    let mut estimates = Vec::new();
    for (place, state) in by_rate(&held).into_iter().enumerate() {
        let mut add = |parameter, value: f64, interval: [f64; 2]| {
            estimates.push(ParameterEstimate { state: place, parameter, value, interval });
        };
        let about = |centre: f64, slope: Vec<f64>| {
            let off = reach * deviation(&free.covariance, &slope);
            [(centre - off).max(0.0), (centre + off).max(0.0)]
        };
        // The solver knows the deviation of the rate's logarithm.
        let factor = (reach * deviation(&free.covariance, &layout.unit(state, 1.0))).exp();
        let rate = loose.decays[state];
        let interval = if factor < UNKNOWN { [rate / factor, rate * factor] } else { [0.0, f64::INFINITY] };
        add(Parameter::Decay, held.decays[state], interval);
        for &band in &measured {
            let slope = layout.unit(layout.excitation(state, band), 1.0);
            let interval = about(loose.excitation[state][band], slope);
            add(Parameter::Excitation(band), held.excitation[state][band], interval);
        }
        for band in 0..layout.bands {
            let interval = about(loose.emission(state)[band], layout.emission_slope(&loose, state, band));
            add(Parameter::Emission(band), held.emission(state)[band], interval);
        }
    }
    estimates
}

/// States from the fastest to the slowest.
fn by_rate(unknowns: &Unknowns) -> Vec<usize> {
    let mut states: Vec<usize> = (0..unknowns.decays.len()).collect();
    states.sort_by(|a, b| unknowns.decays[*b].total_cmp(&unknowns.decays[*a]));
    states
}

/// The standard deviation of what has these slopes over the unknowns. Those that the solver cannot tell have
/// a variance of 0 from it.
fn deviation(covariance: &[f64], slope: &[f64]) -> f64 {
    let count = slope.len();
    if (0..count).any(|i| slope[i] != 0.0 && covariance[i * count + i] <= 0.0) {
        return f64::INFINITY;
    }
    let row = |i: usize| (0..count).map(|j| covariance[i * count + j] * slope[j]).sum::<f64>();
    (0..count).map(|i| slope[i] * row(i)).sum::<f64>().max(0.0).sqrt()
}

/// Where the solver's list has what.
struct Layout {
    states: usize,
    bands: usize,
    excited: usize,
}

impl Layout {
    fn len(&self) -> usize {
        2 * self.states - 1 + self.bands + self.states * self.excited
    }

    fn total(&self, band: usize) -> usize {
        2 * self.states - 1 + band
    }

    fn excitation(&self, state: usize, band: usize) -> usize {
        2 * self.states - 1 + self.bands + state * self.excited + band
    }

    fn unit(&self, index: usize, value: f64) -> Vec<f64> {
        let mut slope = vec![0.0; self.len()];
        slope[index] = value;
        slope
    }

    /// Slopes of `total * part / rate`; the first part is what the others leave.
    fn emission_slope(&self, unknowns: &Unknowns, state: usize, band: usize) -> Vec<f64> {
        let (rate, part, total) = (unknowns.decays[state], unknowns.parts[state], unknowns.total[band]);
        let mut slope = self.unit(state, -total * part / rate);
        slope[self.total(band)] = part / rate;
        for other in 1..self.states {
            let sign = if state == 0 { -1.0 } else { f64::from(u8::from(other == state)) };
            slope[self.states + other - 1] = sign * total / rate;
        }
        slope
    }
}
