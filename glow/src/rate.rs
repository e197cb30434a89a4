//! One step of the rate equation (thesis, equation 8.1) at one place, of one state:
//!
//! `dr/dt = (1 - r) charge - decay r`, where `charge` is the integral of excitation rate times irradiance.

/// How a step in time is made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scheme {
    /// The solution for light that stays the same during the step: exact for such light, and stable for steps
    /// of any length.
    #[default]
    Exact,
    /// Forward Euler, as in the thesis (section 8.5). Its error grows with the step, and steps longer than
    /// `2 / (charge + decay)` swing; the share is then cut to [0, 1].
    Euler,
}

impl Scheme {
    /// The excited share after `dt` seconds, in [0, 1] whatever the step.
    ///
    /// All arguments are finite and not negative, `share` is in [0, 1]. Without charge and decay the share
    /// stays.
    pub fn step(self, share: f64, charge: f64, decay: f64, dt: f64) -> f64 {
        let next = match self {
            Self::Exact => share + (equilibrium(charge, decay, share) - share) * progress(charge + decay, dt),
            Self::Euler => share + dt * ((1.0 - share) * charge - decay * share),
        };
        next.clamp(0.0, 1.0)
    }
}

/// The share that light holds for ever, `charge / (charge + decay)`; `otherwise` where nothing fills or
/// empties it.
fn equilibrium(charge: f64, decay: f64, otherwise: f64) -> f64 {
    let total = charge + decay;
    if total > 0.0 { charge / total } else { otherwise }
}

/// How much of the way to the equilibrium a time goes: `1 - exp(-rate dt)`, without loss for small steps.
fn progress(rate: f64, dt: f64) -> f64 {
    -(-rate * dt).exp_m1()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const CHARGE: f64 = 0.7;
    const DECAY: f64 = 0.2;

    /// The share after `time` seconds in `steps` equal steps.
    fn after(scheme: Scheme, start: f64, charge: f64, time: f64, steps: u32) -> f64 {
        let dt = time / f64::from(steps);
        (0..steps).fold(start, |share, _| scheme.step(share, charge, DECAY, dt))
    }

    #[test]
    fn exact_steps_are_the_closed_forms_whatever_their_number() {
        for steps in [1, 7, 1000] {
            let dark = after(Scheme::Exact, 0.9, 0.0, 5.0, steps);
            assert!((dark - 0.9 * (-DECAY * 5.0f64).exp()).abs() < 1e-12, "dark decay in {steps}: {dark}");
            let total = CHARGE + DECAY;
            let lit = after(Scheme::Exact, 0.1, CHARGE, 3.0, steps);
            let expected = CHARGE / total + (0.1 - CHARGE / total) * (-total * 3.0f64).exp();
            assert!((lit - expected).abs() < 1e-12, "constant light in {steps}: {lit}");
        }
    }

    #[test]
    fn long_steps_reach_the_equilibrium_and_strong_light_saturates() {
        assert!((Scheme::Exact.step(0.0, CHARGE, DECAY, 1e9) - CHARGE / (CHARGE + DECAY)).abs() < 1e-12);
        assert!((Scheme::Exact.step(0.0, 1e12, DECAY, 1.0) - 1.0).abs() < 1e-12);
        assert_eq!(Scheme::Exact.step(0.3, 0.0, DECAY, f64::MAX), 0.0);
    }

    #[test]
    fn nothing_happens_in_no_time_and_without_rates() {
        for scheme in [Scheme::Exact, Scheme::Euler] {
            assert_eq!(scheme.step(0.37, CHARGE, DECAY, 0.0), 0.37);
            assert_eq!(scheme.step(0.37, 0.0, 0.0, 1e6), 0.37);
        }
    }

    #[test]
    fn halving_the_step_halves_the_error_of_euler() {
        let exact = after(Scheme::Exact, 0.0, CHARGE, 2.0, 1);
        let error = |steps| (after(Scheme::Euler, 0.0, CHARGE, 2.0, steps) - exact).abs();
        for steps in [50, 100, 200] {
            let ratio = error(steps) / error(2 * steps);
            assert!((1.95..2.05).contains(&ratio), "{steps} steps: {ratio}");
        }
    }

    #[test]
    fn small_steps_lose_nothing() {
        let step = Scheme::Exact.step(0.0, 1e-13, 0.0, 1e-3);
        assert!((step / 1e-16 - 1.0).abs() < 1e-9, "{step}");
    }

    proptest! {
        #[test]
        fn shares_stay_shares(
            share in 0.0..=1.0f64, charge in 0.0..1e30f64, decay in 0.0..1e30f64, dt in 0.0..1e30f64,
        ) {
            for scheme in [Scheme::Exact, Scheme::Euler] {
                prop_assert!((0.0..=1.0).contains(&scheme.step(share, charge, decay, dt)));
            }
        }

        #[test]
        fn exact_steps_never_pass_the_equilibrium(
            share in 0.0..=1.0f64, charge in 0.0..9.0f64, decay in 0.0..9.0f64, dt in 0.0..99.0f64,
        ) {
            let (rest, next) = (equilibrium(charge, decay, share), Scheme::Exact.step(share, charge, decay, dt));
            prop_assert!((rest - next).abs() <= (rest - share).abs() + 1e-15);
        }
    }
}
