//! The settings of a training run. A run keeps them as `config.json`, from before its first step.

use crate::feed::Endless;
use crate::loss::Loss;
use crate::optim::Optimiser;
use crate::{Stop, TrainError, files};
use deepshade_infer::NetSpec;
use deepshade_shaders::similarity::TILE;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Name of the file in the run's folder.
pub const CONFIG_FILE: &str = "config.json";
/// Most minutes of a run: some two years.
pub const MOST_MINUTES: f64 = 1e6;

const MOST_STEPS: usize = 1_000_000_000;
const MOST_IMAGES: usize = 1024;
const MOST_EDGE: usize = 8192;
/// Pixels of a batch: the first feature map of the paper's network has 2 GiB then.
const MOST_PIXELS: usize = 1 << 26;
const MOST_WORKERS: usize = 256;
const MOST_MEGABYTES: usize = 1 << 24;
const MOST_RATE: f64 = 1000.0;

/// Devices where a run of earlier versions does not say.
const fn one() -> usize {
    1
}

/// The settings of a training run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainConfig {
    /// The network.
    pub spec: NetSpec,
    /// Folder of the dataset, or the recipe of a stream. Does not change what is learned, as long as the data
    /// are the same.
    pub dataset: PathBuf,
    /// How pairs are taken from a stream; none where they are a folder's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stream: Option<Endless>,
    /// What tells the data from others: BLAKE3 hash of the dataset's `manifest.json`, in hexadecimal.
    /// Training fills it in, and does not go on with a run on other data.
    pub data_hash: String,
    /// What is made small.
    #[serde(default)]
    pub loss: Loss,
    /// How weights follow gradients.
    pub optimiser: Optimiser,
    /// Folder of a model whose weights the run begins with; random ones without it.
    #[serde(default)]
    pub start: Option<PathBuf>,
    /// Images a step.
    pub batch: usize,
    /// Devices that share the images of a step; at most as many as there are images. Changes how sums are
    /// rounded, and nothing else of what is learned.
    #[serde(default = "one")]
    pub devices: usize,
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
    /// Minutes that `steps` were chosen to fit into, by which progress is shown; not kept.
    #[serde(skip)]
    pub fitted: Option<f64>,
    /// How the run is asked to end; not kept.
    #[serde(skip)]
    pub stop: Stop,
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
            stream: None,
            data_hash: String::new(),
            loss: Loss::DssimL2,
            optimiser: Optimiser::ADAMW,
            start: None,
            batch: 4,
            devices: 1,
            crop: 256,
            steps: 20_000,
            validation_pairs: 32,
            validate_every: 500,
            patience: 20,
            checkpoint_every: 250,
            seed: 1,
            minutes: None,
            fitted: None,
            stop: Stop::default(),
            workers: 1,
            cache_megabytes: 4096,
        }
    }

    /// Whether the settings make sense.
    ///
    /// # Errors
    /// If one does not; it is named.
    pub fn check(&self) -> Result<(), TrainError> {
        let error = |field, problem: String| Err(TrainError::Config { field, problem });
        if let Err(problem) = self.spec.validate() {
            return error("spec", format!("is not a network: {problem}"));
        }
        let counts = [
            ("batch", self.batch, 1, MOST_IMAGES),
            ("devices", self.devices, 1, self.batch.max(1)),
            ("crop", self.crop, TILE, MOST_EDGE),
            ("steps", self.steps, 1, MOST_STEPS),
            ("validation_pairs", self.validation_pairs, 1, MOST_STEPS),
            ("validate_every", self.validate_every, 1, MOST_STEPS),
            ("checkpoint_every", self.checkpoint_every, 1, MOST_STEPS),
            ("workers", self.workers, 1, MOST_WORKERS),
            ("cache_megabytes", self.cache_megabytes, 0, MOST_MEGABYTES),
        ];
        for (field, count, least, most) in counts {
            if !(least..=most).contains(&count) {
                return error(field, format!("is {count}; it must be {least} to {most}"));
            }
        }
        if let Some(Endless { uses, window }) = self.stream {
            for (field, count) in [("uses", uses), ("window", window)] {
                if !(1..=MOST_STEPS).contains(&count) {
                    return error("stream", format!("has {field} of {count}; it must be 1 to {MOST_STEPS}"));
                }
            }
        }
        if !self.crop.is_multiple_of(TILE) {
            let problem =
                format!("is {}; it must be a multiple of 8, the size of a tile of the loss", self.crop);
            return error("crop", problem);
        }
        if self.batch * self.crop * self.crop > MOST_PIXELS {
            let problem = format!("is {} with crops of {}: too many pixels at once", self.batch, self.crop);
            return error("batch", problem);
        }
        let weight_decay = self.optimiser.weight_decay();
        if !(0.0..=1.0).contains(&weight_decay) {
            return error("optimiser", format!("has a weight decay of {weight_decay}; it must be 0 to 1"));
        }
        let rate = self.optimiser.highest_rate();
        if !(0.0..=MOST_RATE).contains(&rate) {
            return error("optimiser", format!("has a rate of {rate}; it must be 0 to {MOST_RATE}"));
        }
        match self.minutes {
            Some(minutes) if !(0.0..=MOST_MINUTES).contains(&minutes) => {
                error("minutes", format!("is {minutes}; it must be 0 to {MOST_MINUTES}"))
            }
            _ => Ok(()),
        }
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
    pub fn differences(&self, other: &Self) -> Vec<String> {
        let comparable = |config: &Self| {
            let dataset = PathBuf::new();
            let config = Self { dataset, minutes: None, workers: 1, cache_megabytes: 0, ..config.clone() };
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
