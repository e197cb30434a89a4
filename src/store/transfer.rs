//! Files to objects and back, several at a time.

use super::commit::{Commit, Stored, hash};
use super::remote::Remote;
use crate::place::TRANSFERS;
use anyhow::{Context, Result, bail, ensure};
use deepshade_dataset::progress;
use deepshade_shaders::{atomic_file, own_file};
use rayon::{ThreadPoolBuilder, prelude::*};
use std::path::Path;

/// Puts the files of a folder into a store, but for those that it has.
///
/// # Errors
/// If one cannot be read or has changed since it was listed, or the store cannot be reached.
pub fn put(remote: &Remote, commit: &Commit, folder: &Path) -> Result<()> {
    each(commit, "files stored", |file| {
        if remote.size(&file.object())? == Some(file.bytes) {
            return Ok(());
        }
        let path = folder.join(&file.name);
        let bytes = std::fs::read(&path).with_context(|| path.display().to_string())?;
        ensure!(hash(&bytes) == file.blake3, "{} has changed while it was stored", path.display());
        remote.put(&file.object(), bytes)
    })
}

/// Writes the files of a list into a folder, but for those that it has.
///
/// # Errors
/// If the store cannot be reached, an object is missing or damaged, or a file cannot be written.
pub fn fetch(remote: &Remote, commit: &Commit, folder: &Path) -> Result<()> {
    each(commit, "files fetched", |file| {
        let path = folder.join(&file.name);
        if std::fs::read(&path).is_ok_and(|bytes| hash(&bytes) == file.blake3) {
            return Ok(());
        }
        let bytes = fetched(remote, file)?;
        let place = || path.display().to_string();
        std::fs::create_dir_all(own_file::folder(&path)).with_context(place)?;
        atomic_file::write(&path, &bytes).with_context(place)
    })
}

/// The bytes of a file, held against its hash.
///
/// # Errors
/// If the store cannot be reached, or the object is missing or damaged.
pub fn fetched(remote: &Remote, file: &Stored) -> Result<Vec<u8>> {
    let object = remote.name(&file.object());
    let Some(bytes) = remote.get(&file.object(), file.bytes)? else {
        bail!("{object}, which holds `{}`, is gone", file.name)
    };
    ensure!(
        hash(&bytes) == file.blake3,
        "{object}, which holds `{}`, is damaged: delete that object and `commit.json` there, and make the data anew",
        file.name
    );
    Ok(bytes)
}

fn each(commit: &Commit, what: &'static str, transfer: impl Fn(&Stored) -> Result<()> + Sync) -> Result<()> {
    let bar = progress::bar(what, commit.files.len(), 0);
    let pool = ThreadPoolBuilder::new().num_threads(TRANSFERS).build().context("threads for transfers")?;
    let done = pool.install(|| {
        commit.files.par_iter().try_for_each(|file| {
            transfer(file)?;
            bar.inc(1);
            Ok(())
        })
    });
    bar.finish_and_clear();
    done
}
