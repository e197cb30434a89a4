//! `deepshade bench net`: the paper's networks in WGSL and on the CPU beside onnxruntime and PyTorch.
//!
//! All work on random images in memory of their own; what is not measured is the way there and back. On a
//! machine whose adapter is software, all use the same processor. PyTorch's form of a network is held against
//! ours first.

mod budget;
mod layers;
mod measurement;
mod page;
mod peaks;
mod rivals;
mod subjects;
mod turns;

use super::pytorch;
use crate::arguments::Size;
use crate::figures::{Figures, write_atomically};
use crate::onnxruntime;
use anyhow::{Result, ensure};
use deepshade_infer::Model;
use deepshade_infer::forward::{Network, Options, OutputKind, Variant};
use deepshade_shaders::Effect;
use deepshade_shaders::gpu::Gpu;
use measurement::Measurement;
use peaks::Peaks;
use rivals::{Devices, EngineComparison};
use serde_json::json;
use std::path::PathBuf;
use std::time::Duration;
use subjects::MeasuredNetwork;
use turns::Effort;

/// The size of the paper's times, which figures are of.
const PAPER: [usize; 2] = [768, 512];
/// Sizes by default: on a graphics card up to 3840x2160, else what does not take hours.
const SIZES: [[usize; 2]; 5] = [[256, 256], PAPER, [1280, 720], [1920, 1080], [3840, 2160]];
const SOFTWARE_SIZES: usize = 2;

/// Milliseconds of the paper's networks beside onnxruntime and PyTorch.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    deepshade bench net --json net.json --page net.html\n  \
    deepshade bench net --networks ao,gi --sizes 1920x1080 --python python3 --layers\n  \
    deepshade bench net --networks ao --budget 4 --sizes 1920x1080\n\n\
    Networks without a folder in --models are the paper's, with random weights. For the same layers these take as long \
    as trained ones, but shipped ones that predict kernels take longer than the paper's. A mono network is timed on one \
    colour channel. By default sizes are 256x256, 768x512, 1280x720, 1920x1080 and 3840x2160 on a graphics card, and the \
    first two on a software adapter.\n\n\
    Rates of bytes may be above the peak, which is that of memory, where an image is so small that caches hold it. \
    Engines that fail are named at the end, after what the others took, and the code is then 1.\n\n\
    --budget needs exactly one of --networks and one of --sizes, and takes --threads and --json beside them, nothing \
    else. Of networks like the paper's with other numbers of kernels on the first level (u0 in net.json) and of levels it \
    finds the one with the most multiply-adds whose fastest run, on the engine that runs networks on this machine, takes at most \
    so long. More multiply-adds may be fewer weights: those of the first level work on the most pixels.")]
pub struct Args {
    /// Effects whose networks are measured; by default all of the paper's Table 7.1.
    #[arg(long, value_delimiter = ',')]
    networks: Vec<Effect>,
    /// Folder of trained networks, each in a folder with its effect's name [default: models, where there is
    /// one]
    #[arg(long)]
    models: Option<PathBuf>,
    /// Sizes of the images, columns x rows.
    #[arg(long, value_delimiter = ',')]
    sizes: Vec<Size>,
    /// Seconds for each engine, network and size.
    #[arg(long, default_value_t = 2.0, value_parser = crate::arguments::within(0.001..=86_400.0))]
    seconds: f32,
    /// Most timed runs of each.
    #[arg(long, default_value_t = 50, value_parser = clap::value_parser!(u16).range(3..=2000))]
    runs: u16,
    /// Threads of everything on the processor; by default as many as the machine has.
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Times of every layer too, in WGSL and on the CPU.
    #[arg(long)]
    layers: bool,
    /// Finds the largest network of the effect's kind that takes at most so many milliseconds, all colour
    /// channels together; see below.
    #[arg(long, value_name = "MILLISECONDS", value_parser = crate::arguments::positive,
        conflicts_with_all = ["models", "seconds", "runs", "layers", "onnxruntime", "python", "page"])]
    budget: Option<f32>,
    #[command(flatten)]
    onnxruntime: onnxruntime::Args,
    #[command(flatten)]
    pytorch: pytorch::Args,
    /// Writes the table here as a page.
    #[arg(long, value_parser = crate::arguments::written_file)]
    page: Option<PathBuf>,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
}

/// Measures and prints.
///
/// # Errors
/// If a model cannot be read, the GPU fails, an onnxruntime that is named is none, or an engine did not run;
/// what the others took is printed and written before.
pub fn run(args: &Args) -> Result<()> {
    let gpu = Gpu::new()?;
    // Everything on the processor has as many threads as its rivals.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(args.threads()).build()?;
    pool.install(|| match args.budget {
        Some(budget) => budget::run(args, &gpu, budget),
        None => measure(args, &gpu),
    })
}

fn measure(args: &Args, gpu: &Gpu) -> Result<()> {
    let scratch = tempfile::tempdir()?;
    let subjects = subjects::subjects(&args.networks, args.models.as_deref(), scratch.path())?;
    let onnxruntime = args.onnxruntime.is_there()?.then_some(&args.onnxruntime);
    if onnxruntime.is_none() {
        note!("no onnxruntime is here or named (--onnxruntime): it is left out");
    }
    let devices = Devices { gpu, onnxruntime, pytorch: &args.pytorch, threads: args.threads() };
    note!("what the devices can do at best");
    let mut bench = Bench::new(gpu)?;
    if let Some(bytes) = ao_bytes(gpu, &subjects)? {
        bench.figures.set("bytes_ao_1080p", bytes as f64);
    }
    bench.figures.detail("shipped", json!(subjects::trained(&subjects)));
    for subject in &subjects {
        for size in sizes(args, gpu) {
            bench.add(
                &EngineComparison { subject, size, effort: args.effort(), devices: &devices },
                args.layers,
            );
        }
    }
    bench.finish(args, &devices)
}

fn sizes(args: &Args, gpu: &Gpu) -> Vec<[usize; 2]> {
    match args.sizes.as_slice() {
        [] if gpu.is_software() => SIZES[..SOFTWARE_SIZES].to_vec(),
        [] => SIZES.to_vec(),
        asked => asked.iter().map(|size| [size.width, size.height]).collect(),
    }
}

impl Args {
    fn threads(&self) -> usize {
        self.threads.map_or_else(rayon::current_num_threads, usize::from)
    }

    fn effort(&self) -> Effort {
        Effort { time: Duration::from_secs_f32(self.seconds), most: self.runs.into() }
    }
}

/// What has been measured so far.
struct Bench {
    figures: Figures,
    peaks: Peaks,
    made: Vec<Measurement>,
    layers: Vec<layers::Row>,
    /// What was not measured, and why.
    failed: Vec<String>,
}

impl Bench {
    fn new(gpu: &Gpu) -> Result<Self> {
        let (figures, peaks) = (Figures::new("bench net"), Peaks::measured(gpu)?);
        Ok(Self { figures, peaks, made: Vec::new(), layers: Vec::new(), failed: Vec::new() })
    }

    fn add(&mut self, race: &EngineComparison<'_>, with_layers: bool) {
        let outcome = race.run();
        let network = &race.subject.name;
        if race.size == PAPER {
            for row in &outcome.made {
                self.figures.set(&format!("ms_{}_{network}", row.engine), row.milliseconds);
            }
            for engine in ["wgsl", "cpu"] {
                let name = format!("ratio_{engine}_onnxruntime_{network}");
                self.set_ratio(&name, &outcome.made, [engine, "onnxruntime"]);
            }
        }
        self.made.extend(outcome.made);
        self.failed.extend(outcome.failed);
        if with_layers {
            self.add_layers(race);
        }
    }

    fn add_layers(&mut self, race: &EngineComparison<'_>) {
        note!("{}: layers", race.name());
        match layers::rows(race.devices.gpu, race.subject, race.size) {
            Ok(rows) => self.layers.extend(rows),
            Err(error) => self.failed.push(format!("{}: layers: {error:#}", race.name())),
        }
    }

    fn set_ratio(&mut self, name: &str, made: &[Measurement], [ours, theirs]: [&str; 2]) {
        let of = |engine: &str| made.iter().find(|row| row.engine == engine).map(|row| row.milliseconds);
        if let (Some(ours), Some(theirs)) = (of(ours), of(theirs)) {
            self.figures.set(name, ours / theirs);
        }
    }

    /// Writes and prints what was measured, whichever of both fails, and names what was not.
    fn finish(mut self, args: &Args, devices: &Devices<'_>) -> Result<()> {
        self.peaks.set_shares(devices.gpu, &mut self.made);
        let written = self.write(args, devices);
        let said = self.say(devices);
        written?;
        ensure!(self.failed.is_empty(), "not measured:\n{}", self.failed.join("\n"));
        said
    }

    fn write(&mut self, args: &Args, devices: &Devices<'_>) -> Result<()> {
        for (engine, peak) in [("wgsl", self.peaks.adapter), ("cpu", self.peaks.processor)] {
            self.figures.set(&format!("peak_gflops_{engine}"), peak.multiply_add * 1e-9);
            self.figures.set(&format!("peak_gigabytes_{engine}"), peak.copy * 1e-9);
        }
        let info = &devices.gpu.info;
        self.figures.detail("adapter", json!({ "name": info.name, "driver": info.driver_info }));
        self.figures.detail("threads", json!(devices.threads));
        self.figures.detail("measurements", json!(self.made));
        self.figures.detail("layers", json!(self.layers));
        self.figures.detail("failed", json!(self.failed));
        self.figures.write(args.json.as_deref())?;
        let Some(path) = &args.page else { return Ok(()) };
        let page = page::render(&self.figures, &self.made, &self.layers, devices.gpu)?;
        write_atomically(path, page.as_bytes())
    }

    fn say(&self, devices: &Devices<'_>) -> Result<()> {
        say!(
            "network      weights size       engine                 ms      p95  GFLOP/s  of peak    GB/s  of peak"
        )?;
        self.made.iter().try_for_each(|row| say!("{row}"))?;
        self.layers.iter().try_for_each(|row| say!("{row}"))?;
        for (engine, peak) in [("WGSL", self.peaks.adapter), ("processor", self.peaks.processor)] {
            let (flops, bytes) = (peak.multiply_add * 1e-9, peak.copy * 1e-9);
            say!("{engine} at best {flops:.1} GFLOP/s multiplying and adding, {bytes:.1} GB/s copying")?;
        }
        if let Some(bytes) = self.figures.get("bytes_ao_1080p") {
            say!("ao at 1920x1080: feature maps of {:.1} MB", bytes * 1e-6)?;
        }
        let (info, threads) = (&devices.gpu.info, devices.threads);
        say!("WGSL on {} ({}), the rest on {threads} threads", info.name, info.driver_info)
    }
}

/// Bytes of the feature maps of ao at 1920x1080 in the kernels for graphics cards, in half floats where the
/// device has them.
fn ao_bytes(gpu: &Gpu, subjects: &[MeasuredNetwork]) -> Result<Option<u64>> {
    let Some(subject) = subjects.iter().find(|subject| subject.model.spec.effect == Effect::Ao) else {
        return Ok(None);
    };
    let Model { spec, weights } = &subject.model;
    let options = Options {
        precision: layers::half_where_there_is(gpu),
        variant: Some(Variant::gpu(&gpu.device.limits(), spec, OutputKind::Buffer)),
        ..Options::default()
    };
    let network = Network::with(&gpu.device, spec, weights, &options)?;
    Ok(Some(network.plan(1080, 1920)?.bytes().activations))
}
