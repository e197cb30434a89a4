//! Reading scenes and what they refer to: where it may be, and its bytes with a size limit.

use super::SceneError;
use crate::scene::memory;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Component, Path, PathBuf};

/// Largest file that is read, bytes.
const LARGEST_FILE: u64 = 4 << 30;

/// The bytes of a plain file, as [`bytes`].
pub(super) fn read(path: &Path) -> Result<Vec<u8>, SceneError> {
    bytes(path).map_err(|source| SceneError::Io { path: path.to_owned(), source })
}

/// The bytes of a plain file. Devices and pipes, which may never end, are refused, as is what memory does not
/// hold.
pub(super) fn bytes(path: &Path) -> io::Result<Vec<u8>> {
    let metadata = fs::metadata(path)?;
    if !metadata.is_file() {
        return Err(io::Error::new(ErrorKind::InvalidInput, "is not a plain file"));
    }
    if metadata.len() > LARGEST_FILE.min(memory::available()) {
        let what = format!("has {} bytes, more than are read", metadata.len());
        return Err(io::Error::new(ErrorKind::FileTooLarge, what));
    }
    fs::read(path)
}

/// The text of a plain file.
pub(super) fn text(path: &Path) -> io::Result<String> {
    let no_text = |_| io::Error::new(ErrorKind::InvalidData, "is no text in UTF-8");
    String::from_utf8(bytes(path)?).map_err(no_text)
}

/// Where a file is that a scene in `folder`, or what describes a medium or what glows, names in a file of its
/// own that lies in the folder `below`. Names do not lead out of that folder, since a scene may come from
/// anybody; what shall be read from elsewhere, a link in the folder may stand for.
pub(super) fn beside(folder: &Path, below: &Path, name: impl AsRef<Path>) -> Result<PathBuf, String> {
    let name = name.as_ref();
    let mut inside = below.to_owned();
    for component in name.components() {
        match component {
            Component::Normal(part) => inside.push(part),
            Component::CurDir => {}
            Component::ParentDir if inside.pop() => {}
            _ => {
                return Err(format!(
                    "`{}` leads out of the folder that is read; a link there may stand for it",
                    name.display()
                ));
            }
        }
    }
    Ok(folder.join(inside))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_do_not_lead_out_of_a_scenes_folder() {
        let found = |below: &str, name: &str| beside(Path::new("scenes/hall"), Path::new(below), name);
        assert_eq!(found("", "a.png"), Ok(PathBuf::from("scenes/hall/a.png")));
        assert_eq!(found("", "./textures/../b.bin"), Ok(PathBuf::from("scenes/hall/b.bin")));
        assert_eq!(found("materials", "../textures/a.png"), Ok(PathBuf::from("scenes/hall/textures/a.png")));
        for (below, name) in
            [("", "../a.png"), ("", "/etc/passwd"), ("", "a/../../b.png"), ("materials", "../../a.png")]
        {
            let error = found(below, name).expect_err("outside");
            assert!(error.starts_with(&format!("`{name}` leads out of the folder")), "{error}");
        }
    }
}
