//! The folder in which something for an address is made: what is at the address is fetched into it, and what was made there is put
//! to the address, unless somebody else has put something there since.
//!
//! A note says what the folder holds. Where the store has moved on, a folder without work of its own is filled anew; one with
//! work is set aside, and its owner told.

use super::cache::{Cache, Entry, Lock};
use super::commit::{Commit, Published, hash};
use super::remote::{Remote, Version};
use super::transfer;
use crate::place::Address;
use anyhow::{Context, Result, bail};
use deepshade_dataset::holder::Holder;
use std::io::ErrorKind;
use std::path::PathBuf;

/// The note's file.
const NOTE: &str = "holds";

/// What the folder holds.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Note {
    /// A part of what is under that list.
    Fetching(String),
    /// What is under that list, and nothing else.
    Fetched(String),
    /// What was made on top of what is under that list, or of nothing.
    Work(Option<String>),
}

/// A folder for an address, this program's alone.
pub struct Work {
    address: Address,
    remote: Remote,
    cache: Cache,
    entry: Entry,
    /// The list's object that the work is on top of.
    base: Option<Base>,
    _holder: Holder,
    _lock: Lock,
}

/// A list in a store.
struct Base {
    hash: String,
    version: Version,
}

impl Work {
    /// Takes the folder of an address, with what is at the address.
    ///
    /// # Errors
    /// If another program has it, the store cannot be reached, or what it holds there is damaged.
    pub fn begin(address: &Address) -> Result<Self> {
        Self::on(Remote::open(address)?, Cache::open()?, address)
    }

    /// [`Self::begin`] with any store and cache.
    ///
    /// # Errors
    /// As there.
    pub fn on(remote: Remote, cache: Cache, address: &Address) -> Result<Self> {
        let (entry, lock) = cache.output(&hash(address.to_string().as_bytes()))?;
        let Some(lock) = lock else { bail!("{address}: {} is at work on it", Holder::of(entry.path())) };
        let holder = Holder::sign(entry.path());
        let there = Commit::at(&remote)?;
        let base =
            there.as_ref().map(|(_, hash, version)| Base { hash: hash.clone(), version: version.clone() });
        let work =
            Self { address: address.clone(), remote, cache, entry, base, _holder: holder, _lock: lock };
        work.fill(there.map(|(commit, hash, _)| (commit, hash))).with_context(|| address.to_string())?;
        Ok(work)
    }

    /// Where to work.
    pub fn folder(&self) -> PathBuf {
        self.entry.files()
    }

    /// Makes the folder hold what is there, or work on top of it.
    fn fill(&self, there: Option<(Commit, String)>) -> Result<()> {
        // What is worked on is not deleted for others.
        self.entry.unclaim()?;
        let Some((commit, hash)) = there else {
            if matches!(self.noted()?, Note::Fetching(_)) {
                self.empty()?;
            }
            return self.note(&Note::Work(None));
        };
        match self.noted()? {
            Note::Work(Some(base)) | Note::Fetched(base) if base == hash => {}
            Note::Work(_) if self.holds(&hash)? => {}
            note => {
                match note {
                    Note::Fetching(list) if list == hash => {}
                    Note::Fetching(_) | Note::Fetched(_) => self.empty()?,
                    Note::Work(_) => self.set_aside()?,
                }
                self.note(&Note::Fetching(hash.clone()))?;
                transfer::fetch(&self.remote, &commit, &self.folder())?;
            }
        }
        self.note(&Note::Work(Some(hash)))
    }

    /// Puts what is in the folder to the address. The folder stays as it is while the cache has room for it.
    ///
    /// # Errors
    /// If the store cannot be reached or refuses it, somebody else has put something else there since [`Self::begin`], or the
    /// folder cannot be read.
    pub fn finish(self) -> Result<()> {
        let commit = self.publish()?;
        if !self.cache.claim(&self.entry, commit.bytes())? {
            self.entry.clear()?;
        }
        Ok(())
    }

    /// [`Self::finish`] of what nobody will go on with here: it is deleted from the cache.
    ///
    /// # Errors
    /// As there.
    pub fn deliver(self) -> Result<()> {
        self.publish()?;
        self.entry.clear()
    }

    fn publish(&self) -> Result<Commit> {
        let (address, folder) = (&self.address, self.folder());
        let commit = Commit::of(&folder)?;
        transfer::put(&self.remote, &commit, &folder).with_context(|| address.to_string())?;
        let hash = commit.hash()?;
        match commit.publish(&self.remote, self.base.as_ref().map(|base| (&*base.hash, &base.version)))? {
            Published::Done => {}
            Published::Other => bail!(
                "{address}: somebody else has put something else there since this began; what was made here stays in {} \
                 until the command is given again, and then beside it",
                folder.display()
            ),
        }
        self.note(&Note::Fetched(hash))?;
        Ok(commit)
    }

    /// Whether the folder is what is under a list: another program's, or one of ours that was killed before it noted that.
    fn holds(&self, list_hash: &str) -> Result<bool> {
        Ok(Commit::of(&self.folder())?.hash()? == list_hash)
    }

    /// Keeps work that is on top of what is no longer there.
    fn set_aside(&self) -> Result<()> {
        let folder = self.folder();
        let place = || folder.display().to_string();
        let free =
            (1..).map(|number| self.entry.note(&format!("aside-{number}"))).find(|path| !path.exists());
        let aside = free.context("a name that is free")?;
        std::fs::rename(&folder, &aside).with_context(place)?;
        std::fs::create_dir_all(&folder).with_context(place)?;
        note!(
            "{}: somebody else has put something there since this machine worked on it; what it had made lies in {}, and may be \
             deleted",
            self.address,
            aside.display()
        );
        Ok(())
    }

    fn empty(&self) -> Result<()> {
        self.entry.clear()?;
        std::fs::create_dir_all(self.folder()).with_context(|| self.folder().display().to_string())
    }

    /// What the folder holds. Of what has no note nothing is known: it is taken for work. What is gone, to make room for others,
    /// is as good as never fetched.
    fn noted(&self) -> Result<Note> {
        let folder = self.folder();
        if std::fs::read_dir(&folder).with_context(|| folder.display().to_string())?.next().is_none() {
            return Ok(Note::Fetching(String::new()));
        }
        let path = self.entry.note(NOTE);
        let text = match std::fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Note::Work(None)),
            Err(error) => return Err(error).with_context(|| path.display().to_string()),
        };
        let list = |list: &str| list.to_owned();
        Ok(match text.split_once(' ') {
            Some(("fetching", hash)) => Note::Fetching(list(hash)),
            Some(("fetched", hash)) => Note::Fetched(list(hash)),
            Some(("work", hash)) => Note::Work(Some(list(hash))),
            _ => Note::Work(None),
        })
    }

    fn note(&self, note: &Note) -> Result<()> {
        let text = match note {
            Note::Fetching(hash) => format!("fetching {hash}"),
            Note::Fetched(hash) => format!("fetched {hash}"),
            Note::Work(Some(hash)) => format!("work {hash}"),
            Note::Work(None) => "work".to_owned(),
        };
        crate::figures::write_atomically(&self.entry.note(NOTE), text.as_bytes())
    }
}

#[cfg(test)]
mod tests;
