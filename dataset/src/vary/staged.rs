//! A scene of data, and how it is shown in each of its images.

use super::{Props, Variation, draw, look, motion};
use crate::{DatasetError, Recipe, SceneRecord};
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::Camera;
use std::sync::Arc;

/// A scene of data, ready to be shown as each of its images wants it.
#[derive(Debug)]
pub struct StagedScene<'a> {
    base: Arc<TracedScene>,
    recipe: &'a Recipe,
    props: &'a Props,
}

impl<'a> StagedScene<'a> {
    /// Makes or reads a scene of a recipe.
    ///
    /// # Errors
    /// As [`SceneRecord::load`].
    pub fn load(scene: &SceneRecord, recipe: &'a Recipe, props: &'a Props) -> Result<Self, DatasetError> {
        let mut scene = scene.read(&recipe.folder)?;
        if let Some(vary) = &recipe.vary {
            look::prepare(&mut scene, vary);
        }
        Ok(Self { base: Arc::new(TracedScene::new(scene)?), recipe, props })
    }

    /// The scene as it is by itself, in which views are sampled.
    pub fn base(&self) -> &TracedScene {
        &self.base
    }

    /// Draws by a seed what an image gets: the lens of its camera, and the rest.
    pub fn draw(&self, camera: Camera, seed: u32) -> (Camera, Option<Variation>) {
        let size = [self.recipe.resolution.height, self.recipe.resolution.width];
        draw::draw(self.recipe.vary.as_ref(), self.recipe.effect, &self.base, camera, size, seed)
    }

    /// The scene as an image shows it. Images share the hierarchies, but for that of moving objects.
    ///
    /// # Errors
    /// If moving objects leave what can be traced.
    pub fn shown(
        &self,
        camera: &Camera,
        variation: Option<&Variation>,
    ) -> Result<Arc<TracedScene>, DatasetError> {
        let Some(variation) = variation else { return Ok(Arc::clone(&self.base)) };
        let nothing = super::Vary::default();
        let vary = self.recipe.vary.as_ref().unwrap_or(&nothing);
        let look = look::look(&self.base, vary, variation, self.props);
        let scene = self.base.with_look(look);
        let Some(range) = vary.motion else { return Ok(Arc::new(scene)) };
        let size = [self.recipe.resolution.height, self.recipe.resolution.width];
        let displacements = motion::displacements(&self.base, camera, size, range, variation.seed);
        Ok(Arc::new(scene.with_motion(displacements)?))
    }
}
