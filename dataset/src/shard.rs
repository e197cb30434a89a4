//! Parts of a dataset that are made apart, on whatever machines and in whatever order: `shard-2-of-5.json` lists the pairs
//! of one, [`merge`] puts them together to the bytes of a dataset that one run makes.

use crate::generate::{PAIRS, file_name};
use crate::journal::{JOURNAL, Journal, checked};
use crate::manifest::{MANIFEST, Manifest, PairRecord};
use crate::origin::relative;
use crate::plan::PlannedScene;
use crate::{DatasetError, progress};
use deepshade_shaders::atomic_file;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// One of so many parts of a dataset, written like `2/5`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Shard {
    /// Which one, from 1.
    number: usize,
    /// Of how many.
    count: usize,
}

/// Most shards of a dataset.
const MOST: usize = 1_000_000;

impl Shard {
    /// Which one, from 1.
    pub const fn number(self) -> usize {
        self.number
    }

    /// Of how many.
    pub const fn count(self) -> usize {
        self.count
    }

    /// The file that lists its pairs, in its folder.
    pub fn file_name(self) -> String {
        format!("shard-{}-of-{}.json", self.number, self.count)
    }

    /// Its scenes and views of a plan: views that follow each other, so that few scenes are in more than one shard.
    pub(crate) fn of(self, plan: Vec<PlannedScene>) -> Vec<PlannedScene> {
        let total: usize = plan.iter().map(|scene| scene.views.len()).sum();
        let own = self.places(total);
        let mut first = 0;
        let cut = plan.into_iter().map(|mut scene| {
            let before = first;
            first += scene.views.len();
            let mut place = before..;
            scene.views.retain(|_| place.next().is_some_and(|place| own.contains(&place)));
            scene
        });
        cut.filter(|scene| !scene.views.is_empty()).collect()
    }

    /// Which of so many views, counted through all scenes, are its.
    fn places(self, total: usize) -> Range<usize> {
        // Without overflow, whatever the numbers.
        let begin = |number: usize| (number as u128 * total as u128 / self.count as u128) as usize;
        begin(self.number - 1)..begin(self.number)
    }

    /// The shard whose list lies in a folder.
    fn in_folder(folder: &Path) -> Result<Self, DatasetError> {
        let entries = std::fs::read_dir(folder).map_err(|source| DatasetError::io(folder, source))?;
        let mut names = entries.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned());
        names.find_map(|name| Self::by_file(&name)).ok_or_else(|| {
            DatasetError::invalid(folder, "holds no list of a shard: it is none, or not finished as yet")
        })
    }

    fn by_file(name: &str) -> Option<Self> {
        let (number, count) = name.strip_prefix("shard-")?.strip_suffix(".json")?.split_once("-of-")?;
        format!("{number}/{count}").parse().ok()
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("`{text}` is no shard: the second of five is 2/5");
        let (number, count) = text.split_once('/').ok_or_else(wrong)?;
        let [number, count] = [number, count].map(|number| number.trim().parse::<usize>());
        match (number, count) {
            (Ok(number), Ok(count)) if (1..=count).contains(&number) && count <= MOST => {
                Ok(Self { number, count })
            }
            _ => Err(wrong()),
        }
    }
}

impl TryFrom<String> for Shard {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<Shard> for String {
    fn from(shard: Shard) -> Self {
        shard.to_string()
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.count)
    }
}

/// Pairs that a dataset or shard in a folder has so far, by its journal, which is believed: for whoever wants to know how
/// far it is.
pub fn pairs_so_far(folder: &Path) -> usize {
    let lines = std::fs::read(folder.join(JOURNAL)).unwrap_or_default();
    // The first line says what is made.
    lines.iter().filter(|byte| **byte == b'\n').count().saturating_sub(1)
}

/// Puts all shards of a dataset together in a folder, or what is still missing of it; every file is read and checked.
/// Gives the number of pairs.
///
/// # Errors
/// If a shard is missing, there twice, unfinished, damaged, of other data than the first or not what its recipe plans,
/// or the folder cannot be written, is in use or holds something else.
pub fn merge(shards: &[PathBuf], folder: &Path) -> Result<usize, DatasetError> {
    let lists = shards.iter().map(|shard| listed(shard)).collect::<Result<Vec<_>, _>>()?;
    let lists = complete(lists, folder)?;
    let Some((_, _, first)) = lists.first() else {
        return Err(DatasetError::invalid(folder, "no shard is given"));
    };
    let planned: Vec<String> = first.origin.recipe.view_names().map(|view| file_name(&view)).collect();
    lists.iter().try_for_each(|list| lists_its_own(list, &planned))?;
    let mut origin = first.origin.clone();
    origin.shard = None;
    // Scene files need not be where parts are put together: the way to them stays as it is stated then.
    if origin.recipe.names_files() && origin.recipe.folder.exists() {
        origin.scenes = Some(relative(&origin.recipe.folder, folder)?);
    }
    let (journal, mut entries) = Journal::open::<PairRecord>(folder, &[PAIRS], MANIFEST, &origin)?;
    if folder.join(MANIFEST).exists() {
        let earlier = Manifest::load(folder)?;
        earlier.origin.check_same(&origin, folder)?;
        entries.extend(earlier.pairs);
    }
    let known = checked(folder, entries);
    let pairs: Vec<(&Path, &PairRecord)> = lists
        .iter()
        .flat_map(|(_, from, list)| list.pairs.iter().map(|pair| (from.as_path(), pair)))
        .collect();
    let there = |pair: &PairRecord| known.get(&pair.file).is_some_and(|known| known.blake3 == pair.blake3);
    let bar = progress::bar("pairs", pairs.len(), pairs.iter().filter(|(_, pair)| there(pair)).count());
    pairs.par_iter().filter(|(_, pair)| !there(pair)).try_for_each(|(from, pair)| {
        copied(from, folder, pair)?;
        bar.inc(1);
        journal.add(*pair)
    })?;
    bar.finish_and_clear();
    let manifest = Manifest { origin, pairs: pairs.into_iter().map(|(_, pair)| pair.clone()).collect() };
    manifest.save(folder)?;
    journal.finish()?;
    Ok(manifest.pairs.len())
}

/// A shard's list with its place.
type Listed = (Shard, PathBuf, Manifest);

fn listed(folder: &Path) -> Result<Listed, DatasetError> {
    let shard = Shard::in_folder(folder)?;
    let name = shard.file_name();
    let manifest = Manifest::load_list(folder, &name)?;
    if manifest.origin.shard != Some(shard) {
        return Err(DatasetError::invalid(&folder.join(name), "it lists another shard than its name says"));
    }
    Ok((shard, folder.to_owned(), manifest))
}

/// All shards of one dataset in their order, or what keeps them from being that.
fn complete(mut lists: Vec<Listed>, folder: &Path) -> Result<Vec<Listed>, DatasetError> {
    lists.sort_by_key(|(shard, ..)| *shard);
    let Some((Shard { count, .. }, _, first)) = lists.first() else { return Ok(lists) };
    let same = first.origin.clone();
    for (shard, from, list) in &lists {
        if shard.count != *count {
            let what = format!("it is shard {shard}, where others are of {count}");
            return Err(DatasetError::invalid(from, what));
        }
        let mut origin = list.origin.clone();
        origin.shard = same.shard;
        origin.check_same(&same, from)?;
    }
    if let Some(twice) = lists.windows(2).find(|two| two[0].0 == two[1].0) {
        let what = format!("it is shard {}, as is {}", twice[1].0, twice[0].1.display());
        return Err(DatasetError::invalid(&twice[1].1, what));
    }
    let missing: Vec<String> = (1..=*count)
        .filter(|number| lists.binary_search_by_key(number, |(shard, ..)| shard.number).is_err())
        .map(|number| format!("{number}/{count}"))
        .collect();
    if missing.is_empty() {
        return Ok(lists);
    }
    Err(DatasetError::invalid(folder, format!("shards are missing: {}", missing.join(", "))))
}

/// Whether a list names the files that its recipe plans for that shard, none of them twice and none elsewhere.
fn lists_its_own((shard, from, list): &Listed, planned: &[String]) -> Result<(), DatasetError> {
    let own = &planned[shard.places(planned.len())];
    let wrong = |what: String| Err(DatasetError::invalid(&from.join(shard.file_name()), what));
    if list.pairs.len() != own.len() {
        return wrong(format!("it lists {} pairs where its recipe has {}", list.pairs.len(), own.len()));
    }
    match list.pairs.iter().zip(own).find(|(pair, planned)| pair.file != **planned) {
        Some((pair, planned)) => {
            wrong(format!("it lists `{}` where its recipe has `{planned}`", pair.file.escape_debug()))
        }
        None => Ok(()),
    }
}

/// Copies a pair that is what its record says.
fn copied(from: &Path, to: &Path, pair: &PairRecord) -> Result<(), DatasetError> {
    let source = from.join(&pair.file);
    let bytes = std::fs::read(&source).map_err(|error| DatasetError::io(&source, error))?;
    let hash = blake3::hash(&bytes).to_hex().to_string();
    if hash != pair.blake3 {
        let what =
            format!("its hash is {hash}, not {}: generate that shard again, which mends it", pair.blake3);
        return Err(DatasetError::invalid(&source, what));
    }
    let target = to.join(&pair.file);
    atomic_file::write(&target, &bytes).map_err(|error| DatasetError::io(&target, error))
}

#[cfg(test)]
mod tests;
