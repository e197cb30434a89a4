//! Images and g-buffers as OpenEXR files: half floats, one channel a plane, named `position.X`, `depth`,
//! `target.ao`, which tev, Blender and OpenImageIO show as layers. Text attributes carry where an image is
//! from.
//!
//! Files of other renderers are read too: 16-bit and 32-bit floats and whole numbers, one part or several,
//! upper or lower case, any prefix before the layer's name (`ViewLayer.Normal.X`). What nobody asks for does
//! not matter.

mod blocks;
mod check;
mod image;
mod layers;
mod names;
mod nothing;
mod plain;
mod read;
mod windows;
mod write;

pub use image::ExrImage;
pub use read::{read, read_colour, read_gbuffer};
pub use windows::{Window, Windows};
pub use write::{Layer, encode, write, write_within};

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Text attributes of a file by name, such as `scene`, `camera`, `seed`, `samples`, `radius`, `units`.
pub type Metadata = BTreeMap<String, String>;

/// The name and version that written files carry in their `software` attribute.
pub const PROGRAM: &str = concat!("deepshade ", env!("CARGO_PKG_VERSION"));

/// Why an EXR file could not be read or written; each names the file.
#[derive(Debug, Error)]
pub enum ExrError {
    /// The system says no: not there, not allowed, disk full.
    #[error("{path}: {source}")]
    Io {
        /// Which file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file is damaged, truncated, or uses what is not supported.
    #[error("{path}: not a usable EXR file: {what}")]
    Invalid {
        /// Which file.
        path: PathBuf,
        /// What is wrong with it.
        what: String,
    },
    /// The file lacks channels.
    #[error("{path}: no channel {missing}; the file holds {held}")]
    MissingChannels {
        /// Which file.
        path: PathBuf,
        /// Names of the channels that were looked for in vain.
        missing: String,
        /// Names of all channels there are.
        held: String,
    },
    /// A channel could be one of several of the file's.
    #[error("{path}: `{wanted}` is ambiguous: {candidates}")]
    Ambiguous {
        /// Which file.
        path: PathBuf,
        /// What was looked for.
        wanted: String,
        /// Names of the channels that it could be.
        candidates: String,
    },
    /// The file lacks the layer that was chosen of several.
    #[error("{path}: no layer `{layer}`; the file holds the channels {held}")]
    MissingLayer {
        /// Which file.
        path: PathBuf,
        /// The name that was looked for in vain.
        layer: String,
        /// Names of all channels there are.
        held: String,
    },
    /// A value that half floats cannot hold.
    #[error("{path}: channel `{channel}` has the value {value}, which a half float cannot hold")]
    NotHalf {
        /// Which file.
        path: PathBuf,
        /// Which of its channels.
        channel: String,
        /// It is not finite.
        value: f32,
    },
}

impl ExrError {
    fn io(path: &Path, source: std::io::Error) -> Self {
        Self::Io { path: path.to_owned(), source }
    }

    fn invalid(path: &Path, what: impl Into<String>) -> Self {
        Self::Invalid { path: path.to_owned(), what: what.into() }
    }

    fn from_exr(path: &Path, error: exr::error::Error) -> Self {
        match error {
            exr::error::Error::Io(source) => Self::io(path, source),
            other => Self::invalid(path, other.to_string()),
        }
    }
}

#[cfg(test)]
mod tests;
