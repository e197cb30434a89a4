//! The manifest: what a dataset consists of and where each file comes from. It is written last, so a folder with a
//! manifest is a whole dataset.

use crate::journal::Entry;
use crate::{DatasetError, Part, Recipe, SceneSource};
use deepshade_render::exr_file;
use deepshade_render::scene::Camera;
use deepshade_shaders::atomic_file;
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use std::path::Path;

/// The manifest's name in the dataset's folder.
pub const MANIFEST: &str = "manifest.json";

/// A dataset's contents and provenance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// Name and version of the program that made it.
    pub program: String,
    /// What it was made from, as in [`recipe_hash`].
    pub recipe_hash: String,
    /// The recipe itself.
    pub recipe: Recipe,
    /// Every pair, in the recipe's order.
    pub pairs: Vec<PairRecord>,
}

/// A pair's file and where it comes from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PairRecord {
    /// The EXR file, relative to the dataset's folder.
    pub file: String,
    /// Hash of the file, in hexadecimal.
    pub blake3: String,
    /// What it is used for.
    pub part: Part,
    /// The scene.
    pub scene: SceneSource,
    /// Which of the scene's views.
    pub view: usize,
    /// Where the view is from.
    pub camera: Camera,
    /// How far the effect reaches, metres.
    pub radius: f32,
    /// Seed of the target's samples.
    pub seed: u32,
}

impl Entry for PairRecord {
    fn name(&self) -> &str {
        &self.file
    }

    fn files(&self) -> Vec<(&str, &str)> {
        vec![(&self.file, &self.blake3)]
    }
}

/// BLAKE3 hash of a recipe's contents and of its scene files' contents, in hexadecimal. Comments, order of keys and
/// the recipe's place do not matter.
///
/// # Errors
/// If a scene file cannot be read.
pub fn recipe_hash(recipe: &Recipe) -> Result<String, DatasetError> {
    let contents = (recipe, recipe.file_hashes()?);
    let json = serde_json::to_vec(&contents)
        .map_err(|error| DatasetError::invalid(&recipe.path, error.to_string()))?;
    Ok(blake3::hash(&json).to_hex().to_string())
}

/// What tells a job from others, in words: the version of the program and the recipe.
pub(crate) fn job(program: &str, recipe_hash: &str) -> String {
    format!("{program}, recipe {recipe_hash}")
}

impl Manifest {
    /// The manifest of a recipe's pairs, made by this program.
    ///
    /// # Errors
    /// If a scene file cannot be read.
    pub fn new(recipe: &Recipe, pairs: Vec<PairRecord>) -> Result<Self, DatasetError> {
        let (program, recipe_hash) = (exr_file::PROGRAM.to_owned(), recipe_hash(recipe)?);
        Ok(Self { program, recipe_hash, recipe: recipe.clone(), pairs })
    }

    /// Reads the manifest of a dataset's folder.
    ///
    /// # Errors
    /// If it is missing or damaged.
    pub fn load(folder: &Path) -> Result<Self, DatasetError> {
        read_json(&folder.join(MANIFEST))
    }

    /// Writes it into a dataset's folder.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn save(&self, folder: &Path) -> Result<(), DatasetError> {
        write_json(&folder.join(MANIFEST), self)
    }

    /// What the data were made by and from, in words.
    pub(crate) fn job(&self) -> String {
        job(&self.program, &self.recipe_hash)
    }
}

/// Reads a JSON file.
pub(crate) fn read_json<T: DeserializeOwned>(path: &Path) -> Result<T, DatasetError> {
    let bytes = std::fs::read(path).map_err(|source| DatasetError::io(path, source))?;
    serde_json::from_slice(&bytes).map_err(|error| DatasetError::invalid(path, error.to_string()))
}

/// Writes a JSON file with line breaks.
pub(crate) fn write_json(path: &Path, value: &impl Serialize) -> Result<(), DatasetError> {
    let mut bytes =
        serde_json::to_vec_pretty(value).map_err(|error| DatasetError::invalid(path, error.to_string()))?;
    bytes.push(b'\n');
    atomic_file::write(path, &bytes).map_err(|source| DatasetError::io(path, source))
}
