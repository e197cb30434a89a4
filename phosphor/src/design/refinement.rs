//! Rates that are better than those of the grid, by variable projection (Golub and Pereyra 1973): of the
//! rates alone the sum of squares is a function, the best re-radiation functions being known at once.

use super::Rates;
use super::problem::Problem;
use super::response::{Fitted, fitted};
use crate::least_squares::{Unknown, minimum};
use deepshade_glow::material::State;
use rayon::prelude::*;

/// Rates stay within these bounds, per second.
const DECAY: [f64; 2] = [1e-5, 10.0];
const EXCITATION: [f64; 2] = [0.0, 100.0];
/// How much leaving the start weighs beside the wanted colours: what key frames do not determine stays as it
/// was.
const STAYING: f64 = 1e-6;

/// The best rates that are found from any of the starts, with their functions; never worse than the best
/// start.
pub fn best(problem: &Problem, starts: &[Vec<Rates>]) -> (Vec<Rates>, Fitted) {
    let tried =
        starts.par_iter().flat_map_iter(|start| [Some(start.clone()), refined(problem, start)]).flatten();
    let found = tried.map(|rates| (fitted(problem, &rates), rates)).map(|(fitted, rates)| (rates, fitted));
    found.min_by(|a, b| a.1.cost().total_cmp(&b.1.cost())).expect("a start at least")
}

/// The rates where the sum of squares is least near a start; nothing where the solver finds none.
fn refined(problem: &Problem, start: &[Rates]) -> Option<Vec<Rates>> {
    let bands = problem.bands.count();
    let unknowns: Vec<Unknown> = start.iter().flat_map(unknowns).collect();
    let weight = STAYING * problem.size().sqrt();
    let residuals = |values: &[f64], residuals: &mut [f64]| {
        let (off, moved) = residuals.split_at_mut(problem.keys * bands);
        off.copy_from_slice(&fitted(problem, &unpacked(values, bands)).off);
        for ((moved, value), unknown) in moved.iter_mut().zip(values).zip(&unknowns) {
            *moved = weight * (value - unknown.start) / unknown.scale;
        }
    };
    let found = minimum(&unknowns, problem.keys * bands + unknowns.len(), residuals).ok()?;
    Some(unpacked(&found.values, bands))
}

/// A state's unknowns: the logarithm of its decay, and its excitation rates.
fn unknowns(rates: &Rates) -> impl Iterator<Item = Unknown> {
    let decay = Unknown { start: rates.decay.ln(), bounds: DECAY.map(f64::ln), scale: 1.0 };
    let excitation = |rate: &f64| Unknown { start: *rate, bounds: EXCITATION, scale: rate.max(0.01) };
    std::iter::once(decay).chain(rates.excitation.iter().map(excitation).collect::<Vec<_>>())
}

fn unpacked(values: &[f64], bands: usize) -> Vec<Rates> {
    let rates = |values: &[f64]| Rates { decay: values[0].exp(), excitation: values[1..].to_vec() };
    values.chunks(1 + bands).map(rates).collect()
}

/// The rates of a state that ended at a bound, in words. Below an excitation of 0 there is nothing.
pub fn at_bounds(state: &State) -> Vec<String> {
    let is = |rate: f64, bound: f64| (rate / bound - 1.0).abs() < 1e-9;
    let decays = DECAY.into_iter().filter(|bound| is(state.decay, *bound));
    let most = EXCITATION[1];
    let bands = (1..).zip(&state.excitation).filter(|(_, rate)| is(**rate, most));
    let bands = bands.map(|(band, _): (usize, _)| format!("excitation by band {band} is {most} per second"));
    decays.map(|bound| format!("decay is {bound} per second")).chain(bands).collect()
}
