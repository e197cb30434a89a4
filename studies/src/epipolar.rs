//! `deepshade-studies epipolar`: single scattering by partial-sum trees beside marching, epipolar sampling
//! and min/max mipmaps, on one thread: the claims of Baran et al. 2010, measured again (sections 6, 8 and 10,
//! Figures 11 to 13).
//!
//! The clock holds what theirs does: rectification, integration and the way back, or the march; camera depths
//! and shadow maps are given. Errors are relative squared errors under one exposure, on every sixteenth
//! pixel, against a march of [`equal_error::REFERENCE_STEPS`] steps through the same shadow map.

mod claims;
mod equal_error;
mod hall;
mod on_gpu;
mod scaling;
mod simple_march;
mod subject;

use anyhow::{Context, Result};
use claims::Claims;
use deepshade::shared::figures::{Figures, write_atomically};
use deepshade::shared::table;
use deepshade_shaders::gpu::Gpu;
use equal_error::ViewOutcome;
use on_gpu::OnGpu;
use scaling::Scaling;
use serde_json::json;
use std::path::PathBuf;
use subject::{FogView, Kind, Setup, View};

/// Fog by partial-sum trees beside marching at equal error, on one thread: speed-ups, how times grow, what
/// slices save.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    deepshade-studies epipolar --json epipolar.json --plot epipolar.svg\n  \
    deepshade-studies epipolar --full --json epipolar.json\n\n\
    In the JSON file speedup_SCENE_VIEW is the time of the march with the fewest steps whose relative \
    squared error is no larger than that of the trees, over theirs; speedup_SCENE_VIEW_quarter is that of \
    trees of a quarter of the light rays, and speedup_simple_SCENE_VIEW that over the march that the paper \
    compares with, one step after the other. VIEW is `sun` with the sun in the image and `side` without. \
    sampling_SCENE_VIEW is the same of epipolar sampling, null where that does not become as good. \
    gpu_ratio_SCENE_VIEW is that of `gpu-march` over `gpu-epipolar`, on the GPU (on a software adapter of \
    images of 96x72 pixels). slope_tree and slope_march are of log time against log(srd) / 3.")]
pub struct Args {
    /// At the paper's sizes (1280x960, 4096 light rays, shadow maps of 4096 x 4096) in place of half of them;
    /// takes ten minutes or so in place of one or two.
    #[arg(long)]
    full: bool,
    /// Writes the plot of time against resolution here as SVG.
    #[arg(long, value_parser = deepshade::shared::arguments::svg_file)]
    plot: Option<PathBuf>,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = deepshade::shared::arguments::written_file)]
    json: Option<PathBuf>,
}

/// The paper's sizes.
const PAPER: Setup = Setup { size: [960, 1280], light_rays: 4096, shadow_size: 4096 };

/// Measures and prints.
///
/// # Errors
/// If there is no adapter, no thread can be made, or a file cannot be written.
pub fn run(args: &Args) -> Result<()> {
    let gpu = Gpu::new()?;
    let setup = if args.full { PAPER } else { PAPER.scaled(0.5) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().context("one thread")?;
    let mut outcomes = Vec::new();
    for kind in Kind::ALL {
        for view in View::ALL {
            let subject = FogView::new(kind, view, setup)?;
            note!("{} at {}x{}", subject.name, setup.size[1], setup.size[0]);
            outcomes.push(ViewOutcome::of(&subject, &pool));
        }
    }
    note!("how times grow");
    let scaling = Scaling::of(setup, &pool)?;
    note!("what else is claimed");
    let claims = Claims::of(setup, &pool)?;
    note!("partial sums and the march on the GPU");
    let on_gpu = OnGpu::of(&gpu, setup)?;

    let mut figures = Figures::new("epipolar");
    outcomes.iter().for_each(|outcome| outcome.set(&mut figures));
    equal_error::set_extremes(&outcomes, &mut figures);
    scaling.set(&mut figures);
    claims.set(&mut figures);
    on_gpu.set(&mut figures);
    figures.detail("size", json!(setup.size));
    figures.detail("light_rays", json!(setup.light_rays));
    figures.detail("shadow_size", json!(setup.shadow_size));
    figures.detail("outcomes", outcomes.iter().map(ViewOutcome::to_json).collect());
    figures.detail("scaling", scaling.to_json());
    figures.detail("gpu", on_gpu.to_json());
    figures.write(args.json.as_deref())?;
    if let Some(path) = &args.plot {
        write_atomically(path, scaling.plot().svg("Time against resolution")?.as_bytes())?;
    }
    say!("{}", table::aligned(&equal_error::rows(&outcomes)))?;
    say!("\n{}", table::aligned(&scaling.rows()))?;
    say!("\n{}", table::aligned(&claims.rows()))?;
    say!("\n{}\n{}", on_gpu.title(), table::aligned(&on_gpu.rows()))
}

/// A small number for a table.
fn table_number(value: f64) -> String {
    if value.abs() < 0.01 { format!("{value:.2e}") } else { format!("{value:.3}") }
}
