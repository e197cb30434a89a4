//! What can go wrong with a capture.

use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a capture could not be read; each names the file or the folder.
#[derive(Debug, Error)]
pub enum CaptureError {
    /// The system says no: not there, not allowed.
    #[error("{path}: {source}")]
    Io {
        /// Which file or folder.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file that is damaged or is not what it should be.
    #[error("{path}: {what}")]
    Invalid {
        /// Which file.
        path: PathBuf,
        /// What is wrong, with the line or the frame named.
        what: String,
    },
    /// A folder of no layout that is read here.
    #[error(
        "{folder}: holds neither `rgb.txt` and `depth.txt` (TUM) nor the folders `color` and `depth` (Open3D)"
    )]
    Layout {
        /// Which folder.
        folder: PathBuf,
    },
    /// A folder without a frame.
    #[error("{folder}: {what}")]
    Empty {
        /// Which folder.
        folder: PathBuf,
        /// What is missing.
        what: &'static str,
    },
    /// Nobody says what the camera was.
    #[error("{folder}: nothing says what its camera was; {wanted}")]
    Camera {
        /// Which folder.
        folder: PathBuf,
        /// What would say it.
        wanted: &'static str,
    },
    /// An image that is not as large as another one of the capture.
    #[error("{path}: {found} pixels where {expected} are due")]
    Size {
        /// Which file.
        path: PathBuf,
        /// Its width and height.
        found: String,
        /// What they should be.
        expected: String,
    },
}

impl CaptureError {
    pub(super) fn io(path: &Path, source: std::io::Error) -> Self {
        Self::Io { path: path.to_owned(), source }
    }

    pub(super) fn invalid(path: &Path, what: impl Into<String>) -> Self {
        Self::Invalid { path: path.to_owned(), what: what.into() }
    }
}
