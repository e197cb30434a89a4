//! A material at one place through time: its excited shares, step after step.

use deepshade_glow::material::{Material, is_amount};
use deepshade_glow::rate::Scheme;

/// Why a material cannot be simulated or measured, in words.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct SimulationError(pub(crate) String);

/// A material at one place.
#[derive(Clone, Debug)]
pub struct Simulation<'a> {
    /// The material.
    pub material: &'a Material,
    /// The excited share of each state, in [0, 1].
    pub shares: Vec<f64>,
}

impl<'a> Simulation<'a> {
    /// A place that was in the dark for so long that nothing is excited.
    pub fn dark(material: &'a Material) -> Self {
        Self { material, shares: vec![0.0; material.states.len()] }
    }

    /// Goes `dt` seconds on under an irradiance, one value a band.
    ///
    /// # Errors
    /// If `dt` is negative or not finite, or irradiance is what [`charges`] refuses; nothing changes then.
    pub fn step(&mut self, irradiance: &[f64], dt: f64) -> Result<(), SimulationError> {
        if !(dt.is_finite() && dt >= 0.0) {
            let fault = format!("a step in time of {dt} s: it must be finite and at least 0");
            return Err(SimulationError(fault));
        }
        let charges = charges(self.material, irradiance)?;
        for ((share, state), charge) in self.shares.iter_mut().zip(&self.material.states).zip(charges) {
            *share = Scheme::Exact.step(*share, charge, state.decay, dt);
        }
        Ok(())
    }

    /// What is sent now, one value a band.
    pub fn emission(&self) -> Vec<f64> {
        self.material.emission(&self.shares)
    }
}

/// The rate at which irradiance (one value a band) excites each state, per second: the integral of equation
/// 8.1.
///
/// # Errors
/// If irradiance is negative, not finite or of other bands, or falls on what was never measured under light.
fn charges(material: &Material, irradiance: &[f64]) -> Result<Vec<f64>, SimulationError> {
    let (name, bands) = (&material.name, material.bands.count());
    let fails = || {
        let wanted = format!("{bands} finite numbers that are at least 0");
        SimulationError(format!("{name}: irradiance {irradiance:?} is not {wanted}"))
    };
    if irradiance.len() != bands || !irradiance.iter().copied().all(is_amount) {
        return Err(fails());
    }
    if irradiance.iter().any(|light| *light > 0.0) && !material.excitation_is_known() {
        return Err(SimulationError(format!(
            "{name}: its excitation was never measured, so light has no known effect; it can only decay"
        )));
    }
    let charges: Vec<f64> = material.states.iter().map(|state| state.charge(irradiance)).collect();
    if charges.iter().copied().all(is_amount) { Ok(charges) } else { Err(fails()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_glow::file::MaterialFile;
    use deepshade_glow::material::State;
    use deepshade_glow::paint::{LightInterval, Paint};
    use deepshade_glow::spectrum::Bands;
    use glam::{DVec3, Vec3};

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
    fn a_paint_does_what_its_material_does_under_the_same_colours() {
        let presets = MaterialFile::presets();
        let light = [0.3f64, 0.7, 1.9];
        for material in presets.materials.iter().filter(|material| material.excitation_is_known()) {
            let paint = Paint::new(material, None).expect("few states");
            let mut run = Simulation::dark(material);
            run.step(&material.bands.of_linear_srgb(light), 3.0).expect("a step");
            run.step(&vec![0.0; material.bands.count()], 2.0).expect("a step");
            let irradiance = DVec3::from(light).as_vec3();
            let past = [
                LightInterval { seconds: 3.0, irradiance },
                LightInterval { seconds: 2.0, irradiance: Vec3::ZERO },
            ];
            let shares = paint.after(0.0, past.into_iter());
            assert!((f64::from(shares[0]) - run.shares[0]).abs() < 1e-6, "{}", material.name);
            let expected = material.bands.linear_srgb(&run.emission()).map(|part| part.max(0.0) as f32);
            assert!((paint.emission(&shares) - Vec3::from(expected)).abs().max_element() < 1e-6);
        }
    }

    #[test]
    fn light_that_makes_no_sense_is_refused() {
        let material = material();
        for light in [vec![f64::NAN, 0.0, 0.0], vec![f64::INFINITY; 3], vec![-1.0; 3], vec![1.0; 2]] {
            let fault = charges(&material, &light).expect_err("refused").to_string();
            assert!(fault.starts_with("test: irradiance"), "{fault}");
        }
        let excited = |excitation: Vec<f64>| {
            let state = State { excitation, ..material.states[0].clone() };
            Material { states: vec![state], ..material.clone() }
        };
        assert!(charges(&excited(vec![1e200]), &[1e200, 0.0, 0.0]).is_err(), "a rate that no number holds");
        let unknown = excited(vec![]);
        assert_eq!(charges(&unknown, &[0.0; 3]), Ok(vec![0.0]));
        let fault = charges(&unknown, &[0.0, 0.1, 0.0]).expect_err("refused").to_string();
        assert!(fault.contains("was never measured"), "{fault}");
    }

    /// Long light holds the share at which filling and emptying are alike.
    #[test]
    fn long_light_ends_in_an_equilibrium() {
        let (material, light) = (material(), [0.5, 1.5, 0.2]);
        let mut run = Simulation::dark(&material);
        (0..2000).for_each(|_| run.step(&light, 0.1).expect("a step"));
        for (state, share) in material.states.iter().zip(&run.shares) {
            let charge = state.charge(&light);
            assert!((share - charge / (charge + state.decay)).abs() < 1e-6, "{run:?}");
        }
        assert!(run.emission().iter().all(|sent| *sent > 0.0));
    }

    #[test]
    fn each_state_decays_at_its_own_rate() {
        let material = material();
        let mut run = Simulation { material: &material, shares: vec![1.0, 0.5] };
        (0..100).for_each(|_| run.step(&[0.0; 3], 0.07).expect("a step"));
        let sent = run.emission()[1];
        let expected = 0.3 * (-0.3 * 7.0f64).exp() + 0.02 * 0.5 * (-0.02 * 7.0f64).exp();
        assert!((sent - expected).abs() < 1e-12, "{sent} {expected}");
    }

    #[test]
    fn what_makes_no_sense_is_refused_and_changes_nothing() {
        let material = material();
        let mut run = Simulation { material: &material, shares: vec![0.4, 0.6] };
        for dt in [-1e-9, f64::NAN, f64::INFINITY] {
            let fault = run.step(&[1.0; 3], dt).expect_err("refused").to_string();
            assert!(fault.starts_with("a step in time of"), "{fault}");
        }
        assert!(run.step(&[f64::NAN; 3], 1.0).is_err());
        run.step(&[1.0; 3], 0.0).expect("a step of no time");
        assert_eq!(run.shares, [0.4, 0.6]);
    }

    #[test]
    fn a_state_without_decay_fills_keeps_and_is_dark() {
        let state = State { decay: 0.0, excitation: vec![0.1], emission: vec![1.0; 3] };
        let material = Material { states: vec![state], ..material() };
        let mut run = Simulation::dark(&material);
        run.step(&[5.0, 0.0, 0.0], 1e6).expect("a step");
        run.step(&[0.0; 3], 1e6).expect("a step");
        assert_eq!((run.shares[0], run.emission()), (1.0, vec![0.0; 3]));
    }
}
