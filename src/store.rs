//! Object stores: what a folder holds, put there file by file, with a list of all that is written last.
//!
//! Below an address lie `objects/HASH`, files named by their BLAKE3 hash, and `commit.json`, which lists their names,
//! sizes and hashes (`commit`). Objects are never replaced by others, and the list is one object, which is written only if it takes
//! the place of the one that was there when the work began: so whoever reads sees the whole of what was there before or the
//! whole of what is there now, a broken transfer goes on where it ended, and of two that write different things at once the
//! second is told. Every file that is fetched is held against its hash; copies in the cache are known by their sizes from
//! then on, pairs that are trained on by their hashes.
//!
//! Requests are tried again for some minutes; credentials, regions and endpoints come from the environment, in the names
//! that the stores' own tools have (`AWS_ACCESS_KEY_ID`, `GOOGLE_APPLICATION_CREDENTIALS`, `AZURE_STORAGE_ACCOUNT_KEY`, ...).

mod cache;
mod commit;
mod remote;
mod shard;
#[cfg(feature = "train")]
pub mod stream;
mod transfer;
mod work;

pub use remote::Remote;
pub use shard::Shard;
pub use work::Work;

use crate::place::{Address, Folder};
use anyhow::{Context, Result};
use commit::Commit;

/// A folder with what is at an address, in the cache.
///
/// # Errors
/// If the store cannot be reached, or holds nothing there or something damaged.
pub fn read(address: &Address) -> Result<Folder> {
    let remote = Remote::open(address)?;
    let (commit, hash) = Commit::whole(&remote).with_context(|| address.to_string())?;
    let fetch = |folder: &_| transfer::fetch(&remote, &commit, folder);
    cache::Cache::open()?.source(&commit, &hash, fetch).with_context(|| address.to_string())
}

/// Whether something whole is at an address.
///
/// # Errors
/// If the store cannot be reached.
pub fn holds(address: &Address) -> Result<bool> {
    Ok(Remote::open(address)?.size(commit::NAME)?.is_some())
}
