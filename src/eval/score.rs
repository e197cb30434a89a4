//! Scores of an effect's methods on the frames of a test set: overall, and by where scenes are from, their kind and scene.

use super::rivals::{Rival, trivial_image, trivial_name};
use crate::methods::LEARNED;
use crate::statistics::{Estimate, estimate};
use anyhow::{Context, Result};
use deepshade_dataset::progress;
use deepshade_dataset::testset::{FrameRecord, gather};
use deepshade_dataset::{SceneRecord, StagedScene, Subject, TestFrame, TestSet};
use deepshade_render::method::{Frame, Repeats};
use deepshade_render::metrics::{exposed, flip, psnr, relative_mse, ssim};
use deepshade_render::scene::SceneSource;
use deepshade_shaders::{Effect, Planes};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Methods are timed as the median of so many runs a frame.
const REPEATS: Repeats = Repeats { warm_up: 1, timed: 3 };

/// Scores by figure name (`ssim_learned`), each with the scene it is from.
type Table = BTreeMap<String, Vec<(usize, f64)>>;

/// Scores of all frames.
#[derive(Default)]
pub struct Evaluation {
    /// Number of frames.
    pub frames: usize,
    /// Number of scenes.
    pub scenes: usize,
    /// What each method ran on, by its figures' name.
    pub devices: BTreeMap<String, String>,
    /// Frames of which there is the whole truth, if a network was among the methods.
    pub sights: Vec<Sight>,
    overall: Table,
    /// The same for a part of the scenes: what parts there are by, and which one it is.
    parts: BTreeMap<(&'static str, String), Table>,
}

/// A frame to look at.
pub struct Sight {
    /// Name of the frame.
    pub name: String,
    /// The network's SSIM.
    pub ssim: f64,
    /// What methods made and what was wanted, exposed: `[channels, height, width]`.
    pub images: Vec<(String, Planes)>,
}

impl Evaluation {
    /// Means with their intervals, by figure name.
    pub fn estimates(&self) -> BTreeMap<&str, Estimate> {
        self.overall.iter().map(|(name, values)| (name.as_str(), estimate(values))).collect()
    }

    /// Means of the parts of the scenes: `origins` (procedural or files), `kinds` (families and files), `scenes`.
    pub fn parts(&self) -> BTreeMap<&'static str, BTreeMap<&str, Value>> {
        let means = |table: &Table| -> Value {
            table.iter().map(|(name, values)| (name.clone(), json!(estimate(values).mean))).collect()
        };
        let mut parts: BTreeMap<_, BTreeMap<_, _>> = BTreeMap::new();
        for ((by, part), table) in &self.parts {
            parts.entry(*by).or_default().insert(part.as_str(), means(table));
        }
        parts
    }

    fn add(&mut self, source: &Subject, name: &str, value: f64) {
        let parts = [("origins", origin(source)), ("kinds", kind(source)), ("scenes", source.to_string())];
        let entry = (self.scenes, value);
        self.overall.entry(name.to_owned()).or_default().push(entry);
        for part in parts {
            self.parts.entry(part).or_default().entry(name.to_owned()).or_default().push(entry);
        }
    }
}

/// Runs the methods on chosen frames of a test set.
///
/// # Errors
/// If a scene, a texture or a frame cannot be read, or a method fails.
pub fn evaluate(set: &TestSet, chosen: &[usize], effect: Effect, rivals: &[Rival]) -> Result<Evaluation> {
    let bar = progress::bar("frames", chosen.len(), 0);
    let mut evaluation = Evaluation { frames: chosen.len(), ..Evaluation::default() };
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
        score_frame(&mut evaluation, record, &scene, &set.frame(*index)?, effect, rivals)?;
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
    effect: Effect,
    rivals: &[Rival],
) -> Result<()> {
    let scene = &staged.shown(&record.camera, record.variation.as_ref())?;
    let gbuffer = staged.gbuffer(scene, &record.camera, record.seed);
    let frame =
        Frame { scene, camera: &record.camera, gbuffer: &gbuffer, radius: record.radius, seed: record.seed };
    let source = &record.scene.source;
    let shown = |image: &Planes| exposed(image, record.exposure);
    let (expected, whole) = (shown(&truth.truth), truth.whole.as_ref().map(shown));
    let (mut images, mut times) = (Vec::new(), Vec::new());
    for Rival { name, method, .. } in rivals {
        let shaded = method.shade(&frame, REPEATS).with_context(|| format!("frame {}", record.name))?;
        images.push((name.clone(), shown(&shaded.image)));
        times.push((format!("ms_{name}"), shaded.milliseconds));
        evaluation.devices.insert(name.clone(), shaded.device);
    }
    images.push((trivial_name(effect).to_owned(), shown(&trivial_image(effect, &gbuffer))));
    let mut of_network = None;
    for (name, image) in &images {
        let tiles = gather(image, &truth.tiles);
        let similarity = ssim(&tiles, &expected);
        of_network = of_network.or_else(|| (name == LEARNED).then_some(similarity));
        let scores = [
            ("ssim", similarity),
            ("psnr", psnr(&tiles, &expected)),
            ("relmse", relative_mse(&tiles, &expected)),
            ("bias", mean(&tiles) - mean(&expected)),
        ];
        let whole = whole.as_ref().map(|whole| ("flip", flip(image, whole)));
        for (metric, score) in scores.into_iter().chain(whole) {
            evaluation.add(source, &format!("{metric}_{name}"), score);
        }
    }
    times.iter().for_each(|(name, time)| evaluation.add(source, name, *time));
    evaluation.add(source, "ssim_ceiling", record.ceiling.ssim);
    if let (Some(ssim), Some(whole)) = (of_network, whole) {
        images.push(("target".to_owned(), whole));
        evaluation.sights.push(Sight { name: record.name.clone(), ssim, images });
    }
    Ok(())
}

/// Whether a scene is procedural or somebody's.
fn origin(source: &Subject) -> String {
    match source {
        Subject::Scene(SceneSource::Procedural(..)) => "procedural".to_owned(),
        Subject::Scene(SceneSource::File(_)) | Subject::Capture(_) => "files".to_owned(),
    }
}

/// What scenes are grouped by: the family, or the file's name.
fn kind(source: &Subject) -> String {
    match source {
        Subject::Scene(SceneSource::Procedural(family, _)) => family.name().to_owned(),
        Subject::Scene(SceneSource::File(path)) | Subject::Capture(path) => {
            path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
        }
    }
}

/// Mean of all values.
fn mean(image: &Planes) -> f64 {
    image.data().iter().map(|value| f64::from(*value)).sum::<f64>() / image.data().len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_grouped_by_family_and_by_file() {
        let kind = |text: &str| kind(&Subject::try_from(text.to_owned()).expect("a scene"));
        assert_eq!((kind("drapery:7"), kind("drapery:8")), ("drapery".to_owned(), "drapery".to_owned()));
        assert_eq!(kind("../some:where/hall.gltf"), "hall.gltf");
    }
}
