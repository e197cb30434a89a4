//! How long a test set will take, from a timed probe.

use super::{TestSet, in_tiles, tile_indices, tiles_of};
use crate::{DatasetError, Props, Recipe, StagedScene, views};
use deepshade_render::bvh::bundle::BUNDLE;
use deepshade_render::path::{Sampling, Shot, render_where};
use deepshade_shaders::similarity::TILE;
use std::time::{Duration, Instant};

/// Scenes that are probed.
const SCENES: usize = 12;
/// One tile in so many is rendered, with so many samples a pixel: as many as are traced at a time.
const PROBE: (usize, u32) = (64, BUNDLE as u32);

impl TestSet {
    /// How long [`TestSet::generate`] will take from nothing, on this machine with nothing else to do: a few scenes,
    /// evenly chosen, are loaded and rendered with few samples, and the time is scaled to all.
    ///
    /// # Errors
    /// If the recipe is not for testing or has no `tiles`, or a scene cannot be had or has no fit view.
    pub fn estimate(recipe: &Recipe) -> Result<Duration, DatasetError> {
        let tiles = tiles_of(recipe)?;
        let plan = recipe.plan()?;
        let props = Props::load(recipe)?;
        let (height, width) = (recipe.resolution.height, recipe.resolution.width);
        let probed: Vec<_> = plan.iter().step_by(plan.len().div_ceil(SCENES)).collect();
        let (mut loading, mut rendering, mut rendered) = (0.0, 0.0, 0.0);
        for scene in &probed {
            let start = Instant::now();
            let staged = StagedScene::load(&scene.scene, recipe, &props)?;
            let camera = views::sample_view(staged.base(), [height, width], recipe.seed, scene.key, 0)?;
            let (camera, variation) = staged.draw(camera, scene.views[0].seed);
            let shown = staged.shown(&camera, variation.as_ref())?;
            loading += start.elapsed().as_secs_f64();
            let (one_in, samples) = PROBE;
            let probe = tile_indices(recipe.seed, height, width, one_in);
            let radius = recipe.radius.metres(shown.diagonal());
            let shot = Shot::new(&shown, &camera, [height, width], radius);
            let start = Instant::now();
            let sampling = Sampling::one(samples, recipe.seed);
            render_where(recipe.effect, &shot, sampling, in_tiles(&probe, width));
            rendering += start.elapsed().as_secs_f64();
            rendered += (probe.len() * TILE * TILE) as f64 * f64::from(samples);
        }
        let pixels = (height * width) as f64;
        let frames = (plan.len() * recipe.views_per_scene) as f64;
        let in_tiles = tile_indices(recipe.seed, height, width, tiles.one_in).len() * TILE * TILE;
        let tile_samples = frames * in_tiles as f64 * f64::from(tiles.samples);
        let whole_samples = frames.min(tiles.whole_frames as f64) * pixels * f64::from(recipe.samples);
        let seconds = loading * plan.len() as f64 / probed.len() as f64
            + rendering * (tile_samples + whole_samples) / rendered;
        Ok(Duration::from_secs_f64(seconds))
    }
}
