//! The table `vary` of a recipe: what images are given beside what their scenes bring, so that a network sees
//! every material, light and lens that it may meet ("all per-object attributes which are later allowed to
//! vary at run-time are sampled randomly for each training sample", thesis 7.3.1).
//!
//! What an image gets is drawn by its seed ([`Variation`]) and noted in the manifest, so that its frame can
//! be made again.

mod check;
mod draw;
mod fog;
mod lamp;
mod look;
mod motion;
mod pool;
mod props;
mod staged;
mod timeline;

pub use draw::Variation;
pub(crate) use draw::purpose;
pub use fog::Fog;
pub use lamp::Lamp;
pub use props::{Props, hashes};
pub use staged::StagedScene;
pub use timeline::{Timeline, TimelineMoment};

use crate::Sensor;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// What is varied. Ranges are `[low, high]`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Vary {
    /// Diffuse colour, specular colour and glossiness of every object are drawn for every image; they reflect
    /// by the Phong model.
    pub materials: bool,
    /// Every opaque object gets a texture drawn for every image; objects without texture coordinates are
    /// box-mapped.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub textures: Option<Textures>,
    /// One point light for every image, in place of the scene's own lights, at a place drawn uniformly of
    /// those from which it lights at least a tenth of what is seen. A scene in which nothing shines that the
    /// effect shows gets one in any case.
    pub light: bool,
    /// One environment for all images, which networks learn by heart (thesis 7.4), or one for each.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub environment: Option<Surroundings>,
    /// Share of the images that have one; all, if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub environment_share: Option<f32>,
    /// A lens that focuses the depth of a random pixel; the range is that of the radius, in pixels, of the
    /// circle of confusion of what is infinitely far away.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lens: Option<[f32; 2]>,
    /// Three objects in four move parallel to the image plane; the range is that of how far their nearest
    /// visible point moves while the shutter is open, in pixels. What is animated in a scene file moves as it
    /// does there, at a random time. In a timeline it is how far it moves from frame to frame, and what is
    /// animated goes on from its beginning.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<[f32; 2]>,
    /// Mean free path below every object's surface, of the colour in which it is longest, as a share of the
    /// scene's diagonal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_free_path: Option<[f32; 2]>,
    /// A medium between the surfaces.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fog: Option<FogRange>,
    /// What the frames of a `sequence` have in common, of effects of light that surfaces keep: one look, one
    /// lamp, and movements that go on, while lamps go on and off. Direct light is that of lamps that shine;
    /// how things move is one more attribute of pairs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub timeline: Option<Timeline>,
    /// The camera of a capture: surfaces are what it measures of them, and targets of training its
    /// photographs. Truth of test sets has no noise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor: Option<Sensor>,
}

/// Where textures come from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Textures {
    /// So many procedural patterns: checkers, stripes, bricks, cells, clouds, fractal detail.
    Procedural(usize),
    /// All PNG and JPEG images of a folder and the folders in it, relative to where the recipe's `files` are.
    Folder(PathBuf),
}

/// Where an environment comes from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Surroundings {
    /// A clear sky with a sun over plain ground, from a seed.
    Sky(u32),
    /// One of so many such skies for every image.
    Skies(usize),
    /// An HDR or EXR file, relative to where the recipe's `files` are.
    File(PathBuf),
}

/// Which media are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FogRange {
    /// Optical depth along the scene's diagonal.
    pub optical_depth: [f32; 2],
    /// Share of the images whose medium is smoke on a grid; that of the others is the same everywhere.
    #[serde(default)]
    pub smoke_share: f32,
}

impl Vary {
    /// Whether objects have looks of their own.
    const fn dresses(&self) -> bool {
        self.materials || self.textures.is_some() || self.mean_free_path.is_some()
    }

    /// The files and folders that it names, besides scenes.
    pub(crate) fn paths(&self) -> impl Iterator<Item = &PathBuf> {
        let textures = match &self.textures {
            Some(Textures::Folder(path)) => Some(path),
            _ => None,
        };
        let environment = match &self.environment {
            Some(Surroundings::File(path)) => Some(path),
            _ => None,
        };
        textures.into_iter().chain(environment)
    }
}

#[cfg(test)]
mod tests;
