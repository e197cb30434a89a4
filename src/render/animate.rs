//! `deepshade render --animate`: a sequence of images by a method that runs live, a PNG file a frame.

use super::Args;
use super::picture::Exposure;
use crate::arguments::check_pixels;
use crate::complete::listeners;
use crate::figures::Figures;
use crate::learned::{self, Learned};
use crate::live::animated_view::{AnimatedView, ViewRequest};
use crate::live::{Live, LiveSettings};
use crate::location::Location;
use crate::methods::{self, LEARNED};
use crate::radius;
use crate::report::images::write_png;
use anyhow::{Context, Result, bail, ensure};
use clap::builder::RangedU64ValueParser;
use deepshade_dataset::progress;
use deepshade_render::methods::Quality;
use deepshade_render::metrics::{exposed, exposure};
use deepshade_render::screen::ScreenMethod;
use deepshade_render::screen::reprojection::ReprojectionParameters;
use deepshade_render::screen::reprojection::reference::{Two, flicker};
use deepshade_shaders::effect::EffectSetting;
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{Attribute, Effect, Planes, lists};
use serde_json::json;
use std::path::{Path, PathBuf};

/// A sequence instead of a picture.
#[derive(clap::Args)]
#[command(next_help_heading = "Animation")]
pub struct Sequence {
    /// Renders a sequence of images on the GPU by a live method, a PNG file a frame in the folder --out,
    /// instead of one picture of truth.
    ///
    /// In the end it says what each pass took, milliseconds (median), and how much a method's images flicker:
    /// the mean change of what is seen of a surface from one frame to the next, camera and scene having moved
    /// on, as a share of white (a value of 1 of the image under one exposure). 0 is calm, smaller is better;
    /// --temporal makes it smaller.
    #[arg(long)]
    animate: bool,
    /// What computes the images, of --effect, by default its first method on the GPU (fog-direct:
    /// volume-shell, gpu-epipolar, gpu-march or froxel); `light` is direct light alone, the default where
    /// --effect has no method that runs live.
    #[arg(long)]
    method: Option<String>,
    /// How much time the method may take for a better image: low, medium, high or ultra; high by default.
    #[arg(long)]
    quality: Option<Quality>,
    /// Folder, address or name of the network of the method `learned`; by default models/EFFECT, else the
    /// program's own.
    #[arg(long, value_parser = crate::learned::place)]
    model: Option<Location>,
    /// Mixes each image with what the frames before made of the same surfaces.
    #[arg(long)]
    temporal: bool,
    /// Writes every so-manieth frame; all by default.
    #[arg(long, value_parser = RangedU64ValueParser::<u32>::new().range(1..))]
    every: Option<u32>,
    #[command(flatten)]
    motion: crate::live::animated_view::Args,
}

impl Sequence {
    /// Whether a sequence is asked for.
    pub const fn is_wanted(&self) -> bool {
        self.animate
    }

    /// The first option that is given, beside the wish itself.
    pub fn given(&self) -> Option<&'static str> {
        let options = [
            ("--method", self.method.is_some()),
            ("--quality", self.quality.is_some()),
            ("--model", self.model.is_some()),
            ("--temporal", self.temporal),
            ("--every", self.every.is_some()),
        ];
        let own = options.into_iter().find_map(|(option, given)| given.then_some(option));
        own.or_else(|| self.motion.given())
    }

    /// The method for an effect.
    fn method(&self, effect: Effect) -> &str {
        let first = || methods::screen_names(effect).first().copied().unwrap_or(LIGHT);
        self.method.as_deref().unwrap_or_else(first)
    }
}

/// The name of direct light, which every frame has.
const LIGHT: &str = "light";

/// What is shown, and where of a live scene it is.
struct FrameContent {
    effect: Effect,
    /// Direct light is an attribute, other images are a method's.
    attribute: Option<Attribute>,
}

/// Renders and writes the sequence.
///
/// # Errors
/// If a scene cannot be read, the method does not exist or cannot run, or a file cannot be written.
pub fn run(args: &Args) -> Result<()> {
    let sequence = &args.sequence;
    check(args)?;
    let folder = folder(args)?;
    let size = [args.height, args.width];
    let gpu = Gpu::new()?;
    let direct = sequence.method(args.effect) == LIGHT;
    // Direct light is what anti-aliasing shows, too.
    let effect = if direct { Effect::Aa } else { args.effect };
    let (methods, learned) = opened(args, &gpu)?;
    let request = ViewRequest {
        source: &args.scene,
        time: args.time.time(),
        effects: &[effect],
        size,
        props: &args.props,
        viewpoint: &args.viewpoint,
        additions: &args.additions,
        seed: args.seed,
        learned: learned.as_ref().and_then(|learned| learned.spec().environment.as_ref()),
    };
    let animated_view = sequence.motion.open(&request)?;
    animated_view.added.iter().for_each(|line| note!("{line}"));
    let reach = learned.as_ref().map(|learned| learned.spec().reach);
    let radius = radius::wanted(args.radius, reach, &[effect], animated_view.space());
    let wanted = LiveSettings {
        size,
        methods,
        learned,
        attributes: if direct { vec![Attribute::Light, Attribute::Valid] } else { vec![Attribute::Valid] },
        temporal: sequence.temporal,
        radius,
        shutter: args.time.shutter(),
    };
    let mut live = Live::new(&gpu, &animated_view.animated, &animated_view.camera, wanted)?;
    // Only now, when nothing but writing can fail any more.
    for frame in earlier_frames(&folder)? {
        std::fs::remove_file(&frame).with_context(|| frame.display().to_string())?;
    }
    let shown = FrameContent { effect, attribute: direct.then_some(Attribute::Light) };
    let report = write_sequence(args, &mut live, &animated_view, &shown, &folder)?;
    let mut figures = Figures::new("render");
    for (name, milliseconds) in &report.passes {
        figures.set(&format!("ms_{}", name.replace('-', "_")), *milliseconds);
    }
    figures.set("frames", f64::from(sequence.motion.frames()));
    if let Some(flicker) = report.flicker {
        figures.set("flicker", flicker);
    }
    figures.detail("scene", json!(args.scene.to_string()));
    figures.detail("method", json!(sequence.method(args.effect)));
    figures.detail("effect", json!(effect.name()));
    figures.detail("quality", json!(sequence.quality.unwrap_or_default().name()));
    figures.detail("size", json!(size));
    figures.detail("radius_metres", json!(radius));
    figures.detail("temporal", json!(sequence.temporal));
    figures.detail("adapter", json!(gpu.info.name));
    figures.detail("added", json!(animated_view.added));
    figures.write(args.json.as_deref())?;
    for (name, milliseconds) in &report.passes {
        say!("{name:<12} {milliseconds:>9.3} ms")?;
    }
    if let Some(flicker) = report.flicker {
        say!(
            "flicker {flicker:.5}: by so much, of white, a point of a surface changes from a frame to the next on average; \
             0 is calm"
        )?;
    }
    say!("{}", folder.display())
}

/// What a sequence took and how calm it is.
struct Report {
    /// Median milliseconds of each pass.
    passes: Vec<(String, f64)>,
    /// Mean change of surfaces from frame to frame, of exposed images; `None` of direct light and of a single
    /// frame.
    flicker: Option<f64>,
}

fn write_sequence(
    args: &Args,
    live: &mut Live,
    animated_view: &AnimatedView,
    shown: &FrameContent,
    folder: &Path,
) -> Result<Report> {
    let (every, frames) = (args.sequence.every.unwrap_or(1), args.sequence.motion.frames());
    let bar = progress::bar("frames", frames as usize, 0);
    let mut times: Vec<Vec<f64>> = Vec::new();
    let (mut look, mut before, mut flickers) = (None, None::<(Planes, Planes)>, Vec::new());
    for frame in 0..frames {
        let time = animated_view.time(frame, args.time.time());
        times.extend(live.make(time, args.seed.wrapping_add(frame), &animated_view.camera(frame))?);
        if frame == 0
            && let Some(warning) = live.outside()?
        {
            note!("first frame: {warning}");
        }
        let image = match shown.attribute {
            Some(attribute) => live.attribute(attribute)?,
            None => live.image(0)?,
        };
        // One exposure for the whole sequence, that of its first frame.
        let (white, scale) = look.get_or_insert_with(|| {
            (Exposure::new(shown.effect, &image, args.white), exposure(shown.effect, &image))
        });
        if frame % every == 0 {
            write_png(
                &folder.join(format!("{frame:05}.png")),
                &white.picture(&image, args.eyes(&animated_view.camera(frame), frame).as_ref()),
            )?;
        }
        if shown.attribute.is_none() {
            let since = live.since_before()?;
            let exposed = exposed(&image, *scale);
            if let Some((last, last_since)) = &before {
                let two = Two { since_before: &since, since_before_that: last_since };
                flickers.push(flicker(
                    two,
                    &exposed,
                    last,
                    ReprojectionParameters::default().depth_tolerance,
                ));
            }
            before = Some((exposed, since));
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    times.extend(live.finish()?);
    let medians = live.passes().into_iter().enumerate().filter_map(|(pass, name)| {
        let of_pass: Vec<f64> = times.iter().map(|times| times[pass]).collect();
        (!of_pass.is_empty()).then(|| (name, lists::median(of_pass)))
    });
    let count = flickers.len();
    let flicker = (count > 0).then(|| flickers.iter().sum::<f64>() / count as f64);
    Ok(Report { passes: medians.collect(), flicker })
}

/// The folder that frames go to.
fn folder(args: &Args) -> Result<PathBuf> {
    let folder = args
        .out
        .clone()
        .unwrap_or_else(|| format!("{}-{}", args.effect, args.sequence.method(args.effect)).into());
    if let Some(ending) = folder.extension().and_then(|ending| ending.to_str()) {
        let is_file = ["exr", "png"].iter().any(|file| ending.eq_ignore_ascii_case(file));
        ensure!(!is_file, "--out {}: a sequence goes into a folder", folder.display());
    }
    if folder.exists() && !folder.is_dir() {
        bail!("--out {} is no folder", folder.display());
    }
    earlier_frames(&folder)?;
    Ok(folder)
}

/// The frames of an earlier sequence in a folder, which may hold nothing else.
fn earlier_frames(folder: &Path) -> Result<Vec<PathBuf>> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Ok(Vec::new()) };
    let paths: Vec<PathBuf> =
        entries.map(|entry| entry.map(|entry| entry.path())).collect::<Result<_, _>>()?;
    let is_frame = |path: &Path| {
        let stem = path.file_stem().and_then(|stem| stem.to_str()).unwrap_or_default();
        path.extension().is_some_and(|ending| ending == "png")
            && stem.len() >= 5
            && stem.bytes().all(|byte| byte.is_ascii_digit())
    };
    if let Some(other) = paths.iter().find(|path| !is_frame(path)) {
        bail!("--out {} holds {}, which is no frame of a sequence", folder.display(), other.display());
    }
    Ok(paths)
}

/// Whether all that is given means something to a sequence.
fn check(args: &Args) -> Result<()> {
    check_pixels(args.height, args.width)?;
    let truth = [("--spp", args.samples.spp().is_some()), ("--error", args.samples.error().is_some())];
    let part = [("--part", args.part != "all")];
    let light = args.sequence.method(args.effect) == LIGHT;
    let learned = args.sequence.method(args.effect) == LEARNED;
    for (option, given) in truth.iter().chain(&part) {
        ensure!(!given, "{option} is for truth and means nothing to --animate");
    }
    for (option, given, method) in [
        ("--temporal", light && args.sequence.temporal, "direct light"),
        ("--quality", (light || learned) && args.sequence.quality.is_some(), "direct light or a network"),
        ("--model", !learned && args.sequence.model.is_some(), "any method but `learned`"),
    ] {
        ensure!(!given, "{option} means nothing to {method}; --method names what computes images");
    }
    ensure!(
        args.time.shutter() >= 0.0 && args.time.shutter().is_finite(),
        "--shutter {}: a shutter is open for 0 seconds or more",
        args.time.shutter()
    );
    if !light {
        listeners::check(args.effect, EffectSetting::Radius, &[("--radius", args.radius.is_some())])?;
    }
    args.time.check(if light { Effect::Aa } else { args.effect })
}

/// A method on the screen, or a network, or neither.
type Opened = (Vec<ScreenMethod>, Option<Learned>);

/// The method that is asked for.
fn opened(args: &Args, gpu: &Gpu) -> Result<Opened> {
    let Sequence { quality, model, .. } = &args.sequence;
    match args.sequence.method(args.effect) {
        LIGHT => Ok((Vec::new(), None)),
        LEARNED => {
            let usual = || Location::Folder(learned::usual_folder(args.effect));
            let folder = model.clone().unwrap_or_else(usual).read()?;
            let model = learned::network(&folder, Some(args.effect))?;
            Ok((Vec::new(), Some(Learned::new(gpu, &model)?)))
        }
        name => Ok((vec![methods::open_screen(args.effect, name, gpu, quality.unwrap_or_default())?], None)),
    }
}
