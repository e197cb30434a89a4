//! What can go wrong with data on disk.

use crate::capture::CaptureError;
use deepshade_render::exr_file::ExrError;
use deepshade_render::scene::SceneError;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a dataset could not be made, checked or read; each names the file, the scene or the recipe.
#[derive(Debug, Error)]
pub enum DatasetError {
    /// The system says no: not there, not allowed, disk full.
    #[error("{path}: {source}")]
    Io {
        /// Which file or folder.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The method whose images are targets failed.
    #[error(transparent)]
    Method(#[from] deepshade_render::method::MethodError),
    /// A recipe that cannot be followed.
    #[error("recipe {path}: {what}")]
    Recipe {
        /// Which recipe.
        path: PathBuf,
        /// What is wrong, with the key named.
        what: String,
    },
    /// A recipe that would bring scenes for testing into training or the reverse.
    #[error("recipe {path} mixes training and testing: {what}")]
    Mixed {
        /// Which recipe.
        path: PathBuf,
        /// Which scene is where it must not be.
        what: String,
    },
    /// A file of a dataset that is damaged or does not fit the others.
    #[error("{path}: {what}")]
    Invalid {
        /// Which file.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// A folder that holds what another recipe, or another version of the program, made.
    #[error("{folder} holds other data: {differences}; choose another folder, or delete that one")]
    OtherData {
        /// Which folder.
        folder: PathBuf,
        /// In what they differ from what was to be made, in words.
        differences: String,
    },
    /// A folder that holds something else than data.
    #[error(
        "{folder} holds `{file}`, which is no part of such data: choose another folder, a new or an empty one"
    )]
    Foreign {
        /// Which folder.
        folder: PathBuf,
        /// What is in it.
        file: String,
    },
    /// Data that another version of the program made.
    #[error(
        "{path}: data of version {theirs}, where this program makes and reads version {ours}: make them anew in \
         another folder"
    )]
    OtherVersion {
        /// Which file says so.
        path: PathBuf,
        /// Its version.
        theirs: String,
        /// Ours.
        ours: u32,
    },
    /// Another program is writing into the folder.
    #[error("{folder}: {holder} is generating into this folder")]
    Busy {
        /// Which folder.
        folder: PathBuf,
        /// Who has it, in words.
        holder: String,
    },
    /// No view of a scene is fit for use.
    #[error("scene `{scene}`: none of {attempts} sampled views is fit for use; most often {reason}")]
    NoView {
        /// Which scene.
        scene: String,
        /// How many were tried.
        attempts: u32,
        /// What most of them suffer from.
        reason: &'static str,
    },
    /// A pair of a stream that cannot be had.
    #[error("pair {number} of the stream: {what}")]
    Stream {
        /// Which pair.
        number: usize,
        /// Why, in words.
        what: String,
    },
    /// A scene could not be read.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A capture could not be read.
    #[error(transparent)]
    Capture(#[from] CaptureError),
    /// An EXR file could not be read or written.
    #[error(transparent)]
    Exr(#[from] ExrError),
}

impl DatasetError {
    pub(crate) fn io(path: &Path, source: std::io::Error) -> Self {
        Self::Io { path: path.to_owned(), source }
    }

    pub(crate) fn invalid(path: &Path, what: impl Into<String>) -> Self {
        Self::Invalid { path: path.to_owned(), what: what.into() }
    }
}
