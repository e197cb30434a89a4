//! Writing files so that a name never stands for half a file: a temporary file in the same folder, synced,
//! renamed.

use crate::own_file::folder;
use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::Path;
use tempfile::NamedTempFile;

/// What names of temporary files and folders start with. A killed program leaves some behind; whoever owns a
/// folder may delete them there.
pub const TEMPORARY_PREFIX: &str = ".deepshade-";

/// Modes on Unix of files that others may read, as far as the process's mask lets them, and of those that
/// nobody else may.
const OPEN: u32 = 0o666;
const PRIVATE: u32 = 0o600;

/// Writes a whole file, replacing one of that name. A link stays, and what it leads to is replaced. What is
/// no regular file, such as a pipe or a device (`/dev/stdout`), cannot be replaced and is written into.
///
/// # Errors
/// If the folder is missing, not writable or full; the old file is then as it was. Only where the system
/// fails to make the new name last, at the very end, is the new file there in spite of an error. The error
/// does not say which file: the caller does.
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    write_with(path, bytes, OPEN)
}

/// As [`write()`], a file that on Unix nobody but its owner may read or write.
///
/// # Errors
/// As [`write()`].
pub fn write_private(path: &Path, bytes: &[u8]) -> io::Result<()> {
    write_with(path, bytes, PRIVATE)
}

/// Finds out whether [`write()`] could write a file, its folder made where that is missing: what can be known
/// before there is anything to write.
///
/// # Errors
/// If it could not.
pub fn check(path: &Path) -> io::Result<()> {
    if path.as_os_str().is_empty() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "no name is given"));
    }
    let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    match path.metadata() {
        Ok(found) if found.is_dir() => Err(io::ErrorKind::IsADirectory.into()),
        Ok(found) if !found.is_file() => Ok(()),
        _ => {
            let nearest = path.ancestors().find(|path| folder(path).exists()).unwrap_or(&path);
            temporary(folder(nearest), PRIVATE).map(drop)
        }
    }
}

fn write_with(path: &Path, bytes: &[u8], mode: u32) -> io::Result<()> {
    let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    match path.metadata() {
        Ok(found) if !found.is_file() && !found.is_dir() => {
            OpenOptions::new().write(true).open(path)?.write_all(bytes)
        }
        _ => replace(&path, bytes, mode),
    }
}

/// Deletes what killed programs left half-written in a folder, which the caller alone writes into: files, and
/// folders of them.
///
/// # Errors
/// If the folder cannot be read or something in it not be deleted.
pub fn delete_temporaries(folder: &Path) -> io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        if entry.file_name().to_string_lossy().starts_with(TEMPORARY_PREFIX) {
            match entry.file_type()?.is_dir() {
                true => std::fs::remove_dir_all(entry.path())?,
                false => std::fs::remove_file(entry.path())?,
            }
        }
    }
    Ok(())
}

fn replace(path: &Path, bytes: &[u8], mode: u32) -> io::Result<()> {
    let folder = folder(path);
    let file = temporary(folder, mode)?;
    file.as_file().write_all(bytes)?;
    file.as_file().sync_all()?;
    file.persist(path).map_err(|error| error.error)?;
    sync_folder(folder)
}

/// A temporary file in a folder. It is opened here, since an error of the crate's own names it, which means
/// nothing to anybody.
#[cfg_attr(not(unix), expect(unused_variables, reason = "only Unix has modes"))]
fn temporary(folder: &Path, mode: u32) -> io::Result<NamedTempFile> {
    let mut options = OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, mode);
    tempfile::Builder::new().prefix(TEMPORARY_PREFIX).make_in(folder, |path| options.open(path))
}

/// Makes new names in a folder last through a power cut; only Unix lets a folder be synced.
///
/// # Errors
/// If the system fails to.
pub fn sync_folder(folder: &Path) -> io::Result<()> {
    if cfg!(unix) { std::fs::File::open(folder)?.sync_all() } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_and_nothing_is_left_over() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.txt");
        write(&path, b"first").expect("written");
        write(&path, b"second").expect("replaced");
        assert_eq!(std::fs::read(&path).expect("read"), b"second");
        assert_eq!(std::fs::read_dir(folder.path()).expect("listed").count(), 1);
    }

    #[test]
    fn a_failure_leaves_nothing() {
        let folder = tempfile::tempdir().expect("a folder");
        let taken = folder.path().join("folder");
        std::fs::create_dir(&taken).expect("made");
        assert!(write(&taken, b"x").is_err(), "a folder has that name");
        assert!(write(&folder.path().join("missing/a.txt"), b"x").is_err());
        assert_eq!(std::fs::read_dir(folder.path()).expect("listed").count(), 1);
    }

    #[test]
    fn what_can_be_written_is_told_before() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name);
        std::fs::write(path("file"), b"x").expect("written");
        check(&path("new")).expect("a new file");
        check(&path("deep/deeper/new")).expect("folders can be made");
        check(&path("file")).expect("it is replaced");
        for wrong in ["", "file/new", "file/deep/new"] {
            let error = check(&path(wrong)).expect_err(wrong).to_string();
            assert!(!error.contains(TEMPORARY_PREFIX), "{error}");
        }
        assert_eq!(std::fs::read_dir(folder.path()).expect("listed").count(), 1, "nothing is left");
    }

    #[test]
    fn only_what_was_left_half_written_is_deleted() {
        let folder = tempfile::tempdir().expect("a folder");
        for name in [".deepshade-x1", ".other", "deepshade-x2"] {
            std::fs::write(folder.path().join(name), b"x").expect("written");
        }
        std::fs::create_dir(folder.path().join(".deepshade-x3")).expect("made");
        std::fs::write(folder.path().join(".deepshade-x3/a"), b"x").expect("written");
        delete_temporaries(folder.path()).expect("deleted");
        let mut left: Vec<_> = std::fs::read_dir(folder.path())
            .expect("listed")
            .map(|entry| entry.expect("an entry").file_name())
            .collect();
        left.sort();
        assert_eq!(left, [".other", "deepshade-x2"]);
        assert!(delete_temporaries(&folder.path().join("missing")).is_err());
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_and_what_it_leads_to_is_replaced() {
        let folder = tempfile::tempdir().expect("a folder");
        let (file, link) = (folder.path().join("deep/a.txt"), folder.path().join("link"));
        std::fs::create_dir(folder.path().join("deep")).expect("made");
        std::fs::write(&file, b"first").expect("written");
        std::os::unix::fs::symlink(&file, &link).expect("linked");
        write(&link, b"second").expect("replaced");
        assert_eq!(std::fs::read(&file).expect("read"), b"second");
        assert!(link.is_symlink());
        assert_eq!(std::fs::read_dir(folder.path()).expect("listed").count(), 2);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_pipe_is_written_into() {
        use std::io::Read;
        use std::os::fd::AsRawFd;
        let (mut reader, writer) = io::pipe().expect("a pipe");
        let path = format!("/proc/self/fd/{}", writer.as_raw_fd());
        write(Path::new(&path), b"through").expect("written");
        drop(writer);
        let mut read = Vec::new();
        reader.read_to_end(&mut read).expect("read");
        assert_eq!(read, b"through");
    }
}
