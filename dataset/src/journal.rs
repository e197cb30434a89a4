//! What makes a long job resumable: a file of one JSON line for every finished piece, with the hashes of its
//! files.
//!
//! A line is written after its files bear their final names. Whoever starts the job again believes a line
//! only if the files have the hashes that the line says, so neither a lost line nor a damaged file does harm.
//! The first line says what is being made; another job is refused. When all is done, the journal is deleted.

use crate::DatasetError;
use crate::holder::Holder;
use crate::lock;
use crate::origin::Origin;
use crate::recipe::file_hash;
use deepshade_shaders::atomic_file;
use rayon::prelude::*;
use serde::{Serialize, de::DeserializeOwned};
use std::collections::HashMap;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// The journal's name while a job is unfinished.
pub const JOURNAL: &str = "unfinished.jsonl";

/// What is kept of a finished piece of work.
pub trait Entry: Clone + Serialize + DeserializeOwned + Send + Sync {
    /// A name that no other entry of the job has.
    fn name(&self) -> &str;

    /// The files, relative to the job's folder, with their BLAKE3 hashes in hexadecimal.
    fn files(&self) -> Vec<(&str, &str)>;
}

/// The journal of a job under way. It is locked, so that two programs do not write into one folder.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: Mutex<File>,
    holder: Holder,
}

impl Journal {
    /// Opens or begins the journal of what `origin` makes in a folder, deletes what a killed program left
    /// half-written in the folder and its `subfolders`, and returns the entries so far, unchecked. A finished
    /// job leaves a file `whole`.
    ///
    /// # Errors
    /// If the folder cannot be written, is in use, or holds another job's journal or anything that is no
    /// job's.
    pub fn open<E: Entry>(
        folder: &Path,
        subfolders: &[&str],
        whole: &str,
        origin: &Origin,
    ) -> Result<(Self, Vec<E>), DatasetError> {
        let own = [JOURNAL, whole].iter().any(|name| folder.join(name).exists());
        if let Some(file) = foreign(folder, subfolders).filter(|_| !own) {
            return Err(DatasetError::Foreign { folder: folder.to_owned(), file });
        }
        let folders: Vec<PathBuf> = subfolders.iter().map(|name| folder.join(name)).collect();
        for folder in &folders {
            std::fs::create_dir_all(folder).map_err(|source| DatasetError::io(folder, source))?;
        }
        let path = folder.join(JOURNAL);
        let io = |source| DatasetError::io(&path, source);
        let busy = || DatasetError::Busy { folder: folder.to_owned(), holder: Holder::of(folder) };
        // Whoever finishes deletes the journal while it is locked.
        let mut file = lock::alone(&path).map_err(io)?.ok_or_else(busy)?;
        delete_temporaries(folder)?;
        folders.iter().try_for_each(|folder| delete_temporaries(folder))?;
        let holder = Holder::sign(folder);
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(io)?;
        let (entries, sound) = sound_lines(folder, &bytes, origin)?;
        file.set_len(sound as u64).map_err(io)?;
        file.seek(SeekFrom::End(0)).map_err(io)?;
        if sound == 0 {
            write_line(&mut file, origin).map_err(io)?;
        }
        Ok((Self { path, file: Mutex::new(file), holder }, entries))
    }

    /// Notes that a piece is finished.
    ///
    /// # Errors
    /// If the line cannot be written.
    pub fn add(&self, entry: &impl Entry) -> Result<(), DatasetError> {
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        write_line(&mut file, entry).map_err(|source| DatasetError::io(&self.path, source))
    }

    /// Deletes the journal: the job is done.
    ///
    /// # Errors
    /// If it cannot be deleted.
    pub fn finish(self) -> Result<(), DatasetError> {
        drop(self.holder);
        std::fs::remove_file(&self.path).map_err(|source| DatasetError::io(&self.path, source))
    }
}

/// Those entries whose files are there and have the hashes that the entry says, by name.
pub fn checked<E: Entry>(folder: &Path, entries: Vec<E>) -> HashMap<String, E> {
    let holds = |(file, stated): (&str, &str)| file_hash(&folder.join(file)).is_ok_and(|hash| hash == stated);
    let whole = |entry: &E| entry.files().into_iter().all(holds);
    entries.into_par_iter().filter(whole).map(|entry| (entry.name().to_owned(), entry)).collect()
}

/// The entries of the sound lines at the start of a journal, and where the last of them ends.
fn sound_lines<E: Entry>(
    folder: &Path,
    bytes: &[u8],
    origin: &Origin,
) -> Result<(Vec<E>, usize), DatasetError> {
    let mut entries = Vec::new();
    let mut end = 0;
    for line in bytes.split_inclusive(|byte| *byte == b'\n').take_while(|line| line.ends_with(b"\n")) {
        if end == 0 {
            let theirs: Origin = serde_json::from_slice(line).map_err(|_| {
                let what = "it was begun by another version of the program: choose another folder, or delete that one";
                DatasetError::invalid(&folder.join(JOURNAL), what)
            })?;
            theirs.check_same(origin, folder)?;
        } else {
            let Ok(entry) = serde_json::from_slice(line) else { break };
            entries.push(entry);
        }
        end += line.len();
    }
    Ok((entries, end))
}

/// One write a line, so that a kill leaves at most one line cut off.
fn write_line(file: &mut File, value: &impl Serialize) -> std::io::Result<()> {
    let mut line = serde_json::to_vec(value)?;
    line.push(b'\n');
    file.write_all(&line)
}

/// Something in a folder that no job puts there before its journal.
fn foreign(folder: &Path, subfolders: &[&str]) -> Option<String> {
    let names = std::fs::read_dir(folder).ok()?.flatten().map(|entry| entry.file_name());
    names.map(|name| name.to_string_lossy().into_owned()).find(|name| !subfolders.contains(&name.as_str()))
}

fn delete_temporaries(folder: &Path) -> Result<(), DatasetError> {
    atomic_file::delete_temporaries(folder).map_err(|source| DatasetError::io(folder, source))
}
