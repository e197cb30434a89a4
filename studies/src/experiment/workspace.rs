//! Where experiments work: a folder with datasets, training runs and test sets, each made once under its name
//! and found again, by another study or by the same one after it was interrupted.

use super::size::Size;
use super::test_frames::TestFrames;
use anyhow::{Context, Result, bail};
use deepshade::shared::figures::write_atomically;
use deepshade::shared::learned::Learned;
use deepshade::shared::train::INPUT_RADIUS;
use deepshade_dataset::{Dataset, Radius, Recipe, Summary, TestSet, generate};
use deepshade_infer::{ChannelOrder, Model, NetSpec, Reach};
use deepshade_render::method::Repeats;
use deepshade_train::checkpoint::Checkpoint;
use deepshade_train::metrics::{self, Line};
use deepshade_train::{Loss, TrainConfig, train};
use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What is trained and tested on at the default size.
const RECIPES: [(&str, &str); 2] = [
    ("experiment.toml", include_str!("../../../dataset/recipes/experiment.toml")),
    ("experiment-test.toml", include_str!("../../../dataset/recipes/experiment-test.toml")),
];

/// The name of what the studies vary, unvaried.
const BASE: &str = "base";

/// Where experiments of a size work.
pub struct Workspace {
    folder: PathBuf,
    /// How large they are.
    pub size: Size,
    /// What is trained on.
    pub recipe: Recipe,
    /// What is tested on.
    pub test_recipe: Recipe,
    /// What was done, for the table's foot.
    notes: RefCell<Vec<String>>,
    /// Networks trained.
    runs: RefCell<Vec<TrainedRun>>,
}

/// How a network was trained.
#[derive(Clone, Debug)]
pub struct TrainedRun {
    /// Its name.
    pub name: String,
    /// What was made small.
    pub loss: Loss,
    /// What was measured.
    pub lines: Vec<Line>,
}

/// A dataset.
pub struct Data {
    /// The dataset.
    pub dataset: Dataset,
    /// What making it took, seconds.
    pub seconds: f64,
}

/// A trained network.
pub struct Trained {
    /// The best of its validated networks.
    pub model: Model,
    /// Structural dissimilarity of that one on the pairs held apart.
    pub validation: f64,
    /// What its steps took, seconds, validation not counted.
    pub seconds: f64,
}

impl Trained {
    /// The network as a method, on the processor.
    ///
    /// # Errors
    /// If the processor refuses the network.
    pub fn method(&self) -> Result<Learned> {
        Ok(Learned::on_processor(&self.model)?)
    }
}

impl Workspace {
    /// A workspace in a folder.
    ///
    /// # Errors
    /// If the folder cannot be written.
    pub fn open(folder: &Path, size: Size) -> Result<Self> {
        let load = |(name, text): (&str, &str)| -> Result<Recipe> {
            let path = folder.join(name);
            write_atomically(&path, text.as_bytes())?;
            Ok(Recipe::load(&path)?)
        };
        let [recipe, test_recipe] = RECIPES;
        Ok(Self {
            folder: folder.to_owned(),
            size,
            recipe: size.trained(&load(recipe)?),
            test_recipe: size.tested(&load(test_recipe)?),
            notes: RefCell::default(),
            runs: RefCell::default(),
        })
    }

    /// The dataset of a recipe, under a name.
    ///
    /// # Errors
    /// If it cannot be made, or data of another recipe have that name.
    pub fn data(&self, name: &str, recipe: &Recipe) -> Result<Data> {
        let folder = self.folder.join("data").join(name);
        let times = self.folder.join("data").join(format!("{name}.seconds"));
        note!("data `{name}`: {} scenes, {} samples", recipe.scene_count(), recipe.samples);
        let start = Instant::now();
        let Summary { pairs, rendered, .. } = generate(recipe, &folder)?;
        if rendered > 0 {
            // Of all, from what was rendered now: an interrupted one is gone on with.
            let seconds = start.elapsed().as_secs_f64() * pairs as f64 / rendered as f64;
            write_atomically(&times, seconds.to_string().as_bytes())?;
        }
        let seconds = std::fs::read_to_string(&times).ok().and_then(|text| text.parse().ok());
        let seconds = seconds.unwrap_or(f64::NAN);
        let dataset = Dataset::open(&folder)?;
        let trained = dataset.training().len();
        let made =
            format!("{pairs} pairs, {trained} of them to train on, {} samples a pixel", recipe.samples);
        self.note(format!("data `{name}`: {made}, made in {seconds:.1} s"));
        Ok(Data { dataset, seconds })
    }

    /// The dataset of the workspace's recipe.
    ///
    /// # Errors
    /// As [`Workspace::data`].
    pub fn base_data(&self) -> Result<Data> {
        self.data(BASE, &self.recipe)
    }

    /// The settings of a run on a dataset: the paper's network for its effect.
    ///
    /// # Errors
    /// If the recipe's radius is not a share of the diagonal, or no network is laid out for its effect.
    pub fn settings(&self, data: &Data) -> Result<TrainConfig> {
        let recipe = data.dataset.recipe();
        let Radius::Diagonal(diagonal_share) = recipe.radius else {
            bail!("{}: the radius is no share of the diagonal", recipe.path.display());
        };
        let reach = Reach { radius: INPUT_RADIUS, diagonal_share, height: recipe.resolution.height };
        let spec = NetSpec::published(recipe.effect, ChannelOrder::Interleaved, reach);
        let spec = spec.with_context(|| format!("no network is laid out for effect `{}`", recipe.effect))?;
        Ok(self.size.settings(spec, data.dataset.folder().to_owned()))
    }

    /// The network of some settings, under a name.
    ///
    /// # Errors
    /// If training fails, or a run with other settings has that name.
    pub fn network(&self, name: &str, settings: &TrainConfig) -> Result<Trained> {
        let run = self.folder.join("runs").join(name);
        note!("network `{name}`: {} weights, {} steps", settings.spec.weight_count(), settings.steps);
        let outcome = train(settings, &run)?;
        let checkpoint = Checkpoint::load(&run, &settings.spec)?;
        let weights = checkpoint.as_ref().and_then(Checkpoint::best_weights);
        let (weights, (best, loss)) =
            weights.zip(outcome.progress.best()).context("no network was validated")?;
        let lines = metrics::read(&run)?;
        let seconds = training_seconds(&lines, settings.batch);
        self.note(format!(
            "network `{name}`: {} steps of {} crops of {2} x {2}, best after {best}, trained in {seconds:.1} s",
            settings.steps, settings.batch, settings.crop
        ));
        self.runs.borrow_mut().push(TrainedRun { name: name.to_owned(), loss: settings.loss, lines });
        let model = Model { spec: settings.spec.clone(), weights: weights.clone() };
        Ok(Trained { model, validation: loss.into(), seconds })
    }

    /// The paper's network, trained on the workspace's own dataset.
    ///
    /// # Errors
    /// As [`Workspace::data`] and [`Workspace::network`].
    pub fn base_network(&self) -> Result<Trained> {
        self.network(BASE, &self.settings(&self.base_data()?)?)
    }

    /// The frames of a recipe for testing, under a name.
    ///
    /// # Errors
    /// If they cannot be made, or those of another recipe have that name.
    pub fn test_frames(&self, name: &str, recipe: &Recipe) -> Result<TestFrames> {
        note!("test `{name}`: {} scenes, {} views each", recipe.scene_count(), recipe.views_per_scene);
        let test_frames =
            TestFrames::open(&TestSet::generate(recipe, &self.folder.join("tests").join(name))?)?;
        self.note(format!("test `{name}`: {}", test_frames.ceiling()));
        Ok(test_frames)
    }

    /// The frames of the workspace's recipe for testing.
    ///
    /// # Errors
    /// As [`Workspace::test_frames`].
    pub fn base_test_frames(&self) -> Result<TestFrames> {
        self.test_frames(BASE, &self.test_recipe)
    }

    /// Adds a line to the table's foot.
    pub fn note(&self, line: String) {
        self.notes.borrow_mut().push(line);
    }

    /// What was made, or found, for a study: a line each.
    pub fn notes(&self) -> Vec<String> {
        self.notes.borrow().clone()
    }

    /// How the networks of a study were trained.
    pub fn runs(&self) -> Vec<TrainedRun> {
        self.runs.borrow().clone()
    }
}

/// How near to truth a network's images are.
///
/// # Errors
/// If the device fails.
pub fn scores(test_frames: &TestFrames, network: &Trained) -> Result<super::test_frames::Scores> {
    let method = network.method()?;
    test_frames.scores(|gbuffer, radius| Ok(method.image(gbuffer, radius, Repeats::ONCE)?.image))
}

/// What the steps of a run took, which its lines know by their speed.
fn training_seconds(lines: &[Line], batch: usize) -> f64 {
    let earlier = std::iter::once(0).chain(lines.iter().map(|line| line.step));
    let steps =
        lines.iter().zip(earlier).map(|(line, earlier)| (line.step - earlier, line.images_per_second));
    steps.map(|(steps, speed)| (steps * batch) as f64 / speed).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::size::BATCH;

    #[test]
    fn recipes_are_of_the_default_size() {
        let folder = tempfile::tempdir().expect("a folder");
        let workspace = Workspace::open(folder.path(), Size::DEFAULT).expect("a lab");
        let [recipe, test] = RECIPES.map(|(name, _)| Recipe::load(&folder.path().join(name)).expect("sound"));
        assert_eq!((&workspace.recipe, &workspace.test_recipe), (&recipe, &test));
        let full = Workspace::open(folder.path(), Size::FULL).expect("a lab");
        assert_eq!(full.recipe.scene_count() * full.recipe.views_per_scene, 1000);
    }

    #[test]
    fn seconds_are_images_over_speed() {
        let line = |step, images_per_second| Line {
            step,
            loss: 0.1,
            validation_loss: None,
            rate: 1e-3,
            images_per_second,
        };
        assert_eq!(training_seconds(&[line(20, 40.0), line(50, 20.0)], BATCH), 2.0 + 6.0);
    }
}
