//! Locks on files that whoever holds the lock may delete: a journal goes when its job is done, a note when
//! its folder is free.
//!
//! Between opening and locking such a file another program may delete it and let go of it. The lock is then
//! on a file that has no name any more, and whoever comes next makes another and locks that. So a lock counts
//! only if the file is still the one at its path.

use same_file::Handle;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Error, ErrorKind, Result};
use std::path::Path;

/// Opens a file for reading and appending, makes it where there is none, and locks it for this program alone;
/// `None` if another program holds it. The lock goes with the file that is given.
///
/// # Errors
/// If it cannot be opened, or locks cannot be had there.
pub fn alone(path: &Path) -> Result<Option<File>> {
    loop {
        let file = open(path)?;
        match file.try_lock() {
            Ok(()) if is_at(&file, path)? => return Ok(Some(file)),
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Ok(None),
            Err(TryLockError::Error(error)) => return Err(error),
        }
    }
}

fn open(path: &Path) -> Result<File> {
    OpenOptions::new().read(true).append(true).create(true).open(path)
}

/// Whether an open file is the one at a path.
fn is_at(file: &File, path: &Path) -> Result<bool> {
    let gone = |error: Error| if error.kind() == ErrorKind::NotFound { Ok(false) } else { Err(error) };
    let ours = Handle::from_file(file.try_clone()?)?;
    Handle::from_path(path).map_or_else(gone, |there| Ok(there == ours))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn a_lock_is_one_programs_and_goes_with_its_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("lock");
        let held = alone(&path).expect("opened");
        assert!(held.is_some() && alone(&path).expect("opened").is_none());
        drop(held);
        assert!(alone(&path).expect("opened").is_some(), "free");
        assert!(alone(&folder.path().join("missing/lock")).is_err());
    }

    #[test]
    fn a_file_that_was_deleted_or_replaced_is_not_the_one_at_its_path() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("lock");
        let file = open(&path).expect("opened");
        assert!(is_at(&file, &path).expect("looked at"));
        std::fs::remove_file(&path).expect("deleted");
        assert!(!is_at(&file, &path).expect("looked at"));
        let _other = open(&path).expect("opened");
        assert!(!is_at(&file, &path).expect("looked at"));
    }

    /// Without a look at what was locked, two of these are in at once within a few hundred turns.
    #[test]
    fn whoever_deletes_what_it_holds_lets_one_in_at_a_time() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("lock");
        let inside = AtomicUsize::new(0);
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| {
                    for _ in 0..5000 {
                        let Some(lock) = alone(&path).expect("opened") else { continue };
                        assert_eq!(inside.fetch_add(1, Ordering::SeqCst), 0, "two at once");
                        std::thread::yield_now();
                        inside.fetch_sub(1, Ordering::SeqCst);
                        std::fs::remove_file(&path).expect("deleted");
                        drop(lock);
                    }
                });
            }
        });
    }
}
