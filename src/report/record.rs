//! What is kept of a frame beside its images, in a file among them: what was measured, and from what each
//! image was made, so that images that are there need not be made again. It is written anew after each image.

use super::images;
use crate::figures::write_atomically;
use anyhow::{Context, Result};
use deepshade_render::method::Clock;
use deepshade_render::metrics::Scores;
use deepshade_shaders::Effect;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Name of the file in a frame's folder. TOML, since its reader gives back every digit of a number, and
/// infinite ones.
pub const RECORD: &str = "made.toml";

/// The file name of truth's images.
pub const TRUTH: &str = "truth";

/// A frame, how far truth's own noise goes, and what the methods made of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrameRecord {
    /// What truth was made from, as a hash.
    pub key: String,
    /// What was computed.
    pub effect: Effect,
    /// What the frame is called on the page.
    pub name: String,
    /// Its scene; frames of one scene are summed up together.
    pub scene: String,
    /// Its view.
    pub view: String,
    /// Name of the folder that its images are in.
    pub folder: String,
    /// Rows.
    pub height: usize,
    /// Columns.
    pub width: usize,
    /// How far the effect reaches, metres, where it does.
    pub radius: Option<f32>,
    /// What else is to be known of it, as name and value.
    pub facts: Vec<(String, String)>,
    /// Truth, which the scores refer to.
    pub truth: TruthRecord,
    /// The methods' images, in the order in which the page lists them.
    #[serde(default)]
    pub images: Vec<ImageRecord>,
}

/// What was measured of truth.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TruthRecord {
    /// What images are multiplied by before they are scored and shown.
    pub exposure: f32,
    /// Wall clock of rendering it, milliseconds.
    pub milliseconds: f64,
    /// How far truth's halves are from each other, the `ceiling` of figures.
    pub noise: Scores,
    /// Scores of an image that is [`Effect::background`] everywhere.
    pub floor: Scores,
}

/// What a method made of a frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImageRecord {
    /// What it was made from, as a hash.
    pub key: String,
    /// What its files are called.
    pub file: String,
    /// What pages, tables and figures call it.
    pub label: String,
    /// The method's name.
    pub method: String,
    /// Median time of a run, milliseconds.
    pub milliseconds: f64,
    /// Which clock it is from.
    pub clock: Clock,
    /// What it ran on.
    pub device: String,
    /// The image against truth.
    pub scores: Scores,
}

/// An image that is wanted.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageRequest {
    /// What it is made from, as a hash.
    pub key: String,
    /// What its files are called.
    pub file: String,
    /// What pages, tables and figures call it.
    pub label: String,
}

impl FrameRecord {
    /// The record in a frame's folder with those images that are wanted and whole; none where truth is
    /// another or not whole.
    pub fn kept(out: &Path, folder: &str, key: &str, wanted: &[ImageRequest]) -> Option<Self> {
        let folder = out.join(folder);
        let text = std::fs::read_to_string(folder.join(RECORD)).ok()?;
        let mut record: Self = toml::from_str(&text).ok()?;
        if record.key != key || !images::are_there(&folder, TRUTH) {
            return None;
        }
        let made = |wanted: &ImageRequest| {
            let found =
                record.images.iter().find(|image| (&image.key, &image.file) == (&wanted.key, &wanted.file));
            let whole = found.filter(|image| images::are_there(&folder, &image.file));
            whole.map(|image| ImageRecord { label: wanted.label.clone(), ..image.clone() })
        };
        record.images = wanted.iter().filter_map(made).collect();
        Some(record)
    }

    /// Writes it into its folder.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, out: &Path) -> Result<()> {
        let path = out.join(&self.folder).join(RECORD);
        let text = toml::to_string(self).with_context(|| path.display().to_string())?;
        write_atomically(&path, text.as_bytes())
    }

    /// Deletes the record in a frame's folder, if one is there: its images are about to be made anew.
    ///
    /// # Errors
    /// If it cannot be deleted.
    pub fn delete(folder: &Path) -> Result<()> {
        let path = folder.join(RECORD);
        super::folder::delete(&path).with_context(|| path.display().to_string())
    }

    /// Whether it has an image.
    pub fn has(&self, wanted: &ImageRequest) -> bool {
        self.images.iter().any(|image| image.key == wanted.key)
    }

    /// Names of all its images' files.
    pub fn files(&self) -> impl Iterator<Item = &str> {
        self.images.iter().map(|image| image.file.as_str()).chain([TRUTH])
    }
}
