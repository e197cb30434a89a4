//! What deepshade makes of the same frames without Bevy.

use deepshade_infer::{Model, cpu};
use deepshade_render::methods::estimate::{EstimateInputs, Estimator, with_estimates};
use deepshade_shaders::{GBuffer, Planes};
use std::error::Error;

/// A network's openness of a g-buffer, on the processor, step by step as `deepshade infer` does it there.
///
/// # Errors
/// If the g-buffer lacks something.
pub fn openness(model: &Model, gbuffer: &GBuffer, radius: f32) -> Result<Planes, Box<dyn Error>> {
    let Model { spec, weights } = model;
    let named = |estimate: &deepshade_infer::AnalyticEstimate| {
        Estimator::named(estimate.effect(spec.effect), &estimate.method, &estimate.quality)
    };
    let estimators: Vec<Estimator> = spec.estimates.iter().map(named).collect::<Result<_, _>>()?;
    let inputs = EstimateInputs { gbuffer, radius, seed: 1, scene: None };
    let estimated = with_estimates(&inputs, &estimators)?;
    let prepared = spec.prepared(&estimated, radius)?;
    let scaling = spec.scaling_of_lengths(radius);
    let input = spec.input(&prepared, scaling, 0)?;
    let made = cpu::Network::new(spec, weights)?.run(&input)?;
    let mut image = spec.image(&[made], scaling);
    spec.set_background(gbuffer, &mut image)?;
    Ok(image)
}
