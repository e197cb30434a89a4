//! The settings of a training run. A run keeps them as `config.json`, from before its first step.

use crate::optim::Optimiser;
use crate::{TrainError, files, loss};
use deepshade_infer::NetSpec;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Name of the file in the run's folder.
pub const CONFIG_FILE: &str = "config.json";

/// The settings of a training run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainConfig {
    /// The network.
    pub spec: NetSpec,
    /// Folder of the dataset.
    pub dataset: PathBuf,
    /// How weights follow gradients.
    pub optimiser: Optimiser,
    /// Images a step.
    pub batch: usize,
    /// Height and width of the crops, pixels; a multiple of 8.
    pub crop: usize,
    /// Steps of the whole run.
    pub steps: usize,
    /// At most so many of the pairs that the dataset holds apart are used for validation.
    pub validation_pairs: usize,
    /// Steps between validations; each also saves a checkpoint.
    pub validate_every: usize,
    /// Validations without a better one after which the run ends; 0 for never.
    pub patience: usize,
    /// Steps between checkpoints.
    pub checkpoint_every: usize,
    /// Seed of weights, order, crops and symmetries.
    pub seed: u64,
    /// Minutes after which the run stops, to be resumed by the same command. Does not change what is learned.
    pub minutes: Option<f64>,
    /// Threads that decode pairs. Does not change what is learned.
    pub workers: usize,
    /// Megabytes (2^20 bytes) of decoded pairs kept in memory. Does not change what is learned.
    pub cache_megabytes: usize,
}

impl TrainConfig {
    /// The defaults for a network and a dataset: crops and steps for about an hour on two cores.
    pub fn new(spec: NetSpec, dataset: PathBuf) -> Self {
        Self {
            spec,
            dataset,
            optimiser: Optimiser::ADAMW,
            batch: 4,
            crop: 256,
            steps: 20_000,
            validation_pairs: 32,
            validate_every: 500,
            patience: 20,
            checkpoint_every: 250,
            seed: 1,
            minutes: None,
            workers: 1,
            cache_megabytes: 4096,
        }
    }

    /// Whether the settings make sense.
    ///
    /// # Errors
    /// If one does not; it is named.
    pub fn check(&self) -> Result<(), TrainError> {
        let error = |field, problem: &str| Err(TrainError::Config { field, problem: problem.to_owned() });
        if let Err(problem) = self.spec.validate() {
            return error("spec", &format!("is not a network: {problem}"));
        }
        let counts = [
            ("batch", self.batch),
            ("steps", self.steps),
            ("validation_pairs", self.validation_pairs),
            ("validate_every", self.validate_every),
            ("checkpoint_every", self.checkpoint_every),
            ("workers", self.workers),
        ];
        for (field, count) in counts {
            if count == 0 {
                return error(field, "must be at least 1");
            }
        }
        if self.crop == 0 || !self.crop.is_multiple_of(loss::TILE) {
            return error("crop", "must be a multiple of 8, the size of a tile of the loss");
        }
        Ok(())
    }

    /// The config of a run folder.
    ///
    /// # Errors
    /// If there is none or it is damaged.
    pub fn load(folder: &Path) -> Result<Self, TrainError> {
        let path = folder.join(CONFIG_FILE);
        let bytes = std::fs::read(&path).map_err(TrainError::io("read", &path))?;
        serde_json::from_slice(&bytes)
            .map_err(|e| TrainError::damaged(&path, format!("is no training config: {e}")))
    }

    /// Writes the config into a run's folder, or checks that the run that lies there has the same.
    pub(crate) fn claim(&self, folder: &Path) -> Result<(), TrainError> {
        let path = folder.join(CONFIG_FILE);
        if path.exists() {
            let fields = self.differences(&Self::load(folder)?);
            if !fields.is_empty() {
                return Err(TrainError::OtherRun { path, fields: fields.join(", ") });
            }
        }
        let json = serde_json::to_vec_pretty(self).expect("a config is plain data");
        files::replace(&path, &json)
    }

    /// Names of the settings that differ and change what is learned.
    fn differences(&self, other: &Self) -> Vec<String> {
        let comparable = |config: &Self| {
            let config = Self { minutes: None, workers: 1, cache_megabytes: 0, ..config.clone() };
            serde_json::to_value(config).expect("a config is plain data")
        };
        let (a, b) = (comparable(self), comparable(other));
        let fields = a.as_object().into_iter().flatten();
        fields
            .filter(|(name, value)| b.get(name.as_str()) != Some(*value))
            .map(|(name, _)| name.clone())
            .collect()
    }
}
