//! `deepshade bench net`: the paper's networks in WGSL and on the CPU beside onnxruntime and PyTorch.
//!
//! All work on random images in memory of their own; what is not measured is the way there and back. On a machine
//! whose adapter is software, all use the same processor. PyTorch's form of a network is held against ours first.

mod budget;
mod layers;
mod page;
mod rivals;
mod subjects;

use super::pytorch;
use crate::arguments::Size;
use crate::figures::{Figures, write_atomically};
use crate::onnxruntime;
use anyhow::Result;
use deepshade_infer::forward::{Network, Options, OutputKind, Variant};
use deepshade_infer::{Model, cpu};
use deepshade_shaders::Effect;
use deepshade_shaders::gpu::{self, Ceilings, Gpu};
use rivals::{Devices, Effort, Measurement, Race};
use serde_json::json;
use std::path::PathBuf;
use std::time::Duration;
use subjects::Subject;

/// The size of the paper's times, which figures are of.
const PAPER: [usize; 2] = [768, 512];
/// Sizes by default: on a graphics card up to 3840x2160, else what does not take hours.
const SIZES: [[usize; 2]; 5] = [[256, 256], PAPER, [1280, 720], [1920, 1080], [3840, 2160]];
const SOFTWARE_SIZES: usize = 2;
/// Where the naive kernel is measured, and of which network.
const NAIVE: ([usize; 2], Effect) = ([256, 256], Effect::Ao);

/// Milliseconds of the paper's networks beside onnxruntime and PyTorch.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    deepshade bench net --json net.json --page net.html\n  \
    deepshade bench net --networks ao,gi --sizes 1920x1080 --python python3 --layers\n  \
    deepshade bench net --networks ao --budget 4 --sizes 1920x1080\n\n\
    Networks without a folder in --models have random weights, which take as long. A mono network is timed on one \
    colour channel. By default sizes are 256x256, 768x512, 1280x720, 1920x1080 and 3840x2160 on a graphics card, and \
    the first two on a software adapter.")]
pub struct Args {
    /// Effects whose networks are measured; by default all of the paper's Table 7.1.
    #[arg(long, value_delimiter = ',')]
    networks: Vec<Effect>,
    /// Folder of trained networks, each in a folder with its effect's name.
    #[arg(long, default_value = "models")]
    models: PathBuf,
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
    /// Which network of the effect's kind takes so many milliseconds, by what its layers should take; then runs it.
    #[arg(long, value_name = "MILLISECONDS", value_parser = crate::arguments::positive,
        conflicts_with_all = ["models", "seconds", "runs", "layers", "onnxruntime", "python", "page"])]
    budget: Option<f32>,
    #[command(flatten)]
    onnxruntime: onnxruntime::Args,
    #[command(flatten)]
    pytorch: pytorch::Args,
    /// Writes the table here as a page.
    #[arg(long)]
    page: Option<PathBuf>,
    /// Writes the figures here as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
}

/// Measures and prints.
///
/// # Errors
/// If a model cannot be read, there is no onnxruntime, or the GPU fails.
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
    let subjects = subjects::subjects(&args.networks, &args.models, scratch.path())?;
    let devices = Devices {
        gpu: (gpu, gpu::ceilings(&gpu.device, &gpu.queue)?),
        cpu: Ceilings { multiply_add: cpu::ceilings::multiply_add(), copy: cpu::ceilings::copy() },
        onnxruntime: &args.onnxruntime,
        pytorch: &args.pytorch,
        threads: args.threads(),
    };
    let mut bench = Bench { figures: Figures::new("bench net"), made: Vec::new(), layers: Vec::new() };
    for subject in &subjects {
        for size in sizes(args, gpu) {
            note!("{} at {}x{}", subject.name, size[0], size[1]);
            bench.add(&Race { subject, size, effort: args.effort(), devices: &devices });
            if args.layers {
                bench.layers.extend(layers::rows(gpu, subject, size)?);
            }
        }
    }
    bench.figures.detail("shipped", json!(subjects::shipped(&subjects)));
    if let Some(bytes) = ao_bytes(gpu, &subjects)? {
        bench.figures.set("bytes_ao_1080p", bytes as f64);
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
    made: Vec<Measurement>,
    layers: Vec<layers::Row>,
}

impl Bench {
    fn add(&mut self, race: &Race<'_>) {
        let mut made = race.run();
        let network = &race.subject.name;
        if (race.size, race.subject.model.spec.effect) == NAIVE {
            made.extend(race.naive());
            self.set_ratio(&format!("ratio_naive_wgsl_{network}"), &made, ["naive", "wgsl"]);
        }
        if race.size == PAPER {
            for row in &made {
                self.figures.set(&format!("ms_{}_{network}", row.engine), row.milliseconds);
            }
            for engine in ["wgsl", "cpu"] {
                let name = format!("ratio_{engine}_onnxruntime_{network}");
                self.set_ratio(&name, &made, [engine, "onnxruntime"]);
            }
        }
        self.made.extend(made);
    }

    fn set_ratio(&mut self, name: &str, made: &[Measurement], [ours, theirs]: [&str; 2]) {
        let of = |engine: &str| made.iter().find(|row| row.engine == engine).map(|row| row.milliseconds);
        if let (Some(ours), Some(theirs)) = (of(ours), of(theirs)) {
            self.figures.set(name, ours / theirs);
        }
    }

    fn finish(mut self, args: &Args, devices: &Devices<'_>) -> Result<()> {
        let (gpu, card) = devices.gpu;
        for (engine, peak) in [("wgsl", card), ("cpu", devices.cpu)] {
            self.figures.set(&format!("peak_gflops_{engine}"), peak.multiply_add * 1e-9);
            self.figures.set(&format!("peak_gigabytes_{engine}"), peak.copy * 1e-9);
        }
        let info = &gpu.info;
        self.figures.detail("adapter", json!({ "name": info.name, "driver": info.driver_info }));
        self.figures.detail("threads", json!(devices.threads));
        self.figures.detail("measurements", json!(self.made));
        self.figures.detail("layers", json!(self.layers));
        self.figures.write(args.json.as_deref())?;
        if let Some(path) = &args.page {
            write_atomically(path, page::render(&self.figures, &self.made, &self.layers, gpu)?.as_bytes())?;
        }
        say!(
            "network      size       engine                 ms      p95  GFLOP/s  of peak    GB/s  of peak"
        )?;
        self.made.iter().try_for_each(|row| say!("{row}"))?;
        self.layers.iter().try_for_each(|row| say!("{row}"))?;
        for (engine, peak) in [("WGSL", card), ("processor", devices.cpu)] {
            let (flops, bytes) = (peak.multiply_add * 1e-9, peak.copy * 1e-9);
            say!("{engine} at best {flops:.1} GFLOP/s multiplying and adding, {bytes:.1} GB/s copying")?;
        }
        if let Some(bytes) = self.figures.get("bytes_ao_1080p") {
            say!("ao at 1920x1080: feature maps of {:.1} MB", bytes * 1e-6)?;
        }
        say!("WGSL on {} ({}), the rest on {} threads", info.name, info.driver_info, devices.threads)
    }
}

impl std::fmt::Display for Measurement {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { network, size: [width, height], engine, milliseconds, p95, gflops, gigabytes, .. } = self;
        let (flops, bytes) = (self.of_peak_flops(), self.of_peak_bytes());
        let size = format!("{width}x{height}");
        write!(
            f,
            "{network:<12} {size:<10} {engine:<18} {milliseconds:>8.2} {p95:>8.2} {gflops:>8.1} {flops:>8} {gigabytes:>7.1} {bytes:>8}"
        )
    }
}

/// Bytes of the feature maps of ao at 1920x1080 in the kernels for graphics cards, in half floats where the device has
/// them.
fn ao_bytes(gpu: &Gpu, subjects: &[Subject]) -> Result<Option<u64>> {
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
