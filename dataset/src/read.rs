//! Reading a dataset.

use crate::generate::{VARIANCE_LAYER, target_layer};
use crate::{DatasetError, Manifest, PairRecord, Props, Recipe, Shard, TrainingSplit};
use deepshade_render::exr_file;
use deepshade_shaders::{GBuffer, Planes};
use std::path::{Path, PathBuf};

/// A dataset on disk. Its files are read when asked for, from as many threads as there are.
#[derive(Clone, Debug)]
pub struct Dataset {
    folder: PathBuf,
    manifest: Manifest,
}

/// A g-buffer with the truth of an effect.
#[derive(Clone, Debug, PartialEq)]
pub struct Pair {
    /// What the camera sees, with [`Recipe::attributes`].
    pub gbuffer: GBuffer,
    /// Truth, `[effect.channels(), height, width]`.
    pub target: Planes,
    /// Variance of each value of `target`, by the noise of its samples; `None` where it is not known.
    pub variance: Option<Planes>,
    /// How far the effect reaches, metres.
    pub radius: f32,
}

impl Dataset {
    /// Opens the dataset of a folder. Pairs are not checked: [`crate::verify()`] does.
    ///
    /// # Errors
    /// If the manifest is missing, as it is while the dataset is unfinished, damaged, of another version of
    /// the data, or states values beyond a recipe's limits.
    pub fn open(folder: &Path) -> Result<Self, DatasetError> {
        Ok(Self { folder: folder.to_owned(), manifest: Manifest::load(folder)? })
    }

    /// The pairs of a shard in its folder.
    ///
    /// # Errors
    /// As [`Dataset::open`], of the shard's list.
    pub(crate) fn open_shard(folder: &Path, shard: Shard) -> Result<Self, DatasetError> {
        Ok(Self { folder: folder.to_owned(), manifest: Manifest::load_list(folder, &shard.file_name())? })
    }

    /// The same dataset with the recipe's scene files in another folder than the manifest says.
    #[must_use]
    pub fn with_scenes(mut self, folder: &Path) -> Self {
        folder.clone_into(&mut self.manifest.origin.recipe.folder);
        self
    }

    /// Where it is.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// What it consists of and comes from.
    pub const fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// What it was made from.
    pub const fn recipe(&self) -> &Recipe {
        &self.manifest.origin.recipe
    }

    /// The textures and the environment of its images.
    ///
    /// # Errors
    /// If a file is missing, damaged or not what the data were made from.
    pub fn props(&self) -> Result<Props, DatasetError> {
        Props::load_again(self.recipe(), &self.manifest.origin.props)
    }

    /// Number of pairs.
    pub const fn len(&self) -> usize {
        self.manifest.pairs.len()
    }

    /// Whether there is no pair.
    pub const fn is_empty(&self) -> bool {
        self.manifest.pairs.is_empty()
    }

    /// What is known of a pair.
    ///
    /// # Panics
    /// If there is no pair of that index.
    pub fn record(&self, index: usize) -> &PairRecord {
        &self.manifest.pairs[index]
    }

    /// Indices of the pairs to train on.
    pub fn training(&self) -> Vec<usize> {
        self.part(TrainingSplit::Training)
    }

    /// Indices of the pairs that are held apart from training.
    pub fn validation(&self) -> Vec<usize> {
        self.part(TrainingSplit::Validation)
    }

    /// Indices of the pairs of a part.
    pub fn part(&self, part: TrainingSplit) -> Vec<usize> {
        (0..self.len()).filter(|index| self.manifest.pairs[*index].part == part).collect()
    }

    /// Reads a pair.
    ///
    /// # Errors
    /// If its file is missing or damaged, lacks a channel or has another size than the recipe says.
    ///
    /// # Panics
    /// If there is no pair of that index.
    pub fn pair(&self, index: usize) -> Result<Pair, DatasetError> {
        let record = self.record(index);
        let path = self.folder.join(&record.file);
        let recipe = self.recipe();
        let image = exr_file::read(&path)?;
        let [height, width] = recipe.size(record.seed);
        if [image.height(), image.width()] != [height, width] {
            let size = format!("{} x {} pixels", image.width(), image.height());
            return Err(DatasetError::invalid(
                &path,
                format!("{size} where the recipe says {width} x {height}"),
            ));
        }
        let channels = recipe.effect.channels();
        let variance = recipe.knows_variance().then(|| image.image(VARIANCE_LAYER, channels));
        Ok(Pair {
            gbuffer: image.gbuffer(&recipe.attributes())?,
            target: image.image(&target_layer(recipe), channels)?,
            variance: variance.transpose()?,
            radius: record.radius,
        })
    }
}
