//! Runs on made-up pairs: interrupted, paused, killed, on other numbers of threads, they all learn the same,
//! bit for bit; and what of a run is exported.

use deepshade_dataset::Pair;
use deepshade_infer::{ChannelOrder, Model, NetSpec, Reach, TrainedUnder, Weights};
use deepshade_shaders::{Attribute, Effect, GBuffer, Planes};
use deepshade_train::checkpoint::{Checkpoint, Progress};
use deepshade_train::export::{Facts, export};
use deepshade_train::metrics::Line;
use deepshade_train::{Ending, Optimiser, PairSource, Stop, TrainConfig, TrainError, discard, train_on};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

/// Pairs whose target is a function of the normal. Reading is slow, and fails once `reads` are used up.
struct Synthetic {
    name: &'static str,
    reads: AtomicUsize,
    while_reading: Duration,
}

impl Synthetic {
    fn new(reads: usize) -> Arc<Self> {
        Arc::new(Self { name: "waves", reads: reads.into(), while_reading: Duration::ZERO })
    }
}

impl PairSource for Synthetic {
    fn hash(&self) -> Result<String, String> {
        Ok(self.name.to_owned())
    }

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
        std::thread::sleep(self.while_reading);
        let left = self.reads.fetch_update(Ordering::SeqCst, Ordering::SeqCst, |reads| reads.checked_sub(1));
        left.map_err(|_| format!("pair{index}.exr is gone"))?;
        let wave = |y: usize, x: usize| ((y * (index + 2)) as f32 * 0.13).sin() * (x as f32 * 0.21).cos();
        let planes = Planes::from_fn(7, 40, 48, |c, y, x| match c {
            6 => f32::from(u8::from(x > 3)),
            _ => wave(y + c, x),
        });
        let gbuffer = GBuffer::new(vec![Attribute::Normal, Attribute::Position, Attribute::Valid], planes);
        let target = Planes::from_fn(1, 40, 48, |_, y, x| if x > 3 { 0.5 + 0.4 * wave(y, x) } else { 1.0 });
        Ok(Pair { gbuffer, target, variance: None, radius: 0.5 + index as f32 })
    }
}

fn config(optimiser: Optimiser) -> TrainConfig {
    let reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 40 };
    let spec = NetSpec::ao(ChannelOrder::Interleaved, reach).reshaped(|net| (net.levels, net.u0) = (3, 4));
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
        let best = c.best.as_ref().expect("validated");
        let layers = c.weights.0.iter().chain(&c.mean.0).chain(&best.0);
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
        // Without a cache every crop is a read, beside the two for validation: runs that break off before the
        // first step, early, between checkpoints, and late.
        let uncached = TrainConfig { cache_megabytes: 0, ..config.clone() };
        for reads in [1, 9, 17, 25, 29] {
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

/// On several devices a run is the same each time, and but for rounding that of one device: the same to the
/// last bit where shares are equal powers of two, as the kernels add images up by halves.
#[test]
fn devices_share_a_batch_and_learn_the_same() {
    for optimiser in [ADAMW, Optimiser::ADADELTA] {
        let run = |devices: usize, seed: u64| {
            let folder = tempfile::tempdir().expect("a folder");
            let config =
                TrainConfig { devices, seed, batch: 4, steps: 40, validate_every: 20, ..config(optimiser) };
            train_on(&config, Synthetic::new(ENOUGH), folder.path()).expect("trains");
            let losses: Vec<f32> = lines(folder.path()).iter().map(|line| line.loss).collect();
            (losses, checkpoint(folder.path(), &config))
        };
        let (alone, _) = run(1, 1);
        let off = |losses: &[f32]| {
            assert_eq!(losses.len(), alone.len());
            losses.iter().zip(&alone).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f32::max)
        };
        for devices in [2, 3] {
            let (losses, first) = run(devices, 1);
            assert_same(&first, &run(devices, 1).1);
            println!("{optimiser}, {devices} devices: {:e}", off(&losses));
            assert!(off(&losses) < 1e-4, "{optimiser}, {devices} devices: {alone:?}, {losses:?}");
        }
        assert!(off(&run(2, 2).0) > 1e-2, "another seed is another curve");
    }
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
    let reached = || {
        let saved = Checkpoint::load(folder.path(), &config.spec).expect("never half a checkpoint");
        saved.map_or(0, |checkpoint| checkpoint.progress.step)
    };
    let mut before = 0;
    for (step, threads) in [(5, "1"), (40, "3"), (80, "1"), (100, "2")] {
        let mut child = Command::new(std::env::current_exe().expect("this test"))
            .args(["--exact", "a_run_killed_by_the_system_goes_on_to_the_same_weights"])
            .env(RUN, folder.path())
            .env("RAYON_NUM_THREADS", threads)
            .spawn()
            .expect("starts");
        while reached() < step {
            assert!(child.try_wait().expect("asked").is_none(), "ended by itself before step {step}");
            std::thread::sleep(Duration::from_millis(1));
        }
        child.kill().expect("kills");
        child.wait().expect("ends");
        let now = reached();
        assert!(
            (step.max(before)..config.steps).contains(&now),
            "killed at {step}, fell from {before} to {now}"
        );
        before = now;
    }
    let left_over = folder.path().join(".deepshade-left");
    std::fs::write(&left_over, b"half").expect("written");
    train_on(&config, Synthetic::new(ENOUGH), folder.path()).expect("goes on");
    assert!(!left_over.exists(), "what a killed run left half-written");
    assert_same(&checkpoint(folder.path(), &config), &straight(&config));
}

fn facts() -> Facts {
    let words = || "made up".to_owned();
    Facts {
        recipe: words(),
        metrics: Vec::new(),
        limits: vec![words()],
        licence: words(),
        environment: Some(TrainedUnder::Sky(3)),
    }
}

#[test]
fn a_pause_is_validated_exported_and_forgotten() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = folder.path().join("run");
    // The next validation is far off, and reading for all steps would take three seconds.
    let config = TrainConfig { validate_every: 100, ..config(ADAMW) };
    let short = TrainConfig { minutes: Some(0.01), cache_megabytes: 0, ..config.clone() };
    let slow = Synthetic {
        while_reading: Duration::from_millis(100),
        ..Arc::into_inner(Synthetic::new(ENOUGH)).expect("one")
    };
    let outcome = train_on(&short, Arc::new(slow), &run).expect("pauses");
    let Progress { step, best_loss, pause_loss, .. } = outcome.progress;
    assert_eq!((outcome.ending, best_loss), (Ending::OutOfTime, None));
    assert!((1..config.steps).contains(&step) && pause_loss.is_some(), "{outcome:?}");
    assert_eq!(outcome.progress.best(), pause_loss.map(|loss| (step, loss)));

    let model = export(&run, &folder.path().join("model"), &facts()).expect("exports");
    let weights = checkpoint(&run, &config).mean;
    assert!(model.weights == weights.balanced(&config.spec), "the checkpoint's, balanced");
    let loaded = Model::load(&folder.path().join("model")).expect("a model");
    assert_eq!(loaded.spec.environment, Some(TrainedUnder::Sky(3)));
    let card = std::fs::read_to_string(folder.path().join("model/card.md")).expect("a card");
    assert!(card.contains(&format!("| Steps | {step} (best of {step}) |")), "{card}");
    assert!(card.contains("| Data hash | `waves`"), "{card}");

    train_on(&config, Synthetic::new(ENOUGH), &run).expect("goes on");
    assert_same(&checkpoint(&run, &config), &straight(&config));
}

#[test]
fn a_model_is_replaced_as_a_whole_and_nothing_else_in_its_folder() {
    let folder = tempfile::tempdir().expect("a folder");
    let model = folder.path().join("model");
    let run = |seed: u64| {
        let run = folder.path().join(seed.to_string());
        let config = TrainConfig { steps: 4, seed, ..config(ADAMW) };
        train_on(&config, Synthetic::new(ENOUGH), &run).expect("trains");
        run
    };
    let (first, second) = (run(1), run(2));
    let old = export(&first, &model, &facts()).expect("exports");
    let names = || -> Vec<String> {
        let entries = std::fs::read_dir(&model).expect("listed");
        let names = entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned());
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
    };
    let files = ["card.md", "model.onnx", "net.json", "parity.safetensors", "weights.safetensors"];
    assert_eq!(names(), files);
    for kept in ["testset", ".deepshade-killed"] {
        std::fs::create_dir(model.join(kept)).expect("made");
        std::fs::write(model.join(kept).join("list"), "frames").expect("written");
    }

    // Broken off in the middle, where the card cannot be replaced: there is no model then.
    std::fs::remove_file(model.join("card.md")).expect("removed");
    std::fs::create_dir(model.join("card.md")).expect("made");
    let error = export(&second, &model, &facts()).expect_err("a folder is in the way").to_string();
    assert!(error.contains("card.md"), "{error}");
    let error = Model::load(&model).expect_err("a mixture").to_string();
    assert!(error.contains("net.json"), "{error}");

    std::fs::remove_dir(model.join("card.md")).expect("removed");
    let new = export(&second, &model, &facts()).expect("exports");
    assert_ne!(new.weights, old.weights);
    assert_eq!(Model::load(&model).expect("loads"), new);
    assert_eq!(names(), [&files[..4], &["testset", "weights.safetensors"]].concat());
    assert_eq!(std::fs::read(model.join("testset/list")).expect("kept"), b"frames");
}

#[test]
fn a_network_that_was_never_validated_is_not_exported() {
    let folder = tempfile::tempdir().expect("a folder");
    let (run, model) = (folder.path().join("run"), folder.path().join("model"));
    let uncached = TrainConfig { cache_megabytes: 0, ..config(ADAMW) };
    // At once; as a pause before the first step; and by a failure after the first checkpoint, step 3.
    assert!(export(&run, &model, &facts()).is_err());
    let short = TrainConfig { minutes: Some(0.0), ..uncached.clone() };
    train_on(&short, Synthetic::new(ENOUGH), &run).expect("pauses");
    for (reads, step) in [(ENOUGH, 0), (9, 3)] {
        if reads < ENOUGH {
            train_on(&uncached, Synthetic::new(reads), &run).expect_err("no more reads");
        }
        let error = export(&run, &model, &facts()).expect_err("nothing validated").to_string();
        assert!(
            error.contains(&format!("after {step} steps no network of this run was validated")),
            "{error}"
        );
        assert!(error.starts_with(&run.display().to_string()), "{error}");
        assert!(!model.exists(), "something was exported");
    }
}

#[test]
fn other_data_and_a_folder_in_use_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let config = TrainConfig { steps: 1, ..config(ADAMW) };
    train_on(&config, Synthetic::new(ENOUGH), folder.path()).expect("trains");
    let moved = TrainConfig { dataset: PathBuf::from("./made-up"), steps: 1, ..config.clone() };
    train_on(&moved, Synthetic::new(ENOUGH), folder.path()).expect("the same data");
    let other = Synthetic { name: "noise", ..Arc::into_inner(Synthetic::new(ENOUGH)).expect("one") };
    let error = train_on(&config, Arc::new(other), folder.path()).expect_err("other data");
    assert!(matches!(&error, TrainError::OtherRun { fields, .. } if fields == "data_hash"), "{error}");

    let metrics = std::fs::File::open(folder.path().join("metrics.jsonl")).expect("metrics");
    metrics.lock().expect("locked");
    for refused in
        [train_on(&config, Synthetic::new(ENOUGH), folder.path()).map(drop), discard(folder.path())]
    {
        let error = refused.expect_err("in use").to_string();
        assert!(error.contains("another program is training in this folder"), "{error}");
    }
}

#[test]
fn only_the_files_of_a_run_are_discarded() {
    let folder = tempfile::tempdir().expect("a folder");
    let names = || -> Vec<String> {
        let entries = std::fs::read_dir(folder.path()).expect("listed");
        entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect()
    };
    std::fs::write(folder.path().join("thesis.txt"), b"years of work").expect("written");
    discard(folder.path()).expect("no run");
    let config = TrainConfig { steps: 1, ..config(ADAMW) };
    train_on(&config, Synthetic::new(ENOUGH), folder.path()).expect("trains");
    assert!(names().len() > 3, "{:?}", names());
    discard(folder.path()).expect("discarded");
    assert_eq!(names(), ["thesis.txt"]);
    std::fs::write(folder.path().join("config.json"), b"{\"colour\": 1}").expect("written");
    let error = discard(folder.path()).expect_err("not a run's config").to_string();
    assert!(error.contains("config.json is no training config"), "{error}");
    assert_eq!(names().len(), 2);
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
fn a_start_that_cannot_be_leaves_the_folder_to_another_command() {
    let scratch = tempfile::tempdir().expect("a folder");
    let [run, ours, other] = ["run", "ours", "other"].map(|name| scratch.path().join(name));
    let config = TrainConfig { steps: 1, ..config(ADAMW) };
    let save = |spec: &NetSpec, folder: &Path| {
        Model { weights: Weights::random(spec, 4), spec: spec.clone() }.save(folder).expect("written");
    };
    save(&config.spec, &ours);
    // Its weights have the same shapes and another meaning.
    save(&config.spec.clone().reshaped(|net| net.order = ChannelOrder::Contiguous), &other);
    let starting = |start: &Path| {
        train_on(
            &TrainConfig { start: Some(start.to_owned()), ..config.clone() },
            Synthetic::new(ENOUGH),
            &run,
        )
    };
    let error = starting(&scratch.path().join("missing")).expect_err("nothing is there").to_string();
    assert!(error.contains("missing"), "{error}");
    let error = starting(&other).expect_err("another order").to_string();
    assert!(error.contains("other is another network"), "{error}");
    let dof =
        NetSpec::published(Effect::Dof, ChannelOrder::Interleaved, config.spec.reach).expect("published");
    save(&dof, &other);
    let predicting = TrainConfig {
        spec: dof.predicting_kernels().expect("it filters light"),
        start: Some(other.clone()),
        ..config.clone()
    };
    let error =
        train_on(&predicting, Synthetic::new(ENOUGH), &run).expect_err("another last layer").to_string();
    assert!(error.contains("its last layer makes the image, and that of"), "{error}");
    assert!(!run.exists());
    starting(&ours).expect("trains");
    std::fs::remove_dir_all(&ours).expect("deleted");
    starting(&ours).expect("a run that has begun does not read it again");
}

#[test]
fn a_run_that_is_asked_to_end_keeps_the_step_that_it_is_at() {
    let folder = tempfile::tempdir().expect("a folder");
    // No checkpoint is due before the end, and reading for all steps would take three seconds.
    let config = TrainConfig { validate_every: 100, checkpoint_every: 100, ..config(ADAMW) };
    let stop = Stop::default();
    let asked = TrainConfig { cache_megabytes: 0, stop: stop.clone(), ..config.clone() };
    let slow = Arc::new(Synthetic {
        while_reading: Duration::from_millis(100),
        ..Arc::into_inner(Synthetic::new(ENOUGH)).expect("one")
    });
    let read = |reads: usize| ENOUGH - slow.reads.load(Ordering::SeqCst) >= reads;
    let outcome = std::thread::scope(|scope| {
        let run = scope.spawn(|| train_on(&asked, slow.clone(), folder.path()));
        while !read(10) {
            std::thread::sleep(Duration::from_millis(5));
        }
        assert!(stop.ask(), "it is at its steps");
        run.join().expect("no panic").expect("ends")
    });
    assert_eq!(outcome.ending, Ending::Interrupted);
    assert!((1..config.steps).contains(&outcome.progress.step), "{outcome:?}");
    assert_eq!(checkpoint(folder.path(), &config).progress, outcome.progress);
    assert!(!stop.ask(), "nobody hears any more");
    train_on(&config, Synthetic::new(ENOUGH), folder.path()).expect("goes on");
    assert_same(&checkpoint(folder.path(), &config), &straight(&config));
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
        (TrainConfig { devices: 3, ..config.clone() }, "`devices`"),
        (TrainConfig { devices: 0, ..config.clone() }, "`devices`"),
        (TrainConfig { crop: 20, ..config.clone() }, "`crop`"),
        (TrainConfig { validation_pairs: 0, ..config.clone() }, "`validation_pairs`"),
        (TrainConfig { crop: 48, ..config.clone() }, "smaller than `crop`"),
        (TrainConfig { crop: 8_000_000, ..config.clone() }, "`crop`"),
        (TrainConfig { crop: 8192, batch: 2, ..config.clone() }, "`batch`"),
        (TrainConfig { workers: 1_000_000, ..config.clone() }, "`workers`"),
        (TrainConfig { steps: usize::MAX, ..config.clone() }, "`steps`"),
        (TrainConfig { cache_megabytes: usize::MAX, ..config.clone() }, "`cache_megabytes`"),
        (TrainConfig { minutes: Some(-1.0), ..config.clone() }, "`minutes`"),
        (TrainConfig { minutes: Some(f64::NAN), ..config.clone() }, "`minutes`"),
        (TrainConfig { minutes: Some(1e300), ..config.clone() }, "`minutes`"),
        (
            TrainConfig {
                optimiser: Optimiser::Adamw { rate: f64::NAN, weight_decay: 0.0, warm_up: 1 },
                ..config.clone()
            },
            "rate",
        ),
        (TrainConfig { optimiser: Optimiser::ADAMW.with_weight_decay(f64::NAN), ..config }, "weight decay"),
    ];
    for (config, name) in senseless {
        let folder = tempfile::tempdir().expect("a folder");
        let error =
            train_on(&config, Synthetic::new(ENOUGH), folder.path()).expect_err("senseless").to_string();
        assert!(error.contains(name), "{error}");
    }
}
