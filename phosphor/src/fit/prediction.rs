//! What measurements of a material would be, from the unknowns of a fit.
//!
//! With `ri(0) = 1`, light of the decay is `sum_i Lambda_i kr_i exp(-kr_i t)` (equation 8.6). All states have
//! one spectrum, so that is the total emission at the start times each state's part of it times its decay.

use super::Explained;
use super::measurement::{Measurement, Shot, filled};
use crate::least_squares::Unknown;

/// Which measurement a value is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeasurementKind {
    /// The decay.
    Decay,
    /// The decay through a filter.
    Spectrum,
    /// Excitation by a band.
    Excitation,
}

/// What a fit looks for.
#[derive(Clone, Debug)]
pub struct Unknowns {
    /// Re-radiation rates, one a state, per second.
    pub decays: Vec<f64>,
    /// Each state's part of the light at the start of the decay; they add up to 1.
    pub parts: Vec<f64>,
    /// The light at the start of the decay, one value a band.
    pub total: Vec<f64>,
    /// Excitation rates, a list a state with one value a band up to the last measured one, per second; 0 of
    /// those before it that were not.
    pub excitation: Vec<Vec<f64>>,
}

/// What a measurement would be.
#[derive(Clone, Copy, Debug)]
pub struct Prediction<'a> {
    pub measurement: &'a Measurement,
    pub states: usize,
    excited: usize,
    is_bounded: bool,
}

impl Unknowns {
    /// A state's re-radiation function, one value a band (thesis, section 8.4.5).
    pub fn emission(&self, state: usize) -> Vec<f64> {
        self.total.iter().map(|total| total * self.parts[state] / self.decays[state]).collect()
    }

    /// As the solver has them: logarithms of rates, parts from the second on, emission, excitation; bounded
    /// or not.
    pub fn unknowns(&self, bounded: bool) -> Vec<Unknown> {
        let free = [f64::NEG_INFINITY, f64::INFINITY];
        let within = |bounds: [f64; 2]| if bounded { bounds } else { free };
        let rates = self.decays.iter().map(|rate| Unknown { start: rate.ln(), bounds: free, scale: 1.0 });
        let parts = self.parts[1..].iter().map(|part| Unknown {
            start: *part,
            bounds: within([0.0, 1.0]),
            scale: 1.0,
        });
        let amount = |scale: f64| {
            move |value: &f64| Unknown { start: *value, bounds: within([0.0, f64::INFINITY]), scale }
        };
        let total = self.total.iter().map(amount(largest(&self.total)));
        let excitation = self.excitation.iter().flat_map(|rates| rates.iter().map(amount(largest(rates))));
        rates.chain(parts).chain(total).chain(excitation).collect()
    }
}

/// The largest value, or 1 where all are 0.
fn largest(values: &[f64]) -> f64 {
    let largest = values.iter().copied().fold(0.0, f64::max);
    if largest > 0.0 { largest } else { 1.0 }
}

impl<'a> Prediction<'a> {
    /// Of unknowns within their bounds.
    pub fn new(measurement: &'a Measurement, states: usize) -> Self {
        Self { measurement, states, excited: measurement.excited_bands(), is_bounded: true }
    }

    /// The same of any unknowns.
    pub const fn free(self) -> Self {
        Self { is_bounded: false, ..self }
    }

    /// How many values were measured.
    pub fn count(&self) -> usize {
        3 * (self.measurement.decay.len()
            + self.measurement.spectrum.len()
            + self.measurement.excitation.len())
    }

    /// The unknowns of the solver's list.
    pub fn unpacked(&self, values: &[f64]) -> Unknowns {
        let (rates, rest) = values.split_at(self.states);
        let (others, rest) = rest.split_at(self.states - 1);
        let (total, excitation) = rest.split_at(self.measurement.bands.count());
        // Each of them is bounded by itself; together they are all of the light at most.
        let sum: f64 = others.iter().sum();
        let scale = if self.is_bounded { sum.max(1.0).recip() } else { 1.0 };
        let first = 1.0 - scale * sum;
        let first = if self.is_bounded { first.max(0.0) } else { first };
        Unknowns {
            decays: rates.iter().map(|rate| rate.exp()).collect(),
            parts: std::iter::once(first).chain(others.iter().map(|part| scale * part)).collect(),
            total: total.to_vec(),
            excitation: (0..self.states)
                .map(|state| excitation[state * self.excited..][..self.excited].to_vec())
                .collect(),
        }
    }

    /// Predicted less measured over noise, of each value.
    pub fn residuals(&self, values: &[f64], residuals: &mut [f64]) {
        let mut index = 0;
        self.visit(values, |_, shot, fitted| {
            let (measured, noise) = (shot.radiance(), shot.radiance_noise());
            for channel in 0..3 {
                residuals[index] = (fitted[channel] - measured[channel]) / noise[channel];
                index += 1;
            }
        });
    }

    /// Each measured value beside what is predicted.
    pub fn explained(&self, values: &[f64]) -> Vec<Explained> {
        let mut explained = Vec::with_capacity(self.count());
        self.visit(values, |(part, place, seconds), shot, fitted| {
            let (measured, noise) = (shot.radiance(), shot.radiance_noise());
            explained.extend((0..3).map(|channel| Explained {
                part,
                place,
                seconds,
                channel,
                measured: measured[channel],
                fitted: fitted[channel],
                noise: noise[channel],
            }));
        });
        explained
    }

    /// Goes through all photographs, each with its part, its filter or band and its seconds, and what it
    /// should show.
    fn visit(&self, values: &[f64], mut visit: impl FnMut((MeasurementKind, usize, f64), &Shot, [f64; 3])) {
        let unknowns = self.unpacked(values);
        let ones = vec![1.0; unknowns.total.len()];
        let seen = self.seen(&unknowns.total, &ones);
        let measurement = self.measurement;
        let decayed = |shot: &Shot| {
            unknowns.decays.iter().zip(&unknowns.parts).map(|(k, part)| part * shot.decayed(*k)).sum()
        };
        for shot in &measurement.decay {
            visit((MeasurementKind::Decay, 0, shot.delay), shot, scaled(seen, decayed(shot)));
        }
        for filtered in &measurement.spectrum {
            let seen = self.seen(&unknowns.total, &measurement.filters[filtered.filter]);
            let of = (MeasurementKind::Spectrum, filtered.filter, filtered.shot.delay);
            visit(of, &filtered.shot, scaled(seen, decayed(&filtered.shot)));
        }
        for charged in &measurement.excitation {
            let charge =
                |state: usize| unknowns.excitation[state][charged.band] * measurement.light[charged.band];
            let share = |state: usize| {
                charge(state) * filled(charge(state) + unknowns.decays[state], charged.seconds)
            };
            let light = |state: usize| {
                share(state) * unknowns.parts[state] * charged.shot.decayed(unknowns.decays[state])
            };
            let of = (MeasurementKind::Excitation, charged.band, charged.seconds);
            visit(of, &charged.shot, scaled(seen, (0..self.states).map(light).sum()));
        }
    }

    /// What the camera sees of a spectrum through a filter.
    fn seen(&self, spectrum: &[f64], filter: &[f64]) -> [f64; 3] {
        let sum =
            |channel: &Vec<f64>| channel.iter().zip(spectrum).zip(filter).map(|((a, b), c)| a * b * c).sum();
        std::array::from_fn(|channel| sum(&self.measurement.sensor[channel]))
    }
}

fn scaled(colour: [f64; 3], factor: f64) -> [f64; 3] {
    colour.map(|part| part * factor)
}
