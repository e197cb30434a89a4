//! Folders that stand for places.

#[cfg(feature = "store")]
use crate::store;
use anyhow::Result;
use deepshade_dataset::Out;
use std::fs::File;
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A folder with what is at a place. What was fetched stays there as long as this lives.
#[derive(Clone, Debug)]
pub struct Folder {
    path: PathBuf,
    /// Keeps others from deleting it.
    _lock: Option<Arc<File>>,
}

impl Folder {
    /// One that nobody deletes for room.
    pub fn of(path: &Path) -> Self {
        Self { path: path.to_owned(), _lock: None }
    }

    /// One that is kept by a lock.
    #[cfg(feature = "store")]
    pub fn kept(path: PathBuf, lock: File) -> Self {
        Self { path, _lock: Some(Arc::new(lock)) }
    }
}

impl Deref for Folder {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.path
    }
}

/// A folder to write into for a place.
pub enum Work {
    /// The place itself.
    Folder(PathBuf),
    /// For an address.
    #[cfg(feature = "store")]
    Store(Box<store::Work>, PathBuf),
}

impl Deref for Work {
    type Target = Path;

    fn deref(&self) -> &Path {
        match self {
            Self::Folder(folder) => folder,
            #[cfg(feature = "store")]
            Self::Store(_, folder) => folder,
        }
    }
}

impl Work {
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
    /// If the store cannot be reached or refuses it, or somebody else has put something else there since [`Place::begin`](super::Place::begin).
    pub fn finish(self) -> Result<()> {
        match self {
            Self::Folder(_) => Ok(()),
            #[cfg(feature = "store")]
            Self::Store(work, _) => work.finish(),
        }
    }

    /// [`Self::finish`] of what nobody will go on with on this machine: what is in the store is not kept here.
    ///
    /// # Errors
    /// As there.
    pub fn deliver(self) -> Result<()> {
        match self {
            Self::Folder(_) => Ok(()),
            #[cfg(feature = "store")]
            Self::Store(work, _) => work.deliver(),
        }
    }
}
