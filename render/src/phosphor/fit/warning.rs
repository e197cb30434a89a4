//! Why a fit may not mean what it says, although there is one.

use super::interval::Parameter;
use super::{Fit, Measurement, start};

/// What may be left of a measurement, over its noise: all but the noise is 1, and errors that people state are right within some times.
pub const MOST_LEFT: f64 = 3.0;
/// How much of how the decay changes must be explained where nobody stated the noise.
pub const LEAST_EXPLAINED: f64 = 0.9;
/// A rate whose interval ends at more than so many times where it begins is hardly known.
const WIDE: f64 = 100.0;

/// A reason to doubt a fit. States are counted from 1 on.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Warning {
    /// More is left than noise.
    #[error(
        "residual over noise is {0:.1}, above {MOST_LEFT}: the material does not explain what was measured. are values \
         linear, exposures and times right, and are there more states?"
    )]
    Left(f64),
    /// Little of the decay is explained.
    #[error(
        "of how the decay changes {0:.2} is explained (R^2), below {LEAST_EXPLAINED}: the material says little of what was measured"
    )]
    Explained(f64),
    /// A state that sends nothing.
    #[error("state {0} sends no light: fewer states explain as much")]
    Dark(usize),
    /// A rate below those that can be told.
    #[error("state {0} decays more slowly than photographs over so short a time tell, if it does")]
    Slow(usize),
    /// A rate above those that can be told.
    #[error("state {0} decays faster than photographs so far apart tell")]
    Fast(usize),
    /// A rate whose interval is wide.
    #[error("the decay of state {0} is hardly known, as its interval says: fewer states may explain as much")]
    Unsure(usize),
}

/// All that there are for the fit of a measurement.
pub fn warnings(fit: &Fit, measurement: &Measurement) -> Vec<Warning> {
    let (left, explained) = (fit.residual_over_noise(), fit.explained());
    let whole = if measurement.noise_is_known {
        (left > MOST_LEFT).then_some(Warning::Left(left))
    } else {
        (explained < LEAST_EXPLAINED).then_some(Warning::Explained(explained))
    };
    let [slowest, fastest] = start::told(&measurement.decay);
    let of_state = |index: usize| {
        let state = &fit.material.states[index];
        let is_its = |of: &&super::Estimate| of.state == index && of.parameter == Parameter::Decay;
        let is_wide = |of: &super::Estimate| of.interval[1] > WIDE * of.interval[0];
        let about = match state.decay {
            _ if state.emission.iter().all(|value| *value == 0.0) => Warning::Dark,
            rate if rate < slowest => Warning::Slow,
            rate if rate > fastest => Warning::Fast,
            _ if fit.estimates.iter().find(is_its).is_some_and(is_wide) => Warning::Unsure,
            _ => return None,
        };
        Some(about(index + 1))
    };
    whole.into_iter().chain((0..fit.material.states.len()).filter_map(of_state)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::super::material::file::MaterialFile;
    use super::super::super::spectrum::Bands;
    use super::super::Laboratory;
    use super::*;

    fn measured() -> Measurement {
        let presets = MaterialFile::presets();
        Laboratory::thesis().measure(presets.named("blue").expect("a preset"), 1).expect("a measurement")
    }

    /// What a camera alone measures of the decay, without noise that anybody stated.
    fn in_rgb() -> Measurement {
        let unit = |channel: usize| (0..3).map(|band| f64::from(u8::from(band == channel))).collect();
        Measurement {
            bands: Bands::Rgb,
            sensor: [unit(0), unit(1), unit(2)],
            filters: vec![],
            light: vec![1.0; 3],
            spectrum: vec![],
            excitation: vec![],
            noise_is_known: false,
            ..measured()
        }
    }

    #[test]
    fn a_good_fit_is_not_doubted_and_noise_that_is_not_that_is() {
        let fitted = |measurement: &Measurement| Fit::new("x", measurement, 1).expect("a fit").warnings;
        let mut measurement = measured();
        assert_eq!(fitted(&measurement), []);
        assert_eq!(fitted(&in_rgb()), []);
        let decay = measurement.decay.iter_mut();
        let filtered = measurement.spectrum.iter_mut().map(|filtered| &mut filtered.shot);
        let charged = measurement.excitation.iter_mut().map(|charged| &mut charged.shot);
        for shot in decay.chain(filtered).chain(charged) {
            shot.noise = shot.noise.map(|noise| 0.1 * noise);
        }
        assert!(matches!(fitted(&measurement)[..], [Warning::Left(left)] if (left - 10.0).abs() < 2.0));
    }

    /// What goes up and down for ever is no decay, even where nobody knows the noise.
    #[test]
    fn a_curve_that_explains_nothing_is_found_out() {
        let mut measurement = in_rgb();
        for (index, shot) in measurement.decay.iter_mut().enumerate() {
            let radiance = if index % 2 == 0 { 1.0 } else { 0.8 };
            shot.value = [radiance * shot.exposure.gain; 3];
            shot.noise = [0.1 * shot.exposure.gain; 3];
        }
        let fit = Fit::new("x", &measurement, 1).expect("a fit");
        assert!(fit.explained() < 0.1, "{}", fit.explained());
        assert!(matches!(fit.warnings[0], Warning::Explained(_)), "{:?}", fit.warnings);
    }

    #[test]
    fn states_at_their_bounds_are_named() {
        let measurement = measured();
        let fit = Fit::new("x", &measurement, 1).expect("a fit");
        let with = |change: fn(&mut Fit)| {
            let mut changed = fit.clone();
            change(&mut changed);
            warnings(&changed, &measurement)
        };
        assert_eq!(with(|fit| fit.material.states[0].decay = 1e-6), [Warning::Slow(1)]);
        assert_eq!(with(|fit| fit.material.states[0].decay = 100.0), [Warning::Fast(1)]);
        assert_eq!(with(|fit| fit.material.states[0].emission.fill(0.0)), [Warning::Dark(1)]);
        assert_eq!(with(|fit| fit.estimates[0].interval = [0.001, 1.0]), [Warning::Unsure(1)]);
        assert_eq!(with(|fit| fit.estimates[0].interval = [0.0, f64::INFINITY]), [Warning::Unsure(1)]);
    }
}
