//! `deepshade render`: the truth of one effect as a picture, for whoever just wants that.
//!
//! Passes double the samples; after each of them the PNG is what is known so far. Samples are in independent
//! scramblings, so that the error of the image is known without another image.

mod picture;

use crate::compare::{default_radius, positive};
use crate::complete::{Wants, complete};
use crate::figures::{Figures, write_atomically};
use crate::report::images::write_png;
use crate::views::{self, View};
use anyhow::{Context, Result, bail};
use clap::builder::RangedU64ValueParser;
use deepshade_dataset::progress;
use deepshade_render::bvh::TracedScene;
use deepshade_render::exr_file::{self, Layer, Metadata};
use deepshade_render::path::estimate::SCRAMBLINGS;
use deepshade_render::path::sampler::MAX_SAMPLES;
use deepshade_render::path::{Estimate, Footprint, Refinement, Shot};
use deepshade_render::scene::{Scene, SceneSource};
use deepshade_shaders::Effect;
use picture::Exposure;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Renders a picture of one effect's truth, refining it before one's eyes.
///
/// Beside an EXR file with the linear values, their variance and where they are from, there is a PNG file to look at,
/// which grows better while the program works. What an effect needs and the scene does not bring (light, a lens, fog)
/// is added, and said.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  deepshade render --scene sponza.gltf --effect path --spp 256 --out sponza.exr\n  \
    deepshade render --scene still-life:3 --effect dof --error 0.02 --out blurred.png"
)]
pub struct Args {
    /// A scene file (.gltf, .glb, .obj) or a procedural family and a seed, such as stairs:7.
    #[arg(long)]
    scene: SceneSource,
    /// What is computed.
    #[arg(long, default_value = "path")]
    effect: Effect,
    /// Samples a pixel, rounded up to a multiple of 8; with --error, the most. By default 256, with --error 16,384.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SAMPLES)))]
    spp: Option<u32>,
    /// Stops once the noise is below this share of the values (the square root of the noise's relative mean squared
    /// error).
    #[arg(long, value_parser = positive)]
    error: Option<f32>,
    /// One of the file's cameras, by its name; by default the first.
    #[arg(long, conflicts_with = "view")]
    camera: Option<String>,
    /// A view sampled in the scene, by its number; 0 by default where the file brings no camera.
    #[arg(long)]
    view: Option<usize>,
    /// An environment map (.hdr, .exr) around the scene.
    #[arg(long)]
    environment: Option<PathBuf>,
    /// The picture: an .exr or .png file; the other of the two is written beside it.
    #[arg(long)]
    out: PathBuf,
    /// Rows.
    #[arg(long, default_value_t = 512, value_parser = RangedU64ValueParser::<usize>::new().range(1..=8192))]
    height: usize,
    /// Columns.
    #[arg(long, default_value_t = 768, value_parser = RangedU64ValueParser::<usize>::new().range(1..=8192))]
    width: usize,
    /// How far effects with a radius reach, metres; by default 10 % of the scene's diagonal.
    #[arg(long, value_parser = positive)]
    radius: Option<f32>,
    /// Radius of the lens, metres.
    #[arg(long, value_parser = positive)]
    aperture: Option<f32>,
    /// Depth that the lens focuses, metres; by default that of what is in the middle of the picture.
    #[arg(long, value_parser = positive)]
    focus: Option<f32>,
    /// Moment of animations, skins and morph targets, seconds.
    #[arg(long, default_value_t = 0.0)]
    time: f32,
    /// How long the shutter is open around that moment, seconds, for motion-blur.
    #[arg(long, default_value_t = 0.04)]
    shutter: f32,
    /// Radiance that becomes 1 in the PNG; by default as the picture's brightness wants it.
    #[arg(long, value_parser = positive)]
    white: Option<f32>,
    /// Chooses sampled views, added lights and samples.
    #[arg(long, default_value_t = 0)]
    seed: u32,
    /// Writes the figures here as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
}

/// Most samples of a pixel by default where an error is asked for.
const MOST_FOR_AN_ERROR: u32 = 16_384;

/// Samples of a pixel and scrambling before the noise's estimate is believed.
const LEAST_FOR_AN_ERROR: u32 = 4;

/// Renders, and writes the picture.
///
/// # Errors
/// If the scene or the environment cannot be read, there is no such camera or view, or a file cannot be written.
pub fn run(args: &Args) -> Result<()> {
    let [exr, png] = files(&args.out)?;
    let size = [args.height, args.width];
    let scene = TracedScene::new(scene(args)?).with_context(|| format!("scene {}", args.scene))?;
    let view = views::one(&scene, size, args.camera.as_deref(), args.view, args.seed)?;
    let wants = Wants {
        effect: args.effect,
        size,
        environment: args.environment.as_deref(),
        aperture: args.aperture,
        focus: args.focus,
        seed: args.seed,
    };
    let completed = complete(&scene, &view.camera, &wants)?;
    let radius = args.radius.unwrap_or_else(|| default_radius(None, completed.scene.diagonal(), size[0]));
    let shot =
        Shot { footprint: Footprint::Box, ..Shot::new(&completed.scene, &completed.camera, size, radius) };
    let start = Instant::now();
    let estimate = refined(args, &shot, &png)?;
    let seconds = start.elapsed().as_secs_f64();

    let exposure = Exposure::new(args.effect, &estimate.mean, args.white);
    write_png(&png, &exposure.picture(&estimate.mean))?;
    write_exr(&exr, args, &view, &completed.added, radius, &estimate)?;
    let mean = estimate.mean.data().iter().map(|value| f64::from(*value)).sum::<f64>()
        / estimate.mean.data().len() as f64;
    let noise = estimate.noise_relmse().unwrap_or(f64::NAN);
    let mut figures = Figures::new("render");
    figures.set("seconds", seconds);
    figures.set("mean", mean);
    figures.set("noise_relmse", noise);
    figures.set("samples", f64::from(estimate.samples));
    figures.detail("effect", json!(args.effect));
    figures.detail("scene", args.scene.to_string().into());
    figures.detail("view_name", view.name.clone().into());
    figures.detail("added", json!(completed.added));
    figures.detail("exposure", json!(exposure.to_string()));
    figures.write(args.json.as_deref())?;
    completed.added.iter().try_for_each(|added| say!("{added}"))?;
    say!(
        "{}: {} ({}), {} samples a pixel in {seconds:.1} s",
        exr.display(),
        args.effect,
        args.effect.unit(),
        estimate.samples
    )?;
    say!("mean {mean:.4}, noise {:.2} % of the values", 100.0 * noise.sqrt())?;
    say!("{}: {exposure}", png.display())
}

/// The EXR and the PNG file of a name with either ending.
fn files(out: &Path) -> Result<[PathBuf; 2]> {
    let ending = out.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase();
    if ending != "exr" && ending != "png" {
        bail!("--out {}: a picture is an .exr or a .png file", out.display());
    }
    Ok(["exr", "png"].map(|kind| if ending == kind { out.to_owned() } else { out.with_extension(kind) }))
}

/// The scene, with what moves while the shutter is open where the effect shows it.
fn scene(args: &Args) -> Result<Scene> {
    let scene = match &args.scene {
        SceneSource::File(path) if args.effect == Effect::MotionBlur => {
            Scene::load_moving(path, args.time, args.shutter)
        }
        source => source.scene(args.time),
    };
    scene.with_context(|| format!("scene {}", args.scene))
}

/// Passes that double the samples, each followed by a preview, until there are enough or the noise is small enough.
fn refined(args: &Args, shot: &Shot<'_>, png: &Path) -> Result<Estimate> {
    let most = args.spp.unwrap_or(if args.error.is_some() { MOST_FOR_AN_ERROR } else { 256 });
    let each = most.div_ceil(SCRAMBLINGS);
    let mut refinement = Refinement::new(args.effect, shot, SCRAMBLINGS, args.seed);
    let pixels = (shot.height * shot.width) as u64;
    let bar = progress::bar(
        "thousand samples",
        (pixels * u64::from(each * SCRAMBLINGS)).div_ceil(1000) as usize,
        0,
    );
    let finished = AtomicU64::new(0);
    let mut taken = 0;
    loop {
        let count = taken.clamp(1, each - taken);
        refinement.refine(
            count,
            |_, _| true,
            |pixels| {
                let samples = pixels as u64 * u64::from(count * SCRAMBLINGS);
                bar.set_position((finished.fetch_add(samples, Ordering::Relaxed) + samples) / 1000);
            },
        );
        taken += count;
        let estimate = refinement.estimate();
        let noise = estimate.noise_relmse().unwrap_or(f64::NAN).sqrt();
        bar.set_message(format!("{} a pixel, noise {:.1} %", estimate.samples, 100.0 * noise));
        let enough = args.error.is_some_and(|error| taken >= LEAST_FOR_AN_ERROR && noise <= f64::from(error));
        if taken == each || enough {
            bar.finish_and_clear();
            return Ok(estimate);
        }
        write_png(png, &Exposure::new(args.effect, &estimate.mean, args.white).picture(&estimate.mean))?;
    }
}

/// Writes the linear values and their variance, with all digits, and where they are from.
fn write_exr(
    path: &Path,
    args: &Args,
    view: &View,
    added: &[String],
    radius: f32,
    estimate: &Estimate,
) -> Result<()> {
    let camera = &view.camera;
    let metadata: Metadata = [
        ("scene", args.scene.to_string()),
        ("view_name", view.name.clone()),
        ("camera_position", camera.position.to_string()),
        ("effect", args.effect.to_string()),
        ("units", args.effect.unit().to_owned()),
        ("radius_metres", radius.to_string()),
        ("samples", estimate.samples.to_string()),
        ("scramblings", SCRAMBLINGS.to_string()),
        ("seed", args.seed.to_string()),
        ("pixel", "box filter".to_owned()),
        ("added", added.join("; ")),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into();
    let mut layers = vec![Layer::image(args.effect.name(), &estimate.mean).in_full()];
    layers.extend(estimate.variance.iter().map(|variance| Layer::image("variance", variance).in_full()));
    write_atomically(path, &exr_file::encode(path, &layers, &metadata)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn either_ending_names_both_files() {
        let both = [PathBuf::from("a/b.exr"), PathBuf::from("a/b.png")];
        assert_eq!(files(Path::new("a/b.exr")).expect("a picture"), both);
        assert_eq!(files(Path::new("a/b.png")).expect("a picture"), both);
        assert_eq!(files(Path::new("a/b.PNG")).expect("a picture")[1], Path::new("a/b.PNG"));
        assert!(files(Path::new("a/b.jpg")).expect_err("no picture").to_string().contains("a/b.jpg"));
    }
}
