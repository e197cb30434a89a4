//! `deepshade compare`: methods against truth on the views of a scene.

use crate::arguments::{check_pixels, positive};
use crate::complete::{Additions, Completed, Wants, complete, listeners};
use crate::exposure_time;
use crate::figures::{self, Figures};
use crate::learned;
use crate::methods::{self, Setup};
use crate::props;
use crate::radius::{self, Space};
use crate::report::{Comparison, FrameReport, MethodReport, TruthReport, check_folder};
use crate::samples;
use crate::views::{self, View};
use anyhow::{Context, Result, ensure};
use clap::builder::RangedU64ValueParser;
use deepshade_dataset::progress;
use deepshade_dataset::truth;
use deepshade_render::bvh::TracedScene;
use deepshade_render::gbuffer;
use deepshade_render::method::{Frame, Method, Repeats};
use deepshade_render::methods::Quality;
use deepshade_render::path::{Estimate, Goal, Shot, Truth};
use deepshade_render::scene::{Density, SceneSource};
use deepshade_shaders::Effect;
use deepshade_shaders::gpu::Gpu;
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;

/// Methods are timed as the median of so many runs.
pub const REPEATS: Repeats = Repeats { warm_up: 2, timed: 11 };

/// Samples of a pixel of truth where none are asked for.
const SAMPLES: u32 = 512;
/// The method that takes minutes where others take seconds.
const SLOW: &str = "aov";

/// Compares methods on a scene: images, errors, milliseconds and a page to look at.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  deepshade compare --scene stairs:7 --out report\n  \
    deepshade compare --scene sponza.gltf --views 3 --methods learned,hbao,truth --out report\n  \
    deepshade compare --scene sponza.gltf --put fox.gltf@-5,0,0,0.01,60 --eye -9,1.6,0 --look-at 0,1.2,0 --out report")]
pub struct Args {
    /// A scene file (.gltf, .glb, .obj) or a procedural family and a seed, such as stairs:7.
    #[arg(long)]
    scene: SceneSource,
    /// What is computed.
    #[arg(long, default_value = "ao")]
    effect: Effect,
    /// Which methods, by default all that compute the effect, `learned` only where there is a network, and not `aov`, which
    /// takes minutes where the radius is large; truth is always rendered, since the others are measured against it.
    #[arg(long, value_delimiter = ',')]
    methods: Vec<String>,
    /// How much time analytic methods may take for a better image: low, medium, high or ultra.
    #[arg(long, default_value = "high")]
    quality: Quality,
    /// Folder of the page and its images.
    #[arg(long)]
    out: PathBuf,
    /// Folder of the network of `learned`; by default models/EFFECT.
    #[arg(long)]
    model: Option<PathBuf>,
    /// Rows of the images.
    #[arg(long, default_value_t = 512, value_parser = RangedU64ValueParser::<usize>::new().range(16..=8192))]
    height: usize,
    /// Columns of the images.
    #[arg(long, default_value_t = 512, value_parser = RangedU64ValueParser::<usize>::new().range(16..=8192))]
    width: usize,
    /// How far the effect reaches, metres. By default a share of the scene's diagonal, divided by N in images N times
    /// as high as those that it is meant for: share and height are those that the network of `learned` was trained with,
    /// else 15 % at 512 rows. In lower images it is more, up to half the diagonal.
    #[arg(long, value_parser = positive)]
    radius: Option<f32>,
    #[command(flatten)]
    props: props::Args,
    #[command(flatten)]
    views: views::Args,
    #[command(flatten)]
    samples: samples::Args,
    #[command(flatten)]
    time: exposure_time::Args,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
    #[command(flatten)]
    additions: Additions,
}

/// How a frame is compared.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// What is computed.
    pub effect: Effect,
    /// Rows.
    pub height: usize,
    /// Columns.
    pub width: usize,
    /// How far the effect reaches, metres.
    pub radius: f32,
    /// When truth has samples enough.
    pub goal: Goal,
    /// Chooses all random numbers.
    pub seed: u32,
    /// How often a method runs.
    pub repeats: Repeats,
}

/// All methods of the effect, but for [`SLOW`], and for `learned` where nobody names a network and none lies where it would.
fn default_methods(args: &Args) -> Vec<&'static str> {
    let mut names = methods::names_of(args.effect);
    let folder = model_folder(args);
    if names.contains(&methods::LEARNED) && args.model.is_none() && !folder.exists() {
        note!("no network in {}: without the method `{}`", folder.display(), methods::LEARNED);
        names.retain(|name| *name != methods::LEARNED);
    }
    names.retain(|name| *name != SLOW);
    names
}

/// Compares, writes the page, prints the table.
pub fn run(args: &Args) -> Result<()> {
    check_pixels(args.height, args.width)?;
    check_folder(&args.out)?;
    listeners::check(args.effect, listeners::RADIUS, &[("--radius", args.radius.is_some())])?;
    let names = if args.methods.is_empty() { default_methods(args) } else { names(&args.methods) };
    methods::check(args.effect, &names)?;
    let model = names
        .contains(&methods::LEARNED)
        .then(|| learned::network(&model_folder(args), Some(args.effect)))
        .transpose()?;
    let gpu = Gpu::new()?;
    let setup = Setup { gpu: &gpu, model: model.as_ref(), quality: args.quality };
    let mut methods = methods::open(args.effect, &names, setup)?;
    let scene = TracedScene::new(args.time.scene(&args.scene, &args.props, args.effect)?)
        .with_context(|| format!("scene {}", args.scene))?;
    let space = Space { diagonal: scene.diagonal(), height: args.height };
    let reach = model.as_ref().map(|model| model.spec.reach);
    let settings = Settings {
        effect: args.effect,
        height: args.height,
        width: args.width,
        radius: radius::wanted(args.radius, reach, &[args.effect], space),
        goal: args.samples.goal(SAMPLES),
        seed: args.views.seed,
        repeats: REPEATS,
    };
    let views = args.views.of(&scene, [args.height, args.width])?;
    let wants = Wants {
        effect: args.effect,
        size: [args.height, args.width],
        additions: &args.additions,
        seed: args.views.seed,
        animated: false,
        time: args.time.time(),
    };
    let completed = views.iter().map(|view| complete(&scene, &view.camera, &wants));
    let completed = completed.collect::<Result<Vec<_>>>()?;
    let added = completed.first().map(|first| first.added.clone()).unwrap_or_default();
    added.iter().for_each(|line| note!("{line}"));
    let is_dark = |completed: &Completed| completed.scene.scene().lights.is_empty();
    if matches!(args.effect, Effect::FogDirect | Effect::FogIndirect) && completed.iter().all(is_dark) {
        note!(
            "the scene has no lamp, and of other light only truth knows in fog: the methods' images are black"
        );
    }
    let fog = completed.iter().filter_map(|completed| completed.scene.scene().medium.as_deref());
    if fog.clone().any(|medium| matches!(medium.density, Density::Grid(_))) {
        methods = methods::through_grids(methods, !args.methods.is_empty(), |method| &**method)?;
    }
    let mut frames = Vec::new();
    let bar = progress::bar("frames", views.len(), 0);
    for (view, completed) in views.iter().zip(completed) {
        bar.set_message(view.name.clone());
        let view = View { camera: completed.camera, ..view.clone() };
        let mut frame = compare_frame(&completed.scene, &view, settings, &methods)?;
        if listeners::MEDIUM.contains(&args.effect) {
            frame.facts.push(("medium".to_owned(), args.additions.medium_in_words()));
        }
        frame.facts.extend(completed.added.into_iter().map(|added| ("added".to_owned(), added)));
        frames.push(frame);
        bar.inc(1);
    }
    bar.finish_and_clear();
    let comparison =
        Comparison { effect: args.effect, quality: args.quality, frames, machine: machine(&gpu) };
    let page = comparison.write(&args.out)?;
    let mut figures = Figures::new("compare");
    comparison.set_figures(&mut figures);
    if listeners::RADIUS.contains(&args.effect) {
        figures.set("radius", f64::from(settings.radius));
    }
    figures.detail("added", json!(added));
    if listeners::MEDIUM.contains(&args.effect) {
        figures.detail("medium", args.additions.medium_in_words().into());
    }
    figures.detail("scene", args.scene.to_string().into());
    figures.detail("quality", args.quality.name().into());
    figures.detail("put", args.props.to_string().into());
    figures.write(args.json.as_deref())?;
    say!("{comparison}{}", page.display())
}

fn names(names: &[String]) -> Vec<&str> {
    names.iter().map(String::as_str).collect()
}

fn model_folder(args: &Args) -> PathBuf {
    args.model.clone().unwrap_or_else(|| learned::usual_folder(args.effect))
}

/// Renders a frame's g-buffer and truth, runs every method on it and scores what they make.
///
/// # Errors
/// If the view sees nothing, or a method fails.
pub fn compare_frame(
    scene: &TracedScene,
    view: &View,
    settings: Settings,
    methods: &[Box<dyn Method>],
) -> Result<FrameReport> {
    let Settings { effect, height, width, radius, seed, repeats, .. } = settings;
    let gbuffer = gbuffer::render(scene, &view.camera, height, width, truth::attributes(effect));
    ensure!(gbuffer.seen()?.contains(&true), "view `{}` sees nothing of the scene", view.name);
    let frame = Frame { scene, camera: &view.camera, gbuffer: &gbuffer, radius, seed };
    let truth = render_truth(&frame, settings);
    let methods = methods
        .iter()
        .map(|method| {
            let shaded = method.shade(&frame, repeats)?;
            Ok(MethodReport {
                name: method.name().to_owned(),
                scores: truth.scores(&shaded.image),
                image: shaded.image,
                milliseconds: shaded.milliseconds,
                clock: shaded.clock,
                device: shaded.device,
            })
        })
        .collect::<Result<_>>()?;
    let facts = facts(scene, view, settings, &truth.truth.estimate);
    Ok(FrameReport { name: view.name.clone(), facts, truth, methods })
}

/// Truth, no brighter than its file can hold.
fn render_truth(frame: &Frame<'_>, settings: Settings) -> TruthReport {
    let Settings { effect, height, width, radius, goal, seed, .. } = settings;
    let shot = Shot::new(frame.scene, frame.camera, [height, width], radius);
    let start = Instant::now();
    let mut truth = Truth::render(effect, &shot, goal, seed, |_, _| true);
    truth.estimate.mean = truth::within_half(truth.estimate.mean);
    TruthReport::new(effect, truth, start.elapsed().as_secs_f64() * 1e3)
}

fn facts(scene: &TracedScene, view: &View, settings: Settings, truth: &Estimate) -> Vec<(String, String)> {
    let position = view.camera.position;
    let radius = || ("radius", radius::in_words(settings.radius, scene.diagonal()));
    let reach = listeners::RADIUS.contains(&settings.effect).then(radius);
    [
        ("scene", scene.scene().name.clone()),
        ("triangles", scene.scene().triangle_count().to_string()),
        ("camera", format!("at ({:.2}, {:.2}, {:.2})", position.x, position.y, position.z)),
        ("truth", format!("{} samples a pixel", truth.samples)),
    ]
    .into_iter()
    .chain(reach)
    .map(|(name, value)| (name.to_owned(), value))
    .collect()
}

/// What everything ran on, as the report shows it.
pub fn machine(gpu: &Gpu) -> Vec<(String, String)> {
    let info = &gpu.info;
    let driver = [&info.driver, &info.driver_info].map(String::as_str).join(" ");
    let adapter = ("adapter".to_owned(), format!("{}, {}, {}", info.name, info.backend, driver.trim()));
    let text = |value: &serde_json::Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    let machine = figures::machine();
    let rest = machine.as_object().into_iter().flatten().map(|(name, value)| (name.clone(), text(value)));
    [adapter].into_iter().chain(rest).collect()
}
