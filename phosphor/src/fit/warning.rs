//! Why a fit may not mean what it says, although there is one.

use super::interval::Parameter;
use super::{Fit, Measurement, Shot, State};
use crate::fit::checker::Checker;

/// What may be left of a measurement, over its noise: all but the noise is 1, and errors that people state
/// are right within some times.
const MOST_LEFT: f64 = 3.0;
/// How much of how the decay changes must be explained where nobody stated the noise.
const LEAST_EXPLAINED: f64 = 0.9;
/// A rate whose interval ends at more than so many times where it begins is hardly known, or, where
/// photographs are taken too late or too far apart for it, not told by them.
const WIDE: f64 = 100.0;
const LOOSE: f64 = 2.0;
/// A state that sends no more than this share of the light at the start sends none.
const DARK: f64 = 1e-9;
/// What a matrix may leave of a chart in the root mean square, where white is 1. The nominal camera leaves
/// 0.006, and noise and uneven light some more; nearly all swaps of two patches leave more than this.
const MOST_OF_CHART: f64 = 0.03;
/// A channel of the decay is below 0 by more than this share of the brightest one where the colour is one
/// that screens lack, and not by noise.
const OUTSIDE: f64 = 0.02;

/// A reason to doubt a fit. States are counted from 1 on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Warning {
    /// Much of a colour chart is left.
    #[error(
        "{rms:.3} is left of the colours of checker.csv (RMS, white being 1), above {MOST_OF_CHART}, most of \
        `{patch}`: are patches in their places, values linear, is the light even and as stated, and is \
        nothing full?"
    )]
    Chart {
        /// The root mean square.
        rms: f64,
        /// The patch of which most is left.
        patch: String,
    },
    /// A colour that screens lack.
    #[error(
        "{0} of the decay is negative in linear sRGB: screens lack so pure a colour, and the material has \
        the nearest that the fit finds"
    )]
    Outside(&'static str),
    /// More is left than noise.
    #[error(
        "residual over noise is {0:.1}, above {MOST_LEFT}: the material does not explain what was measured. \
        are values \
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
    let chart = measurement.checker.as_ref().and_then(of_chart);
    let outside = outside(measurement);
    let told = told(&measurement.decay);
    let of_state = |index: usize| about(fit, index, told).map(|warning| warning(index + 1));
    whole
        .into_iter()
        .chain(chart)
        .chain(outside)
        .chain((0..fit.material.states.len()).filter_map(of_state))
        .collect()
}

/// What there is to doubt of a colour chart.
fn of_chart(checker: &Checker) -> Option<Warning> {
    let Checker { rms, worst: (patch, _), .. } = checker;
    (*rms > MOST_OF_CHART || rms.is_nan()).then(|| Warning::Chart { rms: *rms, patch: patch.clone() })
}

/// The first channel of a decay in linear sRGB that is negative.
fn outside(measurement: &Measurement) -> Option<Warning> {
    let sum = |channel: usize| measurement.decay.iter().map(|shot| shot.radiance()[channel]).sum::<f64>();
    let sums = [0, 1, 2].map(sum);
    let brightest = sums.into_iter().fold(0.0, f64::max);
    let negative = (0..3).find(|channel| sums[*channel] < -OUTSIDE * brightest);
    negative
        .filter(|_| measurement.checker.is_some())
        .map(|channel| Warning::Outside(["red", "green", "blue"][channel]))
}

/// What there is to doubt of a state.
fn about(fit: &Fit, index: usize, [slowest, fastest]: [f64; 2]) -> Option<fn(usize) -> Warning> {
    let light = |state: &State| state.decay * state.emission.iter().sum::<f64>();
    let state = &fit.material.states[index];
    let is_wider = |times: f64| {
        let mut estimates = fit.estimates.iter();
        let its = estimates.find(|of| of.state == index && of.parameter == Parameter::Decay);
        its.is_some_and(|its| its.interval[1] > times * its.interval[0])
    };
    match state.decay {
        _ if light(state) <= DARK * fit.material.states.iter().map(light).sum::<f64>() => Some(Warning::Dark),
        rate if rate < slowest && is_wider(LOOSE) => Some(Warning::Slow),
        rate if rate > fastest && is_wider(LOOSE) => Some(Warning::Fast),
        _ if is_wider(WIDE) => Some(Warning::Unsure),
        _ => None,
    }
}

/// The slowest and the fastest rate that photographs can tell by themselves: hardly any decay by the last,
/// and nearly all between the two that are nearest.
fn told(shots: &[Shot]) -> [f64; 2] {
    let last = shots.iter().map(|shot| shot.delay + shot.exposure.seconds).fold(0.0, f64::max);
    let gaps = shots.windows(2).map(|pair| pair[1].delay - pair[0].delay).filter(|gap| *gap > 0.0);
    [0.03 / last, 4.0 / gaps.fold(f64::INFINITY, f64::min)]
}

#[cfg(test)]
mod tests {
    use super::super::Laboratory;
    use super::super::tests::in_rgb;
    use super::*;
    use deepshade_glow::file::MaterialFile;

    fn measured() -> Measurement {
        let presets = MaterialFile::presets();
        Laboratory::thesis().measure(presets.named("blue").expect("a preset"), 1).expect("a measurement")
    }

    /// Colours without noise that anybody stated.
    fn colours() -> Measurement {
        Measurement { noise_is_known: false, ..in_rgb(&measured()) }
    }

    #[test]
    fn a_good_fit_is_not_doubted_and_noise_that_is_not_that_is() {
        let fitted = |measurement: &Measurement| Fit::new("x", measurement, 1).expect("a fit").warnings;
        let mut measurement = measured();
        assert_eq!(fitted(&measurement), []);
        assert_eq!(fitted(&colours()), []);
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
        let mut measurement = colours();
        for (index, shot) in measurement.decay.iter_mut().enumerate() {
            let radiance = if index % 2 == 0 { 1.0 } else { 0.8 };
            shot.value = [radiance * shot.exposure.gain; 3];
            shot.noise = [0.1 * shot.exposure.gain; 3];
        }
        let fit = Fit::new("x", &measurement, 1).expect("a fit");
        assert!(fit.explained() < 0.1, "{}", fit.explained());
        assert!(matches!(fit.warnings[0], Warning::Explained(_)), "{:?}", fit.warnings);
    }

    /// Photographs that are close at first tell what is fast, however late the last is.
    #[test]
    fn the_nearest_photographs_tell_the_fastest_rate() {
        let shot = |delay: f64| Shot { delay, ..measured().decay[0] };
        let [slowest, fastest] = told(&[0.0, 0.1, 0.2, 10.0, 100.0].map(shot));
        assert!((fastest - 40.0).abs() < 1e-9 && slowest < 3.1e-4, "{slowest} {fastest}");
    }

    /// Rounding is no change that anybody could explain.
    #[test]
    fn nothing_is_explained_of_a_steady_light() {
        let mut fit = Fit::new("x", &colours(), 1).expect("a fit");
        for (index, value) in fit.values.iter_mut().enumerate() {
            (value.measured, value.fitted) = (0.1 + 1e-15 * (index % 2) as f64, 0.09);
        }
        assert_eq!(fit.explained(), 0.0);
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
        let at = |rate: f64, wide: f64| {
            let mut changed = fit.clone();
            (changed.material.states[0].decay, changed.estimates[0].interval) = (rate, [rate, wide * rate]);
            warnings(&changed, &measurement)
        };
        assert_eq!((at(1e-6, 3.0), at(1e-6, 1.5)), (vec![Warning::Slow(1)], vec![]));
        assert_eq!((at(100.0, 3.0), at(100.0, 1.5)), (vec![Warning::Fast(1)], vec![]));
        assert_eq!(at(100.0, f64::INFINITY), [Warning::Fast(1)]);
        assert_eq!(with(|fit| fit.material.states[0].emission.fill(0.0)), [Warning::Dark(1)]);
        let faint = |part: f64| {
            let mut changed = fit.clone();
            let mut state = changed.material.states[0].clone();
            state.emission.iter_mut().for_each(|value| *value *= part);
            changed.material.states.push(state);
            warnings(&changed, &measurement)
        };
        assert_eq!((faint(1e-12), faint(1e-6)), (vec![Warning::Dark(2)], vec![]));
        assert_eq!(with(|fit| fit.estimates[0].interval = [0.001, 1.0]), [Warning::Unsure(1)]);
        assert_eq!(with(|fit| fit.estimates[0].interval = [0.0, f64::INFINITY]), [Warning::Unsure(1)]);
    }
}
