//! Files and folders that are the user's own: nobody else can have put anything there.

use std::fs::Metadata;
use std::io;
use std::path::Path;

/// Whether nobody but the user, and root, may have written a file, or what a folder holds. On other systems
/// than Unix it is not known, and taken for true.
pub fn is_own(found: &Metadata) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        owned(found.uid(), found.mode(), rustix::process::geteuid().as_raw())
    }
    #[cfg(not(unix))]
    {
        let _ = found;
        true
    }
}

/// Makes a folder, and those that it is in, where there is none; on Unix nobody else may enter what is made.
///
/// # Errors
/// If it cannot be made.
pub fn create_folder(path: &Path) -> io::Result<()> {
    let mut builder = std::fs::DirBuilder::new();
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.recursive(true).create(path)
}

/// The folder of a file.
pub fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Whether what belongs to `owner` and has that mode is `user`'s own.
#[cfg(unix)]
const fn owned(owner: u32, mode: u32, user: u32) -> bool {
    const ROOT: u32 = 0;
    const OTHERS_WRITE: u32 = 0o022;
    (owner == user || owner == ROOT) && mode & OTHERS_WRITE == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn what_others_own_or_may_write_is_not_the_users_own() {
        assert!(owned(1000, 0o100_644, 1000) && owned(1000, 0o040_755, 1000));
        assert!(owned(0, 0o100_644, 1000), "root could do anything anyway");
        assert!(!owned(1001, 0o100_600, 1000) && !owned(1001, 0o100_600, 0), "another user's");
        assert!(!owned(1000, 0o100_664, 1000) && !owned(1000, 0o100_646, 1000), "others may write it");
        assert!(!owned(0, 0o041_777, 1000), "/tmp");
    }

    #[test]
    fn a_name_alone_is_in_the_folder_where_one_is() {
        assert_eq!(folder(Path::new("name")), Path::new("."));
        assert_eq!(folder(Path::new("a/b/name")), Path::new("a/b"));
    }
}
