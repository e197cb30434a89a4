//! The thread that follows a training run, be it in another program: its log, and its weights at each
//! checkpoint.
//!
//! `deepshade train` replaces its checkpoint as a whole and appends whole lines to its log, so that looking
//! at both disturbs nobody.

use super::catch_panic::catch_panic;
use super::method_worker::Trained;
use super::request_slot::RequestSlot;
use super::workers::{SendUpdate, Update};
use crate::learned::run::is_run;
use crate::output::message;
use anyhow::{Context, Result};
use deepshade_infer::Model;
use deepshade_train::checkpoint::{CHECKPOINT_FILE, Checkpoint, Progress};
use deepshade_train::metrics::{self, Line, METRICS_FILE};
use deepshade_train::{TrainConfig, is_taken};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, SystemTime};

/// How often the run's files are looked at.
const EVERY: Duration = Duration::from_millis(400);
/// Lines of the log whose speed tells when the run ends.
const RECENT: usize = 10;

/// A run as its folder tells it.
#[derive(Clone)]
pub struct TrainingRun {
    /// Its folder.
    pub folder: PathBuf,
    /// Steps of the whole run.
    pub steps: usize,
    /// Images a step.
    batch: usize,
    /// Whether a program is at it.
    pub is_taken: bool,
    /// Its log.
    pub lines: Arc<[Line]>,
    /// How far its newest checkpoint had come, and the weights then.
    pub checkpoint: Option<(Progress, Trained)>,
}

impl TrainingRun {
    /// Steps that are done, as far as log and checkpoint tell.
    pub fn step(&self) -> usize {
        let logged = self.lines.last().map_or(0, |line| line.step);
        self.checkpoint.as_ref().map_or(logged, |(progress, _)| progress.step.max(logged))
    }

    /// Whether it has come to its end.
    pub fn is_over(&self) -> bool {
        let stopped = self.checkpoint.as_ref().is_some_and(|(progress, _)| progress.stopped);
        stopped || self.step() >= self.steps
    }

    /// Seconds that the steps to come take, validations not counted, at the speed of the last lines of the
    /// log.
    pub fn seconds_left(&self) -> Option<f64> {
        let recent = &self.lines[self.lines.len().saturating_sub(RECENT)..];
        let speed = recent.iter().map(|line| line.images_per_second).sum::<f64>() / recent.len() as f64;
        let left = self.steps.saturating_sub(self.step()) * self.batch;
        (self.is_taken && !self.is_over() && speed > 0.0).then_some(left as f64 / speed)
    }
}

/// Follows the run whose folder is requested, as soon as it is one, until the slot is closed.
pub fn run(requests: &RequestSlot<Option<PathBuf>>, send: SendUpdate<'_>) {
    while let Some(request) = requests.take() {
        let Some(folder) = request else { continue };
        let mut follower = RunFollower { folder, seen: FileStamps::default(), checkpoint: None, told: None };
        while !requests.fills_within(EVERY) {
            follower.look(send);
        }
    }
}

/// When a file was changed, and its bytes; nothing where there is none.
type Stamp = Option<(SystemTime, u64)>;

/// What tells one state of a file from another without reading it.
fn stamp(path: &Path) -> Stamp {
    let data = std::fs::metadata(path).ok()?;
    Some((data.modified().ok()?, data.len()))
}

/// States of the files that were looked at last.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
struct FileStamps {
    log: Stamp,
    checkpoint: Stamp,
    is_taken: bool,
}

/// Follows a run.
struct RunFollower {
    folder: PathBuf,
    seen: FileStamps,
    checkpoint: Option<(Progress, Trained)>,
    /// What was said last of files that cannot be read, so that it is said once.
    told: Option<String>,
}

impl RunFollower {
    /// Reads what has changed, and sends it. A folder that is no run may become one.
    fn look(&mut self, send: SendUpdate<'_>) {
        if !is_run(&self.folder) {
            return;
        }
        let now = FileStamps {
            log: stamp(&self.folder.join(METRICS_FILE)),
            checkpoint: stamp(&self.folder.join(CHECKPOINT_FILE)),
            is_taken: is_taken(&self.folder),
        };
        if now == self.seen {
            return;
        }
        let anew = now.checkpoint != self.seen.checkpoint;
        self.seen = now;
        match catch_panic("following a training run", || self.read(anew)) {
            Ok(training) => {
                self.told = None;
                send(Update::TrainingRun(training));
            }
            Err(error) => {
                let error = Some(message(&error.context(format!("{}", self.folder.display()))));
                if self.told != error {
                    error.iter().for_each(|error| send(Update::Error(error.clone())));
                    self.told = error;
                }
            }
        }
    }

    /// The run as it is now, its weights read `anew` or as they were.
    fn read(&mut self, anew: bool) -> Result<TrainingRun> {
        let config = TrainConfig::load(&self.folder)?;
        if anew {
            let checkpoint = Checkpoint::load(&self.folder, &config.spec)?;
            self.checkpoint = checkpoint.map(|Checkpoint { progress, weights, .. }| {
                let model = Arc::new(Model { spec: config.spec.clone(), weights });
                (progress, Trained(model))
            });
        }
        let lines = metrics::read(&self.folder).context("the log of the run")?;
        Ok(TrainingRun {
            folder: self.folder.clone(),
            steps: config.steps,
            batch: config.batch,
            is_taken: self.seen.is_taken,
            lines: lines.into(),
            checkpoint: self.checkpoint.clone(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_infer::{ChannelOrder, NetSpec, Reach, Weights};
    use std::sync::Mutex;

    fn line(step: usize, images_per_second: f64) -> Line {
        Line { step, loss: 0.1, validation_loss: None, rate: 1e-3, images_per_second }
    }

    fn training(step: usize, stopped: bool) -> TrainingRun {
        let progress = Progress { step, best_step: 0, best_loss: None, waited: 0, stopped, pause_loss: None };
        let reach = Reach { radius: 0.25, diagonal_share: 0.1, height: 64 };
        let spec =
            NetSpec::ao(ChannelOrder::Interleaved, reach).reshaped(|net| (net.levels, net.u0) = (2, 4));
        let model = Arc::new(Model { weights: Weights::random(&spec, 1), spec });
        let lines: Vec<Line> =
            (1..=20).map(|line_of| line(20 * line_of, if line_of > 10 { 8.0 } else { 1.0 })).collect();
        TrainingRun {
            folder: PathBuf::new(),
            steps: 1000,
            batch: 4,
            is_taken: true,
            lines: lines.into(),
            checkpoint: Some((progress, Trained(model))),
        }
    }

    #[test]
    fn the_last_lines_tell_when_a_run_ends() {
        assert_eq!(training(250, false).seconds_left(), Some(600.0 * 4.0 / 8.0));
        assert_eq!(training(250, true).seconds_left(), None, "it has stopped");
        assert_eq!(training(1000, false).seconds_left(), None, "it is through");
        let left = TrainingRun { is_taken: false, ..training(250, false) };
        assert_eq!(left.seconds_left(), None, "nobody is at it");
        let fresh = TrainingRun { lines: [].into(), checkpoint: None, ..training(0, false) };
        assert_eq!((fresh.step(), fresh.seconds_left()), (0, None));
    }

    #[test]
    fn a_follower_sends_once_of_each_change_and_of_what_is_broken() {
        let folder = tempfile::tempdir().expect("a folder");
        let told = Mutex::new(Vec::new());
        let send = |update| {
            told.lock().expect("no panic").push(match update {
                Update::TrainingRun(training) => format!("step {}", training.step()),
                Update::Error(what) => what,
                _ => "something else".to_owned(),
            });
        };
        let place = folder.path().to_owned();
        let mut follower =
            RunFollower { folder: place.clone(), seen: FileStamps::default(), checkpoint: None, told: None };
        // It is no run yet.
        follower.look(&send);
        let (_, trained) = training(0, false).checkpoint.expect("some");
        let mut config = TrainConfig::new(trained.0.spec.clone(), "data".into());
        config.steps = 100;
        let write =
            |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).expect("written");
        write("config.json", &serde_json::to_vec(&config).expect("plain"));
        let log = |line: &Line| serde_json::to_string(line).expect("plain") + "\n";
        write(METRICS_FILE, log(&line(20, 1.0)).as_bytes());
        follower.look(&send);
        follower.look(&send);
        write(CHECKPOINT_FILE, b"no checkpoint");
        follower.look(&send);
        follower.look(&send);
        write(METRICS_FILE, (log(&line(20, 1.0)) + &log(&line(40, 1.0))).as_bytes());
        let progress = Progress { step: 60, ..training(0, false).checkpoint.expect("some").0 };
        let weights = trained.0.weights.clone();
        let mean = weights.clone();
        let checkpoint = Checkpoint { progress, weights, mean, best: None, optimiser: Vec::new() };
        checkpoint.save(&place, &config.spec).expect("saves");
        follower.look(&send);
        let told = told.into_inner().expect("no panic");
        assert!(
            matches!(&told[..], [first, broken, last]
            if first == "step 20" && broken.contains("checkpoint.safetensors") && last == "step 60"),
            "{told:?}"
        );
        assert_eq!(follower.checkpoint.expect("read").1.0.weights, trained.0.weights);
    }
}
