//! Rates that are better than those of the grid, by variable projection (Golub and Pereyra 1973): of the rates alone the sum of
//! squares is a function, the best re-radiation functions being known at once. Its derivatives are Kaufman's (1975), which leave
//! out what vanishes where the fit is good: those of the responses, less what re-radiation functions make up for. Steps are
//! those of Levenberg and Marquardt, within bounds.

use super::super::material::State;
use super::Rates;
use super::problem::Problem;
use super::response::{Fitted, amounts, dot, fitted, off, slopes};
use rayon::prelude::*;

/// Rates stay within these bounds, per second.
const DECAY: [f64; 2] = [1e-5, 10.0];
const EXCITATION: [f64; 2] = [0.0, 100.0];
/// How much leaving the start weighs beside the wanted colours: what key frames do not determine stays as it was.
const STAYING: f64 = 1e-6;
/// Steps at most, and how often a step is made shorter.
const STEPS: usize = 100;
const TRIES: usize = 12;
/// The search ends where a step lowers the sum of squares by no more than this part.
const ENOUGH: f64 = 1e-9;

/// An unknown: a change of the start in units of its scale.
struct Unknown {
    start: f64,
    scale: f64,
    bounds: [f64; 2],
}

/// The sum of squares at a place, with half its gradient and half its curvature, row-major.
struct Slope {
    cost: f64,
    gradient: Vec<f64>,
    curvature: Vec<f64>,
}

/// The best rates that are found from any of the starts, with their functions; never worse than the best start.
pub fn best(problem: &Problem, starts: &[Vec<Rates>]) -> (Vec<Rates>, Fitted) {
    let tried = starts.par_iter().flat_map_iter(|start| [start.clone(), refined(problem, start)]);
    let found = tried.map(|rates| (fitted(problem, &rates), rates)).map(|(fitted, rates)| (rates, fitted));
    found.min_by(|a, b| a.1.cost.total_cmp(&b.1.cost)).expect("a start at least")
}

/// The rates where the sum of squares is least near a start.
fn refined(problem: &Problem, start: &[Rates]) -> Vec<Rates> {
    let unknowns: Vec<Unknown> = start.iter().flat_map(unknowns).collect();
    let staying = STAYING * STAYING * problem.size();
    let slope_at = |x: &[f64]| slope(problem, &unknowns, x, staying);
    let mut x = vec![0.0; unknowns.len()];
    let (mut here, mut damping) = (slope_at(&x), 1e-3);
    for _ in 0..STEPS {
        let Some((next, there)) = (0..TRIES).find_map(|_| {
            let next = stepped(&here, &x, &unknowns, damping);
            let there = slope_at(&next);
            let better = there.cost < here.cost;
            damping *= if better { 0.1 } else { 10.0 };
            better.then_some((next, there))
        }) else {
            break;
        };
        let won = here.cost - there.cost;
        (x, here) = (next, there);
        if won <= ENOUGH * here.cost {
            break;
        }
    }
    unpacked(&x, &unknowns, problem.bands.count())
}

/// Where a damped step leads to. Unknowns that a bound holds stay there.
fn stepped(here: &Slope, x: &[f64], unknowns: &[Unknown], damping: f64) -> Vec<f64> {
    let count = x.len();
    let held = |index: &usize| {
        let [low, high] = unknowns[*index].reach();
        let (at, gradient) = (x[*index], here.gradient[*index]);
        (at <= low && gradient > 0.0) || (at >= high && gradient < 0.0)
    };
    let free: Vec<usize> = (0..count).filter(|index| !held(index)).collect();
    let entry = |row: usize, column: usize| {
        let (row, column) = (free[row], free[column]);
        let value = here.curvature[row * count + column];
        if row == column { value * (1.0 + damping) } else { value }
    };
    let wanted: Vec<f64> = free.iter().map(|index| -here.gradient[*index]).collect();
    let mut next = x.to_vec();
    for (index, step) in free.iter().zip(solved(entry, wanted)) {
        let [low, high] = unknowns[*index].reach();
        next[*index] = (x[*index] + step).clamp(low, high);
    }
    next
}

/// The solution of equations whose matrix is symmetric and positive, by Cholesky's decomposition; what has no weight stays 0.
fn solved(entry: impl Fn(usize, usize) -> f64, mut x: Vec<f64>) -> Vec<f64> {
    let count = x.len();
    let mut lower = vec![0.0; count * count];
    for row in 0..count {
        for column in 0..=row {
            let known: f64 = (0..column).map(|k| lower[row * count + k] * lower[column * count + k]).sum();
            let left = entry(row, column) - known;
            lower[row * count + column] = match row == column {
                true if left > 0.0 => left.sqrt(),
                true => f64::INFINITY,
                false => left / lower[column * count + column],
            };
        }
    }
    for row in 0..count {
        let known: f64 = (0..row).map(|k| lower[row * count + k] * x[k]).sum();
        x[row] = (x[row] - known) / lower[row * count + row];
    }
    for row in (0..count).rev() {
        let known: f64 = (row + 1..count).map(|k| lower[k * count + row] * x[k]).sum();
        x[row] = (x[row] - known) / lower[row * count + row];
    }
    x
}

/// The sum of squares where unknowns are `x` from the start.
fn slope(problem: &Problem, unknowns: &[Unknown], x: &[f64], staying: f64) -> Slope {
    let rates = unpacked(x, unknowns, problem.bands.count());
    let (responses, slopes): (Vec<_>, Vec<_>) = rates.iter().map(|rates| slopes(problem, rates)).unzip();
    let of_state = 1 + problem.bands.count();
    let count = x.len();
    let mut slope = Slope {
        cost: staying * dot(x, x),
        gradient: x.iter().map(|x| staying * x).collect(),
        curvature: vec![0.0; count * count],
    };
    (0..count).for_each(|index| slope.curvature[index * count + index] = staying);
    for band in &problem.wanted {
        let amounts = amounts(&responses, band);
        let off = off(&responses, &amounts, band);
        let basis = basis(&responses, &amounts);
        slope.cost += dot(&off, &off);
        let moved: Vec<Option<Vec<f64>>> = (0..count)
            .map(|index| {
                let state = index / of_state;
                let amount = amounts[state] * unknowns[index].scale;
                (amount > 0.0).then(|| made_up_for(&slopes[state][index % of_state], amount, &basis))
            })
            .collect();
        for (row, moved_row) in moved.iter().enumerate() {
            let Some(moved_row) = moved_row else { continue };
            slope.gradient[row] += dot(moved_row, &off);
            for (column, moved_column) in moved.iter().enumerate() {
                let product = moved_column.as_ref().map_or(0.0, |moved| dot(moved_row, moved));
                slope.curvature[row * count + column] += product;
            }
        }
    }
    slope
}

/// Directions of length 1, at right angles, of the responses that are sent.
fn basis(responses: &[Vec<f64>], amounts: &[f64]) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for (response, _) in responses.iter().zip(amounts).filter(|(_, amount)| **amount > 0.0) {
        let rest = made_up_for(response, 1.0, &basis);
        let length = dot(&rest, &rest).sqrt();
        if length > 1e-9 * dot(response, response).sqrt() {
            basis.push(rest.iter().map(|value| value / length).collect());
        }
    }
    basis
}

/// A change times a factor, without what other amounts of the responses make up for.
fn made_up_for(change: &[f64], factor: f64, basis: &[Vec<f64>]) -> Vec<f64> {
    let mut rest: Vec<f64> = change.iter().map(|value| value * factor).collect();
    for direction in basis {
        let part = dot(&rest, direction);
        rest.iter_mut().zip(direction).for_each(|(rest, direction)| *rest -= part * direction);
    }
    rest
}

/// A state's unknowns: the logarithm of its decay, and its excitation rates.
fn unknowns(rates: &Rates) -> impl Iterator<Item = Unknown> {
    let decay = Unknown { start: rates.decay.ln(), bounds: DECAY.map(f64::ln), scale: 1.0 };
    let excitation = |rate: &f64| Unknown { start: *rate, bounds: EXCITATION, scale: rate.max(0.01) };
    std::iter::once(decay).chain(rates.excitation.iter().map(excitation).collect::<Vec<_>>())
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

impl Unknown {
    /// From where to where its change goes.
    fn reach(&self) -> [f64; 2] {
        self.bounds.map(|bound| (bound - self.start) / self.scale)
    }
}

fn unpacked(x: &[f64], unknowns: &[Unknown], bands: usize) -> Vec<Rates> {
    let values: Vec<f64> =
        x.iter().zip(unknowns).map(|(x, unknown)| unknown.start + unknown.scale * x).collect();
    let rates = |values: &[f64]| Rates { decay: values[0].exp(), excitation: values[1..].to_vec() };
    values.chunks(1 + bands).map(rates).collect()
}
