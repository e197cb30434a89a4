//! Files that are whole or not there.

use crate::TrainError;
use std::io::Write;
use std::path::Path;

/// Replaces a file: written beside it under another name, synced, then renamed.
pub(crate) fn replace(path: &Path, bytes: &[u8]) -> Result<(), TrainError> {
    let folder = path.parent().unwrap_or(Path::new("."));
    let write = || {
        let mut file = tempfile::NamedTempFile::new_in(folder)?;
        file.write_all(bytes)?;
        file.as_file().sync_all()?;
        file.persist(path)?;
        std::fs::File::open(folder)?.sync_all()
    };
    write().map_err(TrainError::io("write", path))
}
