//! `deepshade-studies lpv`: what light propagation volumes cost stage by stage, how wrong they are beside
//! what else could be shown, and where propagation holds: Billeter, Sintorn and Assarsson 2012, Table 1 and
//! Figure 5, measured again.

mod alternatives;
mod closed;
mod cost;
mod motion;
mod page;
mod progress;
mod reflective;
mod room;
mod scores;
mod studies;
mod subject;

use alternatives::Alternatives;
use anyhow::{Result, ensure};
use closed::ClosedRooms;
use cost::Costs;
use deepshade::shared::arguments::Size;
use deepshade::shared::figures::{Figures, write_atomically};
use deepshade::shared::table;
use deepshade_render::methods::Quality;
use deepshade_render::scene::SceneSource;
use deepshade_shaders::gpu::{self, Gpu};
use motion::{Flicker, Leaks};
use page::Page;
use progress::Progress;
use reflective::Injections;
use serde_json::json;
use std::path::PathBuf;
use std::time::Duration;
use studies::Studies;
use subject::LpvFrame;

/// Milliseconds of light propagation volumes stage by stage, errors beside the paper's alternatives, how far
/// propagation is right, how much it flickers and leaks.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    deepshade-studies lpv --json lpv.json --plot lpv.svg\n  \
    deepshade-studies lpv --only images --scene drapery:1 --scene cave:1 --scene playground:1 --scene \
    bridge:1 --scene sponza.gltf --scene CesiumMan.gltf --page figure-5 --json six.json\n  \
    deepshade-studies lpv --scene sponza.gltf --full --json lpv.json\n\n\
    In the JSON file ms_STAGE and ms_STAGE_64 are of 32 and 64 cells along the scene and eight iterations, \
    ratio_64_32 is of propagation; bytes_ratio is what propagation reads and writes at least in a second \
    over what a copy does, bytes_ratio_paper the same of the paper's on its card. \
    relmse_NAME is the relative squared error against all light, path traced, of what \
    the paper compares: shadow_map, plain, single, marched, sum, and ours in relmse_lpv and with the paper's \
    factors, lobes and lookup in relmse_paper; light that the medium scattered once is that of \
    `gpu-epipolar`, but in relmse_lpv_traced_single and relmse_paper_traced_single, where it is path traced; \
    relmse_multiple that of multiple scattering alone, relmse_multiple_CELLS_ITERATIONS of grids of many \
    sizes, relmse_multiple_two_bands of the \
    paper's lobes in the grid of relmse_multiple_32_32; relmse_black of \
    nothing. flip_NAME and brightness_NAME are beside each, brightness_lit_NAME and brightness_dark_NAME \
    where the lamp lights what is seen and where it does not, over truth's; of several scenes all are means \
    over those in which such a region is seen. injection_error_WAY is the share of surfaces' light that \
    surfels, or a reflective shadow map of so many texels along an edge, put into other cells than one of \
    1536 does. energy_loss_iteration is the largest share of its energy that light loses in an iteration; \
    moment_ratio_L_A the mean squared distance of collisions over that of exponential flights, whose mean \
    free path is found by what they come to in a cube of the same size, L cells a mean free path and an \
    albedo of A; monopole_error_L_A how far fluence is from a \
    monopole's beyond three mean free paths, monopole_error of 1 cell and 0.9; flux_DIRECTION the flux of a \
    point source without a medium along an axis, across an edge and across a corner over what it is where \
    all directions are alike; ringing_2_bands the share of light that is negative in two spherical harmonic \
    bands, axis_over_diagonal_2_bands the flux along an axis over that across a corner in them. flicker_WHAT \
    is how far images are from the mean of those before and after as something moves, over their mean; \
    room_EFFECT_ALBEDO_QUALITY the mean of light in \
    the fog of a closed room over truth's; leak_LOOKUP the light seen behind a wall thinner than \
    a cell over that before it.")]
pub struct Args {
    /// A scene file (.gltf, .glb, .obj, .ply) or a procedural family and a seed. Several times for images of
    /// several; stages are timed on the first.
    #[arg(long, default_value = "colonnade:1")]
    scene: Vec<SceneSource>,
    /// Measures only some of it.
    #[arg(long, value_delimiter = ',')]
    only: Vec<LpvStudy>,
    /// At the paper's size (1280x720) in place of a quarter of its edges, with truth of more samples, 100
    /// frames of what moves in place of 20, and rooms at all presets in place of the two fastest.
    #[arg(long)]
    full: bool,
    /// Timed runs of each stage; by default 20 on a graphics card and 1 on a software adapter.
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1000))]
    runs: Option<u16>,
    /// Writes the images beside truth (PNG and EXR) and a page that shows them into this folder.
    #[arg(long)]
    page: Option<PathBuf>,
    /// Writes the plot of collisions' distances, and of light far away, against mean free paths here as SVG.
    #[arg(long, value_parser = deepshade::shared::arguments::svg_file)]
    plot: Option<PathBuf>,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = deepshade::shared::arguments::written_file)]
    json: Option<PathBuf>,
}

/// What is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum LpvStudy {
    /// What each stage takes.
    Stages,
    /// Where light is injected, from surfels and from reflective shadow maps.
    Injection,
    /// Images beside truth.
    Images,
    /// Light behind a wall.
    Leaks,
    /// Fog in a closed room.
    Rooms,
    /// What moves.
    Motion,
    /// Propagation in an infinite medium.
    Propagation,
}

impl LpvStudy {
    const ALL: [Self; 7] = [
        Self::Stages,
        Self::Injection,
        Self::Images,
        Self::Leaks,
        Self::Rooms,
        Self::Motion,
        Self::Propagation,
    ];

    const fn name(self) -> &'static str {
        match self {
            Self::Stages => "stages",
            Self::Injection => "where light is injected",
            Self::Images => "images beside truth",
            Self::Leaks => "light behind a wall",
            Self::Rooms => "fog in a closed room",
            Self::Motion => "what moves",
            Self::Propagation => "propagation in an infinite medium",
        }
    }

    /// What it takes, seconds of a machine of two cores.
    const fn seconds(self, scenes: usize, full: bool) -> f64 {
        match (self, full) {
            (Self::Stages, false) => 60.0,
            (Self::Stages, true) => 480.0,
            (Self::Images, false) => 150.0 * scenes as f64,
            (Self::Images, true) => 1200.0 * scenes as f64,
            (Self::Injection, _) => 20.0,
            (Self::Leaks, _) => 10.0,
            (Self::Rooms, false) => 200.0,
            (Self::Rooms, true) => 3000.0,
            (Self::Motion, false) => 120.0,
            (Self::Motion, true) => 600.0,
            (Self::Propagation, _) => 120.0,
        }
    }
}

/// The paper's size.
const PAPER: Size = Size { width: 1280, height: 720 };
/// Samples of a pixel of truth.
const SAMPLES: [u32; 2] = [64, 512];
/// Samples of truth in a closed room, of which the mean alone is asked, over those.
const ROOM_SAMPLES: u32 = 4;
/// Frames of what moves.
const FRAMES: [usize; 2] = [20, 100];
/// How long a GPU is kept busy before it is measured.
const WARM_UP_TIME: Duration = Duration::from_millis(500);

/// Measures and prints.
///
/// # Errors
/// If the scene cannot be read, the device fails, or a file cannot be written.
pub fn run(args: &Args) -> Result<()> {
    let wanted = |part: &LpvStudy| args.only.is_empty() || args.only.contains(part);
    ensure!(args.page.is_none() || wanted(&LpvStudy::Images), "--page shows images, which --only leaves out");
    ensure!(
        args.plot.is_none() || wanted(&LpvStudy::Propagation),
        "--plot shows propagation, which --only leaves out"
    );
    let page = args.page.as_deref().map(Page::new).transpose()?;
    let gpu = Gpu::new()?;
    let runs = args.runs.map_or(if gpu.is_software() { 1 } else { 20 }, usize::from);
    let scales = if args.full { [1.0, 0.25] } else { [0.25, 0.1] };
    let [size, small] = scales.map(|scale| PAPER.scaled(scale));
    gpu::warm_up(&gpu.device, &gpu.queue, WARM_UP_TIME)?;
    let parts: Vec<LpvStudy> = LpvStudy::ALL.into_iter().filter(wanted).collect();
    let seconds = |part: &LpvStudy| (part.name(), part.seconds(args.scene.len(), args.full));
    let mut progress = Progress::new(parts.iter().map(seconds).collect());
    let mut figures = Figures::new("lpv");
    let mut tables = Vec::new();
    for part in parts {
        progress.next();
        match part {
            LpvStudy::Stages => {
                let costs = Costs::of(&LpvFrame::new(&gpu, &args.scene[0], size)?, runs)?;
                costs.set(&mut figures);
                tables.push(costs.rows());
            }
            LpvStudy::Injection => {
                let injections = Injections::of(&LpvFrame::new(&gpu, &args.scene[0], small)?, runs)?;
                injections.set(&mut figures);
                tables.push(injections.rows());
            }
            LpvStudy::Images => {
                let samples = SAMPLES[usize::from(args.full)];
                let of = |scene: &SceneSource| Alternatives::of(&LpvFrame::new(&gpu, scene, small)?, samples);
                let scenes: Vec<Alternatives> = args.scene.iter().map(of).collect::<Result<_>>()?;
                let names: Vec<String> = args.scene.iter().map(ToString::to_string).collect();
                for (name, scene) in names.iter().zip(&scenes) {
                    figures.detail(name, scene.figures().into());
                }
                let mean = scores::mean(scenes.iter().map(|scene| &scene.rows[..]));
                scores::set(&mean, &mut figures);
                tables.push(scores::table(&mean));
                if let Some(page) = &page {
                    page.write(&names, &scenes, &mean)?;
                }
            }
            LpvStudy::Leaks => {
                let leaks = Leaks::of(&gpu)?;
                leaks.set(&mut figures);
                tables.push(leaks.rows());
            }
            LpvStudy::Rooms => {
                let qualities = if args.full { &Quality::ALL[..] } else { &Quality::ALL[..2] };
                let samples = SAMPLES[usize::from(args.full)] * ROOM_SAMPLES;
                let rooms = ClosedRooms::of(&gpu, samples, qualities)?;
                rooms.set(&mut figures);
                tables.push(rooms.rows());
            }
            LpvStudy::Motion => {
                let flicker = Flicker::of(&gpu, FRAMES[usize::from(args.full)])?;
                flicker.set(&mut figures);
                tables.push(flicker.rows());
            }
            LpvStudy::Propagation => {
                let studies = Studies::new();
                studies.set(&mut figures);
                tables.push(studies.rows());
                if let Some(path) = &args.plot {
                    let plot = studies.plot().svg("Squared distance of collisions, and light far away")?;
                    write_atomically(path, plot.as_bytes())?;
                }
            }
        }
    }
    figures.detail("adapter", json!(gpu.info.name));
    figures.detail("scenes", json!(args.scene.iter().map(ToString::to_string).collect::<Vec<_>>()));
    figures.detail("size", json!(size.to_string()));
    figures.detail("size_of_images", json!(small.to_string()));
    figures.detail("runs", json!(runs));
    figures.write(args.json.as_deref())?;
    say!("stages at {size}, images at {small} on {}", gpu.info.name)?;
    if gpu.is_software() {
        say!("(a software adapter: of milliseconds the order alone means something)")?;
    }
    for rows in tables {
        say!("\n{}", table::aligned(&rows))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser as _;

    #[derive(clap::Parser)]
    struct Line {
        #[command(flatten)]
        args: Args,
    }

    #[test]
    fn files_of_parts_that_are_left_out_are_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let refused = |option: &str, name: &str, only: &str| {
            let path = folder.path().join(name).display().to_string();
            let line = Line::try_parse_from(["lpv", option, &path, "--only", only]).expect("options");
            run(&line.args).expect_err("nothing would be written").to_string()
        };
        assert!(refused("--page", "page", "stages,leaks").contains("--only leaves out"));
        assert!(refused("--plot", "plot.svg", "images").contains("--only leaves out"));
        assert!(!folder.path().join("page").exists());
    }
}
