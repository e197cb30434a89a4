//! The manifest: what a dataset consists of and where each file comes from. It is written last, so a folder
//! with a manifest is a whole dataset.

use crate::journal::Entry;
use crate::origin::{Origin, Versioned};
use crate::{DatasetError, SceneRecord, Shard, TrainingSplit, Variation};
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
    /// What it was made by and from.
    pub origin: Origin,
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
    pub part: TrainingSplit,
    /// The scene.
    pub scene: SceneRecord,
    /// Which of the scene's views.
    pub view: usize,
    /// Where the view is from.
    pub camera: Camera,
    /// How far the effect reaches, metres.
    pub radius: f32,
    /// Seed of the target's samples.
    pub seed: u32,
    /// What the image was given beside what its scene brings.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub variation: Option<Variation>,
}

impl Entry for PairRecord {
    fn name(&self) -> &str {
        &self.file
    }

    fn files(&self) -> Vec<(&str, &str)> {
        vec![(&self.file, &self.blake3)]
    }
}

impl Manifest {
    /// Reads the manifest of a dataset's folder.
    ///
    /// # Errors
    /// If it is missing, as it is in the folder of a shard, damaged, of another version of the data, or
    /// states values beyond a recipe's limits.
    pub fn load(folder: &Path) -> Result<Self, DatasetError> {
        match Shard::in_folder(folder) {
            Some(shard) => Err(DatasetError::invalid(folder, shard.is_no_dataset())),
            None => Self::load_list(folder, MANIFEST),
        }
    }

    /// [`Manifest::load`] of a file of another name: the list of a shard.
    pub(crate) fn load_list(folder: &Path, name: &str) -> Result<Self, DatasetError> {
        let path = folder.join(name);
        let bytes = std::fs::read(&path).map_err(|source| DatasetError::io(&path, source))?;
        Self::parse(&bytes, &path)
    }

    /// [`Manifest::load`] of bytes that are at a path, or would be.
    pub(crate) fn parse(bytes: &[u8], path: &Path) -> Result<Self, DatasetError> {
        let mut manifest: Self = parse_json(bytes, path)?;
        manifest.origin.opened(path)?;
        Ok(manifest)
    }

    /// BLAKE3 hash, in hexadecimal, of the manifest in a dataset's folder, but for the way to scene files,
    /// which depends on where the folder is. It tells the data from all others, since the manifest holds the
    /// hash of every pair. Where no way is stated it is the hash of the file.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn file_hash(folder: &Path) -> Result<String, DatasetError> {
        let path = folder.join(MANIFEST);
        let mut manifest: Self = read_json(&path)?;
        manifest.origin.scenes = None;
        Ok(blake3::hash(&json(&path, &manifest)?).to_hex().to_string())
    }

    /// Writes it into a dataset's folder.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn save(&self, folder: &Path) -> Result<(), DatasetError> {
        self.save_list(folder, MANIFEST)
    }

    /// [`Manifest::save`] as a file of another name: the list of a shard.
    pub(crate) fn save_list(&self, folder: &Path, name: &str) -> Result<(), DatasetError> {
        write_json(&folder.join(name), self)
    }
}

/// Reads a JSON file that states its [`Origin`], if it is of this version of the data.
pub(crate) fn read_json<T: DeserializeOwned>(path: &Path) -> Result<T, DatasetError> {
    parse_json(&std::fs::read(path).map_err(|source| DatasetError::io(path, source))?, path)
}

/// [`read_json`] of bytes that are at a path, or would be.
fn parse_json<T: DeserializeOwned>(bytes: &[u8], path: &Path) -> Result<T, DatasetError> {
    let invalid = |error: serde_json::Error| DatasetError::invalid(path, error.to_string());
    let Versioned { origin } = serde_json::from_slice(bytes).map_err(invalid)?;
    origin.unwrap_or_default().check_version(path)?;
    serde_json::from_slice(bytes).map_err(invalid)
}

/// Writes a JSON file with line breaks.
pub(crate) fn write_json(path: &Path, value: &impl Serialize) -> Result<(), DatasetError> {
    let bytes = json(path, value)?;
    atomic_file::write(path, &bytes).map_err(|source| DatasetError::io(path, source))
}

/// What a JSON file at a path holds.
fn json(path: &Path, value: &impl Serialize) -> Result<Vec<u8>, DatasetError> {
    let mut bytes =
        serde_json::to_vec_pretty(value).map_err(|error| DatasetError::invalid(path, error.to_string()))?;
    bytes.push(b'\n');
    Ok(bytes)
}
