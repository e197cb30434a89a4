//! How weights follow their gradients.

mod adadelta;

pub use adadelta::{Adadelta, AdadeltaState};

use burn::optim::{AdamWConfig, ModuleOptimizer};
use serde::{Deserialize, Serialize};

/// An optimiser with its numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "method", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Optimiser {
    /// ADADELTA, as in the thesis (7.3.3). Its framework calls the decay momentum; there is no heavy-ball term.
    Adadelta {
        /// What every step is multiplied by; 1 in the paper.
        rate: f64,
        /// Decay of the running means.
        decay: f64,
        /// Keeps roots away from 0, and sets how far the first steps go.
        epsilon: f64,
    },
    /// AdamW (Loshchilov and Hutter 2019) with betas 0.9 and 0.99 and epsilon 1e-8; the rate rises linearly, then falls along
    /// half a cosine to a hundredth of itself at the last step. Where an image is dark structural similarity has gradients
    /// many times as large as elsewhere: with a second beta of 0.999 such a step goes three times the rate and the next ones on
    /// in its direction, from which the network for indirect light did not come back.
    Adamw {
        /// The highest rate.
        rate: f64,
        /// Share of itself that a weight loses a step, times the rate.
        weight_decay: f64,
        /// Steps until the highest rate.
        warm_up: usize,
    },
}

impl Optimiser {
    /// The paper's optimiser.
    pub const ADADELTA: Self = Self::Adadelta { rate: 1.0, decay: 0.9, epsilon: 1e-6 };
    /// The practical default.
    pub const ADAMW: Self = Self::Adamw { rate: 2e-3, weight_decay: 1e-4, warm_up: 200 };

    /// The highest rate of a run.
    pub const fn highest_rate(&self) -> f64 {
        let (Self::Adadelta { rate, .. } | Self::Adamw { rate, .. }) = *self;
        rate
    }

    /// The same with another highest rate.
    #[must_use]
    pub const fn with_rate(mut self, wanted: f64) -> Self {
        let (Self::Adadelta { rate, .. } | Self::Adamw { rate, .. }) = &mut self;
        *rate = wanted;
        self
    }

    /// Share of itself that a weight loses a step, times the rate.
    pub const fn weight_decay(&self) -> f64 {
        match *self {
            Self::Adadelta { .. } => 0.0,
            Self::Adamw { weight_decay, .. } => weight_decay,
        }
    }

    /// The same with another weight decay; of ADADELTA, which has none, as it is.
    #[must_use]
    pub const fn with_weight_decay(mut self, wanted: f64) -> Self {
        if let Self::Adamw { weight_decay, .. } = &mut self {
            *weight_decay = wanted;
        }
        self
    }

    /// A fresh optimiser.
    pub(crate) fn start(&self) -> ModuleOptimizer {
        match *self {
            Self::Adadelta { decay, epsilon, .. } => Adadelta { decay, epsilon }.into(),
            Self::Adamw { weight_decay, .. } => {
                let config = AdamWConfig::new().with_beta_2(0.99).with_epsilon(1e-8);
                config.with_weight_decay(weight_decay as f32).init()
            }
        }
    }

    /// The rate of a step, counted from 0, of a run of `steps`.
    pub fn rate(&self, step: usize, steps: usize) -> f64 {
        match *self {
            Self::Adadelta { rate, .. } => rate,
            Self::Adamw { rate, warm_up, .. } if step < warm_up => rate * (step + 1) as f64 / warm_up as f64,
            Self::Adamw { rate, warm_up, .. } => {
                let share = (step - warm_up) as f64 / (steps.saturating_sub(warm_up)).max(1) as f64;
                let fall = 0.5 + 0.5 * (std::f64::consts::PI * share.min(1.0)).cos();
                rate * (0.01 + 0.99 * fall)
            }
        }
    }
}

impl std::fmt::Display for Optimiser {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Adadelta { rate, decay, epsilon } => {
                write!(f, "ADADELTA, decay {decay}, epsilon {epsilon}, rate {rate}")
            }
            Self::Adamw { rate, weight_decay, warm_up } => {
                write!(f, "AdamW, rate {rate} (warm-up {warm_up} steps, cosine), weight decay {weight_decay}")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_rises_to_its_peak_and_falls_to_a_hundredth() {
        let adamw = Optimiser::Adamw { rate: 1.0, weight_decay: 0.0, warm_up: 10 };
        let close = |step, expected: f64| (adamw.rate(step, 110) - expected).abs() < 1e-12;
        assert!(close(0, 0.1) && close(9, 1.0) && close(10, 1.0) && close(60, 0.505) && close(110, 0.01));
        assert_eq!(Optimiser::ADADELTA.rate(7, 110), 1.0);
    }
}
