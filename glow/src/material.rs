//! What a phosphorescent material is: the parameters of equations 8.1 and 8.3 of the thesis.

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
    /// The excitation rate `ke` of the first bands, as many as were measured; light of the others does
    /// nothing. None at all: nobody knows how light excites it.
    #[serde(default)]
    pub excitation: Vec<f64>,
    /// The re-radiation function `Lambda`, one value a band.
    pub emission: Vec<f64>,
}

/// What is wrong with a material, in words.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct MaterialError(String);

impl Material {
    /// The material, if its values make sense.
    ///
    /// # Errors
    /// If it has no state, a list is not as long as its bands ask, or a value is negative or not finite.
    pub fn checked(self) -> Result<Self, MaterialError> {
        if self.states.is_empty() {
            return Err(MaterialError(format!("{}: has no state", self.name)));
        }
        for (index, state) in self.states.iter().enumerate() {
            let fails = |fault| MaterialError(format!("{}, state {}: {fault}", self.name, index + 1));
            state.check(self.bands.count()).map_err(fails)?;
        }
        Ok(self)
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

    /// Whether its values make sense; else what does not.
    fn check(&self, bands: usize) -> Result<(), String> {
        let (emission, excitation) = (self.emission.len(), self.excitation.len());
        if emission != bands {
            return Err(format!("emission has {emission} values, its bands are {bands}"));
        }
        if excitation > bands {
            return Err(format!("excitation has {excitation} values, its bands are {bands}"));
        }
        let values = [("decay", std::slice::from_ref(&self.decay)), ("excitation", &self.excitation[..])];
        for (what, values) in values.into_iter().chain([("emission", &self.emission[..])]) {
            if let Some(value) = values.iter().find(|value| !is_amount(**value)) {
                return Err(format!("{what} is {value}, not a finite number that is at least 0"));
            }
        }
        Ok(())
    }
}

/// Whether a number is finite and not negative.
pub fn is_amount(value: f64) -> bool {
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
        assert_eq!(state().charge(&[2.0, 4.0, 100.0]), 2.0, "the last band was not measured");
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
        assert_eq!(none.checked().expect_err("refused").to_string(), "test: has no state");
    }
}
