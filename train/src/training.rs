//! The training loop: steps, validation, checkpoints, early stop, resuming.

use crate::checkpoint::{CHECKPOINT_FILE, Checkpoint, Progress};
use crate::export::last_layer;
use crate::feed::{Endless, Feed, Streamed};
use crate::loader::{Batch, Loader, Tensors};
use crate::loss::Loss;
use crate::metrics::{Line, Metrics};
use crate::net::UNet;
use crate::pairs::{Cache, HalfPair, PairSource};
use crate::parallel::gradients;
use crate::{TrainConfig, TrainError, files};
use burn::optim::ModuleOptimizer;
use burn::tensor::{Bytes, Device};
use deepshade_dataset::holder::Holder;
use deepshade_dataset::progress::Gauge;
use deepshade_dataset::{Dataset, DatasetError, Estimator, Pair, Recipe, stream};
use deepshade_infer::{AnalyticEstimate, Model, NetSpec, Trained, Weights};
use deepshade_shaders::{Effect, lists};
use std::fs::File;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Name of the file in a run's folder that says what its frames are like: [`Trained`].
pub const RANGES_FILE: &str = "trained_on.json";
/// The share that the mean of the weights keeps of itself in a step, and how fast it comes to that: early
/// weights say little.
const KEPT: f32 = 0.999;
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
    /// It was asked to end, by [`Stop`](crate::Stop); the same command goes on.
    Interrupted,
}

/// What a run has come to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrainingOutcome {
    /// Why it ended.
    pub ending: Ending,
    /// How far it has come.
    pub progress: Progress,
    /// Share of the time of the steps for which pairs were waited for that were not rendered yet.
    pub waiting: f64,
    /// Images trained on a second, validation and checkpoints not counted; 0 if nothing was left to do.
    pub images_per_second: f64,
}

/// Trains a network on a dataset, in a folder of its own, or goes on with the run that lies there.
///
/// # Errors
/// If the config makes no sense, it or the data are not those of the run in the folder, another program has
/// the folder, a file cannot be read or written, or the loss is no number any more.
pub fn train(config: &TrainConfig, folder: &Path) -> Result<TrainingOutcome, TrainError> {
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
) -> Result<TrainingOutcome, TrainError> {
    config.check()?;
    let split = Split::new(&*source, config.validation_pairs)?;
    let data_hash = source.hash().map_err(TrainError::Data)?;
    let config = &TrainConfig { data_hash, stream: None, ..config.clone() };
    let metrics = claim(config, folder)?;
    let cache = Cache::new(source, config.spec.clone(), config.cache_megabytes << 20);
    let validation = split.validation.iter().map(|index| cache.pair(*index)).collect::<Result<_, _>>()?;
    let feed = move |_| Ok(Feed::Folder { cache, training: split.training });
    TrainingLoop::open(config, folder, metrics, feed, validation)?.go()
}

/// As [`train`], on pairs that are rendered while the network trains.
///
/// # Errors
/// As [`train`], and if a recipe's scenes cannot be had.
pub fn train_streamed(
    config: &TrainConfig,
    recipe: &Recipe,
    folder: &Path,
) -> Result<TrainingOutcome, TrainError> {
    config.check()?;
    let data_hash = stream::hash(recipe);
    let endless = config.stream.unwrap_or(Endless::USUAL);
    let config = &TrainConfig { data_hash, stream: Some(endless), ..config.clone() };
    let metrics = claim(config, folder)?;
    let recipe = &with_estimates(recipe, &config.spec);
    let failed = |error: DatasetError| TrainError::Data(error.to_string());
    let pairs = stream::validation(recipe, config.validation_pairs).map_err(failed)?;
    note_ranges(config.spec.effect, &pairs, folder)?;
    let half = |(index, pair): (usize, &Pair)| {
        let half = HalfPair::new(pair, &config.spec, index as u32).map(Arc::new);
        half.map_err(|problem| TrainError::Pair { index, problem })
    };
    let validation = pairs.iter().enumerate().map(half).collect::<Result<_, _>>()?;
    let feed = |step: usize| {
        let streamed = Streamed::start(recipe, config, endless, step * config.batch)?;
        Ok(Feed::Streamed(streamed))
    };
    TrainingLoop::open(config, folder, metrics, feed, validation)?.go()
}

/// A recipe whose pairs hold what methods that look beyond the screen estimate for a network, too.
fn with_estimates(recipe: &Recipe, spec: &NetSpec) -> Recipe {
    let mut recipe = recipe.clone();
    let own = |estimate: &&AnalyticEstimate| estimate.effect(spec.effect) == spec.effect;
    for AnalyticEstimate { method, quality, .. } in spec.estimates.iter().filter(own) {
        let text = format!("{method}:{quality}");
        let of_scene = Estimator::parse(spec.effect, &text).is_ok_and(|estimator| estimator.reads_scene());
        if of_scene && !recipe.estimates.contains(&text) {
            recipe.estimates.push(text);
        }
    }
    recipe
}

/// Takes a run's folder, or checks that the run that lies there has the same settings.
fn claim(config: &TrainConfig, folder: &Path) -> Result<(File, Holder), TrainError> {
    // Before the run's folder is claimed: what is refused leaves no folder that remembers it.
    if !folder.join(CHECKPOINT_FILE).exists() {
        first_weights(config)?;
    }
    let metrics = files::take(folder)?;
    config.claim(folder)?;
    Ok(metrics)
}

/// Writes down what the frames of a run are like, for what is exported of it.
fn note_ranges(effect: Effect, pairs: &[Pair], folder: &Path) -> Result<(), TrainError> {
    let ranges = Trained::of(effect, pairs.iter().map(|pair| (&pair.gbuffer, pair.radius)));
    if let Ok(Some(ranges)) = ranges {
        let json = serde_json::to_vec_pretty(&ranges).expect("ranges are plain data");
        files::replace(&folder.join(RANGES_FILE), &json)?;
    }
    Ok(())
}

/// Which pairs are trained on, and which of those held apart measure it.
pub(crate) struct Split {
    pub(crate) training: Vec<usize>,
    validation: Vec<usize>,
}

impl Split {
    /// At most `most` pairs for validation, spread evenly over those that are held apart.
    pub(crate) fn new(source: &dyn PairSource, most: usize) -> Result<Self, TrainError> {
        let (training, held) = (source.training(), source.validation());
        if training.is_empty() || held.is_empty() {
            let problem = format!(
                "has {} pairs to train on and {} for validation; the recipe's `validation_share` says how many views are held apart",
                training.len(),
                held.len()
            );
            return Err(TrainError::Config { field: "dataset", problem });
        }
        let validation = lists::spread(held.len(), most).into_iter().map(|index| held[index]).collect();
        Ok(Self { training, validation })
    }
}

/// A run while it goes on.
struct TrainingLoop<'a> {
    config: &'a TrainConfig,
    folder: &'a Path,
    /// Each takes its share of a batch; the first has the network.
    devices: Vec<Device>,
    feed: Arc<Feed>,
    validation: Vec<Arc<HalfPair>>,
    net: UNet,
    /// Mean of the weights over the last steps.
    mean: Weights,
    best: Option<Weights>,
    optimiser: ModuleOptimizer,
    progress: Progress,
    metrics: Metrics,
    meter: Meter,
}

impl<'a> TrainingLoop<'a> {
    /// A fresh run, or the one that the folder's checkpoint holds.
    fn open(
        config: &'a TrainConfig,
        folder: &'a Path,
        metrics: (File, Holder),
        feed: impl FnOnce(usize) -> Result<Feed, TrainError>,
        validation: Vec<Arc<HalfPair>>,
    ) -> Result<Self, TrainError> {
        let devices = crate::device::devices(config.devices)?;
        let devices: Vec<Device> = devices.into_iter().map(|device| device.autodiff()).collect();
        let device = &devices[0];
        let spec = &config.spec;
        let mut optimiser = config.optimiser.start();
        let (net, mean, best, progress) = match Checkpoint::load(folder, spec)? {
            None => {
                let net = first_net(config, device)?;
                let weights = net.weights();
                (net, weights, None, Progress::START)
            }
            Some(checkpoint) => {
                let state = Bytes::from_bytes_vec(checkpoint.optimiser);
                optimiser = optimiser
                    .from_bytes(state)
                    .map_err(|error| TrainError::damaged(&folder.join(CHECKPOINT_FILE), error))?;
                let progress = Progress { pause_loss: None, ..checkpoint.progress };
                let net = UNet::from_weights(spec, &checkpoint.weights, device);
                (net, checkpoint.mean, checkpoint.best, progress)
            }
        };
        let metrics = Metrics::open(folder, metrics, progress.step)?;
        let meter = Meter::default();
        let feed = Arc::new(feed(progress.step)?);
        let run = Self {
            config,
            folder,
            devices,
            feed,
            validation,
            net,
            mean,
            best,
            optimiser,
            progress,
            metrics,
            meter,
        };
        Ok(run)
    }

    /// Trains until the end.
    fn go(mut self) -> Result<TrainingOutcome, TrainError> {
        let config = self.config;
        let deadline = config.minutes.map(|minutes| Instant::now() + Duration::from_secs_f64(60.0 * minutes));
        let mut loader = Loader::start(&self.feed, config, self.progress.step);
        let gauge = self.gauge();
        let _guard = config.stop.guard();
        let mut ending = if self.progress.stopped { Ending::Stopped } else { Ending::Finished };
        while self.progress.step < config.steps && !self.progress.stopped {
            if deadline.is_some_and(|deadline| Instant::now() >= deadline) {
                ending = Ending::OutOfTime;
                self.pause()?;
                break;
            }
            let began = Instant::now();
            let Some(batch) = loader.next(&config.stop)? else {
                ending = Ending::Interrupted;
                self.save()?;
                break;
            };
            let loss = self.step(batch)?;
            self.meter.add(loss, config.batch, began.elapsed());
            self.show(&gauge, loss);
            if self.after_step()? {
                ending = Ending::Stopped;
            }
        }
        gauge.end();
        self.metrics.draw()?;
        let images_per_second = self.meter.images_per_second();
        let waiting = self.feed.waited() / self.meter.time.as_secs_f64().max(1e-9);
        Ok(TrainingOutcome { ending, progress: self.progress, waiting: waiting.min(1.0), images_per_second })
    }

    /// Shows a step: its loss, the best validation so far, the speed.
    fn show(&self, gauge: &Gauge, loss: f32) {
        let validation = self.progress.best_loss.map(|loss| format!(", best validation {loss:.4}"));
        let speed = self.meter.images_per_second();
        let message = format!("loss {loss:.4}{}, {speed:.1} images/s", validation.unwrap_or_default());
        gauge.show(self.progress.step, message);
    }

    /// What shows how far the run is: by time where that is what it has, else by steps.
    fn gauge(&self) -> Gauge {
        let TrainConfig { minutes, fitted, steps, .. } = *self.config;
        let (done, seconds) = (self.progress.step, |minutes: f64| Duration::from_secs_f64(60.0 * minutes));
        // Of a run that goes on the rest of the steps is left, and as much of the time that all were to take.
        let rest = steps.saturating_sub(done) as f64 / steps as f64;
        match (minutes, fitted) {
            (Some(minutes), _) => Gauge::until(steps, done, seconds(minutes)),
            (None, Some(minutes)) => Gauge::about(steps, done, seconds(minutes * rest)),
            (None, None) => Gauge::steps(steps, done),
        }
    }

    /// One step of the optimiser; the loss before it.
    fn step(&mut self, batch: Batch) -> Result<f32, TrainError> {
        let (value, gradients) = gradients(&self.net, self.config.loss, batch, &self.devices);
        if !value.is_finite() {
            return Err(TrainError::Diverged { step: self.progress.step, loss: value });
        }
        let rate = self.config.optimiser.rate(self.progress.step, self.config.steps);
        self.net = self.optimiser.step(rate, self.net.clone(), gradients);
        self.progress.step += 1;
        self.average();
        Ok(value)
    }

    /// Takes the weights into their mean.
    fn average(&mut self) {
        let step = self.progress.step as f32;
        let kept = KEPT.min(step / (step + 10.0));
        let now = self.net.weights();
        for (mean, now) in self.mean.0.iter_mut().zip(&now.0) {
            for (mean, now) in [(&mut mean.weight, &now.weight), (&mut mean.bias, &now.bias)] {
                // So that a mean of equal numbers is that number.
                mean.iter_mut().zip(now).for_each(|(mean, now)| *mean += (1.0 - kept) * (now - *mean));
            }
        }
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

    /// Saves a run whose time is up, and measures what it has learned where a step has not been validated
    /// already.
    fn pause(&mut self) -> Result<(), TrainError> {
        let step = self.progress.step;
        if !step.is_multiple_of(self.config.validate_every) {
            self.progress.pause_loss = Some(self.validation_loss(&self.mean)?);
        }
        self.save()
    }

    /// Measures the network, notes whether it is the best, and whether it is time to stop.
    fn validate(&mut self) -> Result<f32, TrainError> {
        let weights = self.mean.clone();
        let loss = self.validation_loss(&weights)?;
        let progress = &mut self.progress;
        if progress.best_loss.is_none_or(|best| loss < best) {
            (progress.best_loss, progress.best_step, progress.waited) = (Some(loss), progress.step, 0);
            self.best = Some(weights);
        } else {
            progress.waited += 1;
        }
        progress.stopped = self.config.patience > 0 && progress.waited >= self.config.patience;
        Ok(loss)
    }

    /// Mean structural dissimilarity on the views held apart, whole images, whatever the loss is that is
    /// trained for. The noise of their targets is taken off where it is known, so that data with and without
    /// that are not to be compared by it.
    fn validation_loss(&self, weights: &Weights) -> Result<f32, TrainError> {
        let device = crate::device();
        let net = UNet::from_weights(&self.config.spec, weights, &device);
        let mut sum = 0.0;
        for pair in &self.validation {
            let mut batch = Batch::default();
            let whole = pair.window(0, 0, pair.height(), pair.width());
            (0..self.config.spec.runs())
                .for_each(|run| batch.push(&whole, pair.scale(), &self.config.spec, run));
            let Tensors { input, target, exposure } = batch.into_tensors(&device);
            let loss = Loss::Dssim.of(net.forward(input) * exposure, target);
            sum += loss.into_scalar::<f32>();
        }
        let loss = sum / self.validation.len() as f32;
        if loss.is_finite() { Ok(loss) } else { Err(TrainError::Diverged { step: self.progress.step, loss }) }
    }

    fn save(&self) -> Result<(), TrainError> {
        let path = self.folder.join(CHECKPOINT_FILE);
        let optimiser = self.optimiser.into_bytes().map_err(|error| TrainError::damaged(&path, error))?;
        let checkpoint = Checkpoint {
            progress: self.progress,
            weights: self.net.weights(),
            mean: self.mean.clone(),
            best: self.best.clone(),
            optimiser: optimiser.to_vec(),
        };
        checkpoint.save(self.folder, &self.config.spec)
    }
}

/// What a run begins with.
fn first_net(config: &TrainConfig, device: &Device) -> Result<UNet, TrainError> {
    Ok(match first_weights(config)? {
        Some(weights) => UNet::from_weights(&config.spec, &weights, device),
        None => UNet::random(&config.spec, config.seed, device),
    })
}

/// The weights of the network that a run begins with; none where it begins with random ones.
fn first_weights(config: &TrainConfig) -> Result<Option<Weights>, TrainError> {
    let Some(folder) = &config.start else { return Ok(None) };
    let Model { spec, weights } = Model::load(folder)?;
    let own = &config.spec;
    let (its, wanted) = (last_layer(&spec), last_layer(own));
    // Weights mean the same in a network that reads the same in the same order, whatever it learns to make of
    // it.
    let alike = NetSpec { effect: own.effect, reach: own.reach, trained: None, environment: None, ..spec };
    if alike == *own && weights.fit(own) {
        return Ok(Some(weights));
    }
    let problem = match its == wanted {
        true => "but for effect and reach its spec must be that of the one that is trained".to_owned(),
        false => format!("its last layer {its}, and that of the one that is trained {wanted}"),
    };
    Err(TrainError::damaged(folder, format!("is another network: {problem}")))
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
