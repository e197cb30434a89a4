//! Recipes: TOML files that say what data to make.
//!
//! A recipe is for training or for testing. A family is one or the other by itself; a scene file is what the
//! recipe that lists it is. A training recipe with scene files therefore names the recipes for testing that
//! it must stay away from (`test_recipes`), and is refused where one of its scenes appears there, under
//! another name or in another format ([`crate::identity`]). Rotated, mirrored or extended copies of a scene
//! are not recognised: who makes such answers for them.

mod check;
pub mod drawn;

use crate::{DatasetError, Vary};
use deepshade_render::methods::estimate::Estimator;
use deepshade_render::scene::procedural::Split;
use deepshade_shaders::{Attribute, Effect, names};
use glam::Vec3;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// What data to make.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// What is to be learned.
    pub effect: Effect,
    /// What targets are: a method's images, by its name; truth without it, and `samples` mean nothing with
    /// it. See [`crate::target`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub target: Option<String>,
    /// What the data are for.
    #[serde(with = "SplitName")]
    pub split: Split,
    /// Chooses scenes, views and samples.
    pub seed: u32,
    /// Size of every image; with `smallest` the largest.
    pub resolution: Resolution,
    /// The smallest image of sizes that are drawn for each view, log-uniformly: see [`Recipe::size`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub smallest: Option<Resolution>,
    /// Samples of a pixel; with `error` the most.
    pub samples: u32,
    /// Of pairs: independent sequences that a target's samples are split over. With several of them targets
    /// come with the variance of their noise, which losses by structural similarity take off; one, the
    /// default, has a little less noise.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub scramblings: u32,
    /// Of pairs: noise below which a target takes no more samples, as a share of its values; see
    /// [`Goal::error`](deepshade_render::path::Goal). Targets then come with their variance, too.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<f32>,
    /// How far the effect reaches; of effects without a reach, the length by which networks measure.
    pub radius: Radius,
    /// Views of every scene.
    pub views_per_scene: usize,
    /// Where sampled views are from.
    #[serde(default, skip_serializing_if = "is_anywhere")]
    pub views: Views,
    /// Where all views are from; without it, they are sampled.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera: Option<Viewpoint>,
    /// Vertical field of view, degrees. Without it 50.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub field_of_view: Option<FieldOfView>,
    /// Views that follow each other, as the camera goes on a little, for networks that know what they made of
    /// the frame before: as many of `views_per_scene` as there are frames belong together. With
    /// `vary.timeline` time goes on, too.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sequence: Option<Sequence>,
    /// Share of the scenes, or of the views where there is one scene only, that is held apart for validation.
    #[serde(default)]
    pub validation_share: f64,
    /// Procedural scenes.
    #[serde(default)]
    pub families: Vec<FamilyShare>,
    /// Scene files, relative to the recipe's folder.
    #[serde(default)]
    pub files: Vec<PathBuf>,
    /// Captures of a real camera, [`crate::capture`], in place of scenes, relative to the recipe's folder: of
    /// each `views_per_scene` frames, evenly spread, of which colours are targets as they are, and `samples`
    /// mean nothing.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub captures: Vec<PathBuf>,
    /// Recipes for testing whose scene files must not be in `files`, relative to the recipe's folder.
    #[serde(default)]
    pub test_recipes: Vec<PathBuf>,
    /// Methods that estimate what a network reads, METHOD:QUALITY: pairs hold their images. Those that look
    /// beyond the screen have to be here; others can be made of a pair's g-buffer whenever it is read.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub estimates: Vec<String>,
    /// How a test set is made; see [`crate::testset`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tiles: Option<Tiles>,
    /// What images are given beside what their scenes bring.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vary: Option<Vary>,
    /// Where the recipe was read from; empty in data that were made from it.
    #[serde(skip)]
    pub path: PathBuf,
    /// What `files`, and those of `vary`, are relative to: the recipe's folder, or where data made from it
    /// say that the files are.
    #[serde(skip)]
    pub folder: PathBuf,
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

/// A camera that does not move, with [`FIELD_OF_VIEW`](deepshade_render::scene::camera::FIELD_OF_VIEW).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Viewpoint {
    /// Where it stands, world space, metres.
    pub position: Vec3,
    /// What it looks at, world space, metres.
    pub target: Vec3,
}

/// Where sampled views are from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Views {
    /// From anywhere in the scene to anywhere; see [`crate::views`].
    #[default]
    Anywhere,
    /// Every other view as above, and the others from near a surface; see [`crate::views::near`].
    NearAndFar,
}

/// A vertical field of view, degrees.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "a number of degrees, or the two that it is drawn between")]
pub enum FieldOfView {
    /// That of all views, each of them such that all fields of view can be had, the camera going along its
    /// axis, so that a scene has the same views at all of them; see [`crate::views::dolly`].
    Fixed(f32),
    /// Drawn uniformly for each view.
    Drawn([f32; 2]),
}

impl std::fmt::Display for FieldOfView {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Fixed(degrees) => write!(f, "{degrees}"),
            Self::Drawn([low, high]) => write!(f, "{low} to {high}"),
        }
    }
}

/// A camera that goes on a little from frame to frame, always as fast.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sequence {
    /// How many views follow each other.
    pub frames: usize,
    /// How far the camera turns from one to the next, degrees; 0 where it stands still.
    pub turn: f32,
    /// How far it goes from one to the next, as a share of the diagonal of the scene's bounds.
    pub step: f32,
}

/// How far an effect reaches.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Radius {
    /// As a share of the diagonal of the scene's bounds.
    Diagonal(f32),
    /// In metres.
    Metres(f32),
    /// Drawn log-uniformly for each view, in pixels: so many it spans at the median depth of what the view
    /// sees. At most half the diagonal of the scene's bounds.
    Pixels([f32; 2]),
    /// Drawn log-uniformly for each view, in metres.
    MetresBetween([f32; 2]),
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
    /// Samples of a pixel of these tiles; a multiple of 8, since there are eight independent scramblings.
    pub samples: u32,
    /// One tile out of so many.
    pub one_in: usize,
    /// So many frames are also kept whole, with the recipe's `samples` a pixel.
    pub whole_frames: usize,
}

const fn one() -> u32 {
    1
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde asks")]
const fn is_one(count: &u32) -> bool {
    *count == 1
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde asks")]
const fn is_anywhere(views: &Views) -> bool {
    matches!(views, Views::Anywhere)
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "Split", rename_all = "kebab-case")]
enum SplitName {
    Train,
    Test,
}

impl Recipe {
    /// Reads and checks a recipe, and that it does not mix training and testing.
    ///
    /// # Errors
    /// If a file is missing, a key unknown or a value out of range, or the recipe mixes training and testing.
    pub fn load(path: &Path) -> Result<Self, DatasetError> {
        let recipe = Self::parse(path)?;
        recipe.check_files(None)?;
        Ok(recipe)
    }

    /// [`Recipe::load`] with scene files, those of `test_recipes` too, that are not relative to the recipe
    /// that names them but to `scenes`.
    ///
    /// # Errors
    /// As [`Recipe::load`].
    pub fn load_with_scenes(path: &Path, scenes: &Path) -> Result<Self, DatasetError> {
        let recipe = Self { folder: scenes.to_owned(), ..Self::parse(path)? };
        recipe.check_files(Some(scenes))?;
        Ok(recipe)
    }

    /// Reads a recipe and checks all but its scene files.
    fn parse(path: &Path) -> Result<Self, DatasetError> {
        let text = std::fs::read_to_string(path).map_err(|source| DatasetError::io(path, source))?;
        let parsed: Result<Self, _> = toml::from_str(&text);
        let mut recipe = parsed.map_err(|error| DatasetError::Recipe {
            path: path.to_owned(),
            what: names::with_meant(&error.to_string()),
        })?;
        recipe.path = path.to_owned();
        recipe.folder = path.parent().unwrap_or(Path::new("")).to_owned();
        recipe.check(path)?;
        Ok(recipe)
    }

    /// Whether it names files that are relative to [`Recipe::folder`].
    pub(crate) fn names_files(&self) -> bool {
        !self.files.is_empty()
            || !self.captures.is_empty()
            || self.vary.iter().any(|vary| vary.paths().next().is_some())
    }

    /// Whether its frames are of a timeline.
    pub(crate) fn is_timeline(&self) -> bool {
        self.vary.as_ref().is_some_and(|vary| vary.timeline.is_some())
    }

    /// The attributes of its pairs: what is [seen](Recipe::seen_attributes), and what methods estimate.
    pub fn attributes(&self) -> Vec<Attribute> {
        let mut attributes = self.seen_attributes();
        attributes.extend(self.estimators().flat_map(|estimator| estimator.makes()));
        attributes
    }

    /// The methods that estimate what a network reads.
    pub(crate) fn estimators(&self) -> impl Iterator<Item = Estimator> {
        self.estimates.iter().filter_map(|text| Estimator::parse(self.effect, text).ok())
    }

    /// What of a scene is seen in its pairs: the attributes of its effect, and in a timeline how things move.
    pub fn seen_attributes(&self) -> Vec<Attribute> {
        let mut attributes = self.effect.attributes().to_vec();
        if self.is_timeline() && !attributes.contains(&Attribute::Motion) {
            // The mask is the last of all.
            attributes.insert(attributes.len() - 1, Attribute::Motion);
        }
        attributes
    }

    /// Whether targets of its pairs come with their variance.
    pub const fn knows_variance(&self) -> bool {
        self.scramblings > 1 || self.error.is_some()
    }

    /// Number of scenes and captures.
    pub fn scene_count(&self) -> usize {
        self.families
            .iter()
            .fold(self.files.len() + self.captures.len(), |sum, family| sum.saturating_add(family.scenes))
    }
}

/// The BLAKE3 hash of a file, in hexadecimal.
pub(crate) fn file_hash(path: &Path) -> Result<String, DatasetError> {
    let mut hasher = blake3::Hasher::new();
    let hashed = std::fs::File::open(path).and_then(|file| hasher.update_reader(file).map(|_| ()));
    hashed.map_err(|source| DatasetError::io(path, source))?;
    Ok(hasher.finalize().to_hex().to_string())
}

/// What a split is for, in words.
pub(crate) const fn split_name(split: Split) -> &'static str {
    match split {
        Split::Train => "training",
        Split::Test => "testing",
    }
}

#[cfg(test)]
mod tests;
