//! `deepshade eval`: a network and its analytic rivals on a test set, with confidence intervals over scenes.

use crate::figures::Figures;
use crate::methods::{self, Setup};
use crate::statistics::{Estimate, estimate};
use anyhow::{Context, Result, ensure};
use deepshade_dataset::testset::{FrameRecord, gather};
use deepshade_dataset::{SceneRecord, StagedScene, TestFrame, TestSet};
use deepshade_dataset::{progress, truth};
use deepshade_infer::Model;
use deepshade_render::gbuffer;
use deepshade_render::method::{Frame, Method, Repeats};
use deepshade_render::metrics::{exposed, flip, psnr, ssim};
use deepshade_render::scene::SceneSource;
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{Effect, Planes, lists};
use serde_json::json;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Evaluates a network and its analytic rivals on a test set.
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  deepshade eval --model models/ao --json eval.json\n\nTest sets are made by \
    `deepshade dataset testset`; that of a model that is shipped lies in its folder."
)]
pub struct Args {
    /// Folder of the network.
    #[arg(long, default_value = "models/ao")]
    model: PathBuf,
    /// Folder of the test set; by default `testset` in the model's folder.
    #[arg(long)]
    testset: Option<PathBuf>,
    /// Folder that the recipe's scene files are relative to, where it is not the one that the test set remembers.
    #[arg(long)]
    scenes: Option<PathBuf>,
    /// Only so many frames, spread over all of them.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    frames: Option<u32>,
    /// Writes the figures here as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
}

/// The name under which the image that is background everywhere is scored.
const WHITE: &str = "white";

/// Scores by figure name (`ssim_learned`), each with the scene it is from.
type Table = BTreeMap<String, Vec<(usize, f64)>>;

/// Evaluates, prints the table.
///
/// # Errors
/// If the model or the test set cannot be read, or a method fails.
pub fn run(args: &Args) -> Result<()> {
    let model = Model::load(&args.model)?;
    let effect = model.spec.effect;
    let folder = args.testset.clone().unwrap_or_else(|| args.model.join("testset"));
    ensure!(
        TestSet::is_in(&folder),
        "no test set in {0}; `deepshade dataset testset dataset/recipes/{effect}-test.toml --out {0}` makes one, and \
         --testset says where another is",
        folder.display()
    );
    let set = TestSet::open(&folder)?;
    let set = match &args.scenes {
        Some(scenes) => set.with_scenes(scenes),
        None => set,
    };
    ensure!(set.recipe().effect == effect, "{} is for another effect than {effect}", folder.display());
    let gpu = Gpu::new()?;
    let methods = methods::open_all(effect, Setup { gpu: &gpu, model: Some(&model) })?;
    let chosen = lists::spread(set.frames().len(), args.frames.map_or(usize::MAX, |frames| frames as usize));
    ensure!(!chosen.is_empty(), "{} has no frame", folder.display());
    let evaluation = evaluate(&set, &chosen, effect, &methods)?;
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
    figures.detail("testset", json!(folder));
    figures.detail("adapter", json!(gpu.info.name));
    figures.write(args.json.as_deref())?;
    let names: Vec<&str> = methods.iter().map(|method| method.name()).collect();
    print_table(&names, &estimates, chosen.len(), evaluation.scenes)
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

fn evaluate(
    set: &TestSet,
    chosen: &[usize],
    effect: Effect,
    methods: &[Box<dyn Method>],
) -> Result<Evaluation> {
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
        score_frame(&mut evaluation, record, &scene, &set.frame(*index)?, set, effect, methods)?;
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
    methods: &[Box<dyn Method>],
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
        if let Some(whole) = &whole {
            evaluation.add(&kind, index, format!("flip_{name}"), flip(&image, whole));
        }
    };
    for method in methods {
        let shaded = method.shade(&frame, Repeats::ONCE).with_context(|| format!("frame {}", record.name))?;
        score(&method.name().replace('-', "_"), &shaded.image);
    }
    score(WHITE, &Planes::filled(effect.channels(), height, width, effect.background().unwrap_or(0.0)));
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

fn print_table(
    names: &[&str],
    estimates: &BTreeMap<&str, Estimate>,
    frames: usize,
    scenes: usize,
) -> Result<()> {
    say!("{frames} frames of {scenes} scenes; means over scenes with 95 % confidence intervals")?;
    say!("{:<10} {:<22} {:<22} FLIP", "method", "SSIM", "PSNR (dB)")?;
    let cell = |figure: String| estimates.get(figure.as_str()).map_or(String::new(), Estimate::to_string);
    let rows = names.iter().copied().chain([WHITE, "ceiling"]);
    for name in rows {
        let id = name.replace('-', "_");
        let [ssim, psnr, flip] = ["ssim", "psnr", "flip"].map(|metric| cell(format!("{metric}_{id}")));
        say!("{name:<10} {ssim:<22} {psnr:<22} {flip}")?;
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
