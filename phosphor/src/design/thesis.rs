//! The rival: the thesis' search on a grid of all seven parameters (section 8.6, Table 8.2).

use super::grid::{Grid, THESIS_STEPS};
use super::problem::Problem;
use super::{DesignError, TargetPoint, checked};
use rayon::prelude::*;

/// Re-radiation functions of the thesis' grid: `0.1 2^b`, ten values of `b` from 0 to 9.
const EMISSION_SCALE: f64 = 0.1;

/// The least residual of all 10^7 points of the thesis' grid: one state, each of ten values for the decay,
/// for the excitation rate of each band and for the re-radiation function in each. To given rates, bands are
/// independent, so that nothing is lost by trying their functions one by one. Bands that are eight share
/// rates in three groups.
///
/// # Errors
/// If a place makes no sense, or they have not the same bands.
pub fn thesis_grid(places: &[TargetPoint]) -> Result<f64, DesignError> {
    checked(places)?;
    let problem = Problem::new(places);
    let grid = Grid::new(&problem);
    let cost = |response: &[f64]| -> f64 {
        let of_band = |band: &Vec<f64>| {
            let off = |emission: f64| -> f64 {
                let pairs = response.iter().zip(band);
                pairs.map(|(response, wanted)| (emission * response - wanted).powi(2)).sum()
            };
            let tried = (0..THESIS_STEPS).map(|step| off(EMISSION_SCALE * (step as f64).exp2()));
            tried.fold(f64::INFINITY, f64::min)
        };
        problem.wanted.iter().map(of_band).sum()
    };
    let points = Grid::points().into_par_iter().filter(|point| Grid::is_of_thesis(*point));
    Ok(points.map(|point| cost(&grid.response(point))).reduce(|| f64::INFINITY, f64::min))
}
