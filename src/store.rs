//! Object stores: what a folder holds, put there file by file, with a list of all that is written last.
//!
//! Below an address lie `objects/HASH`, files named by their BLAKE3 hash, and `commit.json`, which lists their names,
//! sizes and hashes (`commit`). Objects are never replaced by others, and the list is one object: so whoever reads sees the
//! whole of what was there before or the whole of what is there now, a broken transfer goes on where it ended, and two
//! that write at once do no harm to each other. Every file that is read is held against its hash.
//!
//! Requests are tried again for some minutes; credentials, regions and endpoints come from the environment, in the names
//! that the stores' own tools have (`AWS_ACCESS_KEY_ID`, `GOOGLE_APPLICATION_CREDENTIALS`, `AZURE_STORAGE_ACCOUNT_KEY`, ...).

mod cache;
mod commit;
mod remote;
#[cfg(feature = "train")]
pub mod stream;
mod transfer;

use crate::place::Address;
use anyhow::{Context, Result, bail};
use commit::Commit;
use remote::Remote;
use std::path::PathBuf;

/// A folder with what is at an address, in the cache.
///
/// # Errors
/// If the store cannot be reached, or holds nothing there or something damaged.
pub fn read(address: &Address) -> Result<PathBuf> {
    let remote = Remote::open(address)?;
    let Some((commit, hash)) = Commit::at(&remote)? else {
        bail!("{address}: nothing is there, or nothing finished: no `{}`", commit::NAME);
    };
    cache::source(&commit, &hash, |folder| {
        transfer::fetch(&remote, &commit, folder).with_context(|| address.to_string())
    })
}

/// A folder to work in on what is to be at an address, with what is there already.
///
/// # Errors
/// If the store cannot be reached, or what it holds there is damaged.
pub fn begin(address: &Address) -> Result<PathBuf> {
    let remote = Remote::open(address)?;
    let work = cache::Work::of(address)?;
    if let Some((commit, hash)) = Commit::at(&remote)?
        && !work.goes_on_from(&hash)
    {
        work.clear()?;
        transfer::fetch(&remote, &commit, &work.folder).with_context(|| address.to_string())?;
        work.note(&hash)?;
    }
    Ok(work.folder)
}

/// Puts what is in the folder of [`begin`] to its address.
///
/// # Errors
/// If the store cannot be reached or refuses it, or the folder cannot be read.
pub fn finish(address: &Address) -> Result<()> {
    let remote = Remote::open(address)?;
    let work = cache::Work::of(address)?;
    let commit = Commit::of(&work.folder)?;
    transfer::put(&remote, &commit, &work.folder).with_context(|| address.to_string())?;
    let hash = commit.publish(&remote)?;
    work.note(&hash)
}
