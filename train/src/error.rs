//! What can go wrong while training and exporting.

use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a training run or an export ended without its result.
#[derive(Debug, Error)]
pub enum TrainError {
    /// A setting makes no sense.
    #[error("`{field}` of the training config {problem}")]
    Config {
        /// Name of the setting.
        field: &'static str,
        /// What is wrong with it.
        problem: String,
    },
    /// A run folder belongs to a run with other settings.
    #[error(
        "{} was begun with other settings ({fields}); resume with its own, or choose another folder",
        path.display()
    )]
    OtherRun {
        /// The run's config file.
        path: PathBuf,
        /// Names of the settings that differ.
        fields: String,
    },
    /// Another program is training in the folder.
    #[error("{}: {holder} is training in this folder", folder.display())]
    Busy {
        /// Which folder.
        folder: PathBuf,
        /// Who has it, in words.
        holder: String,
    },
    /// A run has no network yet that could be exported.
    #[error(
        "{}: after {step} steps no network of this run was validated yet; the same `deepshade train` command goes on",
        run.display()
    )]
    NotValidated {
        /// The run's folder.
        run: PathBuf,
        /// Steps done.
        step: usize,
    },
    /// A file or folder cannot be read or written.
    #[error("cannot {action} {}: {source}", path.display())]
    Io {
        /// What was tried, as a verb.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file is not what it should be.
    #[error("{} {problem}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
    },
    /// The dataset cannot be opened.
    #[error(transparent)]
    Dataset(#[from] deepshade_dataset::DatasetError),
    /// The data cannot be told from others.
    #[error("the training data: {0}")]
    Data(String),
    /// A pair cannot be read or used.
    #[error("pair {index} of the dataset: {problem}")]
    Pair {
        /// Its index.
        index: usize,
        /// What is wrong with it.
        problem: String,
    },
    /// The loss is no number any more.
    #[error("the loss is {loss} at step {step}; try a smaller learning rate")]
    Diverged {
        /// The step.
        step: usize,
        /// The loss.
        loss: f32,
    },
    /// The device that trains failed.
    #[error("the training device: {0}")]
    Device(String),
    /// A model folder cannot be written.
    #[error(transparent)]
    Model(#[from] deepshade_infer::ModelError),
}

impl TrainError {
    /// What turns an error of the file system into one of these.
    pub(crate) fn io(action: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::Io { action, path, source }
    }

    /// A file that is not what it should be, and why.
    pub(crate) fn damaged(path: &Path, problem: impl std::fmt::Display) -> Self {
        Self::Damaged { path: path.to_owned(), problem: problem.to_string() }
    }
}
