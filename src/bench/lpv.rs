//! `deepshade bench lpv`: what light propagation volumes cost stage by stage, how wrong they are beside what else could
//! be shown, and where propagation holds: Billeter, Sintorn and Assarsson 2012, Table 1 and Figure 5, measured again.

mod alternatives;
mod cost;
mod motion;
mod progress;
mod room;
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
use motion::{Flicker, Leaks};
use progress::Progress;
use serde_json::json;
use std::path::PathBuf;
use std::time::Duration;
use studies::Studies;
use subject::Subject;

/// Milliseconds of light propagation volumes stage by stage, errors beside the paper's alternatives, how far
/// propagation is right, how much it flickers and leaks.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    deepshade bench lpv --json lpv.json --plot lpv.svg\n  \
    deepshade bench lpv --scene sponza.gltf --full --json lpv.json\n\n\
    In the JSON file ms_STAGE and ms_STAGE_64 are of 32 and 64 cells along the scene and eight iterations, ratio_64_32 is of \
    propagation; bytes_ratio is what propagation reads and writes at least in a second over what a copy does. relmse_NAME is the \
    relative squared error against all light, path traced, of what the paper compares: shadow_map, plain, single, marched, sum, and \
    ours in relmse_lpv and with the paper's factors, lobes and lookup in relmse_paper; relmse_multiple that of multiple scattering \
    alone, relmse_multiple_CELLS_ITERATIONS of grids of many sizes, relmse_multiple_nested of a grid of 32 cells with a finer one \
    around the camera, relmse_multiple_one_grid of one that takes as long; relmse_black of nothing. energy_loss_iteration is the \
    largest share of its energy that light loses in an iteration; moment_ratio_L_A the mean squared distance of collisions over \
    what it is in an infinite medium, L cells a mean free path and an albedo of A; moment_ratio_FACTORS_L_A by other factors; \
    monopole_error how far fluence is from a monopole's beyond three mean free paths; flux_DIRECTION the flux of a point source \
    without a medium along an axis, across an edge and across a corner over what it is where all directions are alike; \
    ringing_N_bands the share of light that is negative in N spherical harmonic bands by themselves. \
    flicker_WHAT is how far images are from the mean of those before and after as something moves, over their mean; leak_LOOKUP \
    the light seen behind a wall thinner than a cell over that before it.")]
pub struct Args {
    /// A scene file (.gltf, .glb, .obj) or a procedural family and a seed.
    #[arg(long, default_value = "colonnade:1")]
    scene: SceneSource,
    /// At the paper's size (1280x720) in place of a quarter of its edges, with truth of more samples, 100 frames of what
    /// moves in place of 20, and mean free paths of four cells.
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
/// Frames of what moves.
const FRAMES: [usize; 2] = [20, 100];
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
    let slow = if args.full { 8.0 } else { 1.0 };
    let mut progress = Progress::new(vec![
        ("stages", 60.0 * slow),
        ("images beside truth", 150.0 * slow),
        ("light behind a wall", 10.0),
        ("what moves", if args.full { 600.0 } else { 120.0 }),
        ("propagation in an infinite medium", if args.full { 150.0 } else { 60.0 }),
    ]);
    progress.next();
    let costs = Costs::of(&Subject::new(&gpu, &args.scene, size)?, runs)?;
    progress.next();
    let small = if args.full { PAPER.scaled(0.25) } else { PAPER.scaled(0.1) };
    let alternatives =
        Alternatives::of(&Subject::new(&gpu, &args.scene, small)?, SAMPLES[usize::from(args.full)])?;
    progress.next();
    let leaks = Leaks::of(&gpu)?;
    progress.next();
    let flicker = Flicker::of(&gpu, FRAMES[usize::from(args.full)])?;
    progress.next();
    let studies = Studies::new(args.full);

    let mut figures = Figures::new("bench lpv");
    studies.set(&mut figures);
    costs.set(&mut figures);
    alternatives.set(&mut figures);
    leaks.set(&mut figures);
    flicker.set(&mut figures);
    figures.detail("adapter", json!(gpu.info.name));
    figures.detail("scene", json!(args.scene.to_string()));
    figures.detail("size", json!(size.to_string()));
    figures.detail("size_of_images", json!(small.to_string()));
    figures.detail("runs", json!(runs));
    figures.write(args.json.as_deref())?;
    if let Some(path) = &args.plot {
        write_atomically(path, studies.plot().svg("Squared distance of collisions")?.as_bytes())?;
    }
    say!("{} at {size} on {}", args.scene, gpu.info.name)?;
    if gpu.is_software() {
        say!("(a software adapter: of milliseconds the order alone means something)")?;
    }
    for rows in [costs.rows(), alternatives.rows(), leaks.rows(), flicker.rows(), studies.rows()] {
        say!("\n{}", table::aligned(&rows))?;
    }
    Ok(())
}
