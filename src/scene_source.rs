//! What `--scene` may say: a scene file, or a procedural family with a seed.

use anyhow::{Context, Result, bail};
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::{Scene, procedural::Family};
use std::path::{Path, PathBuf};

/// Where a scene comes from: `path/to/file.gltf` (.glb, .obj) or `family:seed`, such as `stairs:7`.
#[derive(Clone, Debug, PartialEq)]
pub enum SceneSource {
    /// A file.
    File(PathBuf),
    /// A procedural family and the seed of one of its scenes.
    Procedural(Family, u64),
}

impl SceneSource {
    /// Loads or builds the scene, with animations at `time` seconds, and makes it ready for rays.
    ///
    /// # Errors
    /// If the file is missing or damaged.
    pub fn trace(&self, time: f32) -> Result<TracedScene> {
        Ok(TracedScene::new(self.scene(time)?)?)
    }

    /// Loads or builds the scene, with animations at `time` seconds.
    ///
    /// # Errors
    /// If the file is missing or damaged.
    pub fn scene(&self, time: f32) -> Result<Scene> {
        match self {
            Self::File(path) => Ok(Scene::load(path, time)?),
            Self::Procedural(family, seed) => Ok(family.scene(*seed)),
        }
    }
}

impl std::str::FromStr for SceneSource {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let is_file = Path::new(text).extension().is_some_and(|ending| {
            ["gltf", "glb", "obj"].iter().any(|known| ending.eq_ignore_ascii_case(known))
        });
        if is_file {
            return Ok(Self::File(text.into()));
        }
        let Some((family, seed)) = text.split_once(':') else {
            bail!(
                "`{text}` is neither a scene file (.gltf, .glb, .obj) nor a family and a seed such as `stairs:7`"
            );
        };
        let seed = seed.parse().with_context(|| format!("seed of `{text}`"))?;
        Ok(Self::Procedural(Family::by_name(family)?, seed))
    }
}

impl std::fmt::Display for SceneSource {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::File(path) => write!(f, "{}", path.display()),
            Self::Procedural(family, seed) => write!(f, "{}:{seed}", family.name()),
        }
    }
}
