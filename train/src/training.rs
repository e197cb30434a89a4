//! The training loop: steps, validation, checkpoints, early stop, resuming.

use crate::checkpoint::{Checkpoint, Progress};
use crate::loader::{Batch, Loader};
use crate::metrics::{Line, Metrics};
use crate::net::UNet;
use crate::pairs::{Cache, PairSource};
use crate::progress::Display;
use crate::{TrainConfig, TrainError, loss};
use burn::optim::{GradientsParams, ModuleOptimizer};
use burn::tensor::{Bytes, Device, Tensor};
use deepshade_dataset::Dataset;
use deepshade_infer::Weights;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Steps between lines of metrics.
const LINE_EVERY: usize = 20;

/// Why a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// All steps are done.
    Finished,
    /// Validation has not become better for `patience` validations.
    Stopped,
    /// The time was up; the same command goes on.
    OutOfTime,
}

/// What a run has come to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// Why it ended.
    pub ending: Ending,
    /// How far it has come.
    pub progress: Progress,
    /// Images trained on a second, validation and checkpoints not counted; 0 if nothing was left to do.
    pub images_per_second: f64,
}

/// Trains a network on a dataset, in a folder of its own, or goes on with the run that lies there.
///
/// # Errors
/// If the config makes no sense or is not that of the run in the folder, a file cannot be read or written, or the
/// loss is no number any more.
pub fn train(config: &TrainConfig, folder: &Path) -> Result<Outcome, TrainError> {
    config.check()?;
    let dataset = Dataset::open(&config.dataset)?;
    train_on(config, Arc::new(dataset), folder)
}

/// As [`train`], on pairs from anywhere.
///
/// # Errors
/// As [`train`].
pub fn train_on(
    config: &TrainConfig,
    source: Arc<dyn PairSource>,
    folder: &Path,
) -> Result<Outcome, TrainError> {
    config.check()?;
    let split = Split::new(&*source, config.validation_pairs)?;
    std::fs::create_dir_all(folder).map_err(TrainError::io("create", folder))?;
    config.claim(folder)?;
    let cache = Arc::new(Cache::new(source, config.spec.clone(), config.cache_megabytes << 20));
    Run::open(config, folder, cache, split)?.go()
}

/// Which pairs are trained on, and which of those held apart measure it.
struct Split {
    training: Vec<usize>,
    validation: Vec<usize>,
}

impl Split {
    /// At most `most` pairs for validation, spread evenly over those that are held apart.
    fn new(source: &dyn PairSource, most: usize) -> Result<Self, TrainError> {
        let (training, held) = (source.training(), source.validation());
        if training.is_empty() || held.is_empty() {
            let problem =
                format!("has {} pairs to train on and {} for validation", training.len(), held.len());
            return Err(TrainError::Config { field: "dataset", problem });
        }
        let count = held.len().min(most);
        Ok(Self { training, validation: (0..count).map(|i| held[i * held.len() / count]).collect() })
    }
}

/// A run while it goes on.
struct Run<'a> {
    config: &'a TrainConfig,
    folder: &'a Path,
    device: Device,
    cache: Arc<Cache>,
    split: Split,
    net: UNet,
    best: Weights,
    optimiser: ModuleOptimizer,
    progress: Progress,
    metrics: Metrics,
    meter: Meter,
}

impl<'a> Run<'a> {
    /// A fresh run, or the one that the folder's checkpoint holds.
    fn open(
        config: &'a TrainConfig,
        folder: &'a Path,
        cache: Arc<Cache>,
        split: Split,
    ) -> Result<Self, TrainError> {
        let device = crate::device().autodiff();
        let spec = &config.spec;
        let mut optimiser = config.optimiser.start();
        let fresh = Progress { step: 0, best_step: 0, best_loss: None, waited: 0, stopped: false };
        let (net, best, progress) = match Checkpoint::load(folder, spec)? {
            None => {
                let net = UNet::random(spec, config.seed, &device);
                let weights = net.weights();
                (net, weights, fresh)
            }
            Some(checkpoint) => {
                let state = Bytes::from_bytes_vec(checkpoint.optimiser);
                optimiser = optimiser.from_bytes(state).map_err(|error| {
                    TrainError::damaged(&folder.join(crate::checkpoint::CHECKPOINT_FILE), error)
                })?;
                (UNet::from_weights(spec, &checkpoint.weights, &device), checkpoint.best, checkpoint.progress)
            }
        };
        let metrics = Metrics::open(folder, progress.step)?;
        let meter = Meter::default();
        Ok(Self { config, folder, device, cache, split, net, best, optimiser, progress, metrics, meter })
    }

    /// Trains until the end.
    fn go(mut self) -> Result<Outcome, TrainError> {
        let config = self.config;
        let deadline = config.minutes.map(|minutes| Instant::now() + Duration::from_secs_f64(60.0 * minutes));
        let mut loader = Loader::start(&self.cache, self.split.training.clone(), config, self.progress.step);
        let mut display = Display::new(self.progress.step, config.steps);
        let mut ending = if self.progress.stopped { Ending::Stopped } else { Ending::Finished };
        while self.progress.step < config.steps && !self.progress.stopped {
            if deadline.is_some_and(|deadline| Instant::now() >= deadline) {
                ending = Ending::OutOfTime;
                self.save()?;
                break;
            }
            let began = Instant::now();
            let loss = self.step(loader.next()?)?;
            self.meter.add(loss, config.batch, began.elapsed());
            display.show(self.progress.step, loss, self.progress.best_loss, self.meter.images_per_second());
            if self.after_step()? {
                ending = Ending::Stopped;
            }
        }
        display.finish();
        self.metrics.draw()?;
        Ok(Outcome { ending, progress: self.progress, images_per_second: self.meter.images_per_second() })
    }

    /// One step of the optimiser; the loss before it.
    fn step(&mut self, batch: Batch) -> Result<f32, TrainError> {
        let [input, target, valid] = batch.into_tensors(&self.device);
        let loss = loss::dssim(self.net.forward(input), target, valid);
        let value: f32 = loss.clone().into_scalar();
        if !value.is_finite() {
            return Err(TrainError::Diverged { step: self.progress.step, loss: value });
        }
        let gradients = GradientsParams::from_grads(loss.backward(), &self.net);
        let rate = self.config.optimiser.rate(self.progress.step, self.config.steps);
        self.net = self.optimiser.step(rate, self.net.clone(), gradients);
        self.progress.step += 1;
        Ok(value)
    }

    /// Validates, measures and saves where it is time to; whether the run ends early.
    fn after_step(&mut self) -> Result<bool, TrainError> {
        let step = self.progress.step;
        let last = step == self.config.steps;
        let validate = last || step.is_multiple_of(self.config.validate_every);
        let validation_loss = if validate { Some(self.validate()?) } else { None };
        if validate || step.is_multiple_of(LINE_EVERY) {
            let rate = self.config.optimiser.rate(step - 1, self.config.steps);
            let (loss, images_per_second) = self.meter.line();
            self.metrics.add(Line { step, loss, validation_loss, rate, images_per_second })?;
        }
        if validate {
            self.metrics.draw()?;
        }
        if validate || step.is_multiple_of(self.config.checkpoint_every) {
            self.save()?;
        }
        Ok(self.progress.stopped)
    }

    /// Loss on the views held apart, whole images; notes whether it is the best.
    fn validate(&mut self) -> Result<f32, TrainError> {
        let device = crate::device();
        let weights = self.net.weights();
        let net = UNet::from_weights(&self.config.spec, &weights, &device);
        let mut sum = 0.0;
        for index in &self.split.validation {
            let pair = self.cache.pair(*index)?;
            let mut batch = Batch::default();
            batch.push(&pair.window(0, 0, pair.height(), pair.width()), &self.config.spec);
            let [input, target, valid] = batch.into_tensors(&device);
            let loss: Tensor<1> = loss::dssim(net.forward(input), target, valid);
            sum += loss.into_scalar::<f32>();
        }
        let loss = sum / self.split.validation.len() as f32;
        let progress = &mut self.progress;
        if progress.best_loss.is_none_or(|best| loss < best) {
            (progress.best_loss, progress.best_step, progress.waited) = (Some(loss), progress.step, 0);
            self.best = weights;
        } else {
            progress.waited += 1;
        }
        progress.stopped = self.config.patience > 0 && progress.waited >= self.config.patience;
        Ok(loss)
    }

    fn save(&self) -> Result<(), TrainError> {
        let path = self.folder.join(crate::checkpoint::CHECKPOINT_FILE);
        let optimiser = self.optimiser.into_bytes().map_err(|error| TrainError::damaged(&path, error))?;
        let checkpoint = Checkpoint {
            progress: self.progress,
            weights: self.net.weights(),
            best: self.best.clone(),
            optimiser: optimiser.to_vec(),
        };
        checkpoint.save(self.folder, &self.config.spec)
    }
}

/// Mean loss and speed, of the run and since the last line.
#[derive(Default)]
struct Meter {
    loss: f64,
    steps: usize,
    images: usize,
    time: Duration,
    line: (usize, Duration),
}

impl Meter {
    fn add(&mut self, loss: f32, images: usize, time: Duration) {
        self.loss += f64::from(loss);
        self.steps += 1;
        self.images += images;
        self.time += time;
    }

    fn images_per_second(&self) -> f64 {
        self.images as f64 / self.time.as_secs_f64().max(1e-9)
    }

    /// Mean loss and images a second since the last call.
    fn line(&mut self) -> (f32, f64) {
        let seconds = (self.time - self.line.1).as_secs_f64().max(1e-9);
        let line = ((self.loss / self.steps as f64) as f32, (self.images - self.line.0) as f64 / seconds);
        (self.loss, self.steps, self.line) = (0.0, 0, (self.images, self.time));
        line
    }
}
