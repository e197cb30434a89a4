//! What all images of a recipe share: a pool of textures and an environment.

use super::pool::Pool;
use super::{Surroundings, Textures};
use crate::recipe::file_hash;
use crate::{DatasetError, Recipe};
use deepshade_render::scene::Environment;
use deepshade_render::scene::procedural::sky;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

/// Textures and an environment.
#[derive(Debug, Default)]
pub struct Props {
    textures: Pool,
    environment: Option<Arc<Environment>>,
}

impl Props {
    /// Finds or reads what a recipe names; files are relative to [`Recipe::folder`]. Images of a folder are
    /// read when they are needed.
    ///
    /// # Errors
    /// If a file or folder is missing or damaged, or a folder holds no image.
    pub fn load(recipe: &Recipe) -> Result<Self, DatasetError> {
        let Some(vary) = &recipe.vary else { return Ok(Self::default()) };
        let textures = match &vary.textures {
            None => Pool::default(),
            Some(Textures::Procedural(count)) => Pool::patterns(*count, recipe.seed, recipe.split),
            Some(Textures::Folder(folder)) => Pool::folder(&recipe.folder.join(folder))?,
        };
        let environment = match &vary.environment {
            None => None,
            Some(Surroundings::Sky(seed)) => Some(sky(u64::from(*seed))),
            Some(Surroundings::File(path)) => Some(Environment::load(&recipe.folder.join(path))?),
        };
        Ok(Self { textures, environment: environment.map(Arc::new) })
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
    pub(super) const fn textures(&self) -> &Pool {
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
        let hash = if whole.is_dir() { Pool::folder(&whole)?.hash() } else { file_hash(&whole)? };
        Ok((path.clone(), hash))
    };
    paths.map(hash).collect()
}
