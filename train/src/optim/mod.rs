//! How weights follow their gradients.

mod adadelta;

pub use adadelta::{Adadelta, AdadeltaState};

use burn::grad_clipping::GradientClippingConfig;
use burn::optim::{AdamWConfig, ModuleOptimizer};
use serde::{Deserialize, Serialize};

/// An optimiser with its numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "method", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Optimiser {
    /// ADADELTA, as in the thesis (7.3.3). Its framework calls the decay momentum; there is no heavy-ball
    /// term.
    Adadelta {
        /// What every step is multiplied by; 1 in the paper.
        rate: f64,
        /// Decay of the running means.
        decay: f64,
        /// Keeps roots away from 0, and sets how far the first steps go.
        epsilon: f64,
    },
    /// AdamW (Loshchilov and Hutter 2019) with betas 0.9 and 0.99 and epsilon 1e-8. The rate rises linearly,
    /// stays until [`FLAT`] of the steps are done, and falls linearly to 0 at the last one. Gradients are
    /// clipped to a norm of 1 a tensor. Where an image is dark, structural similarity has gradients many
    /// times as large as elsewhere. With a second beta of 0.999 such a step went three times the rate, and
    /// the next ones went on in its direction. The network for indirect light did not come back from that.
    Adamw {
        /// The highest rate.
        rate: f64,
        /// Share of itself that a weight loses a step, times the rate.
        weight_decay: f64,
        /// Steps until the highest rate.
        warm_up: usize,
    },
}

/// The share of a run after which AdamW's rate falls.
pub const FLAT: f64 = 0.6;
/// The largest norm of the gradient of a tensor.
const CLIPPED: f32 = 1.0;

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
                let config = config.with_grad_clipping(Some(GradientClippingConfig::Norm(CLIPPED)));
                config.with_weight_decay(weight_decay as f32).init()
            }
        }
    }

    /// The rate of a step, counted from 0, of a run of `steps`.
    pub fn rate(&self, step: usize, steps: usize) -> f64 {
        match *self {
            Self::Adadelta { rate, .. } => rate,
            Self::Adamw { rate, warm_up, .. } if step < warm_up.min(steps / 10) => {
                rate * (step + 1) as f64 / warm_up.min(steps / 10) as f64
            }
            Self::Adamw { rate, .. } => {
                let share = step as f64 / steps.max(1) as f64;
                rate * ((1.0 - share) / (1.0 - FLAT)).clamp(0.0, 1.0)
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
                write!(
                    f,
                    "AdamW, rate {rate} (warm-up {warm_up} steps, flat, then to 0), weight decay {weight_decay}"
                )
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_rises_stays_and_falls_to_nothing() {
        let adamw = Optimiser::Adamw { rate: 1.0, weight_decay: 0.0, warm_up: 10 };
        let close = |step, expected: f64| (adamw.rate(step, 100) - expected).abs() < 1e-12;
        assert!(close(0, 0.1) && close(9, 1.0) && close(10, 1.0) && close(60, 1.0) && close(80, 0.5));
        assert!(close(100, 0.0));
        assert!((adamw.rate(1, 50) - 0.4).abs() < 1e-12, "a short run warms up for a tenth of it");
        assert_eq!(Optimiser::ADADELTA.rate(7, 110), 1.0);
    }
}
