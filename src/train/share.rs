//! A radius in metres as a share of scenes' diagonals, by which a network of the paper's measures.

use anyhow::{Context, Result, ensure};
use deepshade_dataset::{Recipe, SceneOrCapture};
use deepshade_shaders::lists;

/// The most scenes whose diagonals are looked at.
const MOST: usize = 16;

/// Which share of a scene's diagonal `metres` are: of the median diagonal of a recipe's scenes, of which at
/// most [`MOST`] are looked at.
///
/// # Errors
/// If a scene cannot be read, or all are captures, which have none.
pub fn of_metres(recipe: &Recipe, metres: f32) -> Result<f32> {
    let scenes: Vec<_> = recipe.plan()?.into_iter().map(|planned| planned.scene).collect();
    let rendered: Vec<_> =
        scenes.into_iter().filter(|scene| matches!(scene.source, SceneOrCapture::Scene(_))).collect();
    let diagonal = |index: usize| {
        let scene = &rendered[index];
        let read = scene.read(&recipe.folder).with_context(|| scene.source.to_string())?;
        Ok(f64::from(read.bounds().diagonal()))
    };
    let chosen = lists::spread(rendered.len(), MOST);
    let diagonals = chosen.into_iter().map(diagonal).collect::<Result<Vec<f64>>>()?;
    ensure!(!diagonals.is_empty(), "captures have no diagonal");
    let share = metres / lists::median(diagonals) as f32;
    ensure!(share.is_finite() && share > 0.0, "its scenes have no extent");
    Ok(share)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn metres_become_the_share_of_the_diagonal_that_they_are() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("dataset/recipes/ao-tiny.toml");
        let mut recipe = Recipe::load(&path).expect("a recipe");
        recipe.families.truncate(1);
        recipe.families[0].scenes = 1;
        let scenes = recipe.plan().expect("scenes");
        let diagonal = scenes[0].scene.read(&recipe.folder).expect("made").bounds().diagonal();
        let share = |metres| of_metres(&recipe, metres).expect("a share");
        assert!((share(0.1 * diagonal) - 0.1).abs() < 1e-6 && (share(0.5) - 0.5 / diagonal).abs() < 1e-6);
    }
}
