//! What pairs and test frames aim at: truth, or what a method makes of the frame, as the paper's set for
//! indirect light was made (thesis 7.4).

use crate::{DatasetError, Recipe};
use deepshade_render::method::{Frame, Method, Repeats};
use deepshade_render::methods::Quality;
use deepshade_shaders::Planes;

/// The quality at which analytic methods make targets: the best there is.
pub const QUALITY: Quality = Quality::Ultra;

/// A method that makes targets. Several threads ask it at a time.
pub type TargetMethod<'a> = &'a (dyn Method + Sync);

/// Whether a method is what a recipe aims at.
///
/// # Errors
/// If the recipe names another method, or one and there is none, or none and there is one.
pub fn check(recipe: &Recipe, method: Option<TargetMethod<'_>>) -> Result<(), DatasetError> {
    let found = method.map(Method::name);
    let wrong = |what: String| Err(DatasetError::Recipe { path: recipe.path.clone(), what });
    if recipe.target.as_deref() != found {
        let [wanted, found] = [recipe.target.as_deref(), found]
            .map(|name| name.map_or("truth".to_owned(), |name| format!("`{name}`")));
        return wrong(format!("its `target` is {wanted}, and {found} is what would make it"));
    }
    match method.map(Method::effect) {
        Some(effect) if effect != recipe.effect => {
            wrong(format!("its `target` computes {effect}, not {}", recipe.effect))
        }
        _ => Ok(()),
    }
}

/// What a method makes of a frame.
///
/// # Errors
/// If the method fails.
pub fn image(method: TargetMethod<'_>, frame: &Frame<'_>) -> Result<Planes, DatasetError> {
    Ok(method.shade(frame, Repeats::ONCE)?.image)
}
