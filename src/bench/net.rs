//! `deepshade bench net`: a network in WGSL beside onnxruntime's CPU provider.
//!
//! Both work on the same random image in memory of their own; what is not measured is the way there and back. On a
//! machine whose adapter is software, both use the same processor.

use crate::figures::Figures;
use crate::onnxruntime;
use anyhow::Result;
use deepshade_infer::{Model, Network, parity};
use deepshade_shaders::{gpu::Gpu, lists};
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;

/// Runs before the clock counts.
const WARM_UP: usize = 2;

/// Milliseconds of a network in WGSL beside onnxruntime.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade bench net --model models/ao --json net.json")]
pub struct Args {
    /// Folder of the network, with its model.onnx.
    #[arg(long, default_value = "models/ao")]
    model: PathBuf,
    /// Rows of the image.
    #[arg(long, default_value_t = 512, value_parser = clap::value_parser!(u16).range(16..=8192))]
    height: u16,
    /// Columns of the image.
    #[arg(long, default_value_t = 768, value_parser = clap::value_parser!(u16).range(16..=8192))]
    width: u16,
    /// Timed runs; the median counts.
    #[arg(long, default_value_t = 15, value_parser = clap::value_parser!(u16).range(1..=1000))]
    runs: u16,
    /// Threads of onnxruntime; by default as many as the machine has.
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    #[command(flatten)]
    onnxruntime: onnxruntime::Args,
    /// Writes the figures here as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
}

/// Measures and prints.
///
/// # Errors
/// If the model cannot be read, there is no onnxruntime, or the GPU fails.
pub fn run(args: &Args) -> Result<()> {
    let model = Model::load(&args.model)?;
    let (height, width, runs) = (args.height.into(), args.width.into(), args.runs.into());
    let threads = args.threads.map_or_else(rayon::current_num_threads, usize::from);
    let input = parity::noise(model.spec.input_channels(), height, width, 1);
    let gpu = Gpu::new()?;
    let network = Network::new(&gpu.device, &model.spec, &model.weights)?;
    let (_, wgsl) = network.run_timed(&gpu.queue, &input, WARM_UP, runs)?;
    let mut session = args.onnxruntime.session(&args.model.join("model.onnx"), threads)?;
    for _ in 0..WARM_UP {
        session.image(&input)?;
    }
    let onnxruntime = median(runs, || session.image(&input).map(drop))?;

    let effect = model.spec.effect;
    let clock = if wgsl.by_gpu { "timestamps" } else { "wall clock" };
    let mut figures = Figures::new("bench net");
    figures.set(&format!("ms_wgsl_{effect}"), wgsl.milliseconds);
    figures.set(&format!("ms_onnxruntime_{effect}"), onnxruntime);
    figures.detail("size", json!({ "height": height, "width": width, "runs": runs }));
    figures
        .detail("adapter", json!({ "name": gpu.info.name, "driver": gpu.info.driver_info, "clock": clock }));
    figures.detail("onnxruntime_threads", json!(threads));
    figures.write(args.json.as_deref())?;
    let weights = model.spec.weight_count();
    let (adapter, driver) = (&gpu.info.name, &gpu.info.driver_info);
    say!("network      {effect}, {weights} weights, {width} x {height}, median of {runs}")?;
    say!("WGSL         {:.2} ms by {clock}; {adapter} ({driver})", wgsl.milliseconds)?;
    say!("onnxruntime  {onnxruntime:.2} ms, CPU provider, {threads} threads")
}

/// Median wall-clock time of some runs, milliseconds.
fn median(runs: usize, mut work: impl FnMut() -> Result<()>) -> Result<f64> {
    let time = |_| {
        let start = Instant::now();
        work()?;
        Ok(start.elapsed().as_secs_f64() * 1e3)
    };
    Ok(lists::median((0..runs).map(time).collect::<Result<_>>()?))
}
