//! The scenes of data on disk, and how it is noticed that a scene file is no longer what it was.

use crate::DatasetError;
use crate::identity::scene_hash;
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::{Scene, SceneSource};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A scene that data were made of.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneRecord {
    /// Where it comes from; a file is named as in the recipe, relative to the recipe's folder.
    pub source: SceneSource,
    /// Of a file, [`scene_hash`] of what was in it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub blake3: Option<String>,
}

impl SceneRecord {
    /// Makes or reads the scene, ready for rays; files are relative to `folder`.
    ///
    /// # Errors
    /// If the file is missing, damaged, or does not hold the scene that the hash is of.
    pub fn load(&self, folder: &Path) -> Result<TracedScene, DatasetError> {
        Ok(TracedScene::new(self.read(folder)?)?)
    }

    /// Makes or reads the scene; files are relative to `folder`.
    ///
    /// # Errors
    /// As [`SceneRecord::load`].
    pub fn read(&self, folder: &Path) -> Result<Scene, DatasetError> {
        Ok(match &self.source {
            SceneSource::Procedural(family, seed) => family.scene(*seed),
            SceneSource::File(path) => {
                let path = folder.join(path);
                let scene = Scene::load(&path, 0.0)?;
                if self.blake3 != Some(scene_hash(&scene)) {
                    let what = "this file, or one that it refers to, is not what the data were made from";
                    return Err(DatasetError::invalid(&path, what));
                }
                scene
            }
        })
    }
}

impl std::fmt::Display for SceneRecord {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.source.fmt(f)
    }
}
