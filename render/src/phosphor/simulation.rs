//! A material at one place through time: its excited shares, step after step.

use super::material::{Material, MaterialError};
use super::rate::{Scheme, equilibrium};

/// What a place was like before the first step.
#[derive(Clone, Copy, Debug)]
pub enum Initial<'a> {
    /// In the dark for so long that nothing is excited.
    Dark,
    /// These excited shares, one a state, each in [0, 1].
    Shares(&'a [f64]),
    /// Under this irradiance, one value a band, for so long that nothing changes. A state that nothing fills or empties
    /// is not excited.
    LitForLong(&'a [f64]),
}

/// A material at one place.
#[derive(Clone, Debug)]
pub struct Simulation<'a> {
    material: &'a Material,
    scheme: Scheme,
    shares: Vec<f64>,
}

impl<'a> Simulation<'a> {
    /// The place before the first step.
    ///
    /// # Errors
    /// If shares are not one number in [0, 1] a state, or irradiance is what [`Material::charges`] refuses.
    pub fn new(material: &'a Material, scheme: Scheme, initial: Initial) -> Result<Self, MaterialError> {
        let shares = match initial {
            Initial::Dark => vec![0.0; material.states.len()],
            Initial::Shares(shares) => checked(material, shares)?,
            Initial::LitForLong(irradiance) => {
                let charges = material.charges(irradiance)?;
                material
                    .states
                    .iter()
                    .zip(charges)
                    .map(|(s, charge)| equilibrium(charge, s.decay, 0.0))
                    .collect()
            }
        };
        Ok(Self { material, scheme, shares })
    }

    /// Goes `dt` seconds on under an irradiance, one value a band.
    ///
    /// # Errors
    /// If `dt` is negative or not finite, or irradiance is what [`Material::charges`] refuses; nothing changes then.
    pub fn step(&mut self, irradiance: &[f64], dt: f64) -> Result<(), MaterialError> {
        if !(dt.is_finite() && dt >= 0.0) {
            return Err(MaterialError::TimeStep(dt));
        }
        let charges = self.material.charges(irradiance)?;
        for ((share, state), charge) in self.shares.iter_mut().zip(&self.material.states).zip(charges) {
            *share = self.scheme.step(*share, charge, state.decay, dt);
        }
        Ok(())
    }

    /// The excited share of each state, in [0, 1].
    pub fn shares(&self) -> &[f64] {
        &self.shares
    }

    /// What is sent now, one value a band.
    pub fn emission(&self) -> Vec<f64> {
        self.material.emission(&self.shares)
    }
}

fn checked(material: &Material, shares: &[f64]) -> Result<Vec<f64>, MaterialError> {
    let fits =
        shares.len() == material.states.len() && shares.iter().all(|share| (0.0..=1.0).contains(share));
    fits.then(|| shares.to_vec()).ok_or_else(|| MaterialError::Shares {
        material: material.name.clone(),
        shares: shares.to_vec(),
        states: material.states.len(),
    })
}

#[cfg(test)]
mod tests {
    use super::super::material::State;
    use super::super::spectrum::Bands;
    use super::*;

    fn material() -> Material {
        let state = |decay, excitation: [f64; 3]| State {
            decay,
            excitation: excitation.to_vec(),
            emission: vec![decay, 1.0, 2.0],
        };
        let states = vec![state(0.3, [0.1, 0.2, 0.0]), state(0.02, [0.0, 0.05, 0.4])];
        Material { name: "test".into(), bands: Bands::Rgb, doubt: None, states }
    }

    #[test]
    fn long_light_is_where_a_long_simulation_ends() {
        let (material, light) = (material(), [0.5, 1.5, 0.2]);
        let start = Simulation::new(&material, Scheme::Exact, Initial::LitForLong(&light)).expect("a start");
        let mut run = Simulation::new(&material, Scheme::Exact, Initial::Dark).expect("a start");
        (0..2000).for_each(|_| run.step(&light, 0.1).expect("a step"));
        assert!(start.shares().iter().zip(run.shares()).all(|(a, b)| (a - b).abs() < 1e-6), "{run:?}");
        assert!(run.emission().iter().all(|sent| *sent > 0.0));
    }

    #[test]
    fn each_state_decays_at_its_own_rate() {
        let material = material();
        let mut run =
            Simulation::new(&material, Scheme::Exact, Initial::Shares(&[1.0, 0.5])).expect("a start");
        (0..100).for_each(|_| run.step(&[0.0; 3], 0.07).expect("a step"));
        let sent = run.emission()[1];
        let expected = 0.3 * (-0.3 * 7.0f64).exp() + 0.02 * 0.5 * (-0.02 * 7.0f64).exp();
        assert!((sent - expected).abs() < 1e-12, "{sent} {expected}");
    }

    #[test]
    fn what_makes_no_sense_is_refused_and_changes_nothing() {
        let material = material();
        for shares in [&[0.5][..], &[0.5, 1.1], &[0.5, f64::NAN], &[-0.1, 0.0]] {
            assert!(
                Simulation::new(&material, Scheme::Exact, Initial::Shares(shares)).is_err(),
                "{shares:?}"
            );
        }
        let mut run =
            Simulation::new(&material, Scheme::Exact, Initial::Shares(&[0.4, 0.6])).expect("a start");
        for dt in [-1e-9, f64::NAN, f64::INFINITY] {
            assert!(matches!(run.step(&[1.0; 3], dt), Err(MaterialError::TimeStep(_))), "{dt}");
        }
        assert!(run.step(&[f64::NAN; 3], 1.0).is_err());
        run.step(&[1.0; 3], 0.0).expect("a step of no time");
        assert_eq!(run.shares(), [0.4, 0.6]);
    }

    #[test]
    fn a_state_without_decay_fills_keeps_and_is_dark() {
        let state = State { decay: 0.0, excitation: vec![0.1], emission: vec![1.0; 3] };
        let material = Material { states: vec![state], ..material() };
        let mut run =
            Simulation::new(&material, Scheme::Exact, Initial::LitForLong(&[0.0; 3])).expect("a start");
        assert_eq!(run.shares(), [0.0]);
        run.step(&[5.0, 0.0, 0.0], 1e6).expect("a step");
        run.step(&[0.0; 3], 1e6).expect("a step");
        assert_eq!((run.shares()[0], run.emission()), (1.0, vec![0.0; 3]));
    }
}
