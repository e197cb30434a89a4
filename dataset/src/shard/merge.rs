//! Putting shards together. Every pair is read, held against its hash and written where it belongs, one by
//! one.

use super::Shard;
use crate::generate::{PAIRS, file_name};
use crate::journal::{Journal, checked};
use crate::manifest::{MANIFEST, Manifest, PairRecord};
use crate::origin::{Origin, Out};
use crate::{DatasetError, progress};
use deepshade_shaders::atomic_file;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Puts all shards of a dataset together in a folder, or what is still missing of it; every file is read and
/// checked. Gives the number of pairs.
///
/// # Errors
/// If a shard is missing, there twice, unfinished, damaged, of other data than the first or not what its
/// recipe plans, or the folder cannot be written, is in use or holds something else.
pub fn merge<'a>(shards: &[PathBuf], out: impl Into<Out<'a>>) -> Result<usize, DatasetError> {
    let out = out.into();
    let lists = shards.par_iter().map(|folder| listed(folder)).collect::<Result<_, _>>()?;
    let lists = complete(lists, out.folder)?;
    lists.par_iter().try_for_each(Listed::check_pairs)?;
    let (manifest, journal) = together(&lists, out)?;
    manifest.save(out.folder)?;
    journal.finish()?;
    Ok(manifest.pairs.len())
}

/// What of a shard's list keeps it from being put together with others, if something does.
pub(crate) fn list_fault(folder: &Path) -> Option<String> {
    let fault = listed(folder).and_then(|list| list.check_pairs());
    fault.err().map(|error| match error {
        DatasetError::Invalid { what, .. } => what,
        other => other.to_string(),
    })
}

/// A shard with its list.
struct Listed<'a> {
    shard: Shard,
    folder: &'a Path,
    manifest: Manifest,
}

impl Listed<'_> {
    /// Whether the list names the files that its recipe plans for that shard, none of them twice and none
    /// elsewhere.
    fn check_pairs(&self) -> Result<(), DatasetError> {
        let planned: Vec<String> =
            self.manifest.origin.recipe.view_names().map(|view| file_name(&view)).collect();
        let own = &planned[self.shard.places(planned.len())];
        let pairs = &self.manifest.pairs;
        let wrong =
            |what: String| Err(DatasetError::invalid(&self.folder.join(self.shard.file_name()), what));
        if pairs.len() != own.len() {
            return wrong(format!("it lists {} pairs where its recipe has {}", pairs.len(), own.len()));
        }
        match pairs.iter().zip(own).find(|(pair, planned)| pair.file != **planned) {
            Some((pair, planned)) => {
                wrong(format!("it lists `{}` where its recipe has `{planned}`", pair.file.escape_debug()))
            }
            None => Ok(()),
        }
    }
}

fn listed(folder: &Path) -> Result<Listed<'_>, DatasetError> {
    let entries = std::fs::read_dir(folder).map_err(|source| DatasetError::io(folder, source))?;
    let names = entries.flatten().map(|entry| entry.file_name());
    let shard =
        names.into_iter().find_map(|name| Shard::by_file(&name.to_string_lossy())).ok_or_else(|| {
            DatasetError::invalid(folder, "holds no list of a shard: it is none, or not finished as yet")
        })?;
    let manifest = Manifest::load_list(folder, &shard.file_name())?;
    if manifest.origin.shard != Some(shard) {
        let path = folder.join(shard.file_name());
        return Err(DatasetError::invalid(&path, "it lists another shard than its name says"));
    }
    Ok(Listed { shard, folder, manifest })
}

/// All shards of one dataset in their order, or what keeps them from being that.
fn complete<'a>(mut lists: Vec<Listed<'a>>, out: &Path) -> Result<Vec<Listed<'a>>, DatasetError> {
    lists.sort_by_key(|list| list.shard);
    let Some(first) = lists.first() else {
        return Err(DatasetError::invalid(out, "no shard is given"));
    };
    let (count, same) = (first.shard.count(), first.manifest.origin.clone());
    for Listed { shard, folder, manifest } in &lists {
        if shard.count() != count {
            let what = format!("it is shard {shard}, where others are of {count}");
            return Err(DatasetError::invalid(folder, what));
        }
        let origin = Origin { shard: same.shard, ..manifest.origin.clone() };
        origin.check_same(&same, folder)?;
    }
    if let Some(twice) = lists.windows(2).find(|two| two[0].shard == two[1].shard) {
        let what = format!("it is shard {}, as is {}", twice[1].shard, twice[0].folder.display());
        return Err(DatasetError::invalid(twice[1].folder, what));
    }
    let missing: Vec<String> = (1..=count)
        .filter(|number| lists.binary_search_by_key(number, |list| list.shard.number()).is_err())
        .map(|number| format!("{number}/{count}"))
        .collect();
    if missing.is_empty() {
        return Ok(lists);
    }
    Err(DatasetError::invalid(out, format!("shards are missing: {}", missing.join(", "))))
}

/// Brings the pairs of all shards, at least one, into a folder. Gives the manifest that is then to be
/// written, and the journal that is to be finished after it.
fn together(lists: &[Listed<'_>], out: Out<'_>) -> Result<(Manifest, Journal), DatasetError> {
    let folder = out.folder;
    let first = &lists[0].manifest.origin;
    let mut origin = Origin { shard: None, scenes: None, ..first.clone() };
    // Scene files need not be where parts are put together, and then nothing is said of them.
    if first.scenes.is_some() && origin.recipe.folder.exists() {
        origin.scenes = out.way_to_scenes(&origin.recipe)?;
    }
    let (journal, mut entries) = Journal::open::<PairRecord>(folder, &[PAIRS], MANIFEST, &origin)?;
    if folder.join(MANIFEST).exists() {
        let earlier = Manifest::load(folder)?;
        earlier.origin.check_same(&origin, folder)?;
        entries.extend(earlier.pairs);
    }
    let known = checked(folder, entries);
    let pairs: Vec<(&Path, &PairRecord)> =
        lists.iter().flat_map(|list| list.manifest.pairs.iter().map(|pair| (list.folder, pair))).collect();
    let there = |pair: &PairRecord| known.get(&pair.file).is_some_and(|known| known.blake3 == pair.blake3);
    let bar = progress::bar("pairs", pairs.len(), pairs.iter().filter(|(_, pair)| there(pair)).count());
    pairs.par_iter().filter(|(_, pair)| !there(pair)).try_for_each(|(from, pair)| {
        copied(from, folder, pair)?;
        bar.inc(1);
        journal.add(*pair)
    })?;
    bar.finish_and_clear();
    let pairs = pairs.into_iter().map(|(_, pair)| pair.clone()).collect();
    Ok((Manifest { origin, pairs }, journal))
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
