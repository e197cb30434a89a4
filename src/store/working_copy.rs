//! The folder in which something for an address is made: what is at the address is fetched into it, and what
//! was made there is put to the address, unless somebody else has put something there since. Then it goes.
//!
//! A note beside it names the list that the work is on top of. It is written when all of that was fetched, so
//! a folder with a note is the unfinished work of a program that was ended, and one without is a part of a
//! copy.

use super::commit::{Commit, hash};
use super::remote::{Remote, Version};
use super::{cache, transfer};
use crate::figures::write_atomically;
use crate::location::Address;
use anyhow::{Context, Result, bail, ensure};
use deepshade_dataset::holder::Holder;
use deepshade_dataset::lock;
use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// A folder for an address, this program's alone.
pub struct WorkingCopy {
    address: Address,
    remote: Remote,
    /// Holds the folder, the note and the lock.
    entry: PathBuf,
    /// The list's object that the work is on top of.
    base: Option<Version>,
    _holder: Holder,
    _lock: File,
}

impl WorkingCopy {
    /// Takes the folder of an address, with what is at the address, or with unfinished work on top of that.
    ///
    /// # Errors
    /// If another program has it, the store cannot be reached, what it holds there is damaged, or somebody
    /// else has put something there since the unfinished work began.
    pub fn begin(address: &Address) -> Result<Self> {
        Self::on(Remote::open(address)?, &cache()?, address)
    }

    /// [`Self::begin`] with any store and cache.
    fn on(remote: Remote, cache: &Path, address: &Address) -> Result<Self> {
        let entry = cache.join("outputs").join(hash(address.to_string().as_bytes()));
        let place = || entry.display().to_string();
        fs::create_dir_all(&entry).with_context(place)?;
        let lock = lock::alone(&entry.join("lock")).with_context(place)?;
        let Some(lock) = lock else { bail!("{address}: {} is at work on it", Holder::of(&entry)) };
        let holder = Holder::sign(&entry);
        let (list, base) = match Commit::at(&remote)? {
            Some((commit, hash, version)) => (Some((commit, hash)), Some(version)),
            None => (None, None),
        };
        let copy = Self { address: address.clone(), remote, entry, base, _holder: holder, _lock: lock };
        copy.fill(list).with_context(|| address.to_string())?;
        Ok(copy)
    }

    /// Where to work.
    pub fn folder(&self) -> PathBuf {
        self.entry.join("files")
    }

    /// The note: the hash of the list that the work is on top of, empty where nothing was there.
    fn note(&self) -> PathBuf {
        self.entry.join("base")
    }

    /// Makes the folder hold what is there, or unfinished work on top of it.
    fn fill(&self, there: Option<(Commit, String)>) -> Result<()> {
        let folder = self.folder();
        let base = there.as_ref().map_or("", |(_, hash)| hash);
        match fs::read_to_string(self.note()) {
            // What is gone from the store is put there again.
            Ok(noted) if noted == base || base.is_empty() => {}
            Ok(noted) if self.is_worked_on(&noted, base)? => bail!(
                "somebody else has put something else there since this machine began what lies unfinished in \
                {}: \
                 delete that, and start again",
                folder.display()
            ),
            _ => {
                removed(fs::remove_file(self.note()), &self.note())?;
                removed(fs::remove_dir_all(&folder), &folder)?;
                if let Some((commit, _)) = &there {
                    transfer::fetch(&self.remote, commit, &folder)?;
                }
            }
        }
        fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
        write_atomically(&self.note(), base.as_bytes())
    }

    /// Whether the folder holds what is neither under the list that it began with nor under the one that is
    /// there, which it may have put there before it was ended.
    fn is_worked_on(&self, noted: &str, there: &str) -> Result<bool> {
        if !self.folder().exists() {
            return Ok(false);
        }
        let held = Commit::of(&self.folder())?.hash()?;
        Ok(held != noted && held != there)
    }

    /// Puts what is in the folder to the address, and deletes it here.
    ///
    /// # Errors
    /// If the store cannot be reached or refuses it, somebody else has put something else there since
    /// [`Self::begin`], or the folder cannot be read.
    pub fn finish(self) -> Result<()> {
        let folder = self.folder();
        self.publish().with_context(|| self.address.to_string())?;
        // The note first: without it what is left is no unfinished work.
        removed(fs::remove_file(self.note()), &self.note())?;
        removed(fs::remove_dir_all(&folder), &folder)
    }

    fn publish(&self) -> Result<()> {
        let folder = self.folder();
        let commit = Commit::of(&folder)?;
        transfer::put(&self.remote, &commit, &folder)?;
        ensure!(
            commit.publish(&self.remote, self.base.as_ref())?,
            "somebody else has put something else there since this began; what was made here stays in {}",
            folder.display()
        );
        Ok(())
    }
}

/// What is gone already is deleted.
fn removed(result: std::io::Result<()>, path: &Path) -> Result<()> {
    match result {
        Err(error) if error.kind() != ErrorKind::NotFound => {
            Err(error).with_context(|| path.display().to_string())
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests;
