//! Putting shards together. Every pair is read where it is, held against its hash and written where it belongs, one by one, so
//! that shards may be in a store and larger than any disk.

use super::Shard;
use crate::generate::{PAIRS, file_name};
use crate::journal::{Journal, checked};
use crate::manifest::{MANIFEST, Manifest, PairRecord};
use crate::origin::{Origin, Out};
use crate::{DatasetError, progress};
use deepshade_shaders::atomic_file;
use rayon::prelude::*;
use std::io::Result as IoResult;
use std::path::{Path, PathBuf};

/// The files of a shard, wherever they are.
pub trait ShardFiles: Sync {
    /// Where they are, for people.
    fn place(&self) -> PathBuf;

    /// Names of those that are not below another folder.
    ///
    /// # Errors
    /// If they cannot be listed.
    fn names(&self) -> IoResult<Vec<String>>;

    /// The bytes of one.
    ///
    /// # Errors
    /// If it cannot be read.
    fn read(&self, name: &str) -> IoResult<Vec<u8>>;
}

/// A folder.
impl ShardFiles for PathBuf {
    fn place(&self) -> PathBuf {
        self.clone()
    }

    fn names(&self) -> IoResult<Vec<String>> {
        let entries = std::fs::read_dir(self)?.flatten();
        Ok(entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect())
    }

    fn read(&self, name: &str) -> IoResult<Vec<u8>> {
        std::fs::read(self.join(name))
    }
}

impl<S: ShardFiles + ?Sized> ShardFiles for Box<S> {
    fn place(&self) -> PathBuf {
        self.as_ref().place()
    }

    fn names(&self) -> IoResult<Vec<String>> {
        self.as_ref().names()
    }

    fn read(&self, name: &str) -> IoResult<Vec<u8>> {
        self.as_ref().read(name)
    }
}

/// Puts all shards of a dataset together in a folder, or what is still missing of it; every file is read and checked.
/// Gives the number of pairs.
///
/// # Errors
/// If a shard is missing, there twice, unfinished, damaged, of other data than the first or not what its recipe plans,
/// or the folder cannot be written, is in use or holds something else.
pub fn merge<'a, S: ShardFiles>(shards: &[S], out: impl Into<Out<'a>>) -> Result<usize, DatasetError> {
    let out = out.into();
    let lists = complete(listed_all(shards)?, out.folder)?;
    let Some(first) = lists.first() else {
        return Err(DatasetError::invalid(out.folder, "no shard is given"));
    };
    let planned: Vec<String> =
        first.manifest.origin.recipe.view_names().map(|view| file_name(&view)).collect();
    lists.iter().try_for_each(|list| lists_its_own(list, &planned))?;
    let (manifest, journal) = together(&lists, out)?;
    manifest.save(out.folder)?;
    journal.finish()?;
    Ok(manifest.pairs.len())
}

/// What putting some shards of a dataset together is like, in a folder that is of no use afterwards: to time it. Gives the number
/// of pairs.
///
/// # Errors
/// If a shard is unfinished or damaged, or the folder cannot be written, is in use or holds something else.
pub fn rehearse<S: ShardFiles>(shards: &[S], folder: &Path) -> Result<usize, DatasetError> {
    let (manifest, _unfinished) = together(&listed_all(shards)?, Out { folder, stays: false })?;
    Ok(manifest.pairs.len())
}

/// What of a shard's list keeps it from being put together with others, if something does.
pub(crate) fn list_fault(folder: &Path) -> Option<String> {
    let folder = folder.to_owned();
    let fault = listed(&folder).and_then(|list| {
        let planned: Vec<String> =
            list.manifest.origin.recipe.view_names().map(|view| file_name(&view)).collect();
        lists_its_own(&list, &planned)
    });
    fault.err().map(|error| match error {
        DatasetError::Invalid { what, .. } => what,
        other => other.to_string(),
    })
}

/// A shard with its list.
struct Listed<'a, S> {
    shard: Shard,
    files: &'a S,
    manifest: Manifest,
}

impl<S: ShardFiles> Listed<'_, S> {
    /// Its list, for people.
    fn path(&self) -> PathBuf {
        self.files.place().join(self.shard.file_name())
    }
}

fn listed_all<S: ShardFiles>(shards: &[S]) -> Result<Vec<Listed<'_, S>>, DatasetError> {
    shards.par_iter().map(listed).collect()
}

fn listed<S: ShardFiles>(files: &S) -> Result<Listed<'_, S>, DatasetError> {
    let place = files.place();
    let names = files.names().map_err(|source| DatasetError::io(&place, source))?;
    let shard = names.iter().find_map(|name| Shard::by_file(name)).ok_or_else(|| {
        DatasetError::invalid(&place, "holds no list of a shard: it is none, or not finished as yet")
    })?;
    let path = place.join(shard.file_name());
    let bytes = files.read(&shard.file_name()).map_err(|source| DatasetError::io(&path, source))?;
    let manifest = Manifest::parse(&bytes, &path)?;
    if manifest.origin.shard != Some(shard) {
        return Err(DatasetError::invalid(&path, "it lists another shard than its name says"));
    }
    Ok(Listed { shard, files, manifest })
}

/// All shards of one dataset in their order, or what keeps them from being that.
fn complete<'a, S: ShardFiles>(
    mut lists: Vec<Listed<'a, S>>,
    folder: &Path,
) -> Result<Vec<Listed<'a, S>>, DatasetError> {
    lists.sort_by_key(|list| list.shard);
    let Some(first) = lists.first() else { return Ok(lists) };
    let (count, same) = (first.shard.count(), first.manifest.origin.clone());
    for Listed { shard, files, manifest } in &lists {
        if shard.count() != count {
            let what = format!("it is shard {shard}, where others are of {count}");
            return Err(DatasetError::invalid(&files.place(), what));
        }
        let origin = Origin { shard: same.shard, ..manifest.origin.clone() };
        origin.check_same(&same, &files.place())?;
    }
    if let Some(twice) = lists.windows(2).find(|two| two[0].shard == two[1].shard) {
        let what = format!("it is shard {}, as is {}", twice[1].shard, twice[0].files.place().display());
        return Err(DatasetError::invalid(&twice[1].files.place(), what));
    }
    let missing: Vec<String> = (1..=count)
        .filter(|number| lists.binary_search_by_key(number, |list| list.shard.number()).is_err())
        .map(|number| format!("{number}/{count}"))
        .collect();
    if missing.is_empty() {
        return Ok(lists);
    }
    Err(DatasetError::invalid(folder, format!("shards are missing: {}", missing.join(", "))))
}

/// Whether a list names the files that its recipe plans for that shard, none of them twice and none elsewhere.
fn lists_its_own<S: ShardFiles>(list: &Listed<'_, S>, planned: &[String]) -> Result<(), DatasetError> {
    let own = &planned[list.shard.places(planned.len())];
    let pairs = &list.manifest.pairs;
    let wrong = |what: String| Err(DatasetError::invalid(&list.path(), what));
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

/// Brings the pairs of all shards into a folder, and gives the manifest that is then to be written, and the journal that is to
/// be finished after it.
fn together<S: ShardFiles>(
    lists: &[Listed<'_, S>],
    out: Out<'_>,
) -> Result<(Manifest, Journal), DatasetError> {
    let folder = out.folder;
    let Some(first) = lists.first() else {
        return Err(DatasetError::invalid(folder, "no shard is given"));
    };
    let mut origin = Origin { shard: None, scenes: None, ..first.manifest.origin.clone() };
    // Scene files need not be where parts are put together, and then nothing is said of them.
    if first.manifest.origin.scenes.is_some() && origin.recipe.folder.exists() {
        origin.scenes = out.way_to_scenes(&origin.recipe)?;
    }
    let (journal, mut entries) = Journal::open::<PairRecord>(folder, &[PAIRS], MANIFEST, &origin)?;
    if folder.join(MANIFEST).exists() {
        let earlier = Manifest::load(folder)?;
        earlier.origin.check_same(&origin, folder)?;
        entries.extend(earlier.pairs);
    }
    let known = checked(folder, entries);
    let pairs: Vec<(&S, &PairRecord)> =
        lists.iter().flat_map(|list| list.manifest.pairs.iter().map(|pair| (list.files, pair))).collect();
    let there = |pair: &PairRecord| known.get(&pair.file).is_some_and(|known| known.blake3 == pair.blake3);
    let bar = progress::bar("pairs", pairs.len(), pairs.iter().filter(|(_, pair)| there(pair)).count());
    pairs.par_iter().filter(|(_, pair)| !there(pair)).try_for_each(|(files, pair)| {
        copied(*files, folder, pair)?;
        bar.inc(1);
        journal.add(*pair)
    })?;
    bar.finish_and_clear();
    let pairs = pairs.into_iter().map(|(_, pair)| pair.clone()).collect();
    Ok((Manifest { origin, pairs }, journal))
}

/// Copies a pair that is what its record says.
fn copied(from: &impl ShardFiles, to: &Path, pair: &PairRecord) -> Result<(), DatasetError> {
    let source = from.place().join(&pair.file);
    let bytes = from.read(&pair.file).map_err(|error| DatasetError::io(&source, error))?;
    let hash = blake3::hash(&bytes).to_hex().to_string();
    if hash != pair.blake3 {
        let what =
            format!("its hash is {hash}, not {}: generate that shard again, which mends it", pair.blake3);
        return Err(DatasetError::invalid(&source, what));
    }
    let target = to.join(&pair.file);
    atomic_file::write(&target, &bytes).map_err(|error| DatasetError::io(&target, error))
}
