//! Writing files so that a name never stands for half a file: a temporary file in the same folder, synced, renamed.

use std::io::{self, Write};
use std::path::Path;

/// What names of temporary files start with. A killed program leaves some behind; whoever owns a folder may delete
/// them there.
pub const TEMPORARY_PREFIX: &str = ".deepshade-";

/// Writes a whole file, replacing one of that name. When this fails, the old file is as it was.
///
/// # Errors
/// If the folder is missing, not writable or full. The error does not say which file: the caller does.
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(TEMPORARY_PREFIX);
    // Temporary files are private by default; what is made of them is not. The process's mask still applies.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder)?;
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    file.persist(path).map_err(|error| error.error)?;
    sync_folder(folder)
}

/// Makes the new name last through a power cut; only Unix lets a folder be synced.
fn sync_folder(folder: &Path) -> io::Result<()> {
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
}
