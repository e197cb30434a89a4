//! `deepshade bench train`: images a second through forward pass, loss, backward pass and optimiser.

use super::pytorch;
use crate::figures::Figures;
use anyhow::Result;
use clap::builder::RangedU64ValueParser;
use deepshade_infer::{ChannelOrder, Model, NetSpec, Reach, Weights};
use deepshade_train::{TrainConfig, bench};
use serde_json::json;
use std::path::PathBuf;

/// Images a second that training takes.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  deepshade bench train --json train.json\n  deepshade bench train --python python3    # beside PyTorch"
)]
pub struct Args {
    /// Height and width of the images; a multiple of 8.
    #[arg(long, default_value_t = 256, value_parser = RangedU64ValueParser::<usize>::new().range(8..=8192))]
    crop: usize,
    /// Images a step.
    #[arg(long, default_value_t = 4)]
    batch: usize,
    /// Timed steps; the median counts.
    #[arg(long, default_value_t = 15, value_parser = clap::value_parser!(u16).range(1..=10_000))]
    steps: u16,
    #[command(flatten)]
    pytorch: pytorch::Args,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
}

/// Measures and prints.
///
/// # Errors
/// If a setting makes no sense, or PyTorch fails; our own figures are printed and written before.
pub fn run(args: &Args) -> Result<()> {
    let (batch, crop, steps) = (args.batch, args.crop, usize::from(args.steps));
    let reach = Reach { radius: 1.0, diagonal_share: 0.1, height: crop };
    let spec = NetSpec::ao(ChannelOrder::Interleaved, reach);
    let config = TrainConfig { batch, crop, ..TrainConfig::new(spec, PathBuf::new()) };
    config.check()?;
    let times = bench::bench(&config, steps)?;
    if args.pytorch.is_asked_for() {
        note!("our own steps took {:.3} s each; now PyTorch", batch as f64 / times.images_per_second);
    }
    let more = json!({ "mode": "train", "batch": batch, "crop": crop, "runs": steps, "seconds": 1e3 });
    let model = Model { weights: Weights::random(&config.spec, 1), spec: config.spec.clone() };
    let (rival, failure) = match args.pytorch.run(&model, rayon::current_num_threads(), more) {
        Ok(rival) => (rival, Ok(())),
        Err(error) => (None, Err(error)),
    };
    let measured = TrainingSpeed { config, steps, times, rival };
    let written = measured.figures().write(args.json.as_deref());
    let said = measured.say();
    written.and(failure).and(said)
}

/// What was measured.
struct TrainingSpeed {
    config: TrainConfig,
    steps: usize,
    times: bench::StepTimes,
    rival: Option<pytorch::Report>,
}

impl TrainingSpeed {
    /// Seconds of a step.
    fn seconds(&self) -> f64 {
        self.config.batch as f64 / self.times.images_per_second
    }

    /// Seconds of a step of PyTorch's faster form, with the report that has it.
    fn fastest(&self) -> Option<(f64, &pytorch::Report)> {
        let report = self.rival.as_ref()?;
        let seconds = report.made.iter().map(|row| row.milliseconds * 1e-3);
        Some((seconds.reduce(f64::min)?, report))
    }

    /// Milliseconds of the parts of a step.
    fn parts(&self) -> [(&'static str, f64); 3] {
        let times = &self.times;
        [("forward", times.forward), ("backward", times.backward), ("update", times.update)]
            .map(|(part, time)| (part, time.as_secs_f64() * 1e3))
    }

    fn figures(&self) -> Figures {
        let (TrainConfig { batch, crop, spec, .. }, seconds) = (&self.config, self.seconds());
        let mut figures = Figures::new("bench train");
        figures.set("images_per_second", self.times.images_per_second);
        figures.set("seconds_step_ao", seconds);
        for (part, milliseconds) in self.parts() {
            figures.set(&format!("ms_{part}"), milliseconds);
        }
        let weights = spec.weight_count();
        figures
            .detail("size", json!({ "batch": batch, "crop": crop, "steps": self.steps, "weights": weights }));
        if let Some((theirs, report)) = self.fastest() {
            for row in &report.made {
                figures.set(&format!("seconds_step_{}", row.engine), row.milliseconds * 1e-3);
            }
            figures.set("ratio_step_pytorch", seconds / theirs);
            figures.detail("pytorch", json!({ "version": report.version, "device": report.device }));
        }
        figures
    }

    fn say(&self) -> Result<()> {
        let TrainConfig { batch, crop, spec, .. } = &self.config;
        let (effect, weights, device) = (spec.effect, spec.weight_count(), deepshade_train::device_name()?);
        let (images, steps) = (self.times.images_per_second, self.steps);
        say!("network   {effect}, {weights} weights, batches of {batch} images of {crop} x {crop}")?;
        say!("training  {images:.2} images a second, {device}, median of {steps}")?;
        self.parts()
            .iter()
            .try_for_each(|(part, milliseconds)| say!("{part:<9} {milliseconds:.1} ms a batch"))?;
        let Some((theirs, report)) = self.fastest() else { return Ok(()) };
        let (version, device) = (&report.version, &report.device);
        for row in &report.made {
            let images = *batch as f64 / (row.milliseconds * 1e-3);
            say!("{:<16} {images:.2} images a second ({version}, {device})", row.engine)?;
        }
        say!("a step takes {:.2} of that of PyTorch's faster one", self.seconds() / theirs)
    }
}
