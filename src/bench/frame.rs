//! `deepshade bench frame`: milliseconds of every pass of a live frame, frames a second, and whether memory
//! stays what it is.

use crate::arguments::Size;
use crate::complete::Additions;
use crate::figures::{Figures, memory};
use crate::learned::{self, Learned};
use crate::live::animated_view::{self, ViewRequest};
use crate::live::{Live, LiveSettings};
use crate::location::Location;
use crate::methods::{self, LEARNED};
use crate::props;
use crate::radius;
use crate::views::Viewpoint;
use anyhow::{Context, Result, ensure};
use deepshade_dataset::progress;
use deepshade_render::methods::Quality;
use deepshade_render::scene::SceneSource;
use deepshade_render::screen::ScreenMethod;
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{Attribute, Effect, lists};
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;

/// Frames that are made before anything is measured.
const WARM_UP: u32 = 5;

/// Measures a live frame: its passes, frames a second, memory.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  deepshade bench frame --json frame.json\n  \
    deepshade bench frame --scene sponza.gltf --put fox.gltf@-5,0,0,0.01,60 --sizes 1280x720,1920x1080 \
    --methods ao:gtao,aa:fxaa\n\n\
    ms_PASS in the JSON file is of the first size, fps_720p of the one with 720 rows; details has those of all. memory_growth_mb is by how much \
    the program's memory grows from the frames before the measurement to its end. What a driver needs within a frame stays the \
    program's once it was asked for: on lavapipe that swings by 40 MB with what is seen, so a few steps of some MB are none of \
    a leak's; growth that goes on with --frames is.")]
pub struct Args {
    /// A scene file (.gltf, .glb, .obj, .ply) or a procedural family and a seed, such as stairs:7.
    #[arg(long, default_value = "colonnade:1")]
    scene: SceneSource,
    /// Sizes of the image.
    #[arg(long, value_delimiter = ',', default_value = "1280x720,1920x1080")]
    sizes: Vec<Size>,
    /// What runs on each frame: EFFECT:METHOD; a network is EFFECT:learned. By default the first method of
    /// every effect that has one that works on the screen.
    #[arg(long, value_delimiter = ',', value_parser = method)]
    methods: Vec<(Effect, String)>,
    /// Folder, address or name of the network of `learned`; by default models/EFFECT, else the program's own.
    #[arg(long, value_parser = crate::learned::place)]
    model: Option<Location>,
    /// How much time methods may take for a better image: low, medium, high or ultra.
    #[arg(long, default_value = "medium")]
    quality: Quality,
    /// Moment of the first frame, seconds.
    #[arg(long, default_value_t = 0.0)]
    time: f32,
    #[command(flatten)]
    props: props::Args,
    #[command(flatten)]
    viewpoint: Viewpoint,
    /// How long the shutter is open around a frame's moment, seconds.
    #[arg(long, default_value_t = 0.04, value_parser = crate::arguments::positive)]
    shutter: f32,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
    #[command(flatten)]
    motion: animated_view::Args,
}

/// Reads EFFECT:METHOD.
fn method(text: &str) -> Result<(Effect, String), String> {
    let (effect, method) = text.split_once(':').ok_or("expected EFFECT:METHOD, such as ao:hbao")?;
    Ok((effect.parse()?, method.to_owned()))
}

/// What was measured at one size.
struct FrameTimes {
    size: Size,
    /// Median and 95th percentile of each pass, milliseconds.
    passes: Vec<(String, f64, f64)>,
    /// Of whole frames, by the wall clock.
    frames_a_second: f64,
    /// Megabytes; `None` where the system does not say.
    growth: Option<f64>,
}

/// Measures and prints.
///
/// # Errors
/// If the scene cannot be read, a method does not exist, or the device fails.
pub fn run(args: &Args) -> Result<()> {
    let gpu = Gpu::new()?;
    let measured: Vec<FrameTimes> =
        args.sizes.iter().map(|size| measure(args, &gpu, *size)).collect::<Result<_>>()?;
    let mut figures = Figures::new("bench frame");
    let first = measured.first().context("--sizes names no size")?;
    for (name, median, _) in &first.passes {
        figures.set(&format!("ms_{}", name.replace('-', "_")), *median);
    }
    let hd = measured.iter().find(|measured| measured.size.height == 720);
    hd.iter().for_each(|measured| figures.set("fps_720p", measured.frames_a_second));
    let growth = measured.iter().filter_map(|measured| measured.growth).reduce(f64::max);
    growth.iter().for_each(|growth| figures.set("memory_growth_mb", *growth));
    let sizes = measured.iter().map(|measured| {
        let passes: serde_json::Map<_, _> = measured
            .passes
            .iter()
            .map(|(name, median, p95)| (name.clone(), json!({ "median": median, "p95": p95 })))
            .collect();
        let fps = measured.frames_a_second;
        json!({ "size": measured.size.to_string(), "passes": passes, "frames_a_second": fps, "memory_growth_mb": measured.growth })
    });
    figures.detail("sizes", sizes.collect());
    figures.detail("scene", json!(args.scene.to_string()));
    figures.detail("adapter", json!(gpu.info.name));
    figures.detail("frames", json!(args.motion.frames()));
    figures.detail("quality", json!(args.quality.name()));
    figures.write(args.json.as_deref())?;
    measured.iter().try_for_each(print)
}

fn measure(args: &Args, gpu: &Gpu, size: Size) -> Result<FrameTimes> {
    let rows_and_columns = [size.height, size.width];
    let chosen = chosen(args);
    let effects: Vec<Effect> = chosen.iter().map(|(effect, _)| *effect).chain([Effect::Aa]).collect();
    let request = ViewRequest {
        source: &args.scene,
        time: args.time,
        effects: &effects,
        size: rows_and_columns,
        props: &args.props,
        viewpoint: &args.viewpoint,
        additions: &Additions::default(),
        seed: 0,
        learned: None,
    };
    let animated_view = args.motion.open(&request)?;
    let (methods, learned) = opened(args, &chosen, gpu)?;
    let reach = learned.as_ref().map(|learned| learned.spec().reach);
    let wanted = LiveSettings {
        size: rows_and_columns,
        methods,
        learned,
        attributes: vec![Attribute::Light, Attribute::Valid],
        temporal: false,
        radius: radius::wanted(None, reach, &effects, animated_view.space()),
        shutter: args.shutter,
    };
    let mut live = Live::new(gpu, &animated_view.animated, &animated_view.camera, wanted)?;
    let bar = progress::bar("frames", args.motion.frames() as usize, 0);
    for frame in 0..WARM_UP {
        live.make(animated_view.time(frame, args.time), frame, &animated_view.camera(frame))?;
    }
    let before = memory();
    let start = Instant::now();
    let mut times = Vec::new();
    for frame in 0..args.motion.frames() {
        times.extend(live.make(animated_view.time(frame, args.time), frame, &animated_view.camera(frame))?);
        bar.inc(1);
    }
    times.extend(live.finish()?);
    let seconds = start.elapsed().as_secs_f64();
    ensure!(!times.is_empty(), "the GPU's clock told of no frame: --frames asks for too few");
    bar.finish_and_clear();
    let passes = live.passes().into_iter().enumerate().map(|(pass, name)| {
        let of_pass: Vec<f64> = times.iter().map(|times| times[pass]).collect();
        (name, lists::median(of_pass.clone()), lists::quantile(of_pass, 0.95))
    });
    Ok(FrameTimes {
        size,
        passes: passes.collect(),
        frames_a_second: f64::from(args.motion.frames()) / seconds,
        growth: memory().zip(before).map(|(after, before)| after - before),
    })
}

/// The methods asked for, or one of each effect.
fn chosen(args: &Args) -> Vec<(Effect, String)> {
    let first = |effect: Effect| Some((effect, (*methods::screen_names(effect).first()?).to_owned()));
    match args.methods.as_slice() {
        [] => Effect::ALL.into_iter().filter_map(first).collect(),
        asked => asked.to_vec(),
    }
}

/// What runs on each frame: methods that work on the screen, and a network.
type Opened = (Vec<ScreenMethod>, Option<Learned>);

fn opened(args: &Args, chosen: &[(Effect, String)], gpu: &Gpu) -> Result<Opened> {
    let (networks, others): (Vec<_>, Vec<_>) = chosen.iter().partition(|(_, name)| name == LEARNED);
    ensure!(networks.len() <= 1, "--methods names several networks, of which a frame has one");
    ensure!(
        args.model.is_none() || !networks.is_empty(),
        "--model means nothing without a method EFFECT:{LEARNED}"
    );
    let open = |(effect, name): &(Effect, String)| methods::open_screen(*effect, name, gpu, args.quality);
    let learned = networks.first().map(|(effect, _)| {
        let usual = || Location::Folder(learned::usual_folder(*effect));
        let folder = args.model.clone().unwrap_or_else(usual).read()?;
        anyhow::Ok(Learned::new(gpu, &learned::network(&folder, Some(*effect))?)?)
    });
    Ok((others.into_iter().map(open).collect::<Result<_>>()?, learned.transpose()?))
}

fn print(measured: &FrameTimes) -> Result<()> {
    say!("{}: {:.1} frames a second", measured.size, measured.frames_a_second)?;
    for (name, median, p95) in &measured.passes {
        say!("  {name:<16} {median:>9.3} ms   p95 {p95:>9.3} ms")?;
    }
    match measured.growth {
        Some(growth) => say!("  memory grew by {growth:.1} MB"),
        None => Ok(()),
    }
}
