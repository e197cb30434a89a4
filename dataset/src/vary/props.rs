//! What all images of a recipe share: a pool of textures, one of environments, and the methods that estimate
//! what networks read.

use super::draw::purpose;
use super::pool::Pool;
use super::{Surroundings, Textures};
use crate::random::{mix, uniform};
use crate::recipe::file_hash;
use crate::{DatasetError, Recipe};
use deepshade_render::methods::estimate::Estimator;
use deepshade_render::scene::Environment;
use deepshade_render::scene::procedural::{Split, sky};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

/// Textures, environments and methods.
#[derive(Debug, Default)]
pub struct Props {
    textures: Pool,
    environments: Vec<Arc<Environment>>,
    /// Share of the images that have one; all without it.
    environment_share: Option<f32>,
    estimators: Vec<Estimator>,
}

impl Props {
    /// Finds or reads what a recipe names; files are relative to [`Recipe::folder`]. Images of a folder are
    /// read when they are needed.
    ///
    /// # Errors
    /// If a file or folder is missing or damaged, or a folder holds no image.
    pub fn load(recipe: &Recipe) -> Result<Self, DatasetError> {
        let estimators = recipe.estimators().collect();
        let Some(vary) = &recipe.vary else { return Ok(Self { estimators, ..Self::default() }) };
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
        let environments = environments.into_iter().map(Arc::new).collect();
        Ok(Self { textures, environments, environment_share: vary.environment_share, estimators })
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

    /// The methods that estimate what networks read.
    pub(super) fn estimators(&self) -> &[Estimator] {
        &self.estimators
    }

    /// What shines from infinitely far away in the image of a seed.
    pub(super) fn environment(&self, seed: u64) -> Option<&Arc<Environment>> {
        let has = |share| uniform(&[seed, purpose::HAS_ENVIRONMENT]) < share;
        if !self.environment_share.is_none_or(has) {
            return None;
        }
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

    #[test]
    fn so_many_images_have_an_environment_as_their_share_says() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("recipes/ibl.toml");
        let recipe = Recipe::load(&path).expect("a sound recipe");
        let under = |environment_share: f32| {
            let environment = Some(Surroundings::Sky(1));
            let vary = Vary { environment, environment_share: Some(environment_share), ..Vary::default() };
            let props = Props::load(&Recipe { vary: Some(vary), ..recipe.clone() }).expect("no files");
            (0..1000).filter(|seed| props.environment(*seed).is_some()).count()
        };
        let [none, some, all] = [0.0, 0.3, 1.0].map(under);
        assert_eq!([none, all], [0, 1000]);
        // Four standard deviations.
        assert!((242..358).contains(&some), "{some}");
    }
}
