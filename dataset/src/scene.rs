//! The scenes of data on disk, and how it is noticed that a scene file is no longer what it was.

use crate::DatasetError;
use crate::identity::scene_hash;
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::{Scene, SceneError, SceneSource};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// What data are of: a scene, as [`SceneSource`] is written, or `capture:folder`. That is how it is read,
/// displayed and stored.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum SceneOrCapture {
    /// What is rendered.
    Scene(SceneSource),
    /// What was photographed: the folder of a [`Capture`](crate::Capture).
    Capture(PathBuf),
}

/// What stands before a capture's folder.
const CAPTURE: &str = "capture:";

impl TryFrom<String> for SceneOrCapture {
    type Error = SceneError;

    fn try_from(text: String) -> Result<Self, SceneError> {
        match text.strip_prefix(CAPTURE) {
            Some(folder) => Ok(Self::Capture(folder.into())),
            None => Ok(Self::Scene(text.parse()?)),
        }
    }
}

impl From<SceneOrCapture> for String {
    fn from(subject: SceneOrCapture) -> Self {
        subject.to_string()
    }
}

impl std::fmt::Display for SceneOrCapture {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Scene(source) => source.fmt(f),
            Self::Capture(folder) => write!(f, "{CAPTURE}{}", folder.display()),
        }
    }
}

/// A scene, or a capture, that data were made of.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneRecord {
    /// Where it comes from; a file or folder is named as in the recipe, relative to the recipe's folder.
    pub source: SceneOrCapture,
    /// Of a file, [`scene_hash`] of what was in it; of a capture, [`Capture::hash`](crate::Capture::hash) of
    /// its frames that data are of.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub blake3: Option<String>,
}

impl SceneRecord {
    /// Makes or reads the scene, ready for rays; files are relative to `folder`.
    ///
    /// # Errors
    /// If it is a capture, or the file is missing, damaged, or does not hold the scene that the hash is of.
    pub fn load(&self, folder: &Path) -> Result<TracedScene, DatasetError> {
        Ok(TracedScene::new(self.read(folder)?)?)
    }

    /// Makes or reads the scene; files are relative to `folder`.
    ///
    /// # Errors
    /// As [`SceneRecord::load`].
    pub fn read(&self, folder: &Path) -> Result<Scene, DatasetError> {
        Ok(match &self.source {
            SceneOrCapture::Capture(folder_of) => {
                return Err(DatasetError::invalid(
                    &folder.join(folder_of),
                    "is a capture, where a scene is due",
                ));
            }
            SceneOrCapture::Scene(SceneSource::Procedural(family, seed)) => family.scene(*seed),
            SceneOrCapture::Scene(SceneSource::File(path)) => {
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
