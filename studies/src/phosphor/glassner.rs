//! The rival: phosphorescence as an integral over the past (Glassner 1995, "A Model for Fluorescence and
//! Phosphorescence"), estimated from times drawn by the decay, as in the thesis' Figure 8.16.
//!
//! Light that excited a state `s` seconds ago counts by `exp(-decay s)`. The model has no saturation: it is
//! the rate equation where excited shares are far below 1. To know what is sent now, irradiance at other
//! times is needed, so that a renderer either keeps all that it had, or renders it anew for each sample.

use deepshade_glow::material::{Material, State};
use deepshade_phosphor::noise::Noise;

/// Irradiance of an animation's frames so far at one place, one value a band, and the time between them.
#[derive(Clone, Copy, Debug)]
pub struct Past<'a> {
    /// The frames, the latest last. Before them it was dark.
    pub irradiance: &'a [Vec<f64>],
    /// Between frames, in seconds.
    pub dt: f64,
}

impl Past<'_> {
    /// What is sent when the last frame is over, one value a band, estimated from so many times drawn for
    /// each state.
    pub fn sampled(&self, material: &Material, samples: usize, noise: &mut Noise) -> Vec<f64> {
        let excited = |state: &State| {
            let drawn: f64 = (0..samples).map(|_| self.charge(state, self.draw(state.decay, noise))).sum();
            self.reach(state.decay) * drawn / samples as f64
        };
        let shares: Vec<f64> = material.states.iter().map(excited).collect();
        material.emission(&shares)
    }

    /// The same as a sum over all frames, exact for irradiance that stays the same within a frame.
    pub fn summed(&self, material: &Material) -> Vec<f64> {
        let excited = |state: &State| {
            let (mut share, mut left) = (0.0, 1.0);
            let decayed = (-state.decay * self.dt).exp();
            let within = if state.decay > 0.0 { (1.0 - decayed) / state.decay } else { self.dt };
            for light in self.irradiance.iter().rev() {
                share += left * within * state.charge(light);
                left *= decayed;
            }
            share
        };
        let shares: Vec<f64> = material.states.iter().map(excited).collect();
        material.emission(&shares)
    }

    /// How many samples the standard deviation of what is sent, over all bands, needs to be `error` of it:
    /// from so many trials of one sample each.
    pub fn samples_for(&self, material: &Material, error: f64, trials: usize, noise: &mut Noise) -> f64 {
        let exact: f64 = self.summed(material).iter().sum();
        let off = |_| (self.sampled(material, 1, noise).iter().sum::<f64>() / exact - 1.0).powi(2);
        let variance = (0..trials).map(off).sum::<f64>() / trials as f64;
        (variance / (error * error)).max(1.0)
    }

    /// The integral of the decay over the whole past.
    fn reach(&self, decay: f64) -> f64 {
        let past = self.dt * self.irradiance.len() as f64;
        if decay > 0.0 { -(-decay * past).exp_m1() / decay } else { past }
    }

    /// Seconds ago, drawn in proportion to the decay over the past.
    fn draw(&self, decay: f64, noise: &mut Noise) -> f64 {
        let number = noise.uniform();
        if decay > 0.0 {
            -(-number * decay * self.reach(decay)).ln_1p() / decay
        } else {
            number * self.reach(decay)
        }
    }

    fn charge(&self, state: &State, ago: f64) -> f64 {
        let frames_ago = (ago / self.dt) as usize;
        let frame = self.irradiance.len().checked_sub(frames_ago + 1);
        frame.map_or(0.0, |frame| state.charge(&self.irradiance[frame]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_glow::spectrum::Bands;
    use deepshade_phosphor::simulation::Simulation;

    fn material(excitation: f64) -> Material {
        let state =
            |decay, emission: f64| State { decay, excitation: vec![excitation], emission: vec![emission; 3] };
        let states = vec![state(0.03, 1.0), state(0.4, 2.0)];
        Material { name: "test".into(), bands: Bands::Rgb, doubt: None, states }
    }

    fn light(frames: usize) -> Vec<Vec<f64>> {
        (0..frames).map(|frame| vec![if frame % 50 < 20 { 1.0 } else { 0.0 }, 0.0, 0.0]).collect()
    }

    fn simulated(material: &Material, light: &[Vec<f64>]) -> f64 {
        let mut run = Simulation::dark(material);
        light.iter().for_each(|light| run.step(light, 0.1).expect("a step"));
        run.emission()[0]
    }

    #[test]
    fn weak_light_is_that_of_the_rate_equation_and_strong_light_is_not() {
        let light = light(333);
        let past = Past { irradiance: &light, dt: 0.1 };
        let ratio = |excitation| {
            let material = material(excitation);
            past.summed(&material)[0] / simulated(&material, &light)
        };
        assert!((ratio(1e-8) - 1.0).abs() < 1e-6, "{}", ratio(1e-8));
        assert!(ratio(0.5) > 1.5, "without saturation it is too bright: {}", ratio(0.5));
    }

    #[test]
    fn samples_have_the_sum_as_their_mean() {
        let (light, material, mut noise) = (light(333), material(0.01), Noise::new(1));
        let past = Past { irradiance: &light, dt: 0.1 };
        let (exact, trials) = (past.summed(&material)[0], 20_000);
        let drawn: Vec<f64> =
            (0..trials).map(|_| past.sampled(&material, 4, &mut noise)[0] / exact - 1.0).collect();
        let mean = drawn.iter().sum::<f64>() / trials as f64;
        let error = (drawn.iter().map(|off| off * off).sum::<f64>()).sqrt() / trials as f64;
        assert!(mean.abs() < 3.5 * error && error < 0.01, "{mean} +- {error}");
    }

    #[test]
    fn as_many_samples_as_asked_for_have_the_error_that_was_asked_for() {
        let (light, material, mut noise) = (light(333), material(0.01), Noise::new(2));
        let past = Past { irradiance: &light, dt: 0.1 };
        let samples = past.samples_for(&material, 0.05, 20_000, &mut noise).round() as usize;
        let exact = past.summed(&material)[0];
        let off = |_| (past.sampled(&material, samples, &mut noise)[0] / exact - 1.0).powi(2);
        let error = ((0..1000).map(off).sum::<f64>() / 1000.0).sqrt();
        assert!((0.045..0.055).contains(&error), "{samples} samples: {error}");
    }

    #[test]
    fn states_without_decay_and_no_past_are_dark() {
        let mut dark = material(0.1);
        dark.states.iter_mut().for_each(|state| state.decay = 0.0);
        let (light, mut noise) = (light(10), Noise::new(1));
        let past = Past { irradiance: &light, dt: 0.1 };
        assert_eq!((past.sampled(&dark, 3, &mut noise), past.summed(&dark)), (vec![0.0; 3], vec![0.0; 3]));
        let none = Past { irradiance: &[], dt: 0.1 };
        assert_eq!(
            (none.sampled(&material(0.1), 3, &mut noise), none.summed(&dark)),
            (vec![0.0; 3], vec![0.0; 3])
        );
    }
}
