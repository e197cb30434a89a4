//! How long a test set will take, from a timed probe.

use super::{TestSet, in_tiles, tile_indices, tiles_of};
use crate::plan::PlannedScene;
use crate::recipe::Tiles;
use crate::stopwatch::prepared_and_sampled;
use crate::{DatasetError, Props, Recipe, StagedScene};
use deepshade_render::bvh::bundle::BUNDLE;
use deepshade_render::path::Shot;
use deepshade_shaders::lists;
use deepshade_shaders::similarity::TILE;
use std::time::{Duration, Instant};

/// Scenes that are probed.
const SCENES: usize = 12;
/// One tile in so many is rendered, with so many samples a pixel: as many as are traced at a time.
const PROBE: (usize, u32) = (64, BUNDLE as u32);

/// Seconds that parts of a test set take.
#[derive(Clone, Copy, Debug, Default)]
struct Seconds {
    /// Making or reading a scene.
    scene: f64,
    /// Choosing a view and giving the scene its look.
    view: f64,
    /// What comes before an image's first sample.
    image: f64,
    /// A sample of a pixel.
    sample: f64,
}

impl Seconds {
    /// What a test set of so many scenes takes, of which these are the mean.
    fn of_all(self, recipe: &Recipe, tiles: Tiles, scenes: usize) -> f64 {
        let (height, width) = (recipe.resolution.height, recipe.resolution.width);
        let frames = (scenes * recipe.views_per_scene) as f64;
        let whole = frames.min(tiles.whole_frames as f64);
        let in_tiles = tile_indices(recipe.seed, height, width, tiles.one_in).len() * TILE * TILE;
        let samples = frames * in_tiles as f64 * f64::from(tiles.samples)
            + whole * (height * width) as f64 * f64::from(recipe.samples);
        self.scene * scenes as f64
            + self.view * frames
            + self.image * (frames + whole)
            + self.sample * samples
    }
}

impl TestSet {
    /// How long [`TestSet::generate`] will take from nothing, on this machine with nothing else to do: a few
    /// scenes, evenly chosen, are loaded and rendered with few samples, and the time is scaled to all.
    ///
    /// # Errors
    /// If the recipe is not for testing or has no `tiles`, or a scene cannot be had or has no fit view.
    pub fn estimate(recipe: &Recipe) -> Result<Duration, DatasetError> {
        let tiles = tiles_of(recipe)?;
        let plan = recipe.plan()?;
        let props = Props::load(recipe)?;
        let probed = lists::spread(plan.len(), SCENES);
        let mut mean = Seconds::default();
        for scene in &probed {
            let seconds = probe(recipe, &props, &plan[*scene])?;
            let share = 1.0 / probed.len() as f64;
            mean.scene += share * seconds.scene;
            mean.view += share * seconds.view;
            mean.image += share * seconds.image;
            mean.sample += share * seconds.sample;
        }
        Ok(Duration::from_secs_f64(mean.of_all(recipe, tiles, plan.len())))
    }
}

/// What the first view of a scene takes.
fn probe(recipe: &Recipe, props: &Props, planned: &PlannedScene) -> Result<Seconds, DatasetError> {
    let size @ [height, width] = [recipe.resolution.height, recipe.resolution.width];
    let start = Instant::now();
    let staged = StagedScene::load(&planned.scene, recipe, props)?;
    let scene = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let (camera, variation) = staged.drawn(planned.key, &planned.views[0])?;
    let shown = staged.shown(&camera, variation.as_ref())?;
    let view = start.elapsed().as_secs_f64();
    let (one_in, samples) = PROBE;
    let tiles = tile_indices(recipe.seed, height, width, one_in);
    let radius = staged.radius(&camera, planned.views[0].seed);
    let shot = Shot::new(&shown, &camera, size, radius);
    let seconds = |work: &mut dyn FnMut()| {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64()
    };
    let wanted = in_tiles(&tiles, width);
    let [image, rendering] =
        prepared_and_sampled(recipe.effect, &shot, (samples, recipe.seed), wanted, seconds);
    let rendered = (tiles.len() * TILE * TILE) as f64 * f64::from(samples);
    Ok(Seconds { scene, view, image, sample: rendering / rendered })
}

#[cfg(test)]
mod tests {
    use super::*;

    const RECIPE: &str = "effect = \"sss\"\nsplit = \"test\"\nseed = 7\n\
        resolution = { height = 64, width = 64 }\nsamples = 4\nradius = { diagonal = 0.05 }\nviews_per_scene = 2\n\
        tiles = { samples = 64, one_in = 4, whole_frames = 1 }\n\
        vary = { light = true, mean_free_path = [0.01, 0.02] }\nfamilies = [{ name = \"bridge\", scenes = 1 }]\n";

    fn recipe() -> Recipe {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("sss.toml");
        std::fs::write(&path, RECIPE).expect("written");
        Recipe::load(&path).expect("a recipe")
    }

    #[test]
    fn parts_count_as_often_as_they_are_done() {
        let recipe = recipe();
        let tiles = tiles_of(&recipe).expect("tiles");
        let none = Seconds::default();
        let of_three = |seconds: Seconds| seconds.of_all(&recipe, tiles, 3);
        assert_eq!(of_three(Seconds { scene: 1.0, ..none }), 3.0);
        assert_eq!(of_three(Seconds { view: 1.0, ..none }), 6.0);
        // One image is made again, whole.
        assert_eq!(of_three(Seconds { image: 1.0, ..none }), 7.0);
        let in_tiles = 64 * 64 / 4;
        assert_eq!(of_three(Seconds { sample: 1.0, ..none }), f64::from(6 * in_tiles * 64 + 64 * 64 * 4));
    }

    #[test]
    fn every_part_takes_its_time() {
        let recipe = recipe();
        let plan = recipe.plan().expect("a plan");
        let took = probe(&recipe, &Props::load(&recipe).expect("props"), &plan[0]).expect("a probe");
        assert!([took.scene, took.view, took.image, took.sample].into_iter().all(|seconds| seconds > 0.0));
        // The image is gathered before the first sample.
        assert!(took.image > took.sample, "{took:?}");
        assert!(TestSet::estimate(&recipe).expect("an estimate") > Duration::ZERO);
    }
}
