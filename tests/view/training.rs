//! Training runs that the window follows, and those that it begins.

use super::{PROGRAM, Screen, colours, figures, wait_for};
use deepshade_infer::{ChannelOrder, NetSpec, Reach, Weights};
use deepshade_train::TrainConfig;
use deepshade_train::checkpoint::{Checkpoint, Progress};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A training run, as another program writes it.
struct Run {
    folder: PathBuf,
    spec: NetSpec,
}

impl Run {
    /// One that has begun and saved nothing yet.
    fn begin(folder: PathBuf) -> Self {
        std::fs::create_dir_all(&folder).expect("a folder");
        let reach = Reach { radius: 0.25, diagonal_share: 0.1, height: 48 };
        let spec =
            NetSpec::ao(ChannelOrder::Interleaved, reach).reshaped(|net| (net.levels, net.u0) = (2, 4));
        let config = TrainConfig { steps: 100, ..TrainConfig::new(spec.clone(), "data".into()) };
        let config = serde_json::to_vec(&config).expect("plain data");
        std::fs::write(folder.join("config.json"), config).expect("written");
        std::fs::write(folder.join("metrics.jsonl"), "").expect("written");
        Self { folder, spec }
    }

    /// Comes to a step, and saves.
    fn come_to(&self, step: usize) {
        let log = self.folder.join("metrics.jsonl");
        let lines: String = (1..=step)
            .map(|step| {
                let loss = 0.5 / step as f64;
                format!("{{\"step\":{step},\"loss\":{loss},\"validation_loss\":{loss},\"rate\":0.001,\"images_per_second\":4.0}}\n")
            })
            .collect();
        std::fs::write(log, lines).expect("written");
        let progress = Progress {
            step,
            best_step: step,
            best_loss: Some(0.1),
            waited: 0,
            stopped: false,
            pause_loss: None,
        };
        let weights = Weights::random(&self.spec, step as u32);
        let best = Some(weights.clone());
        let mean = weights.clone();
        let checkpoint = Checkpoint { progress, weights, mean, best, optimiser: Vec::new() };
        checkpoint.save(&self.folder, &self.spec).expect("saves");
    }
}

#[test]
fn a_training_run_is_followed_from_before_its_first_checkpoint_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let run = Run::begin(path("run"));
    let script = "truth off\nwait refusal\nscreenshot refused.png\nwait checkpoint 10\nsave one\n\
        wait checkpoint 60\nsave two\nwait 0.2\nscreenshot after.png\nquit\n";
    let screen = Screen::new();
    let mut command = screen.command(folder.path(), "--model run --methods learned,hbao", script);
    let window = command.stderr(Stdio::piped()).spawn().expect("starts");
    for (file, step) in [("refused.png", 10), ("one/compare.toml", 60)] {
        wait_for(&path(file));
        run.come_to(step);
    }
    let output = window.wait_with_output().expect("ends");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && !said.contains("panicked"), "{said}");
    let image = |name: &str| image::open(path(name)).expect("a picture").to_rgb8();
    assert_ne!(image("one/learned.png"), image("two/learned.png"), "other weights, another image");
    assert!(colours(&path("after.png")).len() > 40);
    // The run stands for a network wherever one is read.
    let again = Command::new(PROGRAM)
        .args(["compare", "--config", "two/compare.toml", "--spp", "8", "--out", "again"])
        .current_dir(folder.path())
        .output()
        .expect("starts");
    assert!(again.status.success(), "{}", String::from_utf8_lossy(&again.stderr));
}

#[test]
fn a_run_that_begins_after_the_window_is_followed_and_found_again_by_its_effect() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    // Nobody names `learned`: it comes with the first weights, and again with the effect.
    let script = "truth off\nwait picture\nsave before\nwait checkpoint 10\nsave first\n\
        effect aa\nwait picture\neffect ao\nwait checkpoint 10\nsave second\nquit\n";
    let screen = Screen::new();
    let mut command = screen.command(folder.path(), "--model run", script);
    let window = command.stderr(Stdio::piped()).spawn().expect("starts");
    wait_for(&path("before/compare.toml"));
    let run = Run::begin(path("run"));
    run.come_to(10);
    let output = window.wait_with_output().expect("ends");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && !said.contains("panicked"), "{said}");
    assert!(!path("before/learned.exr").exists());
    for name in ["first", "second"] {
        assert!(path(name).join("learned.exr").is_file(), "{name}");
        let text = std::fs::read_to_string(path(name).join("compare.toml")).expect("written");
        assert!(text.contains("model = \"../run\""), "{text}");
    }
}

#[test]
fn the_window_begins_trainings_follows_them_and_stops_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let recipe = Path::new(env!("CARGO_MANIFEST_DIR")).join("dataset/recipes/ao-tiny.toml");
    let deepshade = |line: &str| {
        let words = line.split_whitespace();
        let output = Command::new(PROGRAM).args(words).current_dir(folder.path()).output().expect("starts");
        assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    };
    deepshade(&format!("dataset generate {} --out data", recipe.display()));
    let options = "--batch 2 --crop 64 --validate-every 2 --validation-pairs 2";
    let script = format!(
        "truth off\nwait picture\ntrain nowhere run\nwait refusal\ntrain data run --steps 4 {options}\n\
         wait checkpoint 4\nsave kept\nscreenshot trained.png\nstop\ntrain data run --stepz 1\nwait refusal\neffect ao\nwait picture\n\
         train data none --stepz 1\nwait refusal\nwait picture\nsave after\n\
         train data long --steps 1000000 {options}\nwait checkpoint 2\nstop\n\
         train data last --steps 1000000 {options}\nwait checkpoint 2\nquit\n"
    );
    let output = Screen::new().view(folder.path(), "--effect gi", &script);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && !said.contains("panicked"), "{said}");
    assert!(figures(folder.path())["refusals"].as_f64().expect("counted") >= 3.0);
    assert!(folder.path().join("kept/learned.exr").is_file());
    // A training that fails is not waited for.
    for (script, named) in [
        ("truth off\ntrain nosuch q\nquit\n".to_owned(), "line 2 of the script: training: "),
        ("truth off\ntrain data q --stepz 1\nwait checkpoint 4\nwait refusal\n".to_owned(), "--stepz"),
        (
            format!("truth off\ntrain data q --steps 1000000 {options}\ntrain data r\nquit\n"),
            "line 3 of the script: ",
        ),
    ] {
        let output = Screen::new().view(folder.path(), "--effect gi", &script);
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && said.contains(named), "{script}: {said}");
    }
    // What never came to be takes no network away.
    let after = std::fs::read_to_string(folder.path().join("after/compare.toml")).expect("written");
    assert!(after.contains("model = \"../run\"") && !folder.path().join("none").exists(), "{after}");
    assert!(folder.path().join("after/learned.exr").is_file());
    assert!(colours(&folder.path().join("trained.png")).len() > 40);
    // Nobody is at it any more, stopped by hand or by the window's end: it goes on, from where it was.
    for run in ["long", "last"] {
        deepshade(&format!("train --dataset data --out {run} --steps 1000000 --minutes 0.01 {options}"));
    }
}
