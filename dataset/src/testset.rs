//! Test sets: frames of scenes that no network was trained on, with truth that is nearly free of noise.
//!
//! Truth with thousands of samples is dear, and structural similarity is a mean over tiles of 8x8 pixels; so it is
//! rendered for a seeded share of the tiles only, which leaves the mean unbiased.
//!
//! # Files
//! - `testset.json`: the recipe, and for each frame its scene, camera, radius, seed and files. The g-buffer is not
//!   kept: it is rendered again from these, in the recipe's resolution, where it is needed.
//! - `tiles/<frame>.exr`: the truth of the frame's tiles as a strip, `[channels, 8, 8 * tiles]`, in the layer
//!   `truth.<effect>`. Which tiles these are is not stored: [`tile_indices`] gives them, row by row, from the frame's
//!   seed. Half floats round by 1/4096 at most, which changes the similarity of tiles by less than 1e-4. Some
//!   45 kB a frame of 512 x 512 pixels with one tile in eight.
//! - `whole/<frame>.exr`: of a few frames the whole image in the layer `truth.<effect>`, with the recipe's `samples`
//!   a pixel, for metrics that need neighbours.
//!
//! # Noise
//! Truth is the mean of two independent renderings, each with half the samples. [`Ceiling`] says how far these two
//! agree: a perfect image scores no less against their mean.

mod estimate;

use crate::journal::{Entry, Journal, checked};
use crate::manifest::{job, read_json, recipe_hash, write_json};
use crate::plan::{PlannedScene, PlannedView, spread};
use crate::random::mix;
use crate::recipe::Tiles;
use crate::truth::Shot;
use crate::{DatasetError, Recipe, SceneSource, progress, truth, views};
use deepshade_render::atomic_file;
use deepshade_render::bvh::TracedScene;
use deepshade_render::exr_file::{self, Layer, Metadata, PROGRAM};
use deepshade_render::metrics::ssim::{TILE, ssim};
use deepshade_render::scene::Camera;
use deepshade_shaders::Planes;
use indicatif::ProgressBar;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
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
    program: String,
    recipe_hash: String,
    recipe: Recipe,
    frames: Vec<FrameRecord>,
}

/// What is known of a frame without reading its truth.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrameRecord {
    /// A name that no other frame has.
    pub name: String,
    /// The scene.
    pub scene: SceneSource,
    /// Which of the scene's views.
    pub view: usize,
    /// Where the view is from.
    pub camera: Camera,
    /// How far the effect reaches, metres.
    pub radius: f32,
    /// Chooses the tiles and the samples.
    pub seed: u32,
    /// How far two renderings with half the samples agree.
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

/// How far two independent renderings of the tiles, each with half the samples of truth, agree.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ceiling {
    /// Structural similarity; mean over tiles and channels.
    pub ssim: f64,
    /// Mean squared difference. The variance of truth, their mean, is a quarter of it.
    pub mse: f64,
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
    /// If its list is missing, as it is while the set is unfinished, or damaged.
    pub fn open(folder: &Path) -> Result<Self, DatasetError> {
        Ok(Self { folder: folder.to_owned(), list: read_json(&folder.join(LIST))? })
    }

    /// What it was made from.
    pub const fn recipe(&self) -> &Recipe {
        &self.list.recipe
    }

    /// Its frames; those of a scene follow each other.
    pub fn frames(&self) -> &[FrameRecord] {
        &self.list.frames
    }

    /// Reads the truth of a frame.
    ///
    /// # Errors
    /// If a file is missing, damaged, or not of the size that the recipe says.
    ///
    /// # Panics
    /// If there is no frame of that index.
    pub fn frame(&self, index: usize) -> Result<TestFrame, DatasetError> {
        let record = &self.list.frames[index];
        let Recipe { resolution, .. } = self.list.recipe;
        let one_in = tiles_of(&self.list.recipe)?.one_in;
        let tiles = tile_indices(record.seed, resolution.height, resolution.width, one_in);
        let truth = self.image(&record.tiles, TILE, TILE * tiles.len())?;
        let whole = record.whole.as_ref();
        let whole = whole.map(|file| self.image(file, resolution.height, resolution.width)).transpose()?;
        Ok(TestFrame { tiles, truth, whole })
    }

    fn image(&self, file: &HashedFile, height: usize, width: usize) -> Result<Planes, DatasetError> {
        let path = self.folder.join(&file.file);
        let effect = self.list.recipe.effect;
        let image = exr_file::read(&path)?.image(&format!("truth.{effect}"), effect.channels())?;
        if (image.height(), image.width()) != (height, width) {
            let what = format!("{} x {} pixels where {width} x {height} are due", image.width(), image.height());
            return Err(DatasetError::invalid(&path, what));
        }
        Ok(image)
    }

    /// Makes the test set of a recipe in a folder, or what is still missing of it; [`TestSet::estimate`] says how long
    /// that takes. The same recipe gives the same bytes, however often the program was killed on the way.
    ///
    /// # Errors
    /// If the recipe has no `tiles`, a scene cannot be had or has no fit view, or the folder cannot be written, is in
    /// use or holds other data.
    pub fn generate(recipe: &Recipe, folder: &Path) -> Result<Self, DatasetError> {
        let (program, recipe_hash) = (PROGRAM.to_owned(), recipe_hash(recipe)?);
        let ours = job(&program, &recipe_hash);
        let plan = recipe.plan()?;
        let (journal, mut entries) = Journal::open(folder, &["tiles", "whole"], &ours)?;
        if folder.join(LIST).exists() {
            let List { program, recipe_hash, frames, .. } = read_json(&folder.join(LIST))?;
            let theirs = job(&program, &recipe_hash);
            if theirs != ours {
                return Err(DatasetError::OtherData { folder: folder.to_owned(), theirs, ours });
            }
            entries.extend(frames);
        }
        let known = checked(folder, entries);
        let total = recipe.scene_count() * recipe.views_per_scene;
        let bar = progress::bar("frames", total, known.len());
        let tiles = tiles_of(recipe)?;
        let work = Work { recipe, tiles, total, folder, journal: &journal, known: &known, bar: &bar };
        let frames: Result<Vec<Vec<FrameRecord>>, DatasetError> =
            plan.par_iter().enumerate().with_max_len(1).map(|(index, scene)| work.scene(index, scene)).collect();
        let list = List { program, recipe_hash, recipe: recipe.clone(), frames: frames?.concat() };
        bar.finish_and_clear();
        write_json(&folder.join(LIST), &list)?;
        journal.finish()?;
        Ok(Self { folder: folder.to_owned(), list })
    }
}

/// How the recipe wants its tiles.
fn tiles_of(recipe: &Recipe) -> Result<Tiles, DatasetError> {
    let what = "a test set needs the table `tiles`".to_owned();
    recipe.tiles.ok_or_else(|| DatasetError::Recipe { path: recipe.path.clone(), what })
}

/// What all frames share.
struct Work<'a> {
    recipe: &'a Recipe,
    tiles: Tiles,
    total: usize,
    folder: &'a Path,
    journal: &'a Journal,
    known: &'a HashMap<String, FrameRecord>,
    bar: &'a ProgressBar,
}

impl Work<'_> {
    /// All frames of a scene, which is only loaded if one of them is missing.
    fn scene(&self, index: usize, scene: &PlannedScene) -> Result<Vec<FrameRecord>, DatasetError> {
        let known = |view: &PlannedView| self.known.get(&view.name).cloned();
        if let Some(records) = scene.views.iter().map(known).collect() {
            return Ok(records);
        }
        let traced = scene.source.load(self.recipe.folder())?;
        let first = index * self.recipe.views_per_scene;
        let record = |view: &PlannedView| {
            let whole = spread(first + view.index, self.total, self.tiles.whole_frames.min(self.total));
            known(view).map_or_else(|| self.frame(scene, &traced, view, whole), Ok)
        };
        scene.views.par_iter().map(record).collect()
    }

    /// Renders a frame's truth and writes it.
    fn frame(
        &self,
        planned: &PlannedScene,
        scene: &TracedScene,
        view: &PlannedView,
        whole: bool,
    ) -> Result<FrameRecord, DatasetError> {
        let Recipe { effect, resolution, samples, seed, .. } = *self.recipe;
        let (height, width) = (resolution.height, resolution.width);
        let camera = views::sample_view(scene, [height, width], seed, planned.key, view.index)?;
        let radius = self.recipe.radius.metres(scene.diagonal());
        let shot = |samples, stream: u64| {
            let seed = mix(&[u64::from(view.seed), stream]) as u32;
            Shot { scene, camera: &camera, height, width, radius, samples, seed }
        };
        let tiles = tile_indices(view.seed, height, width, self.tiles.one_in);
        let wanted = |x: usize, y: usize| {
            let (row, column) = (y / TILE, x / TILE);
            let whole_tile = row < height / TILE && column < width / TILE;
            whole_tile && tiles.binary_search(&(row * (width / TILE) + column)).is_ok()
        };
        let half = |stream| {
            let image = truth::render_where(effect, &shot(self.tiles.samples / 2, stream), wanted);
            gather(&image, &tiles)
        };
        let (a, b) = (half(0), half(1));
        let mean = Planes::from_fn(a.channels(), a.height(), a.width(), |c, y, x| 0.5 * (a.at(c, y, x) + b.at(c, y, x)));
        let write = |folder: &str, samples: u32, image: &Planes| self.write(folder, view, samples, image);
        let record = FrameRecord {
            name: view.name.clone(),
            scene: planned.source.clone(),
            view: view.index,
            camera,
            radius,
            seed: view.seed,
            ceiling: Ceiling { ssim: ssim(&a, &b), mse: mean_squared_difference(&a, &b) },
            tiles: write("tiles", self.tiles.samples, &mean)?,
            whole: whole.then(|| write("whole", samples, &truth::render(effect, &shot(samples, 2)))).transpose()?,
        };
        self.journal.add(&record)?;
        self.bar.inc(1);
        Ok(record)
    }

    fn write(
        &self,
        folder: &str,
        view: &PlannedView,
        samples: u32,
        image: &Planes,
    ) -> Result<HashedFile, DatasetError> {
        let file = format!("{folder}/{}.exr", view.name);
        let path = self.folder.join(&file);
        let metadata = Metadata::from([
            ("samples".to_owned(), samples.to_string()),
            ("units".to_owned(), truth::units(self.recipe.effect).to_owned()),
        ]);
        let layer = Layer::image(&format!("truth.{}", self.recipe.effect), image);
        let bytes = exr_file::encode(&path, &[layer], &metadata)?;
        atomic_file::write(&path, &bytes).map_err(|source| DatasetError::io(&path, source))?;
        Ok(HashedFile { file, blake3: blake3::hash(&bytes).to_hex().to_string() })
    }
}

fn mean_squared_difference(a: &Planes, b: &Planes) -> f64 {
    let squares = a.data().iter().zip(b.data()).map(|(a, b)| f64::from(a - b).powi(2));
    squares.sum::<f64>() / a.data().len() as f64
}

#[cfg(test)]
mod tests;
