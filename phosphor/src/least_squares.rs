//! Least squares: non-linear ones between bounds (MPFIT, Markwardt 2009), and linear ones without negative
//! unknowns (Lawson and Hanson 1974), by crates of others.

use ndarray::{Array1, Array2};
use rmpfit::{MPFitter, MPPar, MPResult};

/// By what share of its scale an unknown is moved to see what changes.
const DIFFERENCE: f64 = 1e-7;

/// An unknown of a non-linear problem.
#[derive(Clone, Copy, Debug)]
pub struct Unknown {
    /// Where the search starts.
    pub start: f64,
    /// The bounds it stays within; infinite where there are none.
    pub bounds: [f64; 2],
    /// A change that matters.
    pub scale: f64,
}

/// Where a search ended.
#[derive(Clone, Debug)]
pub struct Minimum {
    /// The unknowns.
    pub values: Vec<f64>,
    /// Row-major, for residuals of variance 1; 0 for what is held by a bound.
    pub covariance: Vec<f64>,
    /// The residuals.
    pub residuals: Vec<f64>,
}

/// Why there is no minimum.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("least squares failed: {0}")]
pub struct SolverError(String);

impl Minimum {
    /// The sum of squared residuals.
    pub fn cost(&self) -> f64 {
        self.residuals.iter().map(|residual| residual * residual).sum()
    }
}

/// The unknowns at which the sum of `count` squared residuals is least, near the start. `residuals` fills the
/// second list from the first.
pub fn minimum(
    unknowns: &[Unknown],
    count: usize,
    residuals: impl Fn(&[f64], &mut [f64]),
) -> Result<Minimum, SolverError> {
    let mut problem = Problem { parameters: unknowns.iter().map(parameter).collect(), count, residuals };
    let mut values: Vec<f64> = unknowns.iter().map(|unknown| unknown.start).collect();
    let status = problem.mpfit(&mut values).map_err(|error| SolverError(error.to_string()))?;
    // The solver's own list of residuals may be that of the last step that it tried and did not take.
    let mut residuals = vec![0.0; count];
    (problem.residuals)(&values, &mut residuals);
    Ok(Minimum { values, covariance: status.covar, residuals })
}

/// The non-negative `x` with the least sum of squares of `rows x - wanted`.
pub fn non_negative(rows: &[Vec<f64>], wanted: &[f64]) -> Vec<f64> {
    let matrix = Array2::from_shape_fn((rows.len(), rows[0].len()), |(row, column)| rows[row][column]);
    nnls::nnls(matrix.view(), Array1::from_vec(wanted.to_vec()).view()).0.to_vec()
}

struct Problem<F> {
    parameters: Vec<MPPar>,
    count: usize,
    residuals: F,
}

impl<F: Fn(&[f64], &mut [f64])> MPFitter for Problem<F> {
    fn eval(&mut self, values: &[f64], residuals: &mut [f64]) -> MPResult<()> {
        (self.residuals)(values, residuals);
        Ok(())
    }

    fn number_of_points(&self) -> usize {
        self.count
    }

    fn parameters(&self) -> &[MPPar] {
        &self.parameters
    }
}

fn parameter(unknown: &Unknown) -> MPPar {
    let [low, high] = unknown.bounds;
    MPPar {
        limited_low: low.is_finite(),
        limited_up: high.is_finite(),
        limit_low: low,
        limit_up: high,
        step: DIFFERENCE * unknown.scale,
        ..MPPar::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_glow::spectrum::{Axis, Bands};

    const FREE: Unknown = Unknown { start: 1.0, bounds: [f64::NEG_INFINITY, f64::INFINITY], scale: 1.0 };

    /// A line through points: what the solver finds is the closed form, its covariance too.
    #[test]
    fn a_line_has_the_closed_form() {
        let (x, y) = ([0.0, 1.0, 2.0, 3.0], [1.0, 2.9, 5.2, 6.9]);
        let line = |p: &[f64], r: &mut [f64]| (0..4).for_each(|i| r[i] = p[0] + p[1] * x[i] - y[i]);
        let found = minimum(&[FREE, FREE], 4, line).expect("a minimum");
        assert!((found.values[0] - 1.0).abs() < 1e-6 && (found.values[1] - 2.0).abs() < 1e-6, "{found:?}");
        let expected = [0.7, -0.3, -0.3, 0.2];
        assert!(found.covariance.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{found:?}");
        assert!((found.cost() - 0.06).abs() < 1e-9, "{}", found.cost());
    }

    #[test]
    fn bounds_hold_and_what_cannot_be_solved_is_said() {
        let residuals = |p: &[f64], r: &mut [f64]| (r[0], r[1]) = (p[0] + 2.0, p[0] + 1.0);
        let bounded = Unknown { bounds: [0.0, f64::INFINITY], ..FREE };
        assert_eq!(minimum(&[bounded], 2, residuals).expect("a minimum").values, [0.0]);
        assert!((minimum(&[FREE], 2, residuals).expect("a minimum").values[0] + 1.5).abs() < 1e-6);
        assert!(minimum(&[FREE; 3], 2, |_, r| r.fill(1.0)).is_err(), "more unknowns than residuals");
        assert!(minimum(&[FREE], 2, |_, r| r.fill(f64::NAN)).is_err());
    }

    #[test]
    fn linear_unknowns_are_not_negative() {
        let rows = [vec![1.0, 0.0], vec![0.0, 1.0], vec![1.0, 1.0]];
        let free = non_negative(&rows, &[1.0, 2.0, 3.0]);
        assert!((free[0] - 1.0).abs() < 1e-12 && (free[1] - 2.0).abs() < 1e-12);
        let held = non_negative(&rows, &[2.0, -3.0, 1.0]);
        assert!((held[0] - 1.5).abs() < 1e-12 && held[1] == 0.0, "{held:?}");
    }

    /// The spectra that stand for colours are the smoothest ones that are nowhere negative: those whose
    /// colour is a primary, while differences of neighbouring bands weigh a thousandth.
    #[test]
    fn spectra_of_primaries_are_the_smoothest() {
        const ROUGHNESS: f64 = 1e-3;
        let count = Axis::EIGHT.count;
        let unit = |band: usize| std::array::from_fn::<f64, 8, _>(|other| f64::from(u8::from(other == band)));
        let colours: Vec<[f64; 3]> = (0..count).map(|band| Axis::EIGHT.linear_srgb(&unit(band))).collect();
        let difference = |band: usize| {
            (0..count).map(|other| ROUGHNESS * (unit(band)[other] - unit(band - 1)[other])).collect()
        };
        let of_channel = |channel: usize| colours.iter().map(|colour| colour[channel]).collect();
        let rows: Vec<Vec<f64>> = (0..3).map(of_channel).chain((1..count).map(difference)).collect();
        for channel in 0..3 {
            let mut wanted = vec![0.0; rows.len()];
            wanted[channel] = 1.0;
            let found = non_negative(&rows, &wanted);
            let stated = Bands::Eight.of_linear_srgb([wanted[0], wanted[1], wanted[2]]);
            assert!(found.iter().zip(&stated).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?} {stated:?}");
        }
    }
}
