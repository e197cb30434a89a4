//! Clearing away an earlier report, and nothing else that people keep in its folder.

use super::{PAGE, images};
use std::fs;
use std::io::{self, ErrorKind};
use std::path::Path;

/// What stands in every page of ours, and in no other.
const MARK: &str = "<meta name=\"generator\" content=\"deepshade compare\">";

/// What a folder holds beside no report of ours; frames of one that was never finished do not count.
///
/// # Errors
/// If the folder cannot be read.
pub fn foreign(folder: &Path) -> io::Result<Option<String>> {
    let page = fs::read(folder.join(PAGE)).unwrap_or_default();
    if !folder.exists() || String::from_utf8_lossy(&page).contains(MARK) {
        return Ok(None);
    }
    let names: Vec<_> =
        fs::read_dir(folder)?.map(|entry| Ok(entry?.file_name())).collect::<io::Result<_>>()?;
    let names = names.iter().map(|name| name.to_string_lossy().into_owned());
    Ok(names.into_iter().find(|name| !is_frame_folder(name)))
}

/// Deletes the page, then the images in folders of frames, and those folders that are empty then.
///
/// # Errors
/// If something cannot be deleted.
pub fn delete(folder: &Path) -> io::Result<()> {
    if !folder.exists() {
        return Ok(());
    }
    let page = folder.join(PAGE);
    if page.exists() {
        fs::remove_file(page)?;
    }
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        if is_frame_folder(&entry.file_name().to_string_lossy()) && entry.file_type()?.is_dir() {
            delete_frame(&entry.path())?;
        }
    }
    Ok(())
}

fn delete_frame(folder: &Path) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        if images::is_ours(&entry.file_name().to_string_lossy()) {
            fs::remove_file(entry.path())?;
        }
    }
    match fs::remove_dir(folder) {
        Err(error) if error.kind() != ErrorKind::DirectoryNotEmpty => Err(error),
        _ => Ok(()),
    }
}

/// Whether [`super::frame_folder`] gives names like this.
fn is_frame_folder(name: &str) -> bool {
    name.strip_prefix("frame-")
        .is_some_and(|index| index.len() >= 2 && index.bytes().all(|byte| byte.is_ascii_digit()))
}
