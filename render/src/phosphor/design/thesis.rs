//! The rival: the thesis' search on a grid of all seven parameters (section 8.6, Table 8.2).

use super::grid::{Grid, THESIS_STEPS};
use super::{DesignError, Place};
use rayon::prelude::*;

/// Re-radiation functions of the thesis' grid: `0.1 2^b`, ten values of `b` from 0 to 9.
const EMISSION_SCALE: f64 = 0.1;

/// The least residual of all 10^7 points of the thesis' grid: one state, each of ten values for the decay, for the
/// excitation rate of each band and for the re-radiation function in each. To given rates, bands are independent, so
/// that nothing is lost by trying their functions one by one. Bands that are eight share rates in three groups.
///
/// # Errors
/// If the place makes no sense.
pub fn thesis_grid(place: &Place) -> Result<f64, DesignError> {
    place.check()?;
    let grid = Grid::new(place);
    let wanted = place.wanted();
    let cost = |response: &[f64]| -> f64 {
        let of_band = |band: &Vec<f64>| {
            let off = |emission: f64| -> f64 {
                response
                    .iter()
                    .zip(band)
                    .map(|(response, wanted)| (emission * response - wanted).powi(2))
                    .sum()
            };
            let tried = (0..THESIS_STEPS).map(|step| off(EMISSION_SCALE * (step as f64).exp2()));
            tried.fold(f64::INFINITY, f64::min)
        };
        wanted.iter().map(of_band).sum()
    };
    let points = grid.responses.par_iter().enumerate().filter(|(point, _)| grid.is_of_thesis(*point));
    Ok(points.map(|(_, response)| cost(response)).reduce(|| f64::INFINITY, f64::min))
}
