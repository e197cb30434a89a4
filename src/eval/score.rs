//! Scores of an effect's methods on the frames of a test set: overall, and by where scenes are from, their
//! kind and scene.

use super::rivals::Rival;
use crate::methods::LEARNED;
use crate::statistics::{MeanInterval, estimate, scene_means};
use anyhow::{Context, Result};
use deepshade_dataset::progress;
use deepshade_dataset::testset::{FrameRecord, gather};
use deepshade_dataset::{SceneOrCapture, SceneRecord, StagedScene, TestFrame, TestSet};
use deepshade_render::method::{Frame, Repeats};
use deepshade_render::metrics::{exposed, flip, psnr, relative_mse, ssim};
use deepshade_render::scene::SceneSource;
use deepshade_shaders::{Effect, Planes};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Scores by figure name (`ssim_learned`), each with the scene it is from.
type Table = BTreeMap<String, Vec<(usize, f64)>>;

/// Of a part of the scenes: what parts there are by, and which one it is.
type SceneGroup = (&'static str, String);

/// Scores of all frames.
#[derive(Default)]
pub struct Evaluation {
    /// Number of frames.
    pub frames: usize,
    /// The scenes, by name.
    pub scenes: Vec<String>,
    /// What each method ran on, by its figures' name.
    pub devices: BTreeMap<String, String>,
    /// Whether all of these are the same processor, be it by a software adapter.
    pub all_on_processor: bool,
    /// Frames of which there is the whole truth, if a network was among the methods.
    pub sights: Vec<FrameImages>,
    overall: Table,
    /// The same for parts of the scenes.
    parts: BTreeMap<SceneGroup, Table>,
}

/// A frame to look at.
pub struct FrameImages {
    /// Name of the frame.
    pub name: String,
    /// The network's SSIM.
    pub ssim: f64,
    /// What methods made and what was wanted, exposed: `[channels, height, width]`.
    pub images: Vec<(String, Planes)>,
}

impl Evaluation {
    /// Means with their intervals, by figure name.
    pub fn estimates(&self) -> BTreeMap<&str, MeanInterval> {
        self.overall.iter().map(|(name, values)| (name.as_str(), estimate(values))).collect()
    }

    /// Means of the parts of the scenes: `origins` (procedural or files), `kinds` (families and files),
    /// `scenes`.
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

    /// Several test sets as one. A scene that is in several of them stays one, since its frames resemble each
    /// other. Frames to look at are moved.
    pub fn together<'a>(sets: impl IntoIterator<Item = &'a mut Self>) -> Self {
        let mut all = Self::default();
        for set in sets {
            let scenes: Vec<usize> = set.scenes.iter().map(|name| all.scene(name)).collect();
            all.frames += set.frames;
            all.devices.extend(set.devices.clone());
            all.all_on_processor = set.all_on_processor;
            all.sights.append(&mut set.sights);
            extend(&mut all.overall, &set.overall, &scenes);
            for (part, table) in &set.parts {
                extend(all.parts.entry(part.clone()).or_default(), table, &scenes);
            }
        }
        all
    }

    /// The values of a figure, each with its scene, frame by frame; none where nothing was measured under
    /// that name.
    pub fn values(&self, name: &str) -> &[(usize, f64)] {
        self.overall.get(name).map(Vec::as_slice).unwrap_or_default()
    }

    /// Of how many frames FLIP was taken: of those whose truth is whole.
    pub fn frames_of_flip(&self) -> usize {
        let flips = self.overall.iter().filter(|(name, _)| name.starts_with("flip_"));
        flips.map(|(_, values)| values.len()).max().unwrap_or(0)
    }

    /// The mean over scenes of a figure's values; none where nothing was measured under that name.
    pub fn mean(&self, name: &str) -> Option<f64> {
        let means = scene_means(self.values(name));
        (!means.is_empty()).then(|| means.values().sum::<f64>() / means.len() as f64)
    }

    /// Names of the scenes in which the mean of one figure is below that of another.
    pub fn scenes_below(&self, figure: &str, other: &str) -> Vec<&str> {
        let means = |name: &str| scene_means(self.values(name));
        let (own, others) = (means(figure), means(other));
        let below = own.iter().filter(|(scene, mean)| others.get(*scene).is_some_and(|other| *mean < other));
        below.map(|(scene, _)| self.scenes[*scene].as_str()).collect()
    }

    /// The number of a scene, which is a new one where the name is.
    fn scene(&mut self, name: &str) -> usize {
        self.scenes.iter().position(|known| known == name).unwrap_or_else(|| {
            self.scenes.push(name.to_owned());
            self.scenes.len() - 1
        })
    }

    fn add(&mut self, source: &SceneOrCapture, name: &str, value: f64) {
        let parts = [("origins", origin(source)), ("kinds", kind(source)), ("scenes", source.to_string())];
        let entry = (self.scene(&source.to_string()), value);
        self.overall.entry(name.to_owned()).or_default().push(entry);
        for part in parts {
            self.parts.entry(part).or_default().entry(name.to_owned()).or_default().push(entry);
        }
    }
}

/// Adds values to a table, whose scenes have other numbers.
fn extend(table: &mut Table, more: &Table, scenes: &[usize]) {
    for (name, values) in more {
        let values = values.iter().map(|(scene, value)| (scenes[*scene], *value));
        table.entry(name.clone()).or_default().extend(values);
    }
}

/// Runs the methods on chosen frames of a test set, each so many times a frame.
///
/// # Errors
/// If a scene, a texture or a frame cannot be read, or a method fails.
pub fn evaluate(
    set: &TestSet,
    chosen: &[usize],
    effect: Effect,
    rivals: &[Rival],
    repeats: Repeats,
) -> Result<Evaluation> {
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
                let scene = StagedScene::load(&record.scene, set.recipe(), &props);
                scene
                    .with_context(|| format!("frame {}; --scenes says where scene files are", record.name))?
            }
        };
        score_frame(&mut evaluation, record, &scene, &set.frame(*index)?, effect, rivals, repeats)?;
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
    repeats: Repeats,
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
        let shaded = method.shade(&frame, repeats).with_context(|| format!("frame {}", record.name))?;
        images.push((name.clone(), shown(&shaded.image)));
        times.push((format!("ms_{name}"), shaded.milliseconds));
        evaluation.devices.insert(name.clone(), shaded.device);
    }
    images
        .push((effect.definition().doing_nothing.name().to_owned(), shown(&effect.doing_nothing(&gbuffer))));
    let mut of_network = None;
    for (name, image) in &images {
        let tiles = gather(image, &truth.tiles);
        let similarity = ssim(&tiles, &expected);
        of_network = of_network.or_else(|| (name == LEARNED).then_some(similarity));
        let scores = [
            ("ssim", similarity),
            ("psnr", psnr(&tiles, &expected)),
            ("relmse", relative_mse(&tiles, &expected)),
            ("bias", tiles.mean() - expected.mean()),
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
        evaluation.sights.push(FrameImages { name: record.name.clone(), ssim, images });
    }
    Ok(())
}

/// Whether a scene is procedural or somebody's.
fn origin(source: &SceneOrCapture) -> String {
    match source {
        SceneOrCapture::Scene(SceneSource::Procedural(..)) => "procedural".to_owned(),
        SceneOrCapture::Scene(SceneSource::File(_)) | SceneOrCapture::Capture(_) => "files".to_owned(),
    }
}

/// What scenes are grouped by: the family, or the file's name.
fn kind(source: &SceneOrCapture) -> String {
    match source {
        SceneOrCapture::Scene(SceneSource::Procedural(family, _)) => family.name().to_owned(),
        SceneOrCapture::Scene(SceneSource::File(path)) | SceneOrCapture::Capture(path) => {
            path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
        }
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// Values under some names.
    type Values<'a> = &'a [(&'a str, f64)];

    /// Scores by hand: scenes with frames, of which each has values.
    pub fn evaluation(scenes: &[(&str, &[Values<'_>])]) -> Evaluation {
        let mut evaluation = Evaluation::default();
        for (scene, frames) in scenes {
            let source = SceneOrCapture::try_from((*scene).to_owned()).expect("a scene");
            for frame in *frames {
                evaluation.frames += 1;
                frame.iter().for_each(|(name, value)| evaluation.add(&source, name, *value));
            }
        }
        evaluation
    }

    #[test]
    fn scenes_are_grouped_by_family_and_by_file() {
        let kind = |text: &str| kind(&SceneOrCapture::try_from(text.to_owned()).expect("a scene"));
        assert_eq!((kind("drapery:7"), kind("drapery:8")), ("drapery".to_owned(), "drapery".to_owned()));
        assert_eq!(kind("../some:where/hall.gltf"), "hall.gltf");
    }

    #[test]
    fn a_scene_of_several_test_sets_stays_one() {
        let mut small = evaluation(&[("cave:1", &[&[("ssim_learned", 0.2)], &[("ssim_learned", 0.4)]])]);
        let frames: [&[(&str, f64)]; 1] = [&[("ssim_learned", 0.9)]];
        let mut large = evaluation(&[("drapery:1", &frames), ("cave:1", &frames)]);
        let all = Evaluation::together([&mut small, &mut large]);
        assert_eq!(
            (all.frames, all.scenes.as_slice()),
            (4, &["cave:1".to_owned(), "drapery:1".to_owned()][..])
        );
        assert_eq!(all.values("ssim_learned"), [(0, 0.2), (0, 0.4), (1, 0.9), (0, 0.9)]);
        // The mean of 0.5 and 0.9, not that of four frames, nor of three scenes.
        assert!((all.estimates()["ssim_learned"].mean - 0.7).abs() < 1e-12);
        assert!(
            (all.parts()["kinds"]["cave"]["ssim_learned"].as_f64().expect("a number") - 0.5).abs() < 1e-12
        );
    }

    #[test]
    fn scenes_are_below_by_the_mean_of_their_frames() {
        let scores = |own: f64| [("ssim_learned", own), ("ssim_white", 0.5)];
        let (low, high, same) = (scores(0.1), scores(0.8), scores(0.5));
        let found =
            evaluation(&[("cave:1", &[&low, &high]), ("drapery:1", &[&high, &high]), ("bridge:2", &[&same])]);
        assert_eq!(found.scenes_below("ssim_learned", "ssim_white"), ["cave:1"]);
        assert_eq!(found.scenes_below("ssim_white", "ssim_learned"), ["drapery:1"]);
        assert!(found.scenes_below("ssim_learned", "ssim_black").is_empty(), "nothing was measured");
    }
}
