//! A dataset in a store that is trained on pair by pair, larger than the disk though it may be.
//!
//! Which pairs are wanted when is decided by the run's seed alone; the loader's threads ask for them ahead of the training.
//! What was fetched stays in a folder of the cache until room is wanted, then the oldest goes. Every file is held against
//! its hash, those of an earlier run at their first use.

use super::cache::Cache;
use super::commit::{Commit, Stored};
use super::remote::Remote;
use super::transfer::fetch_file;
use crate::place::{Address, Folder};
use anyhow::{Context, Result, bail};
use deepshade_dataset::{Dataset, Manifest, Pair, Shard, manifest};
use deepshade_train::PairSource;
use std::collections::{HashMap, VecDeque};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A dataset of which the manifest is here, and of the pairs as many as there is room for.
pub struct Stream {
    remote: Remote,
    /// By name.
    files: HashMap<String, Stored>,
    dataset: Dataset,
    /// Most bytes of pairs that nobody reads just now.
    room: u64,
    held: Mutex<Held>,
    /// The cache's folder, if it is one.
    kept: Folder,
}

/// Pairs that are here.
#[derive(Debug, Default)]
struct Held {
    /// The oldest first.
    files: VecDeque<Kept>,
    bytes: u64,
    /// How many threads read a file.
    readers: HashMap<String, usize>,
}

/// A pair's file.
#[derive(Debug)]
struct Kept {
    name: String,
    bytes: u64,
    /// Whether it was held against its hash since the program began.
    sound: bool,
}

impl Held {
    /// What an earlier run has left of some files in a folder.
    fn left(files: &HashMap<String, Stored>, dataset: &Dataset) -> Self {
        let kept = |name: &String| {
            let bytes = dataset.folder().join(name).metadata().ok()?.len();
            files.contains_key(name).then(|| Kept { name: name.clone(), bytes, sound: false })
        };
        let records = (0..dataset.len()).map(|index| &dataset.record(index).file);
        let files: VecDeque<Kept> = records.filter_map(kept).collect();
        Self { bytes: files.iter().map(|file| file.bytes).sum(), files, readers: HashMap::new() }
    }

    /// Notes a file that was held against its hash.
    fn note(&mut self, name: &str, bytes: u64) {
        if let Some(kept) = self.files.iter_mut().find(|kept| kept.name == name) {
            self.bytes = self.bytes - kept.bytes + bytes;
            (kept.bytes, kept.sound) = (bytes, true);
        } else {
            self.files.push_back(Kept { name: name.to_owned(), bytes, sound: true });
            self.bytes += bytes;
        }
    }
}

impl Stream {
    /// The dataset at an address.
    ///
    /// # Errors
    /// If the store cannot be reached, or holds no dataset there.
    pub fn open(address: &Address) -> Result<Self> {
        let remote = Remote::open(address)?;
        let (list, list_hash) = Commit::whole(&remote).with_context(|| address.to_string())?;
        let (folder, room) = Cache::open()?.stream(&list_hash, list.bytes())?;
        Self::new(remote, list, folder, room).with_context(|| address.to_string())
    }

    fn new(remote: Remote, list: Commit, folder: Folder, room: u64) -> Result<Self> {
        let files: HashMap<_, _> = list.files.into_iter().map(|file| (file.name.clone(), file)).collect();
        let Some(manifest) = files.get(manifest::MANIFEST) else {
            let shard = files.keys().find_map(|name| Shard::by_file(name));
            bail!(shard.map_or_else(|| "it is no dataset".to_owned(), Shard::is_no_dataset))
        };
        fetch_file(&remote, manifest, &folder.join(&manifest.name))?;
        let dataset = Dataset::open(&folder)?;
        let held = Mutex::new(Held::left(&files, &dataset));
        Ok(Self { remote, files, dataset, room, held, kept: folder })
    }

    /// Where its manifest is.
    pub fn folder(&self) -> Folder {
        self.kept.clone()
    }

    /// Makes a pair's file be here, and stay as long as it is read.
    fn hold(&self, name: &str) -> Result<()> {
        let file = self.files.get(name).with_context(|| format!("`{name}` is not in the list of files"))?;
        let known = {
            let mut held = self.held();
            *held.readers.entry(name.to_owned()).or_default() += 1;
            held.files.iter().any(|kept| kept.sound && kept.name == name)
        };
        if !known {
            // Another thread may do so at the same time: with the same bytes.
            fetch_file(&self.remote, file, &self.dataset.folder().join(name))?;
            self.held().note(name, file.bytes);
        }
        Ok(())
    }

    /// Lets go of a pair's file, and deletes the oldest that nobody reads until the rest fits.
    fn release(&self, name: &str) -> Result<()> {
        let mut held = self.held();
        if let Some(readers) = held.readers.get_mut(name) {
            *readers -= 1;
            if *readers == 0 {
                held.readers.remove(name);
            }
        }
        while held.bytes > self.room {
            let free = held.files.iter().position(|kept| !held.readers.contains_key(&kept.name));
            let Some(oldest) = free.and_then(|place| held.files.remove(place)) else { break };
            held.bytes -= oldest.bytes;
            let path = self.dataset.folder().join(oldest.name);
            std::fs::remove_file(&path).with_context(|| path.display().to_string())?;
        }
        Ok(())
    }

    /// What is here stays sound if a thread panics between two of its changes.
    fn held(&self) -> MutexGuard<'_, Held> {
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl PairSource for Stream {
    fn hash(&self) -> Result<String, String> {
        Manifest::file_hash(self.dataset.folder()).map_err(|error| error.to_string())
    }

    fn count(&self) -> usize {
        self.dataset.len()
    }

    fn training(&self) -> Vec<usize> {
        self.dataset.training()
    }

    fn validation(&self) -> Vec<usize> {
        self.dataset.validation()
    }

    fn read(&self, index: usize) -> Result<Pair, String> {
        let name = &self.dataset.record(index).file;
        let pair = self
            .hold(name)
            .map_err(|error| format!("{error:#}"))
            .and_then(|()| self.dataset.pair(index).map_err(|error| error.to_string()));
        self.release(name).map_err(|error| format!("{error:#}"))?;
        pair
    }
}

#[cfg(test)]
mod tests;
