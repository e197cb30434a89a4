//! `deepshade bench lpv`: what light propagation volumes cost stage by stage, how wrong they are beside what else could
//! be shown, and where propagation holds: Billeter, Sintorn and Assarsson 2012, Table 1 and Figure 5, measured again.

mod alternatives;
mod cost;
mod studies;
mod subject;

use crate::arguments::Size;
use crate::figures::{Figures, write_atomically};
use crate::table;
use alternatives::Alternatives;
use anyhow::Result;
use cost::Costs;
use deepshade_render::scene::SceneSource;
use deepshade_shaders::gpu::{self, Gpu};
use serde_json::json;
use std::path::PathBuf;
use std::time::Duration;
use studies::Studies;
use subject::Subject;

/// Milliseconds of light propagation volumes stage by stage, errors beside the paper's alternatives, how far
/// propagation is right.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    deepshade bench lpv --json lpv.json --plot lpv.svg\n  \
    deepshade bench lpv --scene sponza.gltf --full --json lpv.json\n\n\
    In the JSON file ms_STAGE and ms_STAGE_64 are of 32 and 64 cells along the scene and eight iterations, ratio_64_32 is of \
    propagation; bytes_ratio is what propagation reads and writes at least in a second over what a copy does. relmse_NAME is the \
    relative squared error against all light, path traced, of what the paper compares: shadow_map, plain, single, marched, sum, and \
    ours in relmse_lpv; relmse_multiple that of multiple scattering alone, relmse_black of nothing. energy_loss_iteration is the \
    largest share of its energy that light loses in an iteration; moment_ratio_L_A the mean squared distance of collisions over \
    what it is in an infinite medium, L cells a mean free path and an albedo of A; moment_ratio_FACTORS_L_A by other factors; \
    monopole_error how far fluence is from a monopole's beyond three mean free paths.")]
pub struct Args {
    /// A scene file (.gltf, .glb, .obj) or a procedural family and a seed.
    #[arg(long, default_value = "colonnade:1")]
    scene: SceneSource,
    /// At the paper's size (1280x720) in place of a quarter of its edges, with truth of more samples.
    #[arg(long)]
    full: bool,
    /// Timed runs of each stage; by default 20 on a graphics card and 1 on a software adapter.
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1000))]
    runs: Option<u16>,
    /// Writes the plot of collisions' distances against mean free paths here as SVG.
    #[arg(long, value_parser = crate::arguments::svg_file)]
    plot: Option<PathBuf>,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
}

/// The paper's size.
const PAPER: Size = Size { width: 1280, height: 720 };
/// Samples of a pixel of truth.
const SAMPLES: [u32; 2] = [64, 512];
/// How long a GPU is kept busy before it is measured.
const WAKING: Duration = Duration::from_millis(500);

/// Measures and prints.
///
/// # Errors
/// If the scene cannot be read, the device fails, or a file cannot be written.
pub fn run(args: &Args) -> Result<()> {
    let gpu = Gpu::new()?;
    let runs = args.runs.map_or(if gpu.is_software() { 1 } else { 20 }, usize::from);
    let size = if args.full { PAPER } else { PAPER.scaled(0.25) };
    gpu::wake(&gpu.device, &gpu.queue, WAKING)?;
    note!("propagation in an infinite medium");
    let studies = Studies::new();
    note!("stages at {size}");
    let costs = Costs::of(&Subject::new(&gpu, &args.scene, size)?, runs)?;
    let small = if args.full { PAPER.scaled(0.25) } else { PAPER.scaled(0.1) };
    note!("errors at {small}");
    let alternatives =
        Alternatives::of(&Subject::new(&gpu, &args.scene, small)?, SAMPLES[usize::from(args.full)])?;

    let mut figures = Figures::new("bench lpv");
    studies.set(&mut figures);
    costs.set(&mut figures);
    alternatives.set(&mut figures);
    figures.detail("adapter", json!(gpu.info.name));
    figures.detail("scene", json!(args.scene.to_string()));
    figures.detail("size", json!(size.to_string()));
    figures.detail("runs", json!(runs));
    figures.write(args.json.as_deref())?;
    if let Some(path) = &args.plot {
        write_atomically(path, studies.plot().svg("Squared distance of collisions")?.as_bytes())?;
    }
    say!("{} at {size} on {}", args.scene, gpu.info.name)?;
    if gpu.is_software() {
        say!("(a software adapter: of milliseconds the order alone means something)")?;
    }
    for rows in [costs.rows(), alternatives.rows(), studies.rows()] {
        say!("\n{}", table::aligned(&rows))?;
    }
    Ok(())
}
