//! Folders to write into.

#[cfg(feature = "store")]
use crate::store;
use anyhow::Result;
use deepshade_dataset::Out;
use std::ops::Deref;
use std::path::{Path, PathBuf};

/// A folder to write into for a location.
pub enum WorkingFolder {
    /// The location itself.
    Folder(PathBuf),
    /// For an address.
    #[cfg(feature = "store")]
    Store(Box<store::WorkingCopy>, PathBuf),
}

impl Deref for WorkingFolder {
    type Target = Path;

    fn deref(&self) -> &Path {
        match self {
            Self::Folder(folder) => folder,
            #[cfg(feature = "store")]
            Self::Store(_, folder) => folder,
        }
    }
}

impl WorkingFolder {
    /// It for makers of data, which state where scene files are if data stay in the folder.
    pub fn out(&self) -> Out<'_> {
        let stays = match self {
            Self::Folder(_) => true,
            #[cfg(feature = "store")]
            Self::Store(..) => false,
        };
        Out { folder: self, stays }
    }

    /// Puts what was written where it belongs, all or, to whoever reads it, nothing.
    ///
    /// # Errors
    /// If the store cannot be reached or refuses it, or somebody else has put something else there since
    /// [`Location::begin`](super::Location::begin).
    pub fn finish(self) -> Result<()> {
        match self {
            Self::Folder(_) => Ok(()),
            #[cfg(feature = "store")]
            Self::Store(copy, _) => copy.finish(),
        }
    }
}
