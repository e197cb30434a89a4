//! Files of a run, whole or not there.

use crate::TrainError;
use deepshade_shaders::atomic_file;
use std::path::Path;

/// Writes or replaces a file.
pub(crate) fn replace(path: &Path, bytes: &[u8]) -> Result<(), TrainError> {
    atomic_file::write(path, bytes).map_err(TrainError::io("write", path))
}
