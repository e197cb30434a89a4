//! How many samples truth takes: a count, or as many as an error needs.

use crate::arguments::positive;
use deepshade_render::path::Goal;
use deepshade_render::sampler::MAX_SAMPLES;

/// Most samples of a pixel by default where an error is asked for.
const MOST_FOR_AN_ERROR: u32 = 16_384;

/// When truth has samples enough.
#[derive(clap::Args, Clone, Copy, Debug)]
pub struct Args {
    /// Samples a pixel of truth, rounded up to a multiple of 8; with --error the most, 16384 by default.
    #[arg(long, visible_alias = "samples", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SAMPLES)))]
    spp: Option<u32>,
    /// Stops once truth's noise is below this share of its values (the square root of the noise's relative
    /// mean squared error); looked at whenever the samples have doubled, from 128 on.
    #[arg(long, value_parser = positive)]
    error: Option<f32>,
}

impl Args {
    /// At most so many samples of a pixel, where that is stated, and so much noise.
    pub const fn new(spp: Option<u32>, error: Option<f32>) -> Self {
        Self { spp, error }
    }

    /// How many samples are asked for.
    pub const fn spp(&self) -> Option<u32> {
        self.spp
    }

    /// Which error is asked for.
    pub const fn error(&self) -> Option<f32> {
        self.error
    }

    /// What is asked for, else so many samples.
    pub fn goal(self, samples: u32) -> Goal {
        let default = if self.error.is_some() { MOST_FOR_AN_ERROR } else { samples };
        Goal { samples: self.spp.unwrap_or(default), error: self.error }
    }
}

/// What is to be said of noise, a relative mean squared error, that is above what was asked for.
pub fn complaint(goal: Goal, noise_relmse: f64) -> Option<String> {
    let error = goal.error.filter(|error| noise_relmse.sqrt() > f64::from(*error))?;
    Some(format!(
        "truth's noise is above --error {error}: --spp allows no more than {} samples",
        goal.samples
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_may_take_many_samples_and_fewer_where_that_is_asked_for() {
        let goal = |spp, error| Args { spp, error }.goal(256);
        assert_eq!(goal(None, None), Goal::samples(256));
        assert_eq!(goal(None, Some(0.02)), Goal { samples: MOST_FOR_AN_ERROR, error: Some(0.02) });
        assert_eq!(goal(Some(64), Some(0.02)).samples, 64);
        assert!(complaint(goal(None, Some(0.02)), 1e-3).is_some_and(|text| text.contains("0.02")));
        assert_eq!(complaint(goal(None, Some(0.02)), 1e-4), None);
        assert_eq!(complaint(goal(None, None), 1.0), None);
    }
}
