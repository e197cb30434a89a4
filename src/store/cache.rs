//! Folders of the user's cache that stand for addresses: copies of what was read, pairs of datasets that are trained on, and
//! folders in which something is made for a store (`work`).
//!
//! Each has a lock of its own, which goes with what is handed out: nothing that a program uses is deleted by another one. All
//! together have a bound. Each claims so many bytes of it before it is filled; where a new claim would not fit, those go
//! first that nobody has used for the longest time.

use super::commit::Commit;
use crate::place::Folder;
use anyhow::{Context, Result, bail, ensure};
use deepshade_dataset::lock;
use etcetera::BaseStrategy;
use std::fs::File;
use std::io::{ErrorKind, Result as IoResult};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Where the cache is, in place of the user's cache folder.
const FOLDER: &str = "DEEPSHADE_CACHE";
/// Most gigabytes of it.
const BOUND: &str = "DEEPSHADE_CACHE_GB";
const DEFAULT_BOUND: u64 = 50;
/// Held by whoever uses what is beside it. It is never deleted, so that all lock the same file.
const LOCK: &str = "lock";
/// The kinds of folders.
const KINDS: [&str; 3] = ["sources", "streams", "outputs"];

/// A cache.
#[derive(Clone, Debug)]
pub struct Cache {
    root: PathBuf,
    /// Most bytes of all that may be deleted.
    bound: u64,
}

/// A folder of the cache with what belongs to it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry(PathBuf);

/// What is had of the cache: nobody else deletes it or writes into it.
pub type Lock = File;

impl Entry {
    /// Where the files are.
    pub fn files(&self) -> PathBuf {
        self.0.join("files")
    }

    /// A file of notes beside them.
    pub fn note(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// Where both are.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// Takes it by a kind of lock, makes its folder, and notes that it is used.
    fn taken(&self, lock: impl FnOnce(&Path) -> IoResult<Lock>) -> Result<Lock> {
        let place = || self.0.display().to_string();
        std::fs::create_dir_all(&self.0).with_context(place)?;
        let lock = lock(&self.0.join(LOCK)).with_context(place)?;
        std::fs::create_dir_all(self.files()).with_context(place)?;
        // What has no time is the first to go, no more.
        let _ = lock.set_modified(SystemTime::now());
        Ok(lock)
    }

    /// Takes it for this program alone, without a use of it; `None` while another one has it.
    fn idle(&self) -> Result<Option<Lock>> {
        std::fs::create_dir_all(&self.0)
            .and_then(|()| lock::alone(&self.0.join(LOCK)))
            .with_context(|| self.0.display().to_string())
    }

    /// How many bytes it claims.
    fn claim(&self) -> u64 {
        let text = std::fs::read_to_string(self.note("bytes")).ok();
        text.and_then(|text| text.parse().ok()).unwrap_or(0)
    }

    /// Claims nothing any more: it is not deleted for others.
    ///
    /// # Errors
    /// If that cannot be noted.
    pub fn unclaim(&self) -> Result<()> {
        deleted(std::fs::remove_file(self.note("bytes"))).with_context(|| self.0.display().to_string())
    }

    /// Deletes the files, all at once to whoever looks for them. Whoever calls it holds the lock.
    ///
    /// # Errors
    /// If that fails.
    pub fn clear(&self) -> Result<()> {
        let waste = self.note("waste");
        let cleared = deleted(std::fs::remove_dir_all(&waste))
            .and_then(|()| deleted(std::fs::rename(self.files(), &waste)))
            .and_then(|()| deleted(std::fs::remove_dir_all(&waste)));
        cleared.with_context(|| self.0.display().to_string())?;
        self.unclaim()
    }

    /// When it was last used.
    fn used(&self) -> SystemTime {
        self.note(LOCK).metadata().and_then(|lock| lock.modified()).unwrap_or(SystemTime::UNIX_EPOCH)
    }
}

/// What is gone already is deleted.
fn deleted(result: IoResult<()>) -> IoResult<()> {
    result.or_else(|error| if error.kind() == ErrorKind::NotFound { Ok(()) } else { Err(error) })
}

impl Cache {
    /// The one that the environment names.
    ///
    /// # Errors
    /// If it names none, or the user has no cache folder.
    pub fn open() -> Result<Self> {
        let folder = match std::env::var_os(FOLDER) {
            Some(folder) => PathBuf::from(folder),
            None => etcetera::choose_base_strategy()
                .with_context(|| format!("no cache folder: {FOLDER} may name one"))?
                .cache_dir()
                .join("deepshade"),
        };
        let gigabytes = match std::env::var(BOUND) {
            Ok(text) => {
                text.parse().with_context(|| format!("{BOUND} is `{text}`, which is no whole number"))?
            }
            Err(_) => DEFAULT_BOUND,
        };
        Ok(Self::at(folder.join("store"), u64::saturating_mul(gigabytes, 1_000_000_000)))
    }

    /// One in a folder, of at most so many bytes.
    pub const fn at(root: PathBuf, bound: u64) -> Self {
        Self { root, bound }
    }

    /// The folder of something that is made, for this program alone; without a lock while another program has it.
    ///
    /// # Errors
    /// If it cannot be made or locked.
    pub fn output(&self, name: &str) -> Result<(Entry, Option<Lock>)> {
        let own = self.entry("outputs", name);
        let _guard = self.guard()?;
        let lock = self.alone(&own)?;
        Ok((own, lock))
    }

    fn alone(&self, entry: &Entry) -> Result<Option<Lock>> {
        let Some(lock) = entry.idle()? else { return Ok(None) };
        entry.taken(|_| Ok(lock)).map(Some)
    }

    /// As long as it is held nobody looks whether others are in use, which for a moment makes them so, and nobody counts on the
    /// same room.
    fn guard(&self) -> Result<Lock> {
        let made = std::fs::create_dir_all(&self.root).and_then(|()| lock::waiting(&self.root.join(LOCK)));
        made.with_context(|| self.root.display().to_string())
    }

    fn entry(&self, kind: &str, name: &str) -> Entry {
        Entry(self.root.join(kind).join(name))
    }

    /// The copy of a list's files: one that is there, or made by `fetch`, which finds in the folder what was fetched before.
    ///
    /// # Errors
    /// If it does not fit into the cache or cannot be made.
    pub fn source(
        &self,
        commit: &Commit,
        list_hash: &str,
        fetch: impl Fn(&Path) -> Result<()>,
    ) -> Result<Folder> {
        let own = self.entry("sources", list_hash);
        loop {
            let lock = own.taken(lock::shared)?;
            if has_sizes(commit, &own.files()) {
                return Ok(Folder::kept(own.files(), lock));
            }
            drop(lock);
            // Whoever else wants the same waits, and then finds it.
            let _lock = own.taken(lock::waiting)?;
            if !has_sizes(commit, &own.files()) {
                let wanted = commit.bytes();
                if !self.claim(&own, wanted)? {
                    bail!(
                        "{wanted} bytes are more than the cache may hold beside what is in use; {BOUND} says how many \
                         gigabytes that is"
                    );
                }
                fetch(&own.files())?;
                // Else it would be fetched again and again.
                ensure!(has_sizes(commit, &own.files()), "what was fetched has not the sizes of its list");
            }
        }
    }

    /// The folder in which pairs of a list's dataset are kept while it is trained on: the first that no other program has; and
    /// for how many bytes there is room. Half of what others leave is left to others.
    ///
    /// # Errors
    /// If it cannot be made.
    #[cfg(feature = "train")]
    pub fn stream(&self, list_hash: &str, most: u64) -> Result<(Folder, u64)> {
        let _guard = self.guard()?;
        for number in 0.. {
            let own = self.entry("streams", &format!("{list_hash}-{number}"));
            let Some(lock) = self.alone(&own)? else { continue };
            let room = most.min(self.bound.saturating_sub(self.in_use(&own)?) / 2);
            let room = if self.claim_guarded(&own, room)? { room } else { 0 };
            return Ok((Folder::kept(own.files(), lock), room));
        }
        unreachable!("one of so many folders is free")
    }

    /// Bytes that others claim and use.
    #[cfg(feature = "train")]
    fn in_use(&self, own: &Entry) -> Result<u64> {
        let claimed = |entry: Entry| Ok(if entry.idle()?.is_some() { 0 } else { entry.claim() });
        self.others(own)?.into_iter().map(claimed).sum()
    }

    /// Claims bytes for an entry whose lock is held, and deletes what nobody uses until they fit; whether they do.
    ///
    /// # Errors
    /// If the cache cannot be read or written.
    pub fn claim(&self, own: &Entry, wanted: u64) -> Result<bool> {
        let _guard = self.guard()?;
        self.claim_guarded(own, wanted)
    }

    fn claim_guarded(&self, own: &Entry, wanted: u64) -> Result<bool> {
        let mut others = self.others(own)?;
        others.sort_by_key(Entry::used);
        let mut held: u64 = others.iter().map(Entry::claim).fold(0, u64::saturating_add);
        for entry in others {
            if wanted > self.bound || held.saturating_add(wanted) <= self.bound {
                break;
            }
            let claim = entry.claim();
            if let Some(_lock) = entry.idle()? {
                entry.clear()?;
                held = held.saturating_sub(claim);
            }
        }
        if held.saturating_add(wanted) > self.bound {
            return Ok(false);
        }
        let note = own.note("bytes");
        std::fs::write(&note, wanted.to_string()).with_context(|| note.display().to_string())?;
        Ok(true)
    }

    /// All others that claim something.
    fn others(&self, own: &Entry) -> Result<Vec<Entry>> {
        let mut entries = Vec::new();
        for kind in KINDS {
            let folder = self.root.join(kind);
            let found = match std::fs::read_dir(&folder) {
                Ok(found) => found,
                Err(error) if error.kind() == ErrorKind::NotFound => continue,
                Err(error) => return Err(error).with_context(|| folder.display().to_string()),
            };
            let found = found.flatten().map(|entry| Entry(entry.path()));
            entries.extend(found.filter(|entry| entry != own && entry.claim() > 0));
        }
        Ok(entries)
    }
}

/// Whether a copy has all files in their sizes: each was held against its hash when it was fetched, and written whole.
fn has_sizes(commit: &Commit, files: &Path) -> bool {
    let size = |name: &str| files.join(name).metadata().map(|found| found.len()).ok();
    commit.files.iter().all(|file| size(&file.name) == Some(file.bytes))
}

#[cfg(test)]
mod tests;
