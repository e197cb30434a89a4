//! `deepshade bench net`: the paper's networks in WGSL and on the CPU beside onnxruntime and PyTorch.
//!
//! All work on the same random image in memory of their own; what is not measured is the way there and back. On a
//! machine whose adapter is software, all use the same processor.

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
use deepshade_shaders::gpu::{Gpu, ceilings};
use rivals::{Devices, Effort, Measurement};
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
    #[arg(long, default_value_t = 2.0, value_parser = crate::arguments::positive)]
    seconds: f32,
    /// Most timed runs of each.
    #[arg(long, default_value_t = 50, value_parser = clap::value_parser!(u16).range(3..=2000))]
    runs: u16,
    /// Threads of onnxruntime and PyTorch; by default as many as the machine has.
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Times of every layer too.
    #[arg(long)]
    layers: bool,
    /// Which network of the effect's kind takes so many milliseconds, by what its layers should take; then runs it.
    #[arg(long, value_name = "MILLISECONDS", value_parser = crate::arguments::positive)]
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
    if let Some(budget) = args.budget {
        return budget::run(args, &gpu, budget.into());
    }
    let scratch = tempfile::tempdir()?;
    let subjects = subjects::subjects(&args.networks, &args.models, scratch.path())?;
    let sizes = sizes(args, &gpu);
    let mut bench = Bench { args, gpu: &gpu, figures: Figures::new("bench net"), made: Vec::new() };
    bench.ceilings()?;
    for subject in &subjects {
        for size in &sizes {
            bench.measure(subject, *size)?;
        }
        if args.layers {
            layers::print(&gpu, subject, sizes[0])?;
        }
    }
    bench.finish(&subjects)
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
struct Bench<'a> {
    args: &'a Args,
    gpu: &'a Gpu,
    figures: Figures,
    made: Vec<Measurement>,
}

impl Bench<'_> {
    /// What the devices can do at best.
    fn ceilings(&mut self) -> Result<()> {
        let card = ceilings(&self.gpu.device, &self.gpu.queue)?;
        let (cpu_flops, cpu_bytes) = (cpu::ceilings::multiply_add(), cpu::ceilings::copy());
        let rows = [("wgsl", card.multiply_add, card.copy), ("cpu", cpu_flops, cpu_bytes)];
        say!("peak         GFLOP/s      GB/s")?;
        for (engine, flops, bytes) in rows {
            self.figures.set(&format!("peak_gflops_{engine}"), flops * 1e-9);
            self.figures.set(&format!("peak_gigabytes_{engine}"), bytes * 1e-9);
            say!("{engine:<11}{:>9.1} {:>9.1}", flops * 1e-9, bytes * 1e-9)?;
        }
        say!("\nnetwork      size       engine                  ms     p95   GFLOP/s    GB/s")
    }

    fn measure(&mut self, subject: &Subject, size: [usize; 2]) -> Result<()> {
        let devices =
            Devices { gpu: self.gpu, onnxruntime: &self.args.onnxruntime, threads: self.args.threads() };
        let mut made = rivals::measure(subject, size, &devices, self.args.effort())?;
        if (size, subject.model.spec.effect) == NAIVE {
            made.push(rivals::naive(subject, size, self.gpu)?);
        }
        let more = json!({ "mode": "infer", "size": size, "compile": true, "runs": self.args.runs, "seconds": self.args.seconds });
        if let Some(report) = self.args.pytorch.run(&subject.model.spec, self.args.threads(), more)? {
            self.figures.detail("pytorch", json!({ "version": report.version, "device": report.device }));
            made.extend(report.made.iter().map(|row| rivals::of_pytorch(subject, size, row)));
        }
        for row in &made {
            let [width, height] = row.size;
            say!(
                "{:<12} {:<10} {:<18} {:>8.2} {:>7.2} {:>9.1} {:>7.1}",
                row.network,
                format!("{width}x{height}"),
                row.engine,
                row.milliseconds,
                row.p95,
                row.gflops,
                row.gigabytes
            )?;
        }
        if size == PAPER {
            self.set_figures(subject, &made);
        }
        if (size, subject.model.spec.effect) == NAIVE {
            self.set_ratio("ratio_naive_wgsl", subject, &made, ["naive", "wgsl"]);
        }
        self.made.extend(made);
        Ok(())
    }

    fn set_figures(&mut self, subject: &Subject, made: &[Measurement]) {
        for row in made {
            self.figures.set(&format!("ms_{}_{}", row.engine, row.network), row.milliseconds);
        }
        for engine in ["wgsl", "cpu"] {
            self.set_ratio(&format!("ratio_{engine}_onnxruntime"), subject, made, [engine, "onnxruntime"]);
        }
    }

    fn set_ratio(&mut self, name: &str, subject: &Subject, made: &[Measurement], [ours, theirs]: [&str; 2]) {
        let of = |engine: &str| made.iter().find(|row| row.engine == engine).map(|row| row.milliseconds);
        if let (Some(ours), Some(theirs)) = (of(ours), of(theirs)) {
            self.figures.set(&format!("{name}_{}", subject.name), ours / theirs);
        }
    }

    fn finish(mut self, subjects: &[Subject]) -> Result<()> {
        if let Some(bytes) = ao_bytes(self.gpu, subjects)? {
            self.figures.set("bytes_ao_1080p", bytes as f64);
            say!("\nao at 1920x1080: feature maps of {:.1} MB", bytes as f64 * 1e-6)?;
        }
        let info = &self.gpu.info;
        self.figures.detail("adapter", json!({ "name": info.name, "driver": info.driver_info }));
        self.figures.detail("threads", json!(self.args.threads()));
        self.figures.detail("measurements", json!(self.made));
        let shipped: Vec<&str> = subjects.iter().filter(|s| s.shipped).map(|s| s.name.as_str()).collect();
        self.figures.detail("shipped", json!(shipped));
        self.figures.write(self.args.json.as_deref())?;
        if let Some(path) = &self.args.page {
            write_atomically(path, page::render(&self.figures, &self.made, self.gpu)?.as_bytes())?;
            say!("{}", path.display())?;
        }
        say!("WGSL on {} ({}); the others on {} threads", info.name, info.driver_info, self.args.threads())
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
