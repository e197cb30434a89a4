//! Pairs of a capture's frames.

use crate::capture::{Capture, View};
use crate::plan::PlannedScene;
use crate::recipe::Resolution;
use crate::{DatasetError, Recipe};
use deepshade_render::scene::Camera;
use deepshade_shaders::{GBuffer, Planes, lists};
use std::path::Path;

/// Those frames of a capture that pairs are made of.
pub struct Frames {
    capture: Capture,
    chosen: Vec<usize>,
    view: View,
}

impl Frames {
    /// Opens a recipe's capture.
    ///
    /// # Errors
    /// If it cannot be read or was changed since it was planned with.
    pub fn open(recipe: &Recipe, planned: &PlannedScene, folder: &Path) -> Result<Self, DatasetError> {
        let (capture, hash) = recipe.capture(folder)?;
        if planned.scene.blake3 != Some(hash) {
            return Err(DatasetError::invalid(
                &recipe.folder.join(folder),
                "was changed while it was in use",
            ));
        }
        let Resolution { height, width } = recipe.resolution;
        let view = View::of(capture.camera(), [height, width]).expect("checked when it was opened");
        Ok(Self { chosen: lists::spread(capture.count(), recipe.views_per_scene), capture, view })
    }

    /// Surfaces, radiance and camera of a view.
    ///
    /// # Errors
    /// If an image cannot be read.
    pub fn pair(&self, view: usize) -> Result<(GBuffer, Planes, Camera), DatasetError> {
        let frame = self.capture.frame(self.chosen[view])?;
        let (gbuffer, colours) = self.view.pair(&frame, self.capture.camera());
        Ok((gbuffer, colours, self.view.camera(&frame, self.capture.camera())))
    }
}

#[cfg(test)]
mod tests;
