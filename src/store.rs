//! Object stores: what a folder holds, put there file by file, with a list of all that is written last.
//!
//! Below an address lie `objects/HASH`, files named by their BLAKE3 hash, and `commit.json`, which lists
//! their names, sizes and hashes (`commit`). Objects are never replaced by others, and the list is one
//! object, which is written only if it takes the place of the one that was there when the work began. So
//! whoever reads sees all of what was there before or all of what is there now, a broken transfer goes on
//! where it ended, and of two that write different things at once the second is told. Every file that is
//! fetched, now or before, is held against its hash.
//!
//! Requests are tried again for some minutes. Credentials, regions and endpoints come from the environment,
//! in the names that the stores' own tools have (`AWS_ACCESS_KEY_ID`, `GOOGLE_APPLICATION_CREDENTIALS`,
//! `AZURE_STORAGE_ACCOUNT_KEY`, ...).

mod commit;
mod remote;
mod transfer;
mod working_copy;

pub use working_copy::WorkingCopy;

use crate::location::Address;
use anyhow::{Context, Result};
use commit::Commit;
use etcetera::BaseStrategy;
use remote::Remote;
use std::path::PathBuf;

/// The variable that names the folder of what was fetched, in place of the user's cache folder.
const CACHE: &str = "DEEPSHADE_CACHE";

/// A folder with what is at an address. It stays there, and another reading fetches what is missing.
///
/// # Errors
/// If the store cannot be reached, or holds nothing there or something damaged.
pub fn read(address: &Address) -> Result<PathBuf> {
    let fetched = || -> Result<PathBuf> {
        let remote = Remote::open(address)?;
        let (commit, hash) = Commit::whole(&remote)?;
        let folder = cache()?.join("copies").join(hash);
        transfer::fetch(&remote, &commit, &folder)?;
        Ok(folder)
    };
    fetched().with_context(|| address.to_string())
}

/// Whether something whole is at an address.
///
/// # Errors
/// If the store cannot be reached.
pub fn holds(address: &Address) -> Result<bool> {
    Ok(Remote::open(address)?.size(commit::NAME)?.is_some())
}

/// The folder of what was fetched and of what is made for stores.
fn cache() -> Result<PathBuf> {
    let folder = match std::env::var_os(CACHE) {
        Some(folder) => PathBuf::from(folder),
        None => etcetera::choose_base_strategy()
            .with_context(|| format!("no cache folder: {CACHE} may name one"))?
            .cache_dir()
            .join("deepshade"),
    };
    Ok(folder.join("store"))
}
