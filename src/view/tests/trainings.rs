//! Training runs that the window follows.

use super::Opened;
use crate::methods::LEARNED;
use crate::view::window::Window;
use deepshade_infer::{ChannelOrder, NetSpec, Reach, Weights};
use deepshade_shaders::Planes;
use deepshade_train::TrainConfig;
use deepshade_train::checkpoint::{Checkpoint, Progress};
use deepshade_train::metrics::Line;
use std::path::PathBuf;
use std::sync::Arc;

/// A training run, as another program writes it.
struct TestRun {
    folder: PathBuf,
    spec: NetSpec,
}

impl TestRun {
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
        let line = |step: usize| {
            let loss = 0.5 / step as f32;
            let line = Line { step, loss, validation_loss: Some(loss), rate: 1e-3, images_per_second: 4.0 };
            serde_json::to_string(&line).expect("plain data") + "\n"
        };
        let lines: String = (1..=step).map(line).collect();
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

/// The network's image, once it is made by weights of a step.
fn image_of_step(opened: &mut Opened, step: usize) -> Arc<Planes> {
    let is_there = |window: &Window| {
        let checkpoint = window.training_of_model().and_then(|run| run.checkpoint.as_ref());
        checkpoint.is_some_and(|(progress, _)| progress.step == step) && window.is_complete()
    };
    opened.wait("a checkpoint", is_there);
    let picture = opened.window().results.picture.clone().expect("a picture");
    let image = picture.images.iter().find(|image| image.name == LEARNED).expect("the network's");
    Arc::clone(&image.values)
}

#[test]
fn a_training_run_is_followed_from_before_its_first_checkpoint_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = TestRun::begin(folder.path().join("run"));
    let line = format!("--model {} --methods learned,hbao", run.folder.display());
    let mut opened = Opened::new(&line);
    opened.click("truth, up to");
    opened.wait("a note", |window| window.is_refused() && window.messages.note.is_some());
    run.come_to(10);
    let first = image_of_step(&mut opened, 10);
    run.come_to(60);
    assert_ne!(first, image_of_step(&mut opened, 60), "other weights, another image");
    opened.click("save");
    opened.wait("files", Window::is_idle);
    // The run stands for a network wherever one is read.
    let text = std::fs::read_to_string(opened.path("view-1/compare.toml")).expect("written");
    assert!(text.contains("model = ") && text.contains("run"), "{text}");
}

#[test]
fn a_run_that_begins_after_the_window_is_followed_and_found_again_by_its_effect() {
    let folder = tempfile::tempdir().expect("a folder");
    let place = folder.path().join("run");
    let mut opened = Opened::new(&format!("--model {}", place.display()));
    opened.click("truth, up to");
    opened.wait_until_complete();
    assert!(!opened.window().state.show.methods.contains(&LEARNED));
    // It comes with the first weights, and again with the effect.
    TestRun::begin(place).come_to(10);
    let first = image_of_step(&mut opened, 10);
    opened.choose("effect", "aa");
    opened.wait_until_complete();
    opened.choose("effect", "ao");
    assert_eq!(first.height(), image_of_step(&mut opened, 10).height());
}
