//! Files of a run: whole or not there, and written by one program at a time.

use crate::checkpoint::CHECKPOINT_FILE;
use crate::config::CONFIG_FILE;
use crate::events::EVENTS_FILE;
use crate::metrics::{CURVE_FILE, METRICS_FILE};
use crate::training::RANGES_FILE;
use crate::{TrainConfig, TrainError};
use deepshade_dataset::holder::Holder;
use deepshade_dataset::lock;
use deepshade_shaders::atomic_file;
use std::fs::{File, TryLockError};
use std::path::Path;

/// Writes or replaces a file.
pub(crate) fn replace(path: &Path, bytes: &[u8]) -> Result<(), TrainError> {
    atomic_file::write(path, bytes).map_err(TrainError::io("write", path))
}

/// Takes a run's folder, which is made where it is missing, for this program alone, as long as what it gives
/// lives: the metrics, to be appended to, and the note of who has the folder. What a killed program left
/// half-written is deleted.
///
/// # Errors
/// If another program has the folder, or it cannot be written.
pub(crate) fn take(folder: &Path) -> Result<(File, Holder), TrainError> {
    std::fs::create_dir_all(folder).map_err(TrainError::io("create", folder))?;
    let path = folder.join(METRICS_FILE);
    let busy = || TrainError::Busy { folder: folder.to_owned(), holder: Holder::of(folder) };
    // A run that is discarded is deleted while it is locked.
    let file = lock::alone(&path).map_err(TrainError::io("lock", &path))?.ok_or_else(busy)?;
    atomic_file::delete_temporaries(folder).map_err(TrainError::io("clean", folder))?;
    Ok((file, Holder::sign(folder)))
}

/// Whether a program has a run's folder. Without its note the lock is not looked at, which would keep out
/// whoever takes it just then.
#[must_use]
pub fn is_taken(folder: &Path) -> bool {
    let is_locked = |file: File| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock));
    Holder::has_signed(folder) && File::open(folder.join(METRICS_FILE)).is_ok_and(is_locked)
}

/// Deletes the files of the run in a folder, and nothing else in it; a folder without a run is left as it is.
///
/// # Errors
/// If the config in it is not that of a run, another program is training there, or a file cannot be deleted.
pub fn discard(folder: &Path) -> Result<(), TrainError> {
    if !folder.join(CONFIG_FILE).exists() {
        return Ok(());
    }
    TrainConfig::load(folder)?;
    let _taken = take(folder)?;
    // The config last: as long as it is there, what is left is known as a run.
    for name in [CHECKPOINT_FILE, METRICS_FILE, CURVE_FILE, EVENTS_FILE, RANGES_FILE, CONFIG_FILE] {
        let path = folder.join(name);
        if path.exists() {
            std::fs::remove_file(&path).map_err(TrainError::io("delete", &path))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_taken_as_long_as_somebody_has_it() {
        let folder = tempfile::tempdir().expect("a folder");
        assert!(!is_taken(folder.path()));
        let taken = take(folder.path()).expect("free");
        assert!(is_taken(folder.path()));
        drop(taken);
        assert!(!is_taken(folder.path()));
        // As a killed program leaves it.
        std::mem::forget(Holder::sign(folder.path()));
        assert!(!is_taken(folder.path()));
    }
}
