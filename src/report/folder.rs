//! The folder of a report: whose it is, and clearing away what an earlier report left in it, and nothing else
//! that people keep there.

use super::record::{FrameRecord, RECORD};
use super::{PAGE, images};
use crate::figures::write_atomically;
use anyhow::{Context, Result, bail};
use deepshade_dataset::holder::Holder;
use deepshade_dataset::lock;
use deepshade_shaders::atomic_file;
use std::fs::{self, DirEntry, File};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// What stands in every page of ours, and in no other.
const MARK: &str = "<meta name=\"generator\" content=\"deepshade compare\">";
/// What a report was made from.
pub const DESCRIPTION: &str = "compare.toml";
/// How every description of ours begins.
pub const DESCRIPTION_MARK: &str = "# What `deepshade compare` made";
/// The same figures as on the page.
pub const MARKDOWN: &str = "compare.md";
/// Who holds this file's lock writes into the folder.
const LOCK: &str = "compare.lock";
/// How names of frames' folders begin.
pub const FRAME_PREFIX: &str = "frame-";

/// A folder that this program alone writes a report into.
#[derive(Debug)]
pub struct Folder {
    /// Where it is.
    pub path: PathBuf,
    _holder: Holder,
    _lock: File,
}

impl Folder {
    /// Takes a folder, which is made where it is missing. An earlier page goes first and the new one is
    /// written last, so that a page never shows what is not there or is from another comparison.
    ///
    /// # Errors
    /// If it holds something else, is in use, or cannot be written to.
    pub fn open(path: &Path) -> Result<Self> {
        check(path)?;
        let place = || path.display().to_string();
        fs::create_dir_all(path).with_context(place)?;
        let Some(lock) = lock::alone(&path.join(LOCK)).with_context(place)? else {
            bail!("{}: {} is writing a comparison there", place(), Holder::of(path))
        };
        atomic_file::delete_temporaries(path).with_context(place)?;
        for name in [PAGE, MARKDOWN] {
            delete(&path.join(name)).with_context(place)?;
        }
        Ok(Self { path: path.to_owned(), _holder: Holder::sign(path), _lock: lock })
    }

    /// Writes a file of the report beside the page.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, name: &str, text: &str) -> Result<PathBuf> {
        let path = self.path.join(name);
        write_atomically(&path, text.as_bytes())?;
        Ok(path)
    }

    /// Makes a frame's folder ready to be written into.
    ///
    /// # Errors
    /// If it cannot be made.
    pub fn frame(&self, name: &str) -> Result<PathBuf> {
        let path = self.path.join(name);
        let made = fs::create_dir_all(&path).and_then(|()| atomic_file::delete_temporaries(&path));
        made.with_context(|| path.display().to_string())?;
        Ok(path)
    }

    /// Deletes what earlier reports left that is none of these frames'.
    ///
    /// # Errors
    /// If something cannot be deleted.
    pub fn keep_only(&self, frames: &[FrameRecord]) -> Result<()> {
        let cleared = fs::read_dir(&self.path).and_then(|mut entries| {
            entries.try_for_each(|entry| {
                let entry = entry?;
                let name = entry.file_name().to_string_lossy().into_owned();
                // A link may lead anywhere.
                let frame = entry.file_type()?.is_dir() && name.starts_with(FRAME_PREFIX);
                if !frame || !entry.path().join(RECORD).is_file() {
                    return Ok(());
                }
                clear(&entry.path(), frames.iter().find(|frame| frame.folder == name))
            })
        });
        cleared.with_context(|| format!("the earlier comparison in {}", self.path.display()))
    }
}

impl Drop for Folder {
    /// Whether the file stays matters to nobody: its lock ends with the program.
    fn drop(&mut self) {
        let _ = delete(&self.path.join(LOCK));
    }
}

/// Refuses a folder that is not for a report: one that holds something, but no earlier report.
///
/// # Errors
/// If so, with what it holds; or if it cannot be read.
pub fn check(folder: &Path) -> Result<()> {
    let foreign = foreign(folder).with_context(|| folder.display().to_string())?;
    if let Some(name) = foreign {
        bail!(
            "{} holds `{name}` and no report: choose another folder, a new or an empty one",
            folder.display()
        );
    }
    Ok(())
}

/// What a folder holds beside no report of ours; frames of one that was never finished do not count.
fn foreign(folder: &Path) -> io::Result<Option<String>> {
    let text = |name: &str| {
        let bytes = fs::read(folder.join(name)).unwrap_or_default();
        String::from_utf8_lossy(&bytes).into_owned()
    };
    if !folder.exists() || text(PAGE).contains(MARK) {
        return Ok(None);
    }
    let began = !folder.join(PAGE).exists() && text(DESCRIPTION).starts_with(DESCRIPTION_MARK);
    if began {
        return Ok(None);
    }
    let mut others = fs::read_dir(folder)?.filter(|entry| !entry.as_ref().is_ok_and(is_own));
    let first = others.next().transpose()?;
    Ok(first.map(|entry| entry.file_name().to_string_lossy().into_owned()))
}

/// Whether something in a folder is of a report that was never finished.
fn is_own(entry: &DirEntry) -> bool {
    let name = entry.file_name();
    let temporary = name.to_string_lossy().starts_with(atomic_file::TEMPORARY_PREFIX);
    name == LOCK
        || temporary
        || (name.to_string_lossy().starts_with(FRAME_PREFIX) && entry.path().join(RECORD).is_file())
}

/// Deletes images in a frame's folder but for those of a record, and the folder where it is empty then.
fn clear(folder: &Path, record: Option<&FrameRecord>) -> io::Result<()> {
    let kept: Vec<&str> = record.iter().flat_map(|record| record.files()).collect();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().into_owned();
        let stale = images::stem(&name).is_some_and(|stem| !kept.contains(&stem));
        if stale || (record.is_none() && name == RECORD) {
            fs::remove_file(entry.path())?;
        }
    }
    if record.is_some() {
        return Ok(());
    }
    match fs::remove_dir(folder) {
        Err(error) if error.kind() != ErrorKind::DirectoryNotEmpty => Err(error),
        _ => Ok(()),
    }
}

/// Deletes a file, if it is there.
pub(super) fn delete(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}
