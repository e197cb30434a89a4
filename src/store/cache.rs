//! Folders of the user's cache that stand for addresses.
//!
//! What is read is kept by the hash of its list, so that it never changes under whoever reads it; the oldest goes where the
//! cache would grow beyond its bound. What is written is made in a folder of its address's own.

use super::commit::{Commit, hash};
use crate::place::Address;
use anyhow::{Context, Result, ensure};
use etcetera::BaseStrategy;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Where the cache is, in place of the user's cache folder.
const FOLDER: &str = "DEEPSHADE_CACHE";
/// Most gigabytes of what was read.
const BOUND: &str = "DEEPSHADE_CACHE_GB";
const DEFAULT_BOUND: u64 = 50;
/// Says, in the folder of a copy, that it is whole, and since when it was last asked for.
const WHOLE: &str = "whole";
/// The list's hash that an output goes on from, in the folder of its work.
const BASE: &str = "base";

/// The copy of a list's files: one that is there, or made by `fetch`.
///
/// # Errors
/// If it does not fit into the cache or cannot be made.
pub fn source(commit: &Commit, list_hash: &str, fetch: impl FnOnce(&Path) -> Result<()>) -> Result<PathBuf> {
    let sources = root()?.join("sources");
    let own = sources.join(list_hash);
    let files = own.join("files");
    std::fs::create_dir_all(&files).with_context(|| own.display().to_string())?;
    let lock = File::create(own.join("lock")).with_context(|| own.display().to_string())?;
    // Whoever else wants the same waits, and then finds it.
    lock.lock().with_context(|| own.display().to_string())?;
    let whole = own.join(WHOLE);
    if !(whole.exists() && has_sizes(commit, &files)) {
        make_room(&sources, &own, commit.bytes())?;
        fetch(&files)?;
    }
    std::fs::write(&whole, commit.bytes().to_string()).with_context(|| whole.display().to_string())?;
    Ok(files)
}

/// The folder in which pairs of a list's dataset are kept while it is trained on: the first that no other program has. Its lock
/// goes with what is returned.
///
/// # Errors
/// If it cannot be made.
#[cfg(feature = "train")]
pub fn stream(list_hash: &str) -> Result<(PathBuf, File)> {
    let streams = root()?.join("streams");
    for number in 0.. {
        let folder = streams.join(format!("{list_hash}-{number}"));
        std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
        let lock = File::create(folder.join("lock")).with_context(|| folder.display().to_string())?;
        if lock.try_lock().is_ok() {
            return Ok((folder, lock));
        }
    }
    unreachable!("one of so many folders is free")
}

/// Whether a copy still has all files in their sizes.
fn has_sizes(commit: &Commit, files: &Path) -> bool {
    let size = |name: &str| files.join(name).metadata().map(|found| found.len()).ok();
    commit.files.iter().all(|file| size(&file.name) == Some(file.bytes))
}

/// Deletes copies, those first that nobody has asked for in a long time, until so many bytes fit.
fn make_room(sources: &Path, own: &Path, wanted: u64) -> Result<()> {
    let bound = bound()?;
    ensure!(
        wanted <= bound,
        "{wanted} bytes are more than the cache may hold; {BOUND} says how many gigabytes that is"
    );
    let mut copies: Vec<(SystemTime, u64, PathBuf)> = std::fs::read_dir(sources)
        .with_context(|| sources.display().to_string())?
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| path != own)
        .filter_map(|path| {
            let note = path.join(WHOLE);
            let bytes = std::fs::read_to_string(&note).ok()?.parse().ok()?;
            Some((note.metadata().ok()?.modified().ok()?, bytes, path))
        })
        .collect();
    copies.sort();
    let mut held: u64 = copies.iter().map(|(_, bytes, _)| bytes).sum();
    for (_, bytes, path) in copies {
        if held.saturating_add(wanted) <= bound {
            break;
        }
        // The note first: what is half deleted is not taken for whole.
        let deleted = std::fs::remove_file(path.join(WHOLE)).and_then(|()| std::fs::remove_dir_all(&path));
        deleted.with_context(|| path.display().to_string())?;
        held -= bytes;
    }
    Ok(())
}

/// Most bytes of what was read.
///
/// # Errors
/// If the environment says no number.
pub fn bound() -> Result<u64> {
    let gigabytes = match std::env::var(BOUND) {
        Ok(text) => text.parse().with_context(|| format!("{BOUND} is `{text}`, which is no whole number"))?,
        Err(_) => DEFAULT_BOUND,
    };
    Ok(u64::saturating_mul(gigabytes, 1_000_000_000))
}

fn root() -> Result<PathBuf> {
    let folder = match std::env::var_os(FOLDER) {
        Some(folder) => PathBuf::from(folder),
        None => etcetera::choose_base_strategy()
            .with_context(|| format!("no cache folder: {FOLDER} may name one"))?
            .cache_dir()
            .join("deepshade"),
    };
    Ok(folder.join("store"))
}

/// The folder in which something for an address is made.
pub struct Work {
    /// Where files are written.
    pub folder: PathBuf,
    base: PathBuf,
}

impl Work {
    /// # Errors
    /// If it cannot be made.
    pub fn of(address: &Address) -> Result<Self> {
        let own = root()?.join("outputs").join(hash(address.to_string().as_bytes()));
        let folder = own.join("files");
        std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
        Ok(Self { folder, base: own.join(BASE) })
    }

    /// Whether what is in the folder came from, or went to, the store under that list.
    pub fn goes_on_from(&self, list_hash: &str) -> bool {
        std::fs::read_to_string(&self.base).is_ok_and(|base| base == list_hash)
    }

    /// Notes that the folder holds what is in the store under that list.
    ///
    /// # Errors
    /// If that cannot be written.
    pub fn note(&self, list_hash: &str) -> Result<()> {
        std::fs::write(&self.base, list_hash).with_context(|| self.base.display().to_string())
    }

    /// Deletes what is in the folder: somebody else has finished it since.
    ///
    /// # Errors
    /// If it cannot be deleted.
    pub fn clear(&self) -> Result<()> {
        let cleared =
            std::fs::remove_dir_all(&self.folder).and_then(|()| std::fs::create_dir_all(&self.folder));
        cleared.with_context(|| self.folder.display().to_string())
    }
}
