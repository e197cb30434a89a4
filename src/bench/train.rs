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
    #[arg(long)]
    json: Option<PathBuf>,
}

/// Measures and prints.
///
/// # Errors
/// If a setting makes no sense.
pub fn run(args: &Args) -> Result<()> {
    let (batch, crop, steps) = (args.batch, args.crop, usize::from(args.steps));
    let reach = Reach { radius: 1.0, diagonal_share: 0.1, height: crop };
    let spec = NetSpec::ao(ChannelOrder::Interleaved, reach);
    let config = TrainConfig { batch, crop, ..TrainConfig::new(spec, PathBuf::new()) };
    config.check()?;
    let times = bench::bench(&config, steps)?;

    let (threads, weights) = (rayon::current_num_threads(), config.spec.weight_count());
    let parts = [("forward", times.forward), ("backward", times.backward), ("update", times.update)]
        .map(|(part, time)| (part, time.as_secs_f64() * 1e3));
    let seconds = batch as f64 / times.images_per_second;
    let mut figures = Figures::new("bench train");
    figures.set("images_per_second", times.images_per_second);
    figures.set("seconds_step_ao", seconds);
    for (part, milliseconds) in parts {
        figures.set(&format!("ms_{part}"), milliseconds);
    }
    figures.detail("size", json!({ "batch": batch, "crop": crop, "steps": steps, "weights": weights }));
    let more = json!({ "mode": "train", "batch": batch, "crop": crop, "runs": steps, "seconds": 1e3 });
    let model = Model { weights: Weights::random(&config.spec, 1), spec: config.spec.clone() };
    let rival = args.pytorch.run(&model, threads, more)?;
    let rivals = rival.iter().flat_map(|report| &report.made);
    for row in rivals.clone() {
        figures.set(&format!("seconds_step_{}", row.engine), row.milliseconds * 1e-3);
    }
    let fastest = rivals.map(|row| row.milliseconds * 1e-3).reduce(f64::min);
    if let (Some(theirs), Some(report)) = (fastest, &rival) {
        figures.set("ratio_step_pytorch", seconds / theirs);
        figures.detail("pytorch", json!({ "version": report.version, "device": report.device }));
    }
    figures.write(args.json.as_deref())?;
    let effect = config.spec.effect;
    say!("network   {effect}, {weights} weights, batches of {batch} images of {crop} x {crop}")?;
    say!("training  {:.2} images a second, {threads} threads, median of {steps}", times.images_per_second)?;
    parts.iter().try_for_each(|(part, milliseconds)| say!("{part:<9} {milliseconds:.1} ms a batch"))?;
    let (Some(theirs), Some(report)) = (fastest, &rival) else { return Ok(()) };
    let (version, device) = (&report.version, &report.device);
    for row in &report.made {
        let images = batch as f64 / (row.milliseconds * 1e-3);
        say!("{:<16} {images:.2} images a second ({version}, {device})", row.engine)?;
    }
    say!("a step takes {:.2} of that of PyTorch's faster one", seconds / theirs)
}
