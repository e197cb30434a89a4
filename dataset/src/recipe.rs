//! Recipes: TOML files that say what data to make.
//!
//! A recipe is for training or for testing. A family is one or the other by itself; a scene file is what the recipe
//! that lists it is. A training recipe with scene files therefore names the recipes for testing that it must stay
//! away from (`test_recipes`), and is refused where the contents of one of its files, by their BLAKE3 hash, appear
//! there.

use crate::DatasetError;
use deepshade_render::path::sampler::MAX_SAMPLES;
use deepshade_render::scene::procedural::{Family, Split};
use deepshade_shaders::Effect;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

const EDGE: std::ops::RangeInclusive<usize> = 16..=8192;
const MAX_PIXELS: usize = 1 << 25;
const MAX_PAIRS: usize = 1_000_000;
const MAX_RADIUS: f32 = 1e5;
const MAX_DIAGONAL_SHARE: f32 = 10.0;

/// What data to make.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// What is to be learned.
    pub effect: Effect,
    /// What the data are for.
    #[serde(with = "SplitName")]
    pub split: Split,
    /// Chooses scenes, views and samples.
    pub seed: u32,
    /// Size of every image.
    pub resolution: Resolution,
    /// Samples of a pixel.
    pub samples: u32,
    /// How far the effect reaches.
    pub radius: Radius,
    /// Views of every scene.
    pub views_per_scene: usize,
    /// Share of the scenes, or of the views where there is one scene only, that is held apart for validation.
    #[serde(default)]
    pub validation_share: f64,
    /// Procedural scenes.
    #[serde(default)]
    pub families: Vec<FamilyShare>,
    /// Scene files, relative to the recipe's folder.
    #[serde(default)]
    pub files: Vec<PathBuf>,
    /// Recipes for testing whose scene files must not be in `files`, relative to the recipe's folder.
    #[serde(default)]
    pub test_recipes: Vec<PathBuf>,
    /// How a test set is made; see [`crate::testset`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tiles: Option<Tiles>,
    /// Where the recipe was read from.
    #[serde(skip)]
    pub path: PathBuf,
}

/// Size of an image, pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Resolution {
    /// Rows.
    pub height: usize,
    /// Columns.
    pub width: usize,
}

/// How far an effect reaches.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Radius {
    /// As a share of the diagonal of the scene's bounds.
    Diagonal(f32),
    /// In metres.
    Metres(f32),
}

/// Scenes of a procedural family.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FamilyShare {
    /// The family's name.
    pub name: String,
    /// How many of its scenes.
    pub scenes: usize,
}

/// Truth with many samples on some of the 8x8 tiles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tiles {
    /// Samples of a pixel of these tiles; even, since two independent halves are rendered.
    pub samples: u32,
    /// One tile out of so many.
    pub one_in: usize,
    /// So many frames are also kept whole, with the recipe's `samples` a pixel.
    pub whole_frames: usize,
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "Split", rename_all = "kebab-case")]
enum SplitName {
    Train,
    Test,
}

impl Radius {
    /// The radius in metres in a scene with this diagonal.
    pub fn metres(self, diagonal: f32) -> f32 {
        match self {
            Self::Diagonal(share) => share * diagonal,
            Self::Metres(metres) => metres,
        }
    }
}

impl Recipe {
    /// Reads and checks a recipe, and that it does not mix training and testing.
    ///
    /// # Errors
    /// If a file is missing, a key unknown or a value out of range, or the recipe mixes training and testing.
    pub fn load(path: &Path) -> Result<Self, DatasetError> {
        let text = std::fs::read_to_string(path).map_err(|source| DatasetError::io(path, source))?;
        let parsed: Result<Self, _> = toml::from_str(&text);
        let mut recipe = parsed
            .map_err(|error| DatasetError::Recipe { path: path.to_owned(), what: error.to_string() })?;
        recipe.path = path.to_owned();
        recipe.check_limits().map_err(|what| DatasetError::Recipe { path: path.to_owned(), what })?;
        recipe.check_families()?;
        recipe.check_files()?;
        Ok(recipe)
    }

    /// The folder that file names in the recipe are relative to.
    pub fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new(""))
    }

    /// Number of scenes.
    pub fn scene_count(&self) -> usize {
        self.families.iter().fold(self.files.len(), |sum, family| sum.saturating_add(family.scenes))
    }

    fn check_limits(&self) -> Result<(), String> {
        let Resolution { height, width } = self.resolution;
        let between = |key: &str, holds: bool, limits: &str| {
            if holds { Ok(()) } else { Err(format!("`{key}` must be {limits}")) }
        };
        let edge = format!("{} to {} pixels", EDGE.start(), EDGE.end());
        between("resolution.height", EDGE.contains(&height), &edge)?;
        between("resolution.width", EDGE.contains(&width), &edge)?;
        between("resolution", height * width <= MAX_PIXELS, &format!("at most {MAX_PIXELS} pixels in all"))?;
        let samples = format!("1 to {MAX_SAMPLES}");
        between("samples", (1..=MAX_SAMPLES).contains(&self.samples), &samples)?;
        between("validation_share", (0.0..=0.5).contains(&self.validation_share), "0 to 0.5")?;
        match self.radius {
            Radius::Diagonal(share) => {
                let holds = share > 0.0 && share <= MAX_DIAGONAL_SHARE;
                between("radius.diagonal", holds, &format!("above 0 and at most {MAX_DIAGONAL_SHARE}"))?;
            }
            Radius::Metres(metres) => {
                let holds = metres > 0.0 && metres <= MAX_RADIUS;
                between("radius.metres", holds, &format!("above 0 and at most {MAX_RADIUS}"))?;
            }
        }
        if let Some(tiles) = self.tiles {
            let even = tiles.samples.is_multiple_of(2) && (2..=MAX_SAMPLES).contains(&tiles.samples);
            between("tiles.samples", even, &format!("an even number from 2 to {MAX_SAMPLES}"))?;
            between("tiles.one_in", (1..=64).contains(&tiles.one_in), "1 to 64")?;
        }
        between("families", self.scene_count() > 0, "given, or `files`, so that there is a scene")?;
        let pairs = self.scene_count().saturating_mul(self.views_per_scene);
        let limits = format!("such that there are 1 to {MAX_PAIRS} views in all");
        between("views_per_scene", (1..=MAX_PAIRS).contains(&pairs), &limits)
    }

    fn check_families(&self) -> Result<(), DatasetError> {
        for (index, FamilyShare { name, .. }) in self.families.iter().enumerate() {
            let wrong = |what: String| DatasetError::Recipe { path: self.path.clone(), what };
            let family = Family::by_name(name).map_err(|error| wrong(format!("`families`: {error}")))?;
            if self.families[..index].iter().any(|other| other.name == *name) {
                return Err(wrong(format!("`families` names `{name}` twice")));
            }
            if family.split() != self.split {
                let (own, wanted) = (split_name(family.split()), split_name(self.split));
                let what = format!("family `{name}` is for {own} only, the recipe is for {wanted}");
                return Err(DatasetError::Mixed { path: self.path.clone(), what });
            }
        }
        Ok(())
    }

    fn check_files(&self) -> Result<(), DatasetError> {
        if self.split != Split::Train || self.files.is_empty() {
            return Ok(());
        }
        let wrong = |what: &str| DatasetError::Recipe { path: self.path.clone(), what: what.to_owned() };
        if self.test_recipes.is_empty() {
            return Err(wrong("a training recipe with `files` must name `test_recipes` to stay away from"));
        }
        let own = self.file_hashes()?;
        for path in &self.test_recipes {
            let test = Self::load(&self.folder().join(path))?;
            if test.split != Split::Test {
                return Err(wrong(&format!("`test_recipes`: {} is not for testing", path.display())));
            }
            for (file, hash) in self.files.iter().zip(&own) {
                if test.file_hashes()?.contains(hash) {
                    let what = format!("file {} is also in {}", file.display(), path.display());
                    return Err(DatasetError::Mixed { path: self.path.clone(), what });
                }
            }
        }
        Ok(())
    }

    /// BLAKE3 hashes of `files`, in hexadecimal.
    pub(crate) fn file_hashes(&self) -> Result<Vec<String>, DatasetError> {
        self.files.iter().map(|file| file_hash(&self.folder().join(file))).collect()
    }
}

/// The BLAKE3 hash of a file, in hexadecimal.
pub(crate) fn file_hash(path: &Path) -> Result<String, DatasetError> {
    let mut hasher = blake3::Hasher::new();
    let hashed = std::fs::File::open(path).and_then(|file| hasher.update_reader(file).map(|_| ()));
    hashed.map_err(|source| DatasetError::io(path, source))?;
    Ok(hasher.finalize().to_hex().to_string())
}

fn split_name(split: Split) -> &'static str {
    match split {
        Split::Train => "training",
        Split::Test => "testing",
    }
}

#[cfg(test)]
mod tests;
