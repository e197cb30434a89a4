//! `deepshade eval`: an effect's methods, learned and analytic, on a test set, with confidence intervals over scenes.

mod curve;
pub mod rivals;

use crate::figures::Figures;
use crate::methods::TRUTH;
use crate::statistics::{Estimate, estimate};
use anyhow::{Context, Result, ensure};
use deepshade_dataset::testset::{FrameRecord, gather};
use deepshade_dataset::{SceneRecord, StagedScene, TestFrame, TestSet};
use deepshade_dataset::{progress, truth};
use deepshade_infer::Model;
use deepshade_render::gbuffer;
use deepshade_render::method::{Frame, Repeats};
use deepshade_render::methods::Quality;
use deepshade_render::metrics::{exposed, flip, psnr, relative_mse, ssim};
use deepshade_render::scene::SceneSource;
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{Effect, Planes, lists};
use rivals::{Rival, rivals, trivial_image, trivial_name};
use serde_json::json;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Evaluates an effect's methods, learned and analytic, on a test set.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  deepshade eval --model models/ao --json eval.json\n  \
    deepshade eval --effect gi --methods all --testset testsets/gi --json gi.json\n  \
    deepshade eval --effect ao --methods all --quality low,medium,high,ultra --curve ao.svg\n\nTest sets are made by \
    `deepshade dataset testset`; that of a model that is shipped lies in its folder.")]
pub struct Args {
    /// What is computed; by default what the network computes.
    #[arg(long)]
    effect: Option<Effect>,
    /// Which methods: names, or all. `learned` is one of them where there is a network.
    #[arg(long, value_delimiter = ',', default_value = "all")]
    methods: Vec<String>,
    /// How much time analytic methods may take for a better image: one or several of low, medium, high, ultra.
    #[arg(long, value_delimiter = ',', default_value = "high")]
    quality: Vec<Quality>,
    /// Folder of the network; by default models/EFFECT, and models/ao without --effect.
    #[arg(long)]
    model: Option<PathBuf>,
    /// Folder of the test set; by default `testset` in the model's folder.
    #[arg(long)]
    testset: Option<PathBuf>,
    /// Folder that the recipe's scene files are relative to, where it is not the one that the test set remembers.
    #[arg(long)]
    scenes: Option<PathBuf>,
    /// Only so many frames, spread over all of them.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    frames: Option<u32>,
    /// Draws error against time, a line a method through its qualities, into this SVG file.
    #[arg(long)]
    curve: Option<PathBuf>,
    /// Writes the figures here as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
}

/// Methods are timed as the median of so many runs a frame.
const REPEATS: Repeats = Repeats { warm_up: 1, timed: 3 };

/// Scores by figure name (`ssim_learned`), each with the scene it is from.
type Table = BTreeMap<String, Vec<(usize, f64)>>;

/// Evaluates, prints the table.
///
/// # Errors
/// If the model or the test set cannot be read, or a method fails.
pub fn run(args: &Args) -> Result<()> {
    let (folder, model) = network(args)?;
    let effect = args.effect.or(model.as_ref().map(|model| model.spec.effect)).unwrap_or(Effect::Ao);
    let set = testset(args, effect, &folder)?;
    let gpu = Gpu::new()?;
    let mut qualities = args.quality.clone();
    qualities.sort_unstable();
    qualities.dedup();
    let rivals = rivals(effect, &args.methods, &qualities, &gpu, model.as_ref())?;
    let chosen = lists::spread(set.frames().len(), args.frames.map_or(usize::MAX, |frames| frames as usize));
    ensure!(!chosen.is_empty(), "the test set has no frame");
    let evaluation = evaluate(&set, &chosen, effect, &rivals)?;
    let estimates: BTreeMap<&str, Estimate> =
        evaluation.overall.iter().map(|(name, values)| (name.as_str(), estimate(values))).collect();
    let mut figures = Figures::new("eval");
    for (name, estimate) in &estimates {
        figures.set(name, estimate.mean);
    }
    figures.set("frames", chosen.len() as f64);
    figures.set("scenes", evaluation.scenes as f64);
    let interval = |(name, e): (&&str, &Estimate)| ((*name).to_owned(), json!([e.low, e.high]));
    figures.detail("confidence_95", estimates.iter().map(interval).collect());
    figures.detail("kinds", evaluation.kinds());
    figures.detail("effect", json!(effect.name()));
    figures.detail("target", json!(set.recipe().target.as_deref().unwrap_or(TRUTH)));
    figures.detail("adapter", json!(gpu.info.name));
    figures.write(args.json.as_deref())?;
    if let Some(path) = &args.curve {
        curve::write(path, effect, &rivals, &estimates)?;
    }
    if let Some(target) = &set.recipe().target {
        note!("what methods are scored against is not truth but the images of `{target}`");
    }
    print_table(effect, &rivals, &estimates, chosen.len(), evaluation.scenes)
}

/// The folder where the effect's network would be, and the network if it is there. One that is asked for must be.
fn network(args: &Args) -> Result<(PathBuf, Option<Model>)> {
    let usual = || Path::new("models").join(args.effect.unwrap_or(Effect::Ao).name());
    let folder = args.model.clone().unwrap_or_else(usual);
    let optional = args.model.is_none() && args.effect.is_some() && !folder.join("net.json").exists();
    let model = if optional { None } else { Some(Model::load(&folder)?) };
    if let (Some(model), Some(effect)) = (&model, args.effect) {
        let made = model.spec.effect;
        ensure!(made == effect, "{} is for {made}, not for {effect}", folder.display());
    }
    Ok((folder, model))
}

fn testset(args: &Args, effect: Effect, model: &Path) -> Result<TestSet> {
    let folder = args.testset.clone().unwrap_or_else(|| model.join("testset"));
    ensure!(
        TestSet::is_in(&folder),
        "no test set in {0}; `deepshade dataset testset dataset/recipes/{effect}-rivals.toml --out {0}` makes a small one of \
         six scenes, {effect}-test.toml a large one, and --testset says where another is",
        folder.display()
    );
    let set = TestSet::open(&folder)?;
    let set = match &args.scenes {
        Some(scenes) => set.with_scenes(scenes),
        None => set,
    };
    let made = set.recipe().effect;
    ensure!(made == effect, "{} is for {made}, not for {effect}", folder.display());
    Ok(set)
}

/// Scores of all frames, together and by kind of scene.
#[derive(Default)]
struct Evaluation {
    scenes: usize,
    overall: Table,
    by_kind: BTreeMap<String, Table>,
}

impl Evaluation {
    fn add(&mut self, kind: &str, scene: usize, name: String, value: f64) {
        self.overall.entry(name.clone()).or_default().push((scene, value));
        self.by_kind.entry(kind.to_owned()).or_default().entry(name).or_default().push((scene, value));
    }

    /// Means by kind of scene.
    fn kinds(&self) -> serde_json::Value {
        let means = |table: &Table| -> serde_json::Value {
            table.iter().map(|(name, values)| (name.clone(), json!(estimate(values).mean))).collect()
        };
        self.by_kind.iter().map(|(kind, table)| (kind.clone(), means(table))).collect()
    }
}

fn evaluate(set: &TestSet, chosen: &[usize], effect: Effect, rivals: &[Rival]) -> Result<Evaluation> {
    let bar = progress::bar("frames", chosen.len(), 0);
    let mut evaluation = Evaluation::default();
    // Frames of a scene follow each other, so that a scene is built once.
    let mut current: Option<(SceneRecord, StagedScene<'_>)> = None;
    let props = set.props().context("--scenes says where files are")?;
    for index in chosen {
        let record = &set.frames()[*index];
        let scene = match current.take() {
            Some((source, scene)) if source == record.scene => scene,
            _ => {
                evaluation.scenes += 1;
                let scene = StagedScene::load(&record.scene, set.recipe(), &props);
                scene
                    .with_context(|| format!("frame {}; --scenes says where scene files are", record.name))?
            }
        };
        score_frame(&mut evaluation, record, &scene, &set.frame(*index)?, set, effect, rivals)?;
        current = Some((record.scene.clone(), scene));
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(evaluation)
}

fn score_frame(
    evaluation: &mut Evaluation,
    record: &FrameRecord,
    staged: &StagedScene<'_>,
    truth: &TestFrame,
    set: &TestSet,
    effect: Effect,
    rivals: &[Rival],
) -> Result<()> {
    let (height, width) = (set.recipe().resolution.height, set.recipe().resolution.width);
    let scene = &staged.shown(&record.camera, record.variation.as_ref())?;
    let gbuffer = gbuffer::render(scene, &record.camera, height, width, truth::attributes(effect));
    let frame =
        Frame { scene, camera: &record.camera, gbuffer: &gbuffer, radius: record.radius, seed: record.seed };
    let kind = kind(&record.scene.source);
    let index = evaluation.scenes;
    let shown = |image: &Planes| exposed(image, record.exposure);
    let (expected, whole) = (shown(&truth.truth), truth.whole.as_ref().map(shown));
    let mut score = |name: &str, image: &Planes| {
        let image = shown(image);
        let tiles = gather(&image, &truth.tiles);
        evaluation.add(&kind, index, format!("ssim_{name}"), ssim(&tiles, &expected));
        evaluation.add(&kind, index, format!("psnr_{name}"), psnr(&tiles, &expected));
        evaluation.add(&kind, index, format!("relmse_{name}"), relative_mse(&tiles, &expected));
        evaluation.add(&kind, index, format!("bias_{name}"), mean(&tiles) - mean(&expected));
        if let Some(whole) = &whole {
            evaluation.add(&kind, index, format!("flip_{name}"), flip(&image, whole));
        }
    };
    let mut times = Vec::new();
    for Rival { name, method, .. } in rivals {
        let shaded = method.shade(&frame, REPEATS).with_context(|| format!("frame {}", record.name))?;
        score(name, &shaded.image);
        times.push((format!("ms_{name}"), shaded.milliseconds));
    }
    score(trivial_name(effect), &trivial_image(effect, &gbuffer));
    times.into_iter().for_each(|(name, time)| evaluation.add(&kind, index, name, time));
    evaluation.add(&kind, index, "ssim_ceiling".to_owned(), record.ceiling.ssim);
    Ok(())
}

/// What scenes are grouped by in the details: the family, or the file's name.
fn kind(source: &SceneSource) -> String {
    match source {
        SceneSource::Procedural(family, _) => family.name().to_owned(),
        SceneSource::File(path) => {
            path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
        }
    }
}

/// Mean of all values.
fn mean(image: &Planes) -> f64 {
    image.data().iter().map(|value| f64::from(*value)).sum::<f64>() / image.data().len() as f64
}

/// One row a method.
fn print_table(
    effect: Effect,
    rivals: &[Rival],
    estimates: &BTreeMap<&str, Estimate>,
    frames: usize,
    scenes: usize,
) -> Result<()> {
    say!("{effect}: {frames} frames of {scenes} scenes; means over scenes with 95 % confidence intervals")?;
    say!(
        "{:<20} {:<22} {:<22} {:<22} {:>8} {:>8} {:>9}",
        "method",
        "SSIM",
        "PSNR (dB)",
        "FLIP",
        "relMSE",
        "bias",
        "ms"
    )?;
    let names = rivals.iter().map(|rival| rival.name.as_str()).chain([trivial_name(effect), "ceiling"]);
    for name in names {
        let cell = |metric: &str| {
            let found = estimates.get(format!("{metric}_{name}").as_str());
            found.map_or(String::new(), Estimate::to_string)
        };
        let number = |metric: &str, digits: usize| {
            let found = estimates.get(format!("{metric}_{name}").as_str());
            found.map_or(String::new(), |estimate| format!("{:.digits$}", estimate.mean))
        };
        let [ssim, psnr, flip] = ["ssim", "psnr", "flip"].map(cell);
        let (relmse, bias, ms) = (number("relmse", 4), number("bias", 4), number("ms", 2));
        say!("{name:<20} {ssim:<22} {psnr:<22} {flip:<22} {relmse:>8} {bias:>8} {ms:>9}")?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_grouped_by_family_and_by_file() {
        let kind = |text: &str| kind(&text.parse().expect("a scene"));
        assert_eq!((kind("drapery:7"), kind("drapery:8")), ("drapery".to_owned(), "drapery".to_owned()));
        assert_eq!(kind("../some:where/hall.gltf"), "hall.gltf");
    }
}
