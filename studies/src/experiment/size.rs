//! How large experiments are: small enough to end in minutes, or near the thesis.

use deepshade_dataset::Recipe;
use deepshade_dataset::recipe::{Resolution, Tiles};
use deepshade_infer::NetSpec;
use deepshade_train::Loss;
use deepshade_train::{Optimiser, TrainConfig};
use std::path::PathBuf;

/// The numbers of a size.
#[derive(Clone, Copy, Debug)]
pub struct Size {
    /// What tables and folders call it.
    pub name: &'static str,
    /// Height and width of images, pixels.
    pub edge: usize,
    /// Scenes of each family that is trained on, and views of each.
    pub scenes: usize,
    /// Views of every scene that is trained on.
    pub views: usize,
    /// What an image takes beside its samples, its view, g-buffer and file, in samples that take as long:
    /// from the processor's seconds of `deepshade dataset generate` with 4 and 68 samples at 128 x 128, with
    /// 4 at 512 x 512.
    pub image_cost: usize,
    /// Scenes of each family that is tested on.
    pub test_scenes: usize,
    /// Views of every scene that is tested on.
    pub test_views: usize,
    /// Truth of tests.
    pub tiles: Tiles,
    /// Height and width of the crops that networks are trained on.
    pub crop: usize,
    /// Steps that every network is trained for, of [`BATCH`] crops.
    pub steps: usize,
    /// Numbers of scenes that the study `scenes` compares; each divides the number of pairs.
    pub scene_counts: &'static [usize],
    /// Steps that perceptrons are trained for.
    pub perceptron_steps: usize,
    /// Examples that forests are grown from.
    pub forest_examples: usize,
}

/// Crops a step.
pub const BATCH: usize = 4;
/// Validations of a run.
const VALIDATIONS: usize = 12;
/// Pairs of a validation, at most.
const VALIDATION_PAIRS: usize = 32;

impl Size {
    /// Minutes on two cores.
    pub const DEFAULT: Self = Self {
        name: "default",
        edge: 128,
        scenes: 2,
        views: 4,
        image_cost: 13,
        test_scenes: 3,
        test_views: 2,
        tiles: Tiles { samples: 256, one_in: 1, whole_frames: 8 },
        crop: 128,
        steps: 1000,
        scene_counts: &[1, 5, 10, 40],
        perceptron_steps: 4000,
        forest_examples: 8000,
    };

    /// Many hours on two cores: as many pixels as in the thesis, and a tenth of its pairs.
    pub const FULL: Self = Self {
        name: "full",
        edge: 512,
        scenes: 4,
        views: 25,
        image_cost: 7,
        test_scenes: 10,
        test_views: 5,
        tiles: Tiles { samples: 1024, one_in: 8, whole_frames: 16 },
        crop: 256,
        steps: 20_000,
        scene_counts: &[1, 5, 10, 50, 250],
        perceptron_steps: 20_000,
        forest_examples: 30_000,
    };

    /// A recipe for training at this size.
    pub fn trained(&self, recipe: &Recipe) -> Recipe {
        self.sized(recipe, self.scenes, self.views)
    }

    /// A recipe for testing at this size.
    pub fn tested(&self, recipe: &Recipe) -> Recipe {
        Recipe { tiles: Some(self.tiles), ..self.sized(recipe, self.test_scenes, self.test_views) }
    }

    fn sized(&self, recipe: &Recipe, scenes: usize, views_per_scene: usize) -> Recipe {
        let resolution = Resolution { height: self.edge, width: self.edge };
        let mut recipe = Recipe { resolution, views_per_scene, ..recipe.clone() };
        recipe.families.iter_mut().for_each(|family| family.scenes = scenes);
        recipe
    }

    /// The settings of a run at this size: it goes on to its last step, with the rate's fall fitted to that.
    pub fn settings(&self, spec: NetSpec, dataset: PathBuf) -> TrainConfig {
        let usual = TrainConfig::new(spec, dataset);
        let validate_every = self.steps.div_ceil(VALIDATIONS);
        TrainConfig {
            // The thesis'.
            loss: Loss::Dssim,
            optimiser: warm(usual.optimiser, self.steps / 10),
            batch: BATCH,
            crop: self.crop,
            steps: self.steps,
            validation_pairs: VALIDATION_PAIRS,
            validate_every,
            patience: 0,
            checkpoint_every: validate_every,
            ..usual
        }
    }
}

/// An optimiser whose rate rises for at most so many steps.
fn warm(optimiser: Optimiser, most: usize) -> Optimiser {
    match optimiser {
        Optimiser::Adamw { rate, weight_decay, warm_up } => {
            Optimiser::Adamw { rate, weight_decay, warm_up: warm_up.min(most) }
        }
        Optimiser::Adadelta { .. } => optimiser,
    }
}
