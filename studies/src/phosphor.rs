//! `deepshade-studies phosphor`: what a step of all texels takes, what light of the past costs by the rate
//! equation and by Glassner's integral, in images and at one place, and what a design takes (thesis, sections
//! 8.5 and 8.6).

mod cornell;
mod equal_quality;
mod glassner;
mod growth;
mod pictures;
mod step;
mod subject;

use anyhow::{Context, Result};
use cornell::OFF;
use deepshade::shared::arguments::Size;
use deepshade::shared::figures::{Figures, write_atomically};
use deepshade::shared::table;
use deepshade_glow::file::MaterialFile;
use deepshade_glow::material::{Material, State};
use deepshade_glow::spectrum::Bands;
use deepshade_phosphor::design::{Design, Key, TargetPoint, thesis_grid};
use deepshade_phosphor::noise::Noise;
use deepshade_phosphor::simulation::Simulation;
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::lists::median;
use equal_quality::EqualQuality;
use glassner::Past;
use growth::Growth;
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;
use step::StepCost;

/// Milliseconds of a step of 4.7 million texels and of a design, and what light of the past costs by the rate
/// equation and by Glassner's integral.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  deepshade-studies phosphor --json phosphor.json\n  \
    deepshade-studies phosphor --size 1024x512 --pictures glowing-box\n\n\
    In the JSON file ms_step_4_7m is of one step of all states of a glowing box with 4.7 million texels, \
    irradiance by shadow maps included, texels_per_second what that makes, bandwidth_share the bytes that it \
    moves over what the device copies in the same time. ratio_glassner_equal_quality is what the integral \
    takes for an image of the same error over what the rate equation takes, with \
    samples_glassner_equal_quality moments a pixel (neither is there if 4096 moments are not enough), \
    ms_rate_equation_after_4_s and ms_glassner_after_4_s what a frame takes by both, of equal quality, 4 \
    seconds after the beginning of a sequence under a lamp that blinks, ratio_error_glassner_equal_time its \
    squared error over the rate equation's with as many moments as cost no more. ms_design is the median \
    over places of a material of one state and three colours that meets four keys of a sequence of 200 \
    frames, design_residual the sum of what is left over all places, design_residual_grid that of the \
    thesis' grid; ms_design_BANDS_STATES and so on are of other bands and states. ratio_glassner_one_place \
    is what the integral takes at one place on the processor, at an error of 1 %, over what a step of the \
    rate equation takes there, after 600 frames. relmse_frames_NAME is how far each of the --pictures by \
    frames is from the same light path traced.")]
pub struct Args {
    /// Size of the images that are compared, columns x rows; those of the thesis have 1024x512.
    #[arg(long, default_value = "256x128")]
    size: Size,
    /// Timed runs of each pass; by default 20 on a graphics card and 1 on a software adapter.
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1000))]
    runs: Option<u16>,
    /// Writes pictures of a box with glowing walls here, before and after its lamp has gone out. From left to
    /// right: all light, path traced; what of it surfaces and the lamp send and surfaces reflect once, path
    /// traced, and by frames on the GPU (the rate equation and surfels); what the walls give back by truth;
    /// by the rate equation in frames; by the integral in equal time; by the integral in equal quality.
    #[arg(long)]
    pictures: Option<PathBuf>,
    /// Draws what a frame takes by either method as a sequence goes on into this SVG file.
    #[arg(long, value_parser = deepshade::shared::arguments::svg_file)]
    plot: Option<PathBuf>,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = deepshade::shared::arguments::written_file)]
    json: Option<PathBuf>,
}

/// Places of each kind of design.
const PLACES: usize = 20;
/// Seconds after the lamp has gone out at which images are compared.
const AFTER: f32 = 5.0;
/// Frames of a sequence, and those that are keys.
const FRAMES: usize = 200;
const KEYS: [usize; 4] = [40, 90, 140, 190];
/// Lengths of the past, frames of a sixtieth of a second.
const PASTS: [usize; 4] = [60, 600, 6000, 60_000];
/// Whose ratio is the figure.
const FIGURED_PAST: usize = 600;
/// Error of Glassner's integral that is as good as a step.
const QUALITY: f64 = 0.01;
/// Draws of which an integral's error is known.
const DRAWS: usize = 4000;

/// Designs of one kind.
struct Designed {
    name: &'static str,
    milliseconds: f64,
    worst: f64,
    residual: f64,
    of_grid: f64,
}

/// A place's light after so many frames.
struct Rivals {
    frames: usize,
    step: f64,
    samples: usize,
    drawn: f64,
    error_in_a_step: f64,
}

/// Measures and prints.
///
/// # Errors
/// If a material makes no sense, or the figures cannot be written.
pub fn run(args: &Args) -> Result<()> {
    let gpu = Gpu::new()?;
    let runs = args.runs.map_or(if gpu.is_software() { 1 } else { 20 }, usize::from);
    note!("a step of all texels");
    let step = StepCost::of(&gpu, runs)?;
    note!("images at {}", args.size);
    let comparison = EqualQuality::of(&gpu, args.size, runs, vec![[0.0, OFF]], OFF + AFTER)?;
    note!("frames after 1, 4 and 16 seconds");
    let growth = Growth::of(&gpu, args.size, runs)?;
    if let Some(path) = &args.plot {
        let svg = growth.plot().svg("What a frame takes as a sequence goes on")?;
        write_atomically(path, svg.as_bytes())?;
    }
    let pictures = match &args.pictures {
        Some(folder) => pictures::write(&gpu, folder, args.size, comparison.rivals())?,
        None => Vec::new(),
    };
    note!("designs");
    let kinds = [
        ("rgb_1", Bands::Rgb, 1),
        ("rgb_2", Bands::Rgb, 2),
        ("8_1", Bands::Eight, 1),
        ("8_2", Bands::Eight, 2),
    ];
    let designed = kinds.map(|(name, bands, states)| Designed::of(name, bands, states));
    let designed = designed.into_iter().collect::<Result<Vec<_>>>()?;
    note!("light of the past");
    let rivals = PASTS.map(Rivals::after).into_iter().collect::<Result<Vec<_>>>()?;
    let mut figures = Figures::new("phosphor");
    step.set(&mut figures);
    comparison.set(&mut figures);
    growth.set(&mut figures);
    pictures.iter().for_each(|picture| picture.set(&mut figures));
    figures.detail("adapter", json!(gpu.info.name));
    figures.detail("contest", comparison.to_json());
    for of in &designed {
        figures.set(&format!("ms_design_{}", of.name), of.milliseconds);
        figures.set(&format!("design_residual_{}", of.name), of.residual);
        figures.set(&format!("design_residual_grid_{}", of.name), of.of_grid);
    }
    let usual = &designed[0];
    figures.set("ms_design", usual.milliseconds);
    figures.set("design_residual", usual.residual);
    figures.set("design_residual_grid", usual.of_grid);
    if let Some(of) = rivals.iter().find(|of| of.frames == FIGURED_PAST) {
        figures.set("ratio_glassner_one_place", of.drawn / of.step);
    }
    let detail = |of: &Rivals| json!([of.frames, of.step, of.samples, of.drawn, of.error_in_a_step]);
    figures.detail("glassner", rivals.iter().map(detail).collect());
    figures.write(args.json.as_deref())?;
    say!("{}, on {}", step.in_words(), gpu.info.name)?;
    if gpu.is_software() {
        say!("(a software adapter: of milliseconds the order alone means something)")?;
    }
    say!("\n{}", table::aligned(&comparison.rows()))?;
    say!("\n{}", table::aligned(&growth.rows()))?;
    pictures.iter().try_for_each(|picture| say!("{}", picture.path.display()))?;
    say!("\n{}", table::aligned(&design_rows(&designed)))?;
    say!("\n{}", table::aligned(&rival_rows(&rivals)))
}

fn design_rows(designed: &[Designed]) -> Vec<Vec<String>> {
    let head = ["bands and states", "ms", "at most", "residual", "of the thesis' grid"];
    let row = |of: &Designed| {
        let numbers = [format!("{:.1}", of.milliseconds), format!("{:.1}", of.worst)];
        let residuals = [of.residual, of.of_grid].map(|residual| format!("{residual:.5}"));
        std::iter::once(of.name.replace('_', ", ")).chain(numbers).chain(residuals).collect()
    };
    std::iter::once(head.map(str::to_owned).to_vec()).chain(designed.iter().map(row)).collect()
}

fn rival_rows(rivals: &[Rivals]) -> Vec<Vec<String>> {
    let head =
        ["frames", "step, ns", "samples for 1 %", "their time, us", "times a step", "error in a step's time"];
    let row = |of: &Rivals| {
        vec![
            of.frames.to_string(),
            format!("{:.0}", 1e9 * of.step),
            of.samples.to_string(),
            format!("{:.0}", 1e6 * of.drawn),
            format!("{:.0}", of.drawn / of.step),
            format!("{:.2}", of.error_in_a_step),
        ]
    };
    std::iter::once(head.map(str::to_owned).to_vec()).chain(rivals.iter().map(row)).collect()
}

impl Designed {
    fn of(name: &'static str, bands: Bands, states: usize) -> Result<Self> {
        let mut noise = Noise::new(4);
        let (mut times, mut residual, mut of_grid) = (Vec::new(), 0.0, 0.0);
        for _ in 0..PLACES {
            let place = [place(bands, &mut noise)?];
            let start = Instant::now();
            residual += Design::new("designed", &place, states)?.residual;
            times.push(1e3 * start.elapsed().as_secs_f64());
            of_grid += thesis_grid(&place)?;
        }
        let worst = times.iter().copied().fold(0.0, f64::max);
        Ok(Self { name, milliseconds: median(times), worst, residual, of_grid })
    }
}

/// A place under lights that come and go, which should look at some frames as a material does that is drawn
/// at random, each colour off by up to a tenth.
fn place(bands: Bands, noise: &mut Noise) -> Result<TargetPoint> {
    let count = bands.count();
    let phases: Vec<[f64; 2]> = (0..count).map(|_| [0.05 * noise.uniform(), 6.0 * noise.uniform()]).collect();
    let light =
        |frame: usize| phases.iter().map(|[rate, at]| 1.0 + (rate * frame as f64 + at).sin()).collect();
    let irradiance: Vec<Vec<f64>> = (0..FRAMES).map(light).collect();
    let mut amount = |low: f64, octaves: f64| low * (octaves * noise.uniform()).exp2();
    let state = State {
        decay: amount(0.01, 4.0),
        excitation: (0..count).map(|_| amount(0.002, 5.0)).collect(),
        emission: (0..count).map(|_| amount(0.1, 5.0)).collect(),
    };
    let hidden = Material { name: "hidden".to_owned(), bands, doubt: None, states: vec![state] };
    let dt = 0.2;
    let mut run = Simulation::dark(&hidden);
    let mut keys = Vec::new();
    for (frame, light) in irradiance.iter().enumerate() {
        if KEYS.contains(&frame) {
            let radiance = run.emission().iter().map(|sent| sent * (0.9 + 0.2 * noise.uniform())).collect();
            keys.push(Key { frame, radiance });
        }
        run.step(light, dt)?;
    }
    Ok(TargetPoint { bands, dt, irradiance, reflected: vec![], keys })
}

impl Rivals {
    fn after(frames: usize) -> Result<Self> {
        let presets = MaterialFile::presets();
        let material = presets.named("orange").context("a preset")?;
        let mut noise = Noise::new(9);
        let light = |frame: usize| vec![if frame % 90 < 30 { 1e-6 } else { 0.0 }; Bands::Eight.count()];
        let light: Vec<Vec<f64>> = (0..frames).map(light).collect();
        let past = Past { irradiance: &light, dt: 1.0 / 60.0 };
        let mut run = Simulation::dark(material);
        let start = Instant::now();
        for light in &light {
            run.step(light, past.dt)?;
        }
        let step = start.elapsed().as_secs_f64() / frames as f64;
        let samples = past.samples_for(material, QUALITY, DRAWS, &mut noise).round() as usize;
        let start = Instant::now();
        std::hint::black_box(past.sampled(material, samples, &mut noise));
        let drawn = start.elapsed().as_secs_f64();
        let affordable = (step * samples as f64 / drawn).max(1.0);
        Ok(Self {
            frames,
            step,
            samples,
            drawn,
            error_in_a_step: QUALITY * (samples as f64 / affordable).sqrt(),
        })
    }
}
