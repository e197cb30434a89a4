//! `deepshade render`: the truth of one effect as a picture, for whoever just wants that.
//!
//! Passes double the samples; after each of them the PNG is what is known so far. Samples are in independent
//! scramblings, so that the error of the image is known without another image.

mod animate;
pub mod picture;

use crate::arguments::{check_pixels, positive, reach};
use crate::complete::{Additions, Completed, Wants, complete, listeners, remembered};
use crate::exposure_time;
use crate::figures::{Figures, write_atomically};
use crate::props;
use crate::radius::{self, Space};
use crate::report::images::write_png;
use crate::samples;
use crate::views::{View, Viewpoint};
use anyhow::{Context, Result, bail};
use clap::builder::RangedU64ValueParser;
use deepshade_dataset::progress;
use deepshade_render::bvh::TracedScene;
use deepshade_render::exr_file::{self, Layer, Metadata};
use deepshade_render::metrics::{exposed, exposure, ssim};
use deepshade_render::path::estimate::SCRAMBLINGS;
use deepshade_render::path::{Estimate, Footprint, LightPart, Shot, Truth};
use deepshade_render::scene::{Camera, Lens, SceneSource};
use deepshade_render::scotopic::Scotopic;
use deepshade_shaders::Effect;
use deepshade_shaders::effect::EffectSetting;
use picture::Exposure;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Renders a picture of one effect's truth, refining it before one's eyes.
///
/// Beside an EXR file with the linear values, their variance and where they are from, there is a PNG file to
/// look at, which grows better while the program works. What an effect needs and the scene does not bring
/// (light, a lens, fog) is added, and said. It is seen from the file's first camera, unless --camera, --view
/// or --eye says from where. Where the file has none a place is seen from a sampled view, and anything else
/// from outside.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  deepshade render --scene sponza.gltf --effect path --spp 256 --out sponza.exr\n  \
    deepshade render --scene still-life:1 --view 2 --effect dof --error 0.02 --out blurred.png\n  \
    deepshade render --scene hall.gltf --effect path --medium smoke.vol --extinction 2\n  \
    deepshade render --scene hall.gltf --effect fog-direct --medium clouds.toml --extinction 2 --time 1.5\n  \
    deepshade render --scene room:7 --effect phosphor --time 5 --spp 16 --scotopic\n  \
    deepshade render --scene hall.gltf --effect phosphor --phosphor glow.toml --time 8\n  \
    deepshade render --animate --scene hall.gltf --put fox.gltf@-5,0,0,0.01,60 --eye -9,1.6,0 \
    --look-at 0,1.2,0 --effect ao --method hbao --temporal --frames 50 --out sequence"
)]
pub struct Args {
    /// A scene file (.gltf, .glb, .obj, .ply) or a procedural family and a seed, such as stairs:7.
    #[arg(long)]
    scene: SceneSource,
    /// What is computed: ao, do, gi, glossy, ibl, occluded-ibl, sss, subsurface, dof, motion-blur, aa, multi,
    /// fog-direct, fog-indirect, fog-multiple, phosphor, phosphor-gi, real or path; the book says what each
    /// is.
    #[arg(long, default_value = "path")]
    effect: Effect,
    /// Which of the effect's light: of path emitted, direct, first-indirect (after one bounce) or rest.
    #[arg(long, default_value = "all")]
    part: String,
    #[command(flatten)]
    samples: samples::Args,
    #[command(flatten)]
    props: props::Args,
    #[command(flatten)]
    viewpoint: Viewpoint,
    /// The picture: an .exr or .png file; the other of the two is written beside it. By default
    /// SCENE-EFFECT.exr.
    #[arg(long)]
    out: Option<PathBuf>,
    /// Rows.
    #[arg(long, default_value_t = 512, value_parser = RangedU64ValueParser::<usize>::new().range(1..=8192))]
    height: usize,
    /// Columns.
    #[arg(long, default_value_t = 768, value_parser = RangedU64ValueParser::<usize>::new().range(1..=8192))]
    width: usize,
    /// How far effects with a radius reach, metres, or inf; by default 3 % of the scene's diagonal, and at
    /// most a quarter of the median depth of what is seen; of a network of --animate the share of the
    /// diagonal that it states.
    #[arg(long, value_parser = reach)]
    radius: Option<f32>,
    #[command(flatten)]
    time: exposure_time::Args,
    /// Radiance that becomes 1 in the PNG; by default as the picture's brightness wants it.
    #[arg(long, value_parser = positive)]
    white: Option<f32>,
    /// Shows the PNG as eyes in the dark see it: bluish, blurred, noisy; by how much, from 0 (day) to 1
    /// (night). The blur is of visual angle: pictures of few rows, of which a pixel is coarser, have none.
    #[arg(long, num_args = 0..=1, default_missing_value = "1", value_parser = crate::arguments::within(0.0..=1.0))]
    scotopic: Option<f32>,
    /// Chooses sampled views, added lights and samples.
    #[arg(long, default_value_t = 0)]
    seed: u32,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
    #[command(flatten)]
    additions: Additions,
    #[command(flatten)]
    sequence: animate::Sequence,
}

impl Args {
    /// The eyes that are asked for, of a frame of a sequence.
    fn eyes(&self, camera: &Camera, frame: u32) -> Option<Scotopic> {
        let seed = self.seed.wrapping_add(frame);
        self.scotopic.map(|share| Scotopic::slight(share, camera, self.height, seed))
    }
}

/// Samples of a pixel where none are asked for.
const SAMPLES: u32 = 256;

/// Renders, and writes the picture.
///
/// # Errors
/// If the scene or the environment cannot be read, there is no such camera or view, or a file cannot be
/// written.
pub fn run(args: &Args) -> Result<()> {
    if args.sequence.is_wanted() {
        return animate::run(args);
    }
    if let Some(option) = args.sequence.given() {
        bail!("{option} means nothing without --animate");
    }
    let [exr, png] = files(args)?;
    check_pixels(args.height, args.width)?;
    let part = LightPart::named(&args.part, args.effect).map_err(anyhow::Error::msg)?;
    listeners::check(args.effect, EffectSetting::Radius, &[("--radius", args.radius.is_some())])?;
    let size = [args.height, args.width];
    let scene = args.time.scene(&args.scene, &args.props, args.effect)?;
    let scene = TracedScene::new(scene).with_context(|| format!("scene {}", args.scene))?;
    let view = args.viewpoint.of(&args.scene, &scene, size, args.seed)?;
    let wants = Wants {
        effect: args.effect,
        size,
        additions: &args.additions,
        seed: args.seed,
        learned: None,
        animated: false,
        time: args.time.time(),
    };
    let mut completed = complete(&scene, &view.camera, &wants)?;
    if completed.scene.scene().glow.is_some() {
        completed.scene = remembered(completed.scene, &args.scene, &args.props)?;
    }
    let space = Space::seen(&completed.scene, &completed.camera, size);
    let radius = radius::wanted(args.radius, None, &[args.effect], space);
    let shot = Shot {
        footprint: Footprint::Box,
        part,
        ..Shot::new(&completed.scene, &completed.camera, size, radius)
    };
    let start = Instant::now();
    let Truth { estimate, halves } = refined(args, &shot, &png)?;
    let seconds = start.elapsed().as_secs_f64();

    let tone = Exposure::new(args.effect, &estimate.mean, args.white);
    let provenance = provenance(args, part, &view, &completed, radius, estimate.samples);
    write_png(&png, &tone.picture(&estimate.mean, args.eyes(shot.camera, 0).as_ref()))?;
    write_exr(&exr, args.effect, &estimate, &provenance)?;
    let exposure = exposure(args.effect, &estimate.mean);
    let noise = estimate.noise_relmse(exposure).unwrap_or(f64::NAN);
    let mut figures = Figures::new("render");
    figures.set("seconds", seconds);
    figures.set("mean", estimate.mean.mean());
    figures.set("noise_relmse", noise);
    figures.set("ssim_ceiling", ssim(&exposed(&halves[0], exposure), &exposed(&halves[1], exposure)));
    figures.set("samples", f64::from(estimate.samples));
    figures.detail("provenance", json!(provenance));
    figures.detail("tone", json!(tone.to_string()));
    figures.write(args.json.as_deref())?;
    if let Some(complaint) = samples::complaint(args.samples.goal(SAMPLES), noise) {
        note!("{complaint}");
    }
    completed.added.iter().try_for_each(|added| say!("{added}"))?;
    say!(
        "{}: {} ({}), {} samples a pixel in {seconds:.1} s",
        exr.display(),
        args.effect,
        args.effect.unit(),
        estimate.samples
    )?;
    say!("mean {:.4}, noise {:.2} % of the values", estimate.mean.mean(), 100.0 * noise.sqrt())?;
    say!("{}: {tone}", png.display())
}

/// The EXR and the PNG file of a name with either ending; without a name, of the scene's and the effect's.
fn files(args: &Args) -> Result<[PathBuf; 2]> {
    let name = match &args.scene {
        SceneSource::File(path) => path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        SceneSource::Procedural(family, seed) => format!("{}-{seed}", family.name()),
    };
    let out = args.out.clone().unwrap_or_else(|| format!("{name}-{}.exr", args.effect).into());
    both_endings(&out)
}

fn both_endings(out: &Path) -> Result<[PathBuf; 2]> {
    let ending = out.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase();
    if ending != "exr" && ending != "png" {
        bail!("--out {}: a picture is an .exr or a .png file", out.display());
    }
    Ok(["exr", "png"].map(|kind| if ending == kind { out.to_owned() } else { out.with_extension(kind) }))
}

/// Refines the picture until there are samples enough or its noise is small enough; the PNG shows what is
/// known so far.
fn refined(args: &Args, shot: &Shot<'_>, png: &Path) -> Result<Truth> {
    let goal = args.samples.goal(SAMPLES);
    let pixels = (shot.height * shot.width) as u64;
    let thousands = (pixels * u64::from(goal.samples.next_multiple_of(SCRAMBLINGS))).div_ceil(1000);
    let bar = progress::bar("thousand samples", thousands as usize, 0);
    let taken = AtomicU64::new(0);
    let finished = |samples: u32, pixels: usize| {
        let new = pixels as u64 * u64::from(samples);
        bar.set_position((taken.fetch_add(new, Ordering::Relaxed) + new) / 1000);
    };
    let truth = Truth::refine(args.effect, shot, goal, args.seed, finished, |estimate| {
        let noise = estimate.noise_relmse(exposure(args.effect, &estimate.mean)).unwrap_or(f64::NAN).sqrt();
        bar.set_message(format!("{} a pixel, noise {:.1} %", estimate.samples, 100.0 * noise));
        write_png(
            png,
            &Exposure::new(args.effect, &estimate.mean, args.white)
                .picture(&estimate.mean, args.eyes(shot.camera, 0).as_ref()),
        )
    })?;
    bar.finish_and_clear();
    Ok(truth)
}

/// All that the picture is from, as name and value.
fn provenance(
    args: &Args,
    part: LightPart,
    view: &View,
    Completed { camera, added, .. }: &Completed,
    radius: f32,
    samples: u32,
) -> Metadata {
    let environment = args.additions.environment.as_ref();
    let environment = environment.map_or("none".to_owned(), |path| path.display().to_string());
    let lens = camera
        .lens
        .map_or("pinhole".to_owned(), |Lens { radius, focus }| format!("radius {radius} m, focus {focus} m"));
    [
        ("scene", args.scene.to_string()),
        ("put", args.props.to_string()),
        ("time", args.time.to_string()),
        ("view_name", view.name.clone()),
        ("camera_position", camera.position.to_string()),
        ("camera_rotation", camera.rotation.to_string()),
        ("camera_vertical_fov", format!("{} radians", camera.vertical_fov)),
        ("lens", lens),
        ("environment", environment),
        ("medium", args.additions.medium_in_words()),
        ("effect", args.effect.to_string()),
        ("part", part.to_string()),
        ("units", args.effect.unit().to_owned()),
        ("radius_metres", radius.to_string()),
        ("samples", samples.to_string()),
        ("scramblings", SCRAMBLINGS.to_string()),
        ("seed", args.seed.to_string()),
        ("pixel", "box filter".to_owned()),
        ("added", added.join("; ")),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into()
}

/// Writes the linear values and their variance, with all digits, and where they are from.
fn write_exr(path: &Path, effect: Effect, estimate: &Estimate, provenance: &Metadata) -> Result<()> {
    let mut layers = vec![Layer::image(effect.name(), &estimate.mean).in_full()];
    layers.extend(estimate.variance.iter().map(|variance| Layer::image("variance", variance).in_full()));
    write_atomically(path, &exr_file::encode(path, &layers, provenance)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn either_ending_names_both_files() {
        let both = [PathBuf::from("a/b.exr"), PathBuf::from("a/b.png")];
        assert_eq!(both_endings(Path::new("a/b.exr")).expect("a picture"), both);
        assert_eq!(both_endings(Path::new("a/b.png")).expect("a picture"), both);
        assert_eq!(both_endings(Path::new("a/b.PNG")).expect("a picture")[1], Path::new("a/b.PNG"));
        assert!(both_endings(Path::new("a/b.jpg")).expect_err("no picture").to_string().contains("a/b.jpg"));
    }
}
