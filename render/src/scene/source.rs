//! Where a scene comes from: a file, or a seed of a procedural family.

use super::{Scene, SceneError, procedural::Family};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Endings of scene files, small letters.
const ENDINGS: [&str; 4] = ["gltf", "glb", "obj", "ply"];

/// Where a scene comes from: `path/to/file.gltf` (.glb, .obj, .ply) or `family:seed`, such as `stairs:7`. That
/// is how it is read, displayed and stored.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum SceneSource {
    /// A file.
    File(PathBuf),
    /// A procedural family and the seed of one of its scenes.
    Procedural(Family, u64),
}

impl SceneSource {
    /// Loads or builds the scene, with animations at `time` seconds.
    ///
    /// # Errors
    /// If the file is missing or damaged.
    pub fn scene(&self, time: f32) -> Result<Scene, SceneError> {
        match self {
            Self::File(path) => Scene::load(path, time),
            Self::Procedural(family, seed) => Ok(family.scene(*seed)),
        }
    }
}

impl std::str::FromStr for SceneSource {
    type Err = SceneError;

    fn from_str(text: &str) -> Result<Self, SceneError> {
        let ending = Path::new(text).extension();
        if ending.is_some_and(|ending| ENDINGS.iter().any(|known| ending.eq_ignore_ascii_case(known))) {
            return Ok(Self::File(text.into()));
        }
        let unknown = || SceneError::UnknownSource { text: text.to_owned() };
        let (family, seed) = text.split_once(':').ok_or_else(unknown)?;
        let family = Family::by_name(family)?;
        Ok(Self::Procedural(family, seed.parse().map_err(|_| unknown())?))
    }
}

impl TryFrom<String> for SceneSource {
    type Error = SceneError;

    fn try_from(text: String) -> Result<Self, SceneError> {
        text.parse()
    }
}

impl From<SceneSource> for String {
    fn from(source: SceneSource) -> Self {
        source.to_string()
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_displayed_is_read_again() {
        let sources =
            [SceneSource::File("a/b.OBJ".into()), SceneSource::Procedural(Family::StillLife, u64::MAX)];
        for source in sources {
            assert_eq!(source.to_string().parse::<SceneSource>().expect("a source"), source);
        }
        assert_eq!(SceneSource::Procedural(Family::Stairs, 7).to_string(), "stairs:7");
    }

    #[test]
    fn what_is_no_scene_is_named() {
        let error = |text: &str| text.parse::<SceneSource>().expect_err("no scene").to_string();
        assert!(error("stairs").starts_with("`stairs` is neither a scene file"));
        assert!(error("stairs:-1").contains("`stairs:-1`"));
        assert!(error("castles:7").contains("no procedural family `castles`; there are"));
        assert!(
            error("stair:7").contains("no procedural family `stair` (did you mean `stairs`?); there are")
        );
    }
}
