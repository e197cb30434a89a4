//! What is trained on: pairs that are there, or a recipe's views as they are rendered.

use super::{Args, notes};
use anyhow::{Result, bail};
use deepshade_dataset::{Dataset, Recipe};
use deepshade_train::{TrainConfig, TrainingOutcome};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What is trained on.
pub struct TrainingSource {
    /// What makes the pairs, or has made them.
    pub recipe: Recipe,
    /// The recipe's file, or the dataset's folder.
    pub path: PathBuf,
    /// The pairs that are there; none where they are rendered.
    pairs: Option<Pairs>,
}

/// Pairs that are there.
struct Pairs {
    dataset: Arc<Dataset>,
    /// What is to be said of those held apart.
    warning: Option<String>,
}

impl TrainingSource {
    /// What the command line names.
    ///
    /// # Errors
    /// If it cannot be read, or nothing is named.
    pub fn open(args: &Args) -> Result<Self> {
        if let Some(path) = &args.recipe {
            return Ok(Self { recipe: Recipe::load(path)?, path: path.clone(), pairs: None });
        }
        let Some(dataset) = &args.dataset else { bail!("--dataset or --recipe says what is trained on") };
        let path = dataset.read()?;
        let dataset = Arc::new(Dataset::open(&path)?);
        let recipe = dataset.recipe().clone();
        let warning = notes::held_apart(&dataset.manifest().pairs);
        Ok(Self { recipe, path, pairs: Some(Pairs { dataset, warning }) })
    }

    /// What is to be said of the pairs held apart, where they tell little.
    pub fn warning(&self, config: &TrainConfig) -> Option<String> {
        match &self.pairs {
            Some(pairs) => pairs.warning.clone(),
            None => notes::held_apart_of_stream(&self.recipe, config.validation_pairs),
        }
    }

    /// Trains on it, in the folder of a run.
    ///
    /// # Errors
    /// As [`deepshade_train::train_on`] and [`deepshade_train::train_streamed`].
    pub fn train(&self, config: &TrainConfig, run: &Path) -> Result<TrainingOutcome> {
        Ok(match &self.pairs {
            Some(pairs) => deepshade_train::train_on(config, Arc::clone(&pairs.dataset) as _, run)?,
            None => deepshade_train::train_streamed(config, &self.recipe, run)?,
        })
    }
}
