//! What all images of a recipe share: a pool of textures and an environment.

use super::check::MOST_IMAGES;
use super::{Surroundings, Textures};
use crate::random::mix;
use crate::recipe::file_hash;
use crate::{DatasetError, Recipe};
use deepshade_render::scene::procedural::{pattern, sky};
use deepshade_render::scene::{Environment, SceneError, Texture};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Textures and an environment, in memory.
#[derive(Clone, Debug, Default)]
pub struct Props {
    textures: Vec<Arc<Texture>>,
    environment: Option<Arc<Environment>>,
}

impl Props {
    /// Makes or reads what a recipe names; files are relative to [`Recipe::folder`].
    ///
    /// # Errors
    /// If a file or folder is missing or damaged, or a folder holds no image or more than 512.
    pub fn load(recipe: &Recipe) -> Result<Self, DatasetError> {
        let Some(vary) = &recipe.vary else { return Ok(Self::default()) };
        let textures: Result<Vec<_>, SceneError> = match &vary.textures {
            None => Ok(Vec::new()),
            Some(Textures::Procedural(count)) => {
                let seed = |index: usize| mix(&[u64::from(recipe.seed), index as u64]);
                Ok((0..*count).into_par_iter().map(|index| Arc::new(pattern(seed(index)))).collect())
            }
            Some(Textures::Folder(folder)) => {
                let images = images(&recipe.folder.join(folder))?;
                images.par_iter().map(|path| Texture::load(path).map(Arc::new)).collect()
            }
        };
        let environment = match &vary.environment {
            None => None,
            Some(Surroundings::Sky(seed)) => Some(sky(u64::from(*seed))),
            Some(Surroundings::File(path)) => Some(Environment::load(&recipe.folder.join(path))?),
        };
        Ok(Self { textures: textures?, environment: environment.map(Arc::new) })
    }

    /// [`Props::load`] for data that were made with files of these hashes.
    ///
    /// # Errors
    /// As [`Props::load`], and if a file is not what the data were made from.
    pub fn load_again(recipe: &Recipe, made_from: &BTreeMap<PathBuf, String>) -> Result<Self, DatasetError> {
        let now = hashes(recipe)?;
        if let Some((path, _)) = now.iter().find(|(path, hash)| made_from.get(*path) != Some(hash)) {
            let what = "this is not what the data were made from";
            return Err(DatasetError::invalid(&recipe.folder.join(path), what));
        }
        Self::load(recipe)
    }

    /// The pool that objects are given textures from.
    pub(super) fn textures(&self) -> &[Arc<Texture>] {
        &self.textures
    }

    /// What shines from infinitely far away.
    pub(super) const fn environment(&self) -> Option<&Arc<Environment>> {
        self.environment.as_ref()
    }
}

/// BLAKE3 hashes, in hexadecimal, of the files and folders that a recipe names besides scenes.
///
/// # Errors
/// If one cannot be read.
pub fn hashes(recipe: &Recipe) -> Result<BTreeMap<PathBuf, String>, DatasetError> {
    let paths = recipe.vary.iter().flat_map(super::Vary::paths);
    let hash = |path: &PathBuf| {
        let whole = recipe.folder.join(path);
        let hash = if whole.is_dir() { folder_hash(&whole)? } else { file_hash(&whole)? };
        Ok((path.clone(), hash))
    };
    paths.map(hash).collect()
}

/// The hash of a folder's images and their order.
fn folder_hash(folder: &Path) -> Result<String, DatasetError> {
    let hashes: Result<Vec<String>, DatasetError> =
        images(folder)?.par_iter().map(|path| file_hash(path)).collect();
    Ok(blake3::hash(hashes?.concat().as_bytes()).to_hex().to_string())
}

/// All images in a folder, in the order of their names.
fn images(folder: &Path) -> Result<Vec<PathBuf>, DatasetError> {
    let io = |source| DatasetError::io(folder, source);
    let mut images = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(io)? {
        let path = entry.map_err(io)?.path();
        let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        if ["png", "jpg", "jpeg"].contains(&ending.as_str()) {
            images.push(path);
        }
    }
    if !(1..=MOST_IMAGES).contains(&images.len()) {
        let what = format!("{} PNG and JPEG images, where there must be 1 to {MOST_IMAGES}", images.len());
        return Err(DatasetError::invalid(folder, what));
    }
    images.sort();
    Ok(images)
}
