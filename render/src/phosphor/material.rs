//! What a phosphorescent material is: the parameters of equations 8.1 and 8.3 of the thesis.

pub mod file;

use super::spectrum::Bands;
use serde::{Deserialize, Serialize};

/// A material of one or more states.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// What it is called.
    pub name: String,
    /// What `excitation` and `emission` have one value for.
    pub bands: Bands,
    /// What of the values is not certain, and why.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub doubt: Option<String>,
    /// The states; their light adds up.
    pub states: Vec<State>,
}

/// A state that light excites and that gives light back.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct State {
    /// The re-radiation rate `kr`, per second. A state of rate 0 keeps what it has and is dark.
    pub decay: f64,
    /// The excitation rate `ke` of the first bands, as many as were measured; light of the others does nothing. None at
    /// all: nobody knows how light excites it.
    #[serde(default)]
    pub excitation: Vec<f64>,
    /// The re-radiation function `Lambda`, one value a band.
    pub emission: Vec<f64>,
}

/// What is wrong with a material, or with what it is asked to do.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MaterialError {
    /// A material without states.
    #[error("{material}: has no state")]
    NoState {
        /// The material.
        material: String,
    },
    /// A list that is not as long as the bands ask.
    #[error("{material}, state {state}: {what} has {count} values, its bands are {bands}")]
    BandCount {
        /// The material.
        material: String,
        /// Which state, from 1 on.
        state: usize,
        /// Which list.
        what: &'static str,
        /// Its length.
        count: usize,
        /// The number of bands.
        bands: usize,
    },
    /// A value that is negative or not finite.
    #[error("{material}, state {state}: {what} is {value}, not a finite number that is at least 0")]
    Value {
        /// The material.
        material: String,
        /// Which state, from 1 on.
        state: usize,
        /// Which value.
        what: &'static str,
        /// The value.
        value: f64,
    },
    /// Light on a material of which nobody knows how light excites it.
    #[error("{material}: its excitation was never measured, so light has no known effect; it can only decay")]
    ExcitationUnknown {
        /// The material.
        material: String,
    },
    /// Irradiance that is negative, not finite, or not of the material's bands.
    #[error("{material}: irradiance {irradiance:?} is not {bands} finite numbers that are at least 0")]
    Irradiance {
        /// The material.
        material: String,
        /// The irradiance.
        irradiance: Vec<f64>,
        /// The number of bands.
        bands: usize,
    },
    /// A step that is negative or not finite.
    #[error("a step in time of {0} s: it must be finite and at least 0")]
    TimeStep(f64),
    /// A material that is measured in bands that it is not described in.
    #[error("{material}: described in RGB; materials of eight bands are measured")]
    NotOfEightBands {
        /// The material.
        material: String,
    },
    /// A material that is measured and sends nothing.
    #[error("{material}: sends no light that the camera sees, not even where all is excited")]
    Dark {
        /// The material.
        material: String,
    },
    /// A start that is not one share in [0, 1] a state.
    #[error("{material}: excited shares {shares:?} are not {states} numbers from 0 to 1")]
    Shares {
        /// The material.
        material: String,
        /// The shares.
        shares: Vec<f64>,
        /// The number of states.
        states: usize,
    },
}

impl Material {
    /// The material, if its values make sense.
    ///
    /// # Errors
    /// If it has no state, a list is not as long as its bands ask, or a value is negative or not finite.
    pub fn checked(self) -> Result<Self, MaterialError> {
        if self.states.is_empty() {
            return Err(MaterialError::NoState { material: self.name });
        }
        for (index, state) in self.states.iter().enumerate() {
            state.check(&self.name, index + 1, self.bands.count())?;
        }
        Ok(self)
    }

    /// The rate at which irradiance (one value a band) excites each state, per second: the integral of equation 8.1.
    ///
    /// # Errors
    /// If irradiance is negative, not finite or of other bands, or falls on what was never measured under light.
    pub fn charges(&self, irradiance: &[f64]) -> Result<Vec<f64>, MaterialError> {
        let fails = || MaterialError::Irradiance {
            material: self.name.clone(),
            irradiance: irradiance.to_vec(),
            bands: self.bands.count(),
        };
        if irradiance.len() != self.bands.count() || !irradiance.iter().copied().all(is_amount) {
            return Err(fails());
        }
        if irradiance.iter().any(|light| *light > 0.0) && !self.excitation_is_known() {
            return Err(MaterialError::ExcitationUnknown { material: self.name.clone() });
        }
        let charges: Vec<f64> = self.states.iter().map(|state| state.charge(irradiance)).collect();
        if charges.iter().copied().all(is_amount) { Ok(charges) } else { Err(fails()) }
    }

    /// Whether it is known how light excites it.
    pub fn excitation_is_known(&self) -> bool {
        self.states.iter().all(|state| !state.excitation.is_empty())
    }

    /// What it sends where `shares` of its states are excited, one value a band (equation 8.3).
    pub fn emission(&self, shares: &[f64]) -> Vec<f64> {
        let mut sent = vec![0.0; self.bands.count()];
        for (state, share) in self.states.iter().zip(shares) {
            for (sent, emission) in sent.iter_mut().zip(&state.emission) {
                *sent += emission * state.decay * share;
            }
        }
        sent
    }
}

impl State {
    /// The rate at which irradiance excites it, per second.
    pub fn charge(&self, irradiance: &[f64]) -> f64 {
        self.excitation.iter().zip(irradiance).map(|(rate, light)| rate * light).sum()
    }

    fn check(&self, material: &str, state: usize, bands: usize) -> Result<(), MaterialError> {
        let count =
            |what, count| MaterialError::BandCount { material: material.into(), state, what, count, bands };
        if self.emission.len() != bands {
            return Err(count("emission", self.emission.len()));
        }
        if self.excitation.len() > bands {
            return Err(count("excitation", self.excitation.len()));
        }
        let values = [("decay", std::slice::from_ref(&self.decay)), ("excitation", &self.excitation[..])];
        for (what, values) in values.into_iter().chain([("emission", &self.emission[..])]) {
            if let Some(&value) = values.iter().find(|value| !is_amount(**value)) {
                return Err(MaterialError::Value { material: material.into(), state, what, value });
            }
        }
        Ok(())
    }
}

/// Whether a number is finite and not negative.
fn is_amount(value: f64) -> bool {
    value.is_finite() && value >= 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn material(state: State) -> Material {
        Material { name: "test".into(), bands: Bands::Rgb, doubt: None, states: vec![state] }
    }

    fn state() -> State {
        State { decay: 0.1, excitation: vec![0.5, 0.25], emission: vec![1.0, 2.0, 3.0] }
    }

    #[test]
    fn emission_and_charge_are_sums_over_states_and_bands() {
        let two = Material { states: vec![state(), state()], ..material(state()) };
        let sent = two.emission(&[1.0, 0.5]);
        assert!(sent.iter().zip([0.15, 0.3, 0.45]).all(|(a, b)| (a - b).abs() < 1e-15), "{sent:?}");
        assert_eq!(two.charges(&[2.0, 4.0, 100.0]), Ok(vec![2.0, 2.0]), "the last band was not measured");
    }

    #[test]
    fn what_makes_no_sense_is_refused() {
        assert!(material(state()).checked().is_ok());
        let refused = |change: fn(&mut State)| {
            let mut state = state();
            change(&mut state);
            material(state).checked().expect_err("refused").to_string()
        };
        assert!(refused(|s| s.decay = -1.0).contains("decay is -1"));
        assert!(refused(|s| s.decay = f64::NAN).contains("decay is NaN"));
        assert!(refused(|s| s.excitation[1] = f64::INFINITY).contains("excitation is inf"));
        assert!(refused(|s| s.emission.truncate(2)).contains("emission has 2 values, its bands are 3"));
        assert!(refused(|s| s.excitation = vec![0.0; 4]).contains("excitation has 4"));
        let none = Material { states: vec![], ..material(state()) };
        assert!(matches!(none.checked(), Err(MaterialError::NoState { .. })));
    }

    #[test]
    fn light_that_makes_no_sense_is_refused() {
        for light in [vec![f64::NAN, 0.0, 0.0], vec![f64::INFINITY; 3], vec![-1.0; 3], vec![1.0; 2]] {
            assert!(
                matches!(material(state()).charges(&light), Err(MaterialError::Irradiance { .. })),
                "{light:?}"
            );
        }
        let strong = material(State { excitation: vec![1e200], ..state() });
        assert!(strong.charges(&[1e200, 0.0, 0.0]).is_err(), "a rate that no number holds");
        let unknown = material(State { excitation: vec![], ..state() });
        assert_eq!(unknown.charges(&[0.0; 3]), Ok(vec![0.0]));
        assert!(matches!(unknown.charges(&[0.0, 0.1, 0.0]), Err(MaterialError::ExcitationUnknown { .. })));
    }
}
