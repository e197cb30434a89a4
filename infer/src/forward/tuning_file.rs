//! What was measured on devices, in a file.

use deepshade_shaders::{atomic_file, own_file};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io;
use std::path::Path;

/// Largest file that is read, bytes.
const MOST_BYTES: u64 = 1 << 24;

/// A kernel's shape with its time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Timed {
    /// Outputs an invocation.
    pub outputs: u32,
    /// Columns and rows of pixels an invocation.
    pub pixels: [u32; 2],
    /// Whether it stages.
    pub staged: bool,
    /// How long it takes.
    pub milliseconds: f64,
}

/// What was measured of a layer; nothing says that nothing is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LayerTimes {
    /// Milliseconds of the software kernel.
    pub software: Option<f64>,
    /// The fastest of the kernels for GPUs.
    pub fastest: Option<Timed>,
}

impl LayerTimes {
    /// Takes what was measured anew. What was not stays.
    pub fn update(&mut self, newer: Self) {
        self.software = newer.software.or(self.software);
        self.fastest = newer.fastest.or(self.fastest);
    }
}

/// What of a network does not work, measured as a whole: a layer's kernel is known to work only where all
/// before it do.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fails {
    /// Whether the software kernels do not.
    pub software: bool,
    /// The first layer of which no kernel for GPUs does.
    pub gpu: Option<String>,
}

/// What was measured on a device.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Known {
    /// Layers in words, with what was measured of them. Networks share them.
    pub layers: BTreeMap<String, LayerTimes>,
    /// Networks that were measured.
    pub networks: BTreeMap<String, Fails>,
}

/// The whole file.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TuningFile {
    /// Version of the program whose kernels were measured.
    version: String,
    /// Adapters with their drivers.
    pub devices: BTreeMap<String, Known>,
}

impl Default for TuningFile {
    fn default() -> Self {
        Self { version: env!("CARGO_PKG_VERSION").to_owned(), devices: BTreeMap::new() }
    }
}

impl TuningFile {
    /// Reads a file; one that is missing is empty, and so is one that is of no use, with a note in words.
    pub fn load(path: &Path) -> (Self, Option<String>) {
        let read = match std::fs::metadata(path) {
            Ok(found) if found.len() > MOST_BYTES => Err("is no tuning file".to_owned()),
            Err(error) if error.kind() == io::ErrorKind::NotFound => return (Self::default(), None),
            _ => std::fs::read(path).map_err(|error| error.to_string()),
        };
        let file = read.and_then(|bytes| {
            let file: Self = serde_json::from_slice(&bytes).map_err(|error| error.to_string())?;
            match file.version == Self::default().version {
                true => Ok(file),
                false => Err(format!("is of version {}", file.version)),
            }
        });
        match file {
            Ok(file) => (file, None),
            Err(what) => (Self::default(), Some(format!("{}: {what}; it will be made anew", path.display()))),
        }
    }

    /// Writes a file. Its folder is made where there is none, for nobody but the user: pipeline caches may
    /// lie there too.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn save(&self, path: &Path) -> io::Result<()> {
        own_file::create_folder(own_file::folder(path))?;
        let mut json = serde_json::to_vec_pretty(self)?;
        json.push(b'\n');
        atomic_file::write(path, &json)
    }
}
