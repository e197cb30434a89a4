//! Where a fit starts: the thesis' stages, one after the other, coarsely.

use super::FitError;
use super::measurement::{Filtered, Measurement, Shot};
use super::prediction::{Prediction, Unknowns};
use crate::least_squares::non_negative;
use deepshade_glow::spectrum::Bands;

/// How many rates are tried for the decay. They are spread evenly in their logarithm.
const RATES: usize = 24;
/// The excitation rates that are tried, times the band's light: powers of two from here on.
const LEAST_CHARGE: f64 = 1e-5;
const CHARGES: i32 = 24;

/// Unknowns near those that explain a measurement.
pub fn start(prediction: &Prediction) -> Result<Unknowns, FitError> {
    let measurement = prediction.measurement;
    let (decays, amounts) = decays(&measurement.decay, prediction.states)?;
    let brightness: f64 = amounts.iter().sum();
    let parts: Vec<f64> = amounts.iter().map(|amount| amount / brightness).collect();
    let left =
        |shot: &Shot| decays.iter().zip(&parts).map(|(rate, part)| part * shot.decayed(*rate)).sum::<f64>();
    let spectrum = match measurement.bands {
        Bands::Rgb => measurement.decay[0].radiance().map(|value| value.max(0.0)).to_vec(),
        Bands::Eight => spectrum(measurement, left),
    };
    let seen: f64 =
        measurement.sensor.iter().flat_map(|channel| channel.iter().zip(&spectrum)).map(|(a, b)| a * b).sum();
    if seen <= 0.0 {
        return Err(FitError::Dark);
    }
    let total = spectrum.iter().map(|value| value * brightness / seen).collect();
    let none = vec![0.0; measurement.excited_bands()];
    let mut unknowns = Unknowns { excitation: vec![none; decays.len()], decays, parts, total };
    charge(prediction, &mut unknowns);
    Ok(unknowns)
}

/// The spectrum that photographs through filters show where the light went off, none of it negative (thesis,
/// section 8.4.2, after Kirk and O'Brien 2011). `decay` says how much of that light is left while one is
/// taken.
fn spectrum(measurement: &Measurement, decay: impl Fn(&Shot) -> f64) -> Vec<f64> {
    let (mut rows, mut wanted) = (Vec::new(), Vec::new());
    for Filtered { filter, shot } in &measurement.spectrum {
        let (radiance, noise) = (shot.radiance(), shot.radiance_noise());
        for channel in 0..3 {
            let weight = decay(shot) / noise[channel];
            let pairs = measurement.filters[*filter].iter().zip(&measurement.sensor[channel]);
            rows.push(pairs.map(|(filter, sensor)| filter * sensor * weight).collect());
            wanted.push(radiance[channel] / noise[channel]);
        }
    }
    non_negative(&rows, &wanted)
}

/// Rates, fastest first, and what each brings to the sum of the channels where the light went off: the best
/// of all sets of rates on a grid.
fn decays(shots: &[Shot], states: usize) -> Result<(Vec<f64>, Vec<f64>), FitError> {
    let brightness = |shot: &Shot| shot.radiance().iter().sum::<f64>();
    let noise = |shot: &Shot| shot.radiance_noise().iter().map(|n| n * n).sum::<f64>().sqrt();
    let wanted: Vec<f64> = shots.iter().map(|shot| brightness(shot) / noise(shot)).collect();
    let cost = |rates: &[f64], amounts: &[f64]| -> f64 {
        let model =
            |shot: &Shot| rates.iter().zip(amounts).map(|(k, amount)| amount * shot.decayed(*k)).sum::<f64>();
        shots.iter().zip(&wanted).map(|(shot, wanted)| (model(shot) / noise(shot) - wanted).powi(2)).sum()
    };
    let tried = sets(&rates(shots), states).into_iter().map(|rates| {
        let row = |shot: &Shot| rates.iter().map(|rate| shot.decayed(*rate) / noise(shot)).collect();
        let amounts = non_negative(&shots.iter().map(row).collect::<Vec<_>>(), &wanted);
        (cost(&rates, &amounts), rates, amounts)
    });
    let (_, rates, amounts) = tried.min_by(|a, b| a.0.total_cmp(&b.0)).ok_or(FitError::Dark)?;
    if amounts.iter().sum::<f64>() > 0.0 { Ok((rates, amounts)) } else { Err(FitError::Dark) }
}

/// Rates that photographs can tell apart: from hardly any decay by the last to nearly all between two of
/// them.
fn rates(shots: &[Shot]) -> Vec<f64> {
    let last = shots.iter().map(|shot| shot.delay + shot.exposure.seconds).fold(0.0, f64::max);
    let (slowest, fastest) = (0.03 / last, 4.0 * shots.len() as f64 / last);
    (0..RATES).map(|i| fastest * (slowest / fastest).powf(i as f64 / (RATES - 1) as f64)).collect()
}

/// All sets of so many of the values, in their order.
fn sets(values: &[f64], count: usize) -> Vec<Vec<f64>> {
    if count == 0 {
        return vec![vec![]];
    }
    let with = |index: usize| {
        let rest = sets(&values[index + 1..], count - 1);
        rest.into_iter().map(move |set| std::iter::once(values[index]).chain(set).collect())
    };
    (0..values.len()).flat_map(with).collect()
}

/// Gives all states the excitation rate, band by band, that explains the measurement best.
fn charge(prediction: &Prediction, unknowns: &mut Unknowns) {
    for band in prediction.measurement.measured_bands() {
        let rate = |power: i32| LEAST_CHARGE * 2.0f64.powi(power) / prediction.measurement.light[band];
        let with = |rate: f64, unknowns: &Unknowns| {
            let mut changed = unknowns.clone();
            changed.excitation.iter_mut().for_each(|rates| rates[band] = rate);
            changed
        };
        let cost = |power: &i32| {
            let values: Vec<f64> =
                with(rate(*power), unknowns).unknowns(false).iter().map(|u| u.start).collect();
            let mut residuals = vec![0.0; prediction.count()];
            prediction.residuals(&values, &mut residuals);
            residuals.iter().map(|residual| residual * residual).sum::<f64>()
        };
        let best = (0..CHARGES).min_by(|a, b| cost(a).total_cmp(&cost(b))).unwrap_or(0);
        *unknowns = with(rate(best), unknowns);
    }
}
