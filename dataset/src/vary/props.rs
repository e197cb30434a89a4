//! What all images of a recipe share: a pool of textures and one of environments.

use super::draw::purpose;
use super::pool::Pool;
use super::{Surroundings, Textures};
use crate::random::mix;
use crate::recipe::file_hash;
use crate::{DatasetError, Recipe};
use deepshade_render::scene::Environment;
use deepshade_render::scene::procedural::{Split, sky};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

/// Textures and environments.
#[derive(Debug, Default)]
pub struct Props {
    textures: Pool,
    environments: Vec<Arc<Environment>>,
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
        let environments = match &vary.environment {
            None => Vec::new(),
            Some(Surroundings::Sky(seed)) => vec![sky(u64::from(*seed))],
            Some(Surroundings::Skies(count)) => {
                let split = u64::from(recipe.split == Split::Test);
                let seed = |index: usize| mix(&[u64::from(recipe.seed), split, index as u64]);
                (0..*count).into_par_iter().map(|index| sky(seed(index))).collect()
            }
            Some(Surroundings::File(path)) => vec![Environment::load(&recipe.folder.join(path))?],
        };
        Ok(Self { textures, environments: environments.into_iter().map(Arc::new).collect() })
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

    /// What shines from infinitely far away in the image of a seed.
    pub(super) fn environment(&self, seed: u64) -> Option<&Arc<Environment>> {
        let count = self.environments.len() as u64;
        let chosen = if count > 1 { mix(&[seed, purpose::ENVIRONMENT]) % count } else { 0 };
        self.environments.get(chosen as usize)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vary;
    use std::path::Path;

    #[test]
    fn images_have_skies_of_a_pool_and_those_of_tests_are_others() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("recipes/ibl.toml");
        let recipe = Recipe::load(&path).expect("a sound recipe");
        let vary = Vary { environment: Some(Surroundings::Skies(3)), ..Vary::default() };
        let training = Recipe { vary: Some(vary), ..recipe };
        let testing = Recipe { split: Split::Test, ..training.clone() };
        let skies = |recipe: &Recipe| {
            let props = Props::load(recipe).expect("no files");
            (0..32).map(|seed| props.environment(seed).expect("a sky").clone()).collect::<Vec<_>>()
        };
        let (training, again, testing) = (skies(&training), skies(&training), skies(&testing));
        assert_eq!(training, again, "a seed has one sky");
        let distinct = |skies: &[Arc<Environment>]| {
            (0..skies.len()).filter(|index| !skies[..*index].contains(&skies[*index])).count()
        };
        assert_eq!(distinct(&training), 3);
        assert!(testing.iter().all(|sky| !training.contains(sky)));
    }
}
