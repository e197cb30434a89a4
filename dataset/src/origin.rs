//! What data on disk were made by and from: the head of a manifest and of a test set's list.

use crate::plan::PlannedScene;
use crate::shard::Shard;
use crate::{DatasetError, Recipe, vary};
use deepshade_render::exr_file;
use deepshade_shaders::Effect;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};

/// Version of what a recipe for an effect gives and of how it is described. To be increased whenever the same
/// recipe may give other pixels than before, be it by other scenes, views or samples: data of another version
/// are refused.
pub const fn data_version(effect: Effect) -> u32 {
    match effect {
        Effect::Subsurface | Effect::Sss | Effect::MotionBlur | Effect::Aa | Effect::Path | Effect::Real => 5,
        _ => 4,
    }
}

/// What data were made by and from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Origin {
    /// [`data_version`] of the program that made them.
    pub data_version: u32,
    /// Name and version of that program.
    pub program: String,
    /// BLAKE3 hash of the recipe's contents and of its files' contents, in hexadecimal. Comments, order of
    /// keys and the recipe's place do not matter.
    pub recipe_hash: String,
    /// Of a recipe that names files: what these are relative to, itself relative to the data's folder where
    /// it can be. Left out of data that were made for another place; it is no part of what tells data from
    /// others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scenes: Option<PathBuf>,
    /// BLAKE3 hashes, in hexadecimal, of the files and folders that the recipe's table `vary` names.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub props: BTreeMap<PathBuf, String>,
    /// Which part of the data these are, where they are one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shard: Option<Shard>,
    /// Name of the recipe's file.
    pub recipe_file: String,
    /// The recipe itself.
    pub recipe: Recipe,
}

/// Where data are written to.
#[derive(Clone, Copy, Debug)]
pub struct Out<'a> {
    /// The folder.
    pub folder: &'a Path,
    /// Whether they stay there. Data that are made to be brought elsewhere do not say where scene files are:
    /// from there the way to them is another one.
    pub stays: bool,
}

impl<'a, P: AsRef<Path> + ?Sized> From<&'a P> for Out<'a> {
    /// A folder that data stay in.
    fn from(folder: &'a P) -> Self {
        Self { folder: folder.as_ref(), stays: true }
    }
}

impl Out<'_> {
    /// The way to a recipe's files, where data can say it and the files are here.
    ///
    /// # Errors
    /// If the folder cannot be made.
    pub(crate) fn way_to_scenes(self, recipe: &Recipe) -> Result<Option<PathBuf>, DatasetError> {
        let says = self.stays && recipe.names_files();
        says.then(|| relative(&recipe.folder, self.folder)).transpose()
    }
}

/// As much of a file as every version has.
#[derive(Deserialize)]
pub(crate) struct Versioned {
    pub origin: Option<Version>,
}

/// Which version data are of.
#[derive(Default, Deserialize)]
pub(crate) struct Version {
    data_version: Option<u32>,
    recipe: Option<Purpose>,
}

/// As much of a recipe.
#[derive(Deserialize)]
struct Purpose {
    effect: Option<String>,
}

impl Version {
    /// Whether data of this version in a file are read by this program.
    pub fn check_version(&self, path: &Path) -> Result<(), DatasetError> {
        let effect = self.recipe.as_ref().and_then(|recipe| recipe.effect.as_deref()?.parse().ok());
        // What is of no effect that is known is refused for that, later.
        let ours = data_version(effect.unwrap_or(Effect::Ao));
        if self.data_version == Some(ours) {
            return Ok(());
        }
        let theirs = self.data_version.map_or_else(|| "0".to_owned(), |version| version.to_string());
        Err(DatasetError::OtherVersion { path: path.to_owned(), theirs, ours })
    }
}

impl Origin {
    /// What this program makes from a recipe with this plan.
    ///
    /// # Errors
    /// If the recipe's folder is gone, or a file that its table `vary` names cannot be read.
    pub fn new<'a>(
        recipe: &Recipe,
        plan: &[PlannedScene],
        out: impl Into<Out<'a>>,
    ) -> Result<Self, DatasetError> {
        let props = vary::hashes(recipe)?;
        let hashes = plan.iter().filter_map(|planned| planned.scene.blake3.as_deref());
        Ok(Self {
            data_version: data_version(recipe.effect),
            program: exr_file::PROGRAM.to_owned(),
            recipe_hash: recipe_hash(recipe, hashes.chain(props.values().map(String::as_str)))?,
            props,
            shard: None,
            scenes: out.into().way_to_scenes(recipe)?,
            recipe_file: recipe.path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            recipe: recipe.clone(),
        })
    }

    /// Refuses a folder of these data where `ours` are to be made, if these are others.
    ///
    /// # Errors
    /// If so, with what differs.
    pub(crate) fn check_same(&self, ours: &Self, folder: &Path) -> Result<(), DatasetError> {
        let job = |origin: &Self| {
            (origin.program.clone(), origin.data_version, origin.recipe_hash.clone(), origin.shard)
        };
        if job(self) == job(ours) {
            return Ok(());
        }
        Err(DatasetError::OtherData { folder: folder.to_owned(), differences: differences(self, ours)? })
    }

    /// Checks what a file states, and finds the scene files again from where it lies.
    pub(crate) fn opened(&mut self, path: &Path) -> Result<(), DatasetError> {
        self.recipe.check(path)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        self.recipe.folder = folder.join(self.scenes.as_deref().unwrap_or(Path::new("")));
        Ok(())
    }
}

/// So many differences are named.
const NAMED: usize = 5;

/// In what an origin differs from ours, in words: keys of recipes with both values.
fn differences(theirs: &Origin, ours: &Origin) -> Result<String, DatasetError> {
    let [theirs, ours] = [leaves_of(theirs)?, leaves_of(ours)?];
    let keys: BTreeSet<&String> = theirs.keys().chain(ours.keys()).collect();
    let value =
        |leaves: &BTreeMap<String, String>, key| leaves.get(key).map_or("absent", String::as_str).to_owned();
    let pairs = keys.into_iter().map(|key| (key, value(&theirs, key), value(&ours, key)));
    let differing: Vec<String> = pairs
        .filter(|(_, theirs, ours)| theirs != ours)
        .map(|(key, theirs, ours)| format!("`{key}` is {theirs} there and {ours} here"))
        .collect();
    Ok(match differing.len() {
        0 => "the scene files have other contents".to_owned(),
        1..=NAMED => differing.join(", "),
        more => format!("{} and {} more", differing[..NAMED].join(", "), more - NAMED),
    })
}

/// All values of what data were made by and from, by their keys (`resolution.height`).
fn leaves_of(origin: &Origin) -> Result<BTreeMap<String, String>, DatasetError> {
    let recipe = serde_json::to_value(&origin.recipe)
        .map_err(|error| DatasetError::invalid(&origin.recipe.path, error.to_string()))?;
    let mut leaves = BTreeMap::from([
        ("program".to_owned(), origin.program.clone()),
        ("data_version".to_owned(), origin.data_version.to_string()),
    ]);
    leaves.extend(origin.shard.map(|shard| ("shard".to_owned(), shard.to_string())));
    add_leaves(String::new(), &recipe, &mut leaves);
    for (path, hash) in &origin.props {
        leaves.insert(path.display().to_string(), format!("of hash {hash:.8}"));
    }
    Ok(leaves)
}

fn add_leaves(name: String, value: &Value, leaves: &mut BTreeMap<String, String>) {
    match value {
        Value::Object(members) => {
            for (key, value) in members {
                let dot = if name.is_empty() { "" } else { "." };
                add_leaves(format!("{name}{dot}{key}"), value, leaves);
            }
        }
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(i, item)| add_leaves(format!("{name}[{i}]"), item, leaves));
        }
        leaf => drop(leaves.insert(name, leaf.to_string())),
    }
}

/// [`Origin::recipe_hash`], from the hashes of the recipe's file scenes and other files.
pub(crate) fn recipe_hash<'a>(
    recipe: &Recipe,
    scenes: impl Iterator<Item = &'a str>,
) -> Result<String, DatasetError> {
    let contents = (recipe, scenes.collect::<Vec<_>>());
    let json = serde_json::to_vec(&contents)
        .map_err(|error| DatasetError::invalid(&recipe.path, error.to_string()))?;
    Ok(blake3::hash(&json).to_hex().to_string())
}

/// The way to a folder from another, which may not be there yet; the whole path where there is no way, as
/// from one drive to another.
pub(crate) fn relative(to: &Path, from: &Path) -> Result<PathBuf, DatasetError> {
    let whole = |path: &Path| {
        let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
        path.canonicalize().map_err(|source| DatasetError::io(path, source))
    };
    std::fs::create_dir_all(from).map_err(|source| DatasetError::io(from, source))?;
    let (to, from) = (whole(to)?, whole(from)?);
    let shared = to.components().zip(from.components()).take_while(|(to, from)| to == from).count();
    if shared == 0 {
        return Ok(to);
    }
    let up = from.components().skip(shared).map(|_| Component::ParentDir);
    Ok(up.chain(to.components().skip(shared)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_way_leads_from_one_folder_to_the_other() {
        let root = tempfile::tempdir().expect("a folder");
        let path = |name: &str| root.path().join(name);
        std::fs::create_dir_all(path("a/scenes")).expect("made");
        assert_eq!(relative(&path("a/scenes"), &path("a/b/c")).expect("a way"), Path::new("../../scenes"));
        assert_eq!(relative(&path("a/scenes"), &path("a")).expect("a way"), Path::new("scenes"));
        assert_eq!(relative(&path("a"), &path("a")).expect("a way"), Path::new(""));
        assert!(relative(&path("missing"), &path("a")).is_err());
    }
}
