//! From a recipe to the list of its scenes and views.

use crate::random::mix;
use crate::recipe::file_hash;
use crate::{DatasetError, Recipe};
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::Scene;
use deepshade_render::scene::procedural::{Family, Split};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Where a scene comes from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum SceneSource {
    /// A seed of a procedural family.
    Family {
        /// Its name.
        name: String,
        /// Which of its scenes.
        seed: u64,
    },
    /// A scene file.
    File {
        /// As the recipe names it, relative to the recipe's folder.
        path: PathBuf,
        /// Hash of its contents, in hexadecimal.
        blake3: String,
    },
}

/// What a pair is used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Part {
    /// Gradients.
    Training,
    /// Choosing the best checkpoint and tuning.
    Validation,
    /// Final figures only.
    Test,
}

/// A scene of a recipe with its views.
#[derive(Clone, Debug)]
pub struct PlannedScene {
    /// Where it comes from.
    pub source: SceneSource,
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
    /// Seed of its samples.
    pub seed: u32,
    /// What it is used for.
    pub part: Part,
}

impl SceneSource {
    /// Makes or reads the scene; files are relative to `folder`.
    ///
    /// # Errors
    /// If the file is missing, damaged, or not the one that the hash is of.
    pub fn load(&self, folder: &Path) -> Result<TracedScene, DatasetError> {
        let scene = match self {
            Self::Family { name, seed } => Family::by_name(name)?.scene(*seed),
            Self::File { path, blake3 } => {
                let path = folder.join(path);
                if file_hash(&path)? != *blake3 {
                    return Err(DatasetError::invalid(&path, "not the file that the data were made from"));
                }
                Scene::load(&path, 0.0)?
            }
        };
        Ok(TracedScene::new(scene)?)
    }
}

impl std::fmt::Display for SceneSource {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Family { name, seed } => write!(f, "{name} {seed}"),
            Self::File { path, .. } => write!(f, "{}", path.display()),
        }
    }
}

impl Recipe {
    /// All scenes and views of the recipe, always the same.
    ///
    /// # Errors
    /// If a scene file cannot be read.
    pub fn plan(&self) -> Result<Vec<PlannedScene>, DatasetError> {
        let mut sources = Vec::new();
        for family in &self.families {
            for index in 0..family.scenes {
                let seed = mix(&[u64::from(self.seed), index as u64]) >> 32;
                let source = SceneSource::Family { name: family.name.clone(), seed };
                sources.push((format!("{}-{index:04}", family.name), text_key(&family.name) ^ seed, source));
            }
        }
        for (index, (path, blake3)) in self.files.iter().zip(self.file_hashes()?).enumerate() {
            let key = text_key(&blake3);
            let stem = path.file_stem().and_then(|stem| stem.to_str()).unwrap_or_default();
            let stem: String = stem.chars().filter(char::is_ascii_alphanumeric).collect();
            sources.push((
                format!("file-{index:02}-{stem}"),
                key,
                SceneSource::File { path: path.clone(), blake3 },
            ));
        }
        let scenes = sources.len();
        let planned = sources.into_iter().enumerate().map(|(scene, (name, key, source))| PlannedScene {
            views: (0..self.views_per_scene)
                .map(|view| self.planned_view(scene, scenes, &name, key, view))
                .collect(),
            source,
            key,
        });
        Ok(planned.collect())
    }

    fn planned_view(&self, scene: usize, scenes: usize, name: &str, key: u64, view: usize) -> PlannedView {
        let held_apart = if scenes > 1 {
            held_apart(scene, scenes, self.validation_share)
        } else {
            held_apart(view, self.views_per_scene, self.validation_share)
        };
        let part = match self.split {
            Split::Test => Part::Test,
            Split::Train if held_apart => Part::Validation,
            Split::Train => Part::Training,
        };
        let seed = mix(&[u64::from(self.seed), key, view as u64]) as u32;
        PlannedView { index: view, name: format!("{name}-{view:03}"), seed, part }
    }
}

/// Whether the item of that index is among those held apart, which lie evenly among all: at least one where the
/// share is above 0 and there are two or more.
fn held_apart(index: usize, count: usize, share: f64) -> bool {
    let rounded = (share * count as f64).round() as usize;
    let wanted = if share > 0.0 && count > 1 { rounded.max(1) } else { 0 };
    spread(index, count, wanted)
}

/// Whether the item of that index is among `wanted` of `count` that lie evenly among all.
pub(crate) const fn spread(index: usize, count: usize, wanted: usize) -> bool {
    (index + 1) * wanted / count > index * wanted / count
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
    }
}
