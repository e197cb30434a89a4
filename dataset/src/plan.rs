//! From a recipe to the list of its scenes and views.

use crate::capture::{Capture, View};
use crate::random::mix;
use crate::recipe::Resolution;
use crate::{DatasetError, Recipe, SceneOrCapture, SceneRecord};
use deepshade_render::scene::SceneSource;
use deepshade_render::scene::procedural::Family;
use deepshade_shaders::lists;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// What a pair is used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TrainingSplit {
    /// Gradients.
    Training,
    /// Choosing the best checkpoint and tuning.
    Validation,
}

/// A scene of a recipe with its views.
#[derive(Clone, Debug)]
pub struct PlannedScene {
    /// Where it comes from.
    pub scene: SceneRecord,
    /// What tells its random numbers from those of other scenes.
    pub key: u64,
    /// Its views.
    pub views: Vec<PlannedView>,
}

/// A view to be sampled.
#[derive(Clone, Debug)]
pub struct PlannedView {
    /// Which view of the scene, from 0.
    pub index: usize,
    /// A name that no other view of the recipe has; fit for a file name.
    pub name: String,
    /// Seed of its samples and of all that is drawn for it but its camera.
    pub seed: u32,
    /// Whether it is held apart for validation; never in a recipe for testing.
    pub held_apart: bool,
}

impl Recipe {
    /// All scenes and views of the recipe, always the same.
    ///
    /// # Errors
    /// If a scene file or a capture cannot be read, or two files hold the same scene.
    pub fn plan(&self) -> Result<Vec<PlannedScene>, DatasetError> {
        let mut scenes = Vec::new();
        for share in &self.families {
            let family = Family::by_name(&share.name)?;
            for index in 0..share.scenes {
                let seed = mix(&[u64::from(self.seed), index as u64]);
                scenes.push(procedural(family, seed));
            }
        }
        for (path, identity) in self.files.iter().zip(self.file_identities()?) {
            let (key, source) = (text_key(&identity.hash), SceneSource::File(path.clone()));
            let scene = SceneRecord { source: SceneOrCapture::Scene(source), blake3: Some(identity.hash) };
            scenes.push((key, scene));
        }
        for folder in &self.captures {
            let (_, hash) = self.capture(folder)?;
            let key = text_key(&hash);
            scenes.push((
                key,
                SceneRecord { source: SceneOrCapture::Capture(folder.clone()), blake3: Some(hash) },
            ));
        }
        let count = scenes.len();
        let named = self.scene_names().into_iter().zip(scenes).enumerate();
        let planned = named.map(|(index, (name, (key, scene)))| PlannedScene {
            views: (0..self.views_per_scene)
                .map(|view| self.planned_view(index, count, &name, key, view))
                .collect(),
            scene,
            key,
        });
        Ok(planned.collect())
    }

    /// The names of all views of [`Recipe::plan`] in its order. No file is read for them.
    pub(crate) fn view_names(&self) -> impl Iterator<Item = String> {
        let views = self.views_per_scene;
        self.scene_names()
            .into_iter()
            .flat_map(move |scene| (0..views).map(move |view| view_name(&scene, view)))
    }

    /// A name for every scene, in the plan's order.
    fn scene_names(&self) -> Vec<String> {
        let families = self
            .families
            .iter()
            .flat_map(|share| (0..share.scenes).map(move |index| format!("{}-{index:04}", share.name)));
        let numbered = |kind: &'static str, paths: &[PathBuf]| -> Vec<String> {
            let name = |(index, path): (usize, &PathBuf)| format!("{kind}-{index:02}-{}", plain_stem(path));
            paths.iter().enumerate().map(name).collect()
        };
        families.chain(numbered("file", &self.files)).chain(numbered("capture", &self.captures)).collect()
    }

    /// A capture, and the hash of those of its frames that views are of.
    ///
    /// # Errors
    /// If it cannot be read, has fewer frames than there are to be views or images smaller than the recipe's.
    pub(crate) fn capture(&self, folder: &Path) -> Result<(Capture, String), DatasetError> {
        let folder = self.folder.join(folder);
        let capture = Capture::open(&folder)?;
        let (count, Resolution { height, width }) = (capture.count(), self.resolution);
        if count < self.views_per_scene {
            let what = format!("has {count} frames where `views_per_scene` is {}", self.views_per_scene);
            return Err(DatasetError::invalid(&folder, what));
        }
        if View::of(capture.camera(), [height, width]).is_none() {
            let [rows, columns] = capture.camera().size;
            let what = format!("has {columns} x {rows} pixels where {width} x {height} are wanted");
            return Err(DatasetError::invalid(&folder, what));
        }
        let hash = capture.hash(&lists::spread(count, self.views_per_scene))?;
        Ok((capture, hash))
    }

    /// A family's scene of a seed with its views, none of them held apart.
    pub(crate) fn procedural_scene(&self, family: Family, seed: u64) -> PlannedScene {
        let (key, scene) = procedural(family, seed);
        let name = format!("{}-{seed}", family.name());
        let view = |index| PlannedView {
            index,
            name: view_name(&name, index),
            seed: self.view_seed(key, index),
            held_apart: false,
        };
        PlannedScene { scene, key, views: (0..self.views_per_scene).map(view).collect() }
    }

    fn planned_view(&self, scene: usize, scenes: usize, name: &str, key: u64, view: usize) -> PlannedView {
        let held_apart = if scenes > 1 {
            held_apart(scene, scenes, self.validation_share)
        } else {
            // What follows each other stays together.
            let frames = self.sequence.map_or(1, |sequence| sequence.frames);
            held_apart(view / frames, self.views_per_scene / frames, self.validation_share)
        };
        PlannedView { index: view, name: view_name(name, view), seed: self.view_seed(key, view), held_apart }
    }

    /// The seed of a scene's view.
    pub(crate) fn view_seed(&self, key: u64, view: usize) -> u32 {
        mix(&[u64::from(self.seed), key, view as u64]) as u32
    }
}

/// The key of a family's scene, and where it comes from.
fn procedural(family: Family, seed: u64) -> (u64, SceneRecord) {
    let source = SceneOrCapture::Scene(SceneSource::Procedural(family, seed));
    (text_key(family.name()) ^ seed, SceneRecord { source, blake3: None })
}

fn view_name(scene: &str, view: usize) -> String {
    format!("{scene}-{view:03}")
}

/// Whether the item of that index is among those held apart, which lie evenly among all: at least one where
/// the share is above 0 and there are two or more.
fn held_apart(index: usize, count: usize, share: f64) -> bool {
    let rounded = (share * count as f64).round() as usize;
    let wanted = if share > 0.0 && count > 1 { rounded.max(1) } else { 0 };
    spread(index, count, wanted)
}

/// Whether the item of that index is among `wanted` of `count` that lie evenly among all, the last one
/// always.
pub(crate) const fn spread(index: usize, count: usize, wanted: usize) -> bool {
    lists::is_in_spread(count - 1 - index, count, wanted)
}

/// The letters and digits of a file's or folder's name without its ending.
fn plain_stem(path: &Path) -> String {
    let stem = path.file_stem().and_then(|stem| stem.to_str()).unwrap_or_default();
    stem.chars().filter(char::is_ascii_alphanumeric).collect()
}

/// A number for a text.
fn text_key(text: &str) -> u64 {
    let hash = blake3::hash(text.as_bytes());
    u64::from_le_bytes(std::array::from_fn(|i| hash.as_bytes()[i]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_held_apart_lies_evenly() {
        let apart = |count: usize, share: f64| -> Vec<usize> {
            (0..count).filter(|index| held_apart(*index, count, share)).collect()
        };
        assert_eq!(apart(20, 0.1), [9, 19]);
        assert_eq!(apart(3, 0.1), [2]);
        assert_eq!(apart(1, 0.5), [0; 0]);
        assert_eq!(apart(10, 0.0), [0; 0]);
        assert_eq!(apart(1000, 0.137).len(), 137);
        assert_eq!(apart(13, 0.3), [3, 6, 9, 12]);
    }
}
