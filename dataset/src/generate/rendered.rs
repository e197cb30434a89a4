//! A pair as it is rendered, for files and for streams alike.

use crate::target::{self, TargetMethod};
use crate::{DatasetError, Pair, Recipe, StagedScene, Variation, truth};
use deepshade_render::gbuffer;
use deepshade_render::method::Frame;
use deepshade_render::methods::estimate::{EstimateError, EstimateInputs, Estimator, with_estimates};
use deepshade_render::path::{Estimate, Goal, Sampling, Shot, Truth, render};
use deepshade_render::scene::Camera;
use deepshade_shaders::{Attribute, GBuffer};

/// A rendered view.
pub struct Rendered {
    /// Where the view is from.
    pub camera: Camera,
    /// What the image was given beside what its scene brings.
    pub variation: Option<Variation>,
    /// How far the effect reaches, metres.
    pub radius: f32,
    /// What the camera sees.
    pub gbuffer: GBuffer,
    /// What is learned from, and how many samples of a pixel it took.
    pub target: Estimate,
}

impl Rendered {
    /// Renders a view of a recipe's scene with its seed, of which [`StagedScene::drawn`] gave camera and
    /// variation; `method` is what the recipe aims at, where that is not truth.
    ///
    /// # Errors
    /// If the scene cannot be shown as the view wants it, or the method fails.
    pub fn new(
        recipe: &Recipe,
        method: Option<TargetMethod<'_>>,
        staged: &StagedScene<'_>,
        seed: u32,
        (camera, variation): (Camera, Option<Variation>),
    ) -> Result<Self, DatasetError> {
        let radius = staged.radius(&camera, seed);
        let scene = staged.shown(&camera, variation.as_ref())?;
        let gbuffer = staged.gbuffer(&scene, &camera, seed);
        let frame = Frame { scene: &scene, camera: &camera, gbuffer: &gbuffer, radius, seed };
        let gbuffer = estimated(recipe, staged, &frame)?;
        let frame = Frame { gbuffer: &gbuffer, ..frame };
        let Estimate { mean, variance, samples } = target(recipe, method, &frame)?;
        let mean = truth::within_half(staged.photographed(mean, seed));
        let gbuffer = truth::light_within_half(gbuffer);
        Ok(Self { camera, variation, radius, gbuffer, target: Estimate { mean, variance, samples } })
    }

    /// What is learned from of it.
    pub fn into_pair(self) -> Pair {
        let Self { gbuffer, target: Estimate { mean, variance, .. }, radius, .. } = self;
        Pair { gbuffer, target: mean, variance, radius }
    }
}

/// A frame's g-buffer with what the recipe's methods estimate.
fn estimated(recipe: &Recipe, staged: &StagedScene<'_>, frame: &Frame<'_>) -> Result<GBuffer, DatasetError> {
    let Frame { scene, camera, gbuffer: seen, radius, seed } = *frame;
    let estimators = staged.estimators();
    let mut all = seen.clone();
    // Methods may read what pairs do not hold.
    let is_missing = |attribute: &&Attribute| !seen.attributes().contains(attribute);
    for attribute in estimators.iter().flat_map(Estimator::reads).filter(is_missing) {
        let beside = gbuffer::render(scene, camera, seen.height(), seen.width(), &[*attribute]);
        all = all.with(&[*attribute], beside.planes().data());
    }
    let refused = |error: EstimateError| DatasetError::Recipe {
        path: recipe.path.clone(),
        what: format!("`estimates`: {error}"),
    };
    let inputs = EstimateInputs { gbuffer: &all, radius, seed, scene: Some((scene, camera)) };
    let all = with_estimates(&inputs, estimators).map_err(refused)?;
    let kept = recipe.attributes();
    let planes = all.select(&kept).map_err(|missing| refused(missing.into()))?;
    Ok(GBuffer::new(kept, planes))
}

/// Truth with as many samples as the recipe wants, or what its method makes.
fn target(
    recipe: &Recipe,
    method: Option<TargetMethod<'_>>,
    frame: &Frame<'_>,
) -> Result<Estimate, DatasetError> {
    let Recipe { effect, samples, scramblings, error, .. } = *recipe;
    if let Some(method) = method {
        return Ok(Estimate { mean: target::image(method, frame)?, variance: None, samples: 0 });
    }
    let shot = Shot::new(frame.scene, frame.camera, recipe.size(frame.seed), frame.radius);
    Ok(match error {
        None => render(effect, &shot, Sampling { samples, scramblings, seed: frame.seed }),
        Some(_) => Truth::render(effect, &shot, Goal { samples, error }, frame.seed, |_, _| true).estimate,
    })
}
