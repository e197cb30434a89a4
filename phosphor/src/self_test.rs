//! Whether fits can be believed: materials that are known are measured in a simulated laboratory, and fitted.

mod coverage;
mod states;

pub use coverage::{Coverage, coverage};
pub use states::{StatesCompared, compare_states, hyperbolic_materials, two_state_materials};

/// What can go wrong where a known material is measured.
#[derive(Debug, thiserror::Error)]
pub enum SelfTestError {
    /// The material cannot be measured.
    #[error(transparent)]
    Simulation(#[from] crate::simulation::SimulationError),
    /// The fit failed.
    #[error("{material}, seed {seed}")]
    Fit {
        /// The material.
        material: String,
        /// The noise's seed.
        seed: u64,
        /// Why.
        source: crate::fit::FitError,
    },
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::{Fit, Laboratory};
    use deepshade_glow::file::MaterialFile;

    /// Over 40 seeds shares are known to some 1 % where a material has 12 parameters.
    #[test]
    fn intervals_hold_what_is_true_as_often_as_they_say() {
        for name in ["red", "yellow", "gloves"] {
            let material = MaterialFile::presets().named(name).expect("a preset").clone();
            let found = coverage(&Laboratory::thesis(), &material, 40).expect("fits");
            assert!((0.92..0.98).contains(&found.share), "{found:?}");
            assert!((0.9..1.1).contains(&found.residual_over_noise), "{found:?}");
        }
    }

    #[test]
    fn a_second_state_is_worth_what_the_thesis_says() {
        let found = compare_states(&Laboratory::thesis(), &two_state_materials(), 1).expect("fits");
        assert!(found.median_ratio < 0.08 && found.last_ratio < 0.18, "{found:?}");
        let [one, two] = found.differences;
        assert!(two[0] < 0.5 * one[0] && two[2] < one[2], "{found:?}");
    }

    /// The control: what two states do not explain is found out.
    #[test]
    fn two_states_do_not_explain_all_decays() {
        let (laboratory, materials) = (Laboratory::thesis(), hyperbolic_materials());
        let measurement = laboratory.measure(&materials[0], 1).expect("a measurement");
        let off = |states| Fit::new("x", &measurement, states).expect("a fit").residual_over_noise();
        assert!(off(2) > 2.0 && off(1) > 5.0 * off(2), "{} {}", off(1), off(2));
        let found = compare_states(&laboratory, &materials, 1).expect("fits");
        assert!((0.005..0.3).contains(&found.median_ratio), "{found:?}");
    }
}
