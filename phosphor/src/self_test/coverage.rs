//! How often intervals hold what is true, and how well fits explain measurements.

use super::SelfTestError;
use crate::fit::{Fit, Laboratory, Parameter, ParameterEstimate};
use deepshade_glow::material::Material;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// What fits of one material came to, over many seeds of noise.
#[derive(Clone, Debug, PartialEq)]
pub struct Coverage {
    /// The material.
    pub material: String,
    /// The share of all intervals that hold the true value.
    pub share: f64,
    /// The share of each parameter's intervals: state and parameter.
    pub parameters: Vec<(usize, Parameter, f64)>,
    /// The root mean square of residual over noise, of all seeds together.
    pub residual_over_noise: f64,
    /// The same of the seed where it is largest.
    pub worst_residual_over_noise: f64,
}

/// Measures a material with the noise of each seed from 0 on, and fits it.
///
/// # Errors
/// If the material makes no sense or a fit fails.
pub fn coverage(laboratory: &Laboratory, material: &Material, seeds: u64) -> Result<Coverage, SelfTestError> {
    let fits = (0..seeds).into_par_iter().map(|seed| fitted(laboratory, material, seed));
    let fits: Vec<Fit> = fits.collect::<Result<_, _>>()?;
    let mut held: BTreeMap<(usize, Parameter), usize> = BTreeMap::new();
    for estimate in fits.iter().flat_map(|fit| &fit.estimates) {
        let [low, high] = estimate.interval;
        let holds = (low..=high).contains(&truth(material, estimate));
        *held.entry((estimate.state, estimate.parameter)).or_default() += usize::from(holds);
    }
    let per_fit = fits.len() as f64;
    let residuals: Vec<f64> = fits.iter().map(Fit::residual_over_noise).collect();
    Ok(Coverage {
        material: material.name.clone(),
        share: held.values().sum::<usize>() as f64 / (per_fit * held.len() as f64),
        parameters: held
            .iter()
            .map(|((state, parameter), held)| (*state, *parameter, *held as f64 / per_fit))
            .collect(),
        residual_over_noise: (residuals.iter().map(|residual| residual * residual).sum::<f64>() / per_fit)
            .sqrt(),
        worst_residual_over_noise: residuals.into_iter().fold(0.0, f64::max),
    })
}

fn fitted(laboratory: &Laboratory, material: &Material, seed: u64) -> Result<Fit, SelfTestError> {
    let measurement = laboratory.measure(material, seed)?;
    let fails = |source| SelfTestError::Fit { material: material.name.clone(), seed, source };
    Fit::new(&material.name, &measurement, material.states.len()).map_err(fails)
}

/// The material's own value of a parameter.
fn truth(material: &Material, estimate: &ParameterEstimate) -> f64 {
    let state = &material.states[estimate.state];
    match estimate.parameter {
        Parameter::Decay => state.decay,
        Parameter::Excitation(band) => state.excitation[band],
        Parameter::Emission(band) => state.emission[band],
    }
}
