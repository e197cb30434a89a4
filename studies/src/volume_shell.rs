//! `deepshade-studies volume-shell`: what light from surfaces to a cloud costs by volume shells, stage by
//! stage, how wrong it is, and how its time grows: Nalbach, Ritschel and Seidel 2014, Table 1 and Figure 11,
//! measured again.

mod cloud_box;
mod errors;
mod scaling;
mod subject;

use crate::cards::{GTX_770, Timed};
use crate::stages::{Cost, Stage};
use anyhow::Result;
use deepshade::shared::arguments::Size;
use deepshade::shared::figures::{Figures, write_atomically};
use deepshade::shared::table;
use deepshade_render::methods::Quality;
use deepshade_render::methods::volume_shell::VolumeShellParameters;
use deepshade_render::surfels;
use deepshade_shaders::gpu::{self, Gpu};
use errors::Errors;
use scaling::Scaling;
use serde_json::json;
use std::path::PathBuf;
use std::time::Duration;
use subject::ShellFrame;

/// Milliseconds of volume shells stage by stage, errors with and without what is not in the paper,
/// thresholds, how times grow.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    deepshade-studies volume-shell --json volume-shell.json --plot volume-shell.svg\n  \
    deepshade-studies volume-shell --full --json volume-shell.json\n\n\
    In the JSON file ms_STAGE is of the paper's size and parameters (six levels, epsilon 0.06, 16 samples, \
    200 steps, some 14,000 surfels), intervals with their coefficients; at the paper's size copied_STAGE is \
    what the device could have copied meanwhile over what the paper's card could have in its time, \
    multiplied_STAGE the same of multiplications. relmse is the relative squared error \
    against path-traced truth, relmse_paper that without any improvement, relmse_without_NAME that without \
    one, relmse_epsilon_E that of another threshold; all under one exposure. slope_surfels, slope_pixels and \
    slope_intervals are of log time of splatting against log number, with half of the 95 % interval in \
    slope_NAME_interval.")]
pub struct Args {
    /// At the paper's size (800x600) in place of a quarter of its pixels, with truth of more samples.
    #[arg(long)]
    full: bool,
    /// Timed runs of each stage; by default 20 on a graphics card and 1 on a software adapter.
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1000))]
    runs: Option<u16>,
    /// Writes the plot of time against numbers here as SVG.
    #[arg(long, value_parser = deepshade::shared::arguments::svg_file)]
    plot: Option<PathBuf>,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = deepshade::shared::arguments::written_file)]
    json: Option<PathBuf>,
}

/// The paper's size.
const PAPER: Size = Size { width: 800, height: 600 };
/// Milliseconds of its Table 1, on a GTX 770, by the names of our stages, and what direct light takes.
const PAPER_TIMES: [(&str, f64); 8] = [
    ("shadow_maps", 0.6),
    ("surfels", 3.0),
    ("intervals", 9.4),
    ("splat", 20.0),
    ("blur", 3.0),
    ("sum", 0.4),
    ("total", 37.4),
    ("direct", 1.5),
];
/// Size of images that are compared with truth and from which times grow, over that of the whole frame.
const SMALL: f32 = 0.4;
/// Samples of a pixel of truth.
const SAMPLES: [u32; 2] = [256, 1024];
/// Radius of surfels of which there are some 14,000.
const SCALE: f32 = 0.015;
/// How long a GPU is kept busy before it is measured.
const WARM_UP_TIME: Duration = Duration::from_millis(500);

/// The paper's parameters.
fn parameters() -> VolumeShellParameters {
    let usual = VolumeShellParameters::of(Quality::High);
    let surfels = surfels::SurfelDensity { scale: SCALE, ..usual.surfels };
    VolumeShellParameters { surfels, threshold: 0.06, levels: 6, samples: 16, steps: 200, ..usual }
}

/// Measures and prints.
///
/// # Errors
/// If the device fails, or a file cannot be written.
pub fn run(args: &Args) -> Result<()> {
    let gpu = Gpu::new()?;
    let runs = args.runs.map_or(if gpu.is_software() { 1 } else { 20 }, usize::from);
    let size = if args.full { PAPER } else { PAPER.scaled(0.5) };
    gpu::warm_up(&gpu.device, &gpu.queue, WARM_UP_TIME)?;
    note!("stages at {size}");
    let subject = ShellFrame::new(&gpu, size)?;
    let shadow_maps = subject.shadow_maps(runs)?;
    let direct = subject.direct(parameters(), runs)?;
    let cost = subject.shaded(parameters(), runs)?.cost;
    note!("errors at {}", size.scaled(SMALL));
    let small = ShellFrame::new(&gpu, size.scaled(SMALL))?;
    let errors = Errors::of(&small, parameters(), SAMPLES[usize::from(args.full)], runs)?;
    note!("how times grow");
    let scaling = Scaling::of(&gpu, size.scaled(2.0 * SMALL), parameters(), runs)?;
    let at_best = gpu::ceilings(&gpu.device, &gpu.queue)?;

    let mut figures = Figures::new("volume-shell");
    let stages = stages(&cost, [shadow_maps, direct]);
    let mut rows = vec![["stage", "ms", "paper's", "copied", "multiplied"].map(str::to_owned).to_vec()];
    for (name, milliseconds) in &stages {
        figures.set(&format!("ms_{name}"), *milliseconds);
        let mut row = vec![(*name).to_owned(), format!("{milliseconds:.2}")];
        // Its times are of its size.
        let paper = PAPER_TIMES.iter().find(|(stage, _)| args.full && stage == name);
        if let Some((_, of_paper)) = paper {
            let of_paper = Timed { milliseconds: *of_paper, at_best: GTX_770 };
            let over = Timed { milliseconds: *milliseconds, at_best }.over(of_paper);
            row.push(of_paper.milliseconds.to_string());
            for (what, over) in ["copied", "multiplied"].into_iter().zip(over) {
                figures.set(&format!("{what}_{name}"), over);
                row.push(format!("{over:.1}"));
            }
        }
        row.resize(rows[0].len(), String::new());
        rows.push(row);
    }
    errors.set(&mut figures);
    scaling.set(&mut figures);
    figures.detail("adapter", json!(gpu.info.name));
    figures.detail("size", json!(size.to_string()));
    figures.detail("surfels", json!(cost.surfels[0]));
    figures.detail("megabytes", json!(cost.megabytes));
    figures.detail("runs", json!(runs));
    figures.detail("errors", errors.to_json());
    figures.detail("scaling", scaling.to_json());
    figures.write(args.json.as_deref())?;
    if let Some(path) = &args.plot {
        write_atomically(path, scaling.plot().svg("Time of splatting")?.as_bytes())?;
    }
    say!("a cloud in a box at {size}, {} surfels, on {}", cost.surfels_in_words(), gpu.info.name)?;
    if gpu.is_software() {
        say!("(a software adapter: of milliseconds the order alone means something)")?;
    }
    say!("{}", table::aligned(&rows))?;
    if args.full {
        say!("copied, multiplied: what this device could have done meanwhile over what the paper's could")?;
    }
    say!("\n{}", table::aligned(&errors.rows()))?;
    say!("\n{}", table::aligned(&scaling.rows()))
}

/// Stages of the paper's Table 1 with their milliseconds, and what direct light that is scattered takes
/// beside them.
fn stages(cost: &Cost, [shadow_maps, direct]: [f64; 2]) -> Vec<(&'static str, f64)> {
    let its = cost.stages.iter().map(|(stage, time)| (stage.name(), *time));
    let ends = [("total", shadow_maps + cost.total), (Stage::Direct.name(), direct)];
    [("shadow_maps", shadow_maps)].into_iter().chain(its).chain(ends).collect()
}
