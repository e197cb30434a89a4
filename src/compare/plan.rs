//! What frames a comparison has, and which of their images are there: found out for all scenes before the
//! first image is made, so that what is wrong with the last scene is said at once.

use super::compared_methods::ComparedMethods;
use super::description::{Comparison, distinct, short_name};
use super::key::{Digest, file_digest};
use super::make::{ComparisonSettings, Head, wanted};
use super::run::ComparisonRun;
use crate::complete::{Completed, Wants, complete, remembered};
use crate::radius::{self, Space};
use crate::report::folder::FRAME_PREFIX;
use crate::report::record::FrameRecord;
use crate::views::{self, View};
use crate::{exposure_time, props};
use anyhow::{Context, Result};
use deepshade_dataset::identity::scene_hash;
use deepshade_render::bvh::TracedScene;
use deepshade_render::method::Repeats;
use deepshade_render::scene::{Density, SceneSource};
use deepshade_shaders::Effect;
use deepshade_shaders::effect::EffectSetting;
use std::path::Path;

/// A scene at a moment, with what is put into it.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneRequest {
    source: SceneSource,
    props: props::Args,
    moment: exposure_time::Args,
    /// Whether it shows what moves while the shutter is open.
    moving: bool,
}

/// Scenes as they are asked for; the last one stays, since several frames in a row are of it.
#[derive(Default)]
pub struct SceneCache(Option<(SceneRequest, TracedScene)>);

/// A frame that is to be there.
pub struct Planned {
    /// Which run it is of.
    pub run: usize,
    /// What is seen.
    pub scene_request: SceneRequest,
    /// From where, before the effect's needs are met.
    pub view: View,
    /// How it is made.
    pub settings: ComparisonSettings,
    /// What is added to the scene.
    pub added: Vec<String>,
    /// What it is called, and what of it is there.
    pub head: Head,
    /// Whether light goes through a medium that is a grid there.
    grid: bool,
    /// Whether no lamp shines.
    dark: bool,
}

impl SceneRequest {
    fn of(run: &ComparisonRun, source: &SceneSource, effect: Effect) -> Self {
        let (source, props, moment) = (source.clone(), run.props(), run.moment(effect));
        Self { source, props, moment, moving: effect.listens_to(EffectSetting::Shutter) }
    }

    fn load(&self) -> Result<TracedScene> {
        let effect = if self.moving { Effect::MotionBlur } else { Effect::Aa };
        let scene = self.moment.scene(&self.source, &self.props, effect)?;
        TracedScene::new(scene).with_context(|| format!("scene {}", self.source))
    }
}

impl SceneRequest {
    /// A scene of this one's look, with what it was like before where it moves and surfaces keep light.
    ///
    /// # Errors
    /// If a file cannot be read any more, or triangles come and go.
    pub fn remembered(&self, scene: TracedScene) -> Result<TracedScene> {
        remembered(scene, &self.source, &self.props)
    }
}

impl SceneCache {
    /// A scene, loaded where it is not the last one.
    ///
    /// # Errors
    /// If it cannot be loaded.
    pub fn get(&mut self, scene_request: &SceneRequest) -> Result<&TracedScene> {
        let last = self.0.take().filter(|(last, _)| last == scene_request);
        let found = match last {
            Some(found) => found,
            None => (scene_request.clone(), scene_request.load()?),
        };
        Ok(&self.0.insert(found).1)
    }
}

/// A scene with all that an effect in a run needs.
///
/// # Errors
/// If something that the run states cannot be read or is impossible.
pub fn completed(
    run: &ComparisonRun,
    compared: &ComparedMethods,
    scene: &TracedScene,
    view: &View,
    effect: Effect,
) -> Result<Completed> {
    let additions = run.additions().heard_by(effect);
    let wants = Wants {
        effect,
        size: run.size(),
        additions: &additions,
        seed: run.seed(),
        learned: compared.environment(effect),
        animated: false,
        time: run.moment(effect).time(),
    };
    complete(scene, &view.camera, &wants)
}

/// All frames, those of a scene one after the other, with what of them is in a folder. Methods that do not go
/// through a run's medium are left out of its methods.
///
/// # Errors
/// If a scene cannot be loaded, a view is impossible, or something that a run states is.
pub fn plan(
    comparison: &Comparison,
    compared_by_run: &mut [ComparedMethods],
    scene_cache: &mut SceneCache,
    by_name: &[bool],
    (maker, repeats, out): (&str, Repeats, &Path),
) -> Result<Vec<Planned>> {
    let mut all = Vec::new();
    for (index, run) in comparison.runs.iter().enumerate() {
        let mut frames = Vec::new();
        for source in run.scenes() {
            for effect in run.effects() {
                let by = (maker, repeats);
                frames.extend(frames_of(
                    index,
                    run,
                    source,
                    *effect,
                    &compared_by_run[index],
                    scene_cache,
                    by,
                )?);
            }
        }
        for effect in run.effects() {
            let of = || frames.iter().filter(|frame: &&Planned| frame.settings.effect == *effect);
            if matches!(effect, Effect::FogDirect | Effect::FogIndirect) && of().all(|frame| frame.dark) {
                note!(
                    "the scene has no lamp, and of other light only truth knows in fog: the methods' images are black"
                );
            }
            if of().any(|frame| frame.grid) {
                compared_by_run[index].through_grids(*effect, by_name[index])?;
            }
        }
        all.extend(frames);
    }
    name(comparison, &mut all);
    super::compared_methods::label(compared_by_run);
    for frame in &mut all {
        let compared = compared_by_run[frame.run].of(frame.settings.effect);
        let head = &mut frame.head;
        head.wanted = compared.map(|method| wanted(&head.key, method)).collect();
        head.kept = FrameRecord::kept(out, &head.folder, &head.key, &head.wanted);
    }
    Ok(all)
}

/// The frames of an effect in a scene, without names.
fn frames_of(
    index: usize,
    run: &ComparisonRun,
    source: &SceneSource,
    effect: Effect,
    compared: &ComparedMethods,
    scene_cache: &mut SceneCache,
    (maker, repeats): (&str, Repeats),
) -> Result<Vec<Planned>> {
    let scene_request = SceneRequest::of(run, source, effect);
    let scene = scene_cache.get(&scene_request)?;
    let [height, width] = run.size();
    let contents = scene_hash(scene.scene());
    let views = views::views(run.views.as_ref(), source, scene, run.size(), run.seed())?;
    let mut frames = Vec::new();
    for view in views {
        let Completed { scene: shown, camera, added } = completed(run, compared, scene, &view, effect)?;
        let space = Space::seen(&shown, &camera, run.size());
        let radius = radius::wanted(run.reach(scene.diagonal()), compared.reach(effect), &[effect], space);
        let settings =
            ComparisonSettings { effect, height, width, radius, goal: run.goal(), seed: run.seed(), repeats };
        let shown = shown.scene();
        if frames.is_empty() {
            added.iter().for_each(|line| note!("{line}"));
        }
        let mut digest = Digest::default();
        digest.say(&(maker, &contents, settings, camera, &scene_request.moment, &added));
        digest.say(&(
            &shown.lights,
            &shown.medium,
            &shown.glow,
            run.additions().heard_by(effect).mean_free_path,
        ));
        // What the scene's own hash leaves out and these effects go by.
        if scene_request.moving {
            shown.meshes.iter().for_each(|mesh| digest.say(&mesh.displacements));
        }
        if shown.glow.is_some() {
            shown.materials.iter().for_each(|material| digest.say(&material.name));
        }
        digest.say(&run.environment.as_deref().map(file_digest).transpose()?);
        let grid = shown.medium.as_deref().is_some_and(|medium| matches!(medium.density, Density::Grid(_)));
        let dark = shown.lights.is_empty();
        let head = Head {
            key: digest.finish(),
            name: view.name.clone(),
            scene: shown.name.clone(),
            view: short_name(&view, &shown.name),
            folder: String::new(),
            wanted: Vec::new(),
            kept: None,
        };
        let scene_request = scene_request.clone();
        frames.push(Planned { run: index, scene_request, view, settings, added, head, grid, dark });
    }
    Ok(frames)
}

/// Gives frames names that tell them apart, and folders named like them.
fn name(comparison: &Comparison, frames: &mut [Planned]) {
    let sources =
        distinct(frames.iter().map(|frame| (frame.head.scene.clone(), frame.scene_request.source.clone())));
    for frame in frames.iter_mut() {
        let head = &mut frame.head;
        if sources.iter().filter(|(scene, _)| *scene == head.scene).count() > 1 {
            head.scene = frame.scene_request.source.to_string();
        }
        if let Some(name) = &comparison.runs[frame.run].name {
            head.scene = format!("{}, {name}", head.scene);
        }
    }
    // All of a run's frames of a scene, so that they stay one scene.
    for (run, scene) in repeated(frames) {
        for frame in frames.iter_mut().filter(|frame| (frame.run, &frame.head.scene) == (run, &scene)) {
            frame.head.scene = format!("{scene}, run {}", run + 1);
        }
    }
    let several = distinct(frames.iter().map(|frame| frame.head.scene.clone())).len() > 1;
    let mut folders: Vec<String> = Vec::new();
    for frame in frames {
        let head = &mut frame.head;
        if several {
            head.name = format!("{}, {}", head.scene, head.view);
        }
        let stem = folder_name(&format!("{} {} {}", head.scene, head.view, frame.settings.effect));
        let candidates = (1..).map(|n| if n == 1 { stem.clone() } else { format!("{stem}-{n}") });
        head.folder = candidates.into_iter().find(|name| !folders.contains(name)).unwrap_or_default();
        folders.push(head.folder.clone());
    }
}

/// Runs and scenes of which a frame is called like one of an earlier run.
fn repeated(frames: &[Planned]) -> Vec<(usize, String)> {
    let called = |frame: &Planned| (frame.settings.effect, frame.head.scene.clone(), frame.head.view.clone());
    let earlier =
        |frame: &&Planned| frames.iter().any(|other| other.run < frame.run && called(other) == called(frame));
    distinct(frames.iter().filter(earlier).map(|frame| (frame.run, frame.head.scene.clone())))
}

/// A name that every file system and every address takes.
pub fn folder_name(text: &str) -> String {
    const LONGEST: usize = 100;
    let letters = text.to_lowercase();
    let words = letters.split(|letter: char| !letter.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    let mut name = format!("{FRAME_PREFIX}{}", words.collect::<Vec<_>>().join("-"));
    name.truncate(LONGEST);
    name
}
