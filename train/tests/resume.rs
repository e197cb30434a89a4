//! Runs on made-up pairs: interrupted, killed, on other numbers of threads, they all learn the same, bit for bit.

use deepshade_dataset::Pair;
use deepshade_infer::{ChannelOrder, NetSpec, Reach};
use deepshade_shaders::{Attribute, GBuffer, Planes};
use deepshade_train::checkpoint::Checkpoint;
use deepshade_train::metrics::Line;
use deepshade_train::{Ending, Optimiser, PairSource, TrainConfig, TrainError, train_on};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

/// Pairs of which the target is a function of the normal; reading fails once `reads` are used up.
struct Synthetic {
    reads: AtomicUsize,
}

impl Synthetic {
    fn new(reads: usize) -> Arc<Self> {
        Arc::new(Self { reads: reads.into() })
    }
}

impl PairSource for Synthetic {
    fn count(&self) -> usize {
        6
    }

    fn training(&self) -> Vec<usize> {
        vec![0, 2, 3, 5]
    }

    fn validation(&self) -> Vec<usize> {
        vec![1, 4]
    }

    fn read(&self, index: usize) -> Result<Pair, String> {
        let left = self.reads.fetch_update(Ordering::SeqCst, Ordering::SeqCst, |reads| reads.checked_sub(1));
        left.map_err(|_| format!("pair{index}.exr is gone"))?;
        let wave = |y: usize, x: usize| ((y * (index + 2)) as f32 * 0.13).sin() * (x as f32 * 0.21).cos();
        let planes = Planes::from_fn(7, 40, 48, |c, y, x| match c {
            6 => f32::from(u8::from(x > 3)),
            _ => wave(y + c, x),
        });
        let gbuffer = GBuffer::new(vec![Attribute::Normal, Attribute::Position, Attribute::Valid], planes);
        let target = Planes::from_fn(1, 40, 48, |_, y, x| if x > 3 { 0.5 + 0.4 * wave(y, x) } else { 1.0 });
        Ok(Pair { gbuffer, target, radius: 0.5 + index as f32 })
    }
}

fn config(optimiser: Optimiser) -> TrainConfig {
    let reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 40 };
    let spec = NetSpec { levels: 3, u0: 4, ..NetSpec::ao(ChannelOrder::Interleaved, reach) };
    TrainConfig {
        optimiser,
        batch: 2,
        crop: 24,
        steps: 14,
        validation_pairs: 2,
        validate_every: 4,
        patience: 0,
        checkpoint_every: 3,
        workers: 1,
        cache_megabytes: 16,
        ..TrainConfig::new(spec, PathBuf::from("made-up"))
    }
}

const ADAMW: Optimiser = Optimiser::Adamw { rate: 1e-2, weight_decay: 1e-4, warm_up: 5 };
const ENOUGH: usize = usize::MAX;

fn checkpoint(folder: &Path, config: &TrainConfig) -> Checkpoint {
    Checkpoint::load(folder, &config.spec).expect("a whole checkpoint").expect("a checkpoint")
}

/// The weights of an undisturbed run, now and at its best, and its progress.
fn straight(config: &TrainConfig) -> Checkpoint {
    let folder = tempfile::tempdir().expect("a folder");
    let outcome = train_on(config, Synthetic::new(ENOUGH), folder.path()).expect("trains");
    assert_eq!(outcome.ending, Ending::Finished);
    checkpoint(folder.path(), config)
}

fn assert_same(a: &Checkpoint, b: &Checkpoint) {
    assert_eq!(a.progress, b.progress);
    let bits = |c: &Checkpoint| -> Vec<u32> {
        let layers = c.weights.0.iter().chain(&c.best.0);
        layers.flat_map(|l| l.weight.iter().chain(&l.bias)).map(|w| w.to_bits()).collect()
    };
    assert!(bits(a) == bits(b), "the weights differ");
}

fn lines(folder: &Path) -> Vec<Line> {
    let text = std::fs::read_to_string(folder.join("metrics.jsonl")).expect("metrics");
    text.lines().map(|line| serde_json::from_str(line).expect("a line")).collect()
}

#[test]
fn a_run_that_failed_anywhere_goes_on_to_the_same_weights() {
    for optimiser in [ADAMW, Optimiser::ADADELTA] {
        let config = config(optimiser);
        let expected = straight(&config);
        // Without a cache every crop is a read: runs that break off early, between checkpoints, and late.
        let uncached = TrainConfig { cache_megabytes: 0, ..config.clone() };
        for reads in [1, 9, 17, 27, 33] {
            let folder = tempfile::tempdir().expect("a folder");
            let error = train_on(&uncached, Synthetic::new(reads), folder.path()).expect_err("no more reads");
            assert!(error.to_string().contains("is gone"), "{error}");
            train_on(&config, Synthetic::new(ENOUGH), folder.path()).expect("goes on");
            assert_same(&checkpoint(folder.path(), &config), &expected);
            let steps: Vec<usize> = lines(folder.path()).iter().map(|line| line.step).collect();
            assert_eq!(steps, [4, 8, 12, 14]);
        }
    }
}

#[test]
fn threads_and_memory_change_nothing() {
    let config = config(ADAMW);
    let expected = straight(&config);
    assert_same(&straight(&TrainConfig { workers: 3, ..config.clone() }), &expected);
    assert_same(&straight(&TrainConfig { cache_megabytes: 0, ..config.clone() }), &expected);
    let other = straight(&TrainConfig { seed: 2, ..config });
    assert_ne!(other.weights, expected.weights);
}

#[test]
fn a_run_killed_by_the_system_goes_on_to_the_same_weights() {
    const RUN: &str = "DEEPSHADE_TEST_RUN";
    let config = TrainConfig { steps: 150, checkpoint_every: 1, ..config(ADAMW) };
    if let Some(folder) = std::env::var_os(RUN) {
        train_on(&config, Synthetic::new(ENOUGH), Path::new(&folder)).expect("trains");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let mut reached = Vec::new();
    for milliseconds in [300, 150, 220, 90, 400] {
        let mut child = Command::new(std::env::current_exe().expect("this test"))
            .args(["--exact", "a_run_killed_by_the_system_goes_on_to_the_same_weights"])
            .env(RUN, folder.path())
            .spawn()
            .expect("starts");
        std::thread::sleep(Duration::from_millis(milliseconds));
        child.kill().expect("kills");
        child.wait().expect("ends");
        let saved = Checkpoint::load(folder.path(), &config.spec).expect("never half a checkpoint");
        reached.push(saved.map_or(0, |checkpoint| checkpoint.progress.step));
    }
    assert!(reached.is_sorted(), "a killed run fell back: {reached:?}");
    train_on(&config, Synthetic::new(ENOUGH), folder.path()).expect("goes on");
    assert_same(&checkpoint(folder.path(), &config), &straight(&config));
}

#[test]
fn the_loss_falls() {
    for optimiser in [ADAMW, Optimiser::ADADELTA] {
        let folder = tempfile::tempdir().expect("a folder");
        let config = TrainConfig { steps: 200, validate_every: 40, ..config(optimiser) };
        train_on(&config, Synthetic::new(ENOUGH), folder.path()).expect("trains");
        let losses: Vec<f32> = lines(folder.path()).iter().filter_map(|line| line.validation_loss).collect();
        let (first, last) = (losses[0], losses[losses.len() - 1]);
        assert!(last < 0.7 * first, "{optimiser:?}: {losses:?}");
        let curve = std::fs::read_to_string(folder.path().join("curve.svg")).expect("a curve");
        assert!(curve.contains("polyline"));
    }
}

#[test]
fn a_run_that_gets_no_better_stops_early_and_stays_stopped() {
    let folder = tempfile::tempdir().expect("a folder");
    let still = Optimiser::Adadelta { rate: 0.0, decay: 0.9, epsilon: 1e-6 };
    let config = TrainConfig { steps: 100, validate_every: 2, patience: 3, ..config(still) };
    for _ in 0..2 {
        let outcome = train_on(&config, Synthetic::new(ENOUGH), folder.path()).expect("trains");
        assert_eq!(
            (outcome.ending, outcome.progress.step, outcome.progress.best_step),
            (Ending::Stopped, 8, 2)
        );
    }
}

#[test]
fn time_up_is_a_pause() {
    let folder = tempfile::tempdir().expect("a folder");
    let config = config(ADAMW);
    let short = TrainConfig { minutes: Some(0.0), ..config.clone() };
    let outcome = train_on(&short, Synthetic::new(ENOUGH), folder.path()).expect("pauses");
    assert_eq!((outcome.ending, outcome.progress.step), (Ending::OutOfTime, 0));
    train_on(&config, Synthetic::new(ENOUGH), folder.path()).expect("goes on");
    assert_same(&checkpoint(folder.path(), &config), &straight(&config));
}

#[test]
fn other_settings_in_the_same_folder_and_senseless_ones_are_refused_by_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let config = TrainConfig { steps: 1, ..config(ADAMW) };
    train_on(&config, Synthetic::new(ENOUGH), folder.path()).expect("trains");
    let other = TrainConfig { batch: 1, seed: 9, ..config.clone() };
    let error = train_on(&other, Synthetic::new(ENOUGH), folder.path()).expect_err("other settings");
    assert!(matches!(&error, TrainError::OtherRun { fields, .. } if fields == "batch, seed"), "{error}");
    let senseless = [
        (TrainConfig { batch: 0, ..config.clone() }, "`batch`"),
        (TrainConfig { crop: 20, ..config.clone() }, "`crop`"),
        (TrainConfig { validation_pairs: 0, ..config.clone() }, "`validation_pairs`"),
        (TrainConfig { crop: 48, ..config }, "smaller than `crop`"),
    ];
    for (config, name) in senseless {
        let folder = tempfile::tempdir().expect("a folder");
        let error =
            train_on(&config, Synthetic::new(ENOUGH), folder.path()).expect_err("senseless").to_string();
        assert!(error.contains(name), "{error}");
    }
}
