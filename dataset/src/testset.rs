//! Test sets: frames of scenes that no network was trained on, with truth that is nearly free of noise.
//!
//! Truth with thousands of samples is dear, and structural similarity is a mean over tiles of 8x8 pixels; so
//! it is rendered for a seeded share of the tiles only, which leaves the mean unbiased.
//!
//! # Files
//! - `testset.json`: the recipe, and for each frame its scene, camera, radius, seed and files. The g-buffer
//!   is not kept: it is rendered again from these, in the recipe's resolution, where it is needed.
//! - `tiles/<frame>.exr`: the truth of the frame's tiles as a strip, `[channels, 8, 8 * tiles]`, in the layer
//!   `truth.<effect>`. Which tiles these are is not stored: [`tile_indices`] gives them, row by row, from the
//!   frame's seed. Half floats round values up to 1 by 1/4096 at most, which changes the similarity of tiles
//!   by less than 1e-4. Some 45 kB a frame of 512 x 512 pixels with one tile in eight.
//! - `whole/<frame>.exr`: of a few frames the whole image in the layer `truth.<effect>`, with the recipe's
//!   `samples` a pixel, for metrics that need neighbours.
//!
//! # Noise
//! Truth is the mean of eight independent scramblings. [`Ceiling`] says how much they vary and how far those
//! of one half agree with those of the other: a perfect image scores no less against their mean.

mod estimate;
mod make;
mod show;

use crate::journal::Entry;
use crate::manifest::read_json;
use crate::random::mix;
use crate::recipe::{Tiles, file_hash, split_name};
use crate::{DatasetError, Origin, Props, Recipe, SceneRecord, Variation};
use deepshade_render::exr_file;
use deepshade_render::scene::Camera;
use deepshade_render::scene::procedural::Split;
use deepshade_shaders::Planes;
use deepshade_shaders::similarity::TILE;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The list of frames in a test set's folder.
const LIST: &str = "testset.json";

/// A test set on disk.
#[derive(Clone, Debug)]
pub struct TestSet {
    folder: PathBuf,
    list: List,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct List {
    origin: Origin,
    frames: Vec<FrameRecord>,
}

/// What is known of a frame without reading its truth.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrameRecord {
    /// A name that no other frame has.
    pub name: String,
    /// The scene.
    pub scene: SceneRecord,
    /// Which of the scene's views.
    pub view: usize,
    /// Where the view is from.
    pub camera: Camera,
    /// How far the effect reaches, metres.
    pub radius: f32,
    /// Chooses the tiles and the samples.
    pub seed: u32,
    /// What the frame was given beside what its scene brings.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub variation: Option<Variation>,
    /// What images are multiplied by before they are compared, see
    /// [`exposure`](deepshade_render::metrics::exposure()).
    pub exposure: f32,
    /// How sure truth is.
    pub ceiling: Ceiling,
    /// The tiles' truth.
    pub tiles: HashedFile,
    /// The whole image, of some frames.
    pub whole: Option<HashedFile>,
}

/// A file and its hash.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HashedFile {
    /// Relative to the test set's folder.
    pub file: String,
    /// BLAKE3, in hexadecimal.
    pub blake3: String,
}

/// How sure the tiles' truth is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ceiling {
    /// Structural similarity of two independent images, each of half the samples of truth; mean over tiles
    /// and channels.
    pub ssim: f64,
    /// Mean over pixels and channels of truth's variance, in truth's unit squared.
    pub variance: f64,
}

/// The truth of a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct TestFrame {
    /// Which tiles there is truth of, ascending; tile `i` is in row `i / columns` of the image's whole tiles.
    pub tiles: Vec<usize>,
    /// Their truth side by side, `[channels, 8, 8 * tiles]`; compare with [`gather`] of an image.
    pub truth: Planes,
    /// The whole image with fewer samples, `[channels, height, width]`, of some frames.
    pub whole: Option<Planes>,
}

impl Entry for FrameRecord {
    fn name(&self) -> &str {
        &self.name
    }

    fn files(&self) -> Vec<(&str, &str)> {
        let files = std::iter::once(&self.tiles).chain(&self.whole);
        files.map(|HashedFile { file, blake3 }| (file.as_str(), blake3.as_str())).collect()
    }
}

/// The seeded share of an image's whole tiles, ascending.
pub fn tile_indices(seed: u32, height: usize, width: usize, one_in: usize) -> Vec<usize> {
    let count = (height / TILE) * (width / TILE);
    let mut tiles: Vec<usize> = (0..count).collect();
    tiles.sort_by_key(|tile| mix(&[u64::from(seed), *tile as u64]));
    tiles.truncate(count.div_ceil(one_in));
    tiles.sort_unstable();
    tiles
}

/// Whether a pixel (x, y) of an image so wide lies in one of the tiles.
pub fn in_tiles(tiles: &[usize], width: usize) -> impl Fn(usize, usize) -> bool {
    let columns = width / TILE;
    move |x, y| {
        let (row, column) = (y / TILE, x / TILE);
        column < columns && tiles.binary_search(&(row * columns + column)).is_ok()
    }
}

/// Some tiles of an image side by side, `[channels, 8, 8 * tiles]`.
///
/// # Panics
/// If a tile is not in the image.
pub fn gather(image: &Planes, tiles: &[usize]) -> Planes {
    let columns = image.width() / TILE;
    Planes::from_fn(image.channels(), TILE, TILE * tiles.len(), |channel, y, x| {
        let tile = tiles[x / TILE];
        image.at(channel, tile / columns * TILE + y, tile % columns * TILE + x % TILE)
    })
}

impl TestSet {
    /// Opens a test set.
    ///
    /// # Errors
    /// If its list is missing, as it is while the set is unfinished, damaged, of another version of the data,
    /// or states values beyond a recipe's limits.
    pub fn open(folder: &Path) -> Result<Self, DatasetError> {
        Ok(Self { folder: folder.to_owned(), list: List::load(folder)? })
    }

    /// Whether a folder holds a test set.
    pub fn is_in(folder: &Path) -> bool {
        folder.join(LIST).is_file()
    }

    /// The same test set with the recipe's scene files in another folder than the list says.
    #[must_use]
    pub fn with_scenes(mut self, folder: &Path) -> Self {
        folder.clone_into(&mut self.list.origin.recipe.folder);
        self
    }

    /// What it was made from.
    pub const fn recipe(&self) -> &Recipe {
        &self.list.origin.recipe
    }

    /// The textures and the environment of its frames.
    ///
    /// # Errors
    /// If a file is missing, damaged or not what the set was made from.
    pub fn props(&self) -> Result<Props, DatasetError> {
        Props::load_again(self.recipe(), &self.list.origin.props)
    }

    /// Its frames; those of a scene follow each other.
    pub fn frames(&self) -> &[FrameRecord] {
        &self.list.frames
    }

    /// Reads the truth of a frame.
    ///
    /// # Errors
    /// If a file is missing, damaged, not the one that was made, or not of the size that the recipe says.
    ///
    /// # Panics
    /// If there is no frame of that index.
    pub fn frame(&self, index: usize) -> Result<TestFrame, DatasetError> {
        let record = &self.list.frames[index];
        let Recipe { resolution, .. } = *self.recipe();
        let one_in = tiles_of(self.recipe())?.one_in;
        let tiles = tile_indices(record.seed, resolution.height, resolution.width, one_in);
        let truth = self.image(&record.tiles, TILE, TILE * tiles.len())?;
        let whole = record.whole.as_ref();
        let whole = whole.map(|file| self.image(file, resolution.height, resolution.width)).transpose()?;
        Ok(TestFrame { tiles, truth, whole })
    }

    fn image(&self, file: &HashedFile, height: usize, width: usize) -> Result<Planes, DatasetError> {
        let path = self.folder.join(&file.file);
        let hash = file_hash(&path)?;
        if hash != file.blake3 {
            return Err(DatasetError::invalid(&path, format!("its hash is {hash}, not {}", file.blake3)));
        }
        let effect = self.recipe().effect;
        let image = exr_file::read(&path)?.image(&format!("truth.{effect}"), effect.channels())?;
        if (image.height(), image.width()) != (height, width) {
            let what =
                format!("{} x {} pixels where {width} x {height} are due", image.width(), image.height());
            return Err(DatasetError::invalid(&path, what));
        }
        Ok(image)
    }
}

impl List {
    fn load(folder: &Path) -> Result<Self, DatasetError> {
        let path = folder.join(LIST);
        let mut list: Self = read_json(&path)?;
        list.origin.opened(&path)?;
        Ok(list)
    }
}

/// How the recipe wants its tiles, if it is for testing.
fn tiles_of(recipe: &Recipe) -> Result<Tiles, DatasetError> {
    let wrong = |what: String| DatasetError::Recipe { path: recipe.path.clone(), what };
    if recipe.split != Split::Test {
        return Err(wrong(format!(
            "`split` says {}, where a test set is for testing",
            split_name(recipe.split)
        )));
    }
    recipe.tiles.ok_or_else(|| wrong("a test set needs the table `tiles`".to_owned()))
}

#[cfg(test)]
mod tests;
