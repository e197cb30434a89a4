//! A scene of data, and how it is shown in each of its images.

use super::draw::{between, purpose};
use super::{Props, Variation, Vary, draw, look, motion};
use crate::plan::PlannedView;
use crate::random::uniform;
use crate::recipe::Viewpoint;
use crate::{DatasetError, Recipe, SceneRecord, Sensor, Subject, truth, views};
use deepshade_render::bvh::TracedScene;
use deepshade_render::gbuffer;
use deepshade_render::scene::{Camera, Scene, SceneSource};
use deepshade_shaders::{GBuffer, Planes};
use rayon::prelude::*;
use std::path::PathBuf;
use std::sync::Arc;

/// A scene of data, ready to be shown as each of its images wants it.
#[derive(Debug)]
pub struct StagedScene<'a> {
    base: Arc<TracedScene>,
    /// Of a scene that moves by itself.
    animation: Option<Animation>,
    recipe: &'a Recipe,
    props: &'a Props,
}

/// A scene file that is animated.
#[derive(Debug)]
struct Animation {
    path: PathBuf,
    /// When it begins and ends, seconds.
    span: [f32; 2],
}

/// How long the shutter is open for animated files, seconds: a frame of film.
const SHUTTER: f32 = 1.0 / 24.0;

impl<'a> StagedScene<'a> {
    /// Makes or reads a scene of a recipe.
    ///
    /// # Errors
    /// As [`SceneRecord::load`].
    pub fn load(scene: &SceneRecord, recipe: &'a Recipe, props: &'a Props) -> Result<Self, DatasetError> {
        let base = prepared(scene.read(&recipe.folder)?, recipe)?;
        let moves = recipe.vary.as_ref().is_some_and(|vary| vary.motion.is_some());
        let animation = match &scene.source {
            Subject::Scene(SceneSource::File(path)) if moves => {
                let path = recipe.folder.join(path);
                Scene::animation_span(&path)?.map(|span| Animation { path, span })
            }
            _ => None,
        };
        Ok(Self { base: Arc::new(base), animation, recipe, props })
    }

    /// The scene as it is by itself, in which views are sampled.
    pub fn base(&self) -> &TracedScene {
        &self.base
    }

    /// The camera of one of its views: the recipe's, or a sampled one of this `key` and index.
    ///
    /// # Errors
    /// If none of many sampled views is fit.
    pub fn camera(&self, key: u64, view: usize) -> Result<Camera, DatasetError> {
        match self.recipe.camera {
            Some(Viewpoint { position, target }) => Ok(Camera::look_at(position, target)),
            None => views::recipe_view(self.recipe, &self.base, key, view),
        }
    }

    /// What is known of an image's surfaces, with [`truth::attributes`]: what is seen, or what the recipe's sensor
    /// measures of that, by the image's seed.
    pub fn gbuffer(&self, shown: &TracedScene, camera: &Camera, seed: u32) -> GBuffer {
        let Recipe { effect, resolution, .. } = *self.recipe;
        let seen =
            gbuffer::render(shown, camera, resolution.height, resolution.width, truth::attributes(effect));
        match self.sensor() {
            Some(sensor) => sensor.surface(&seen, camera, seed),
            None => seen,
        }
    }

    /// What is learned from: an image of the effect, or its photograph by the recipe's sensor.
    pub(crate) fn photographed(&self, image: Planes, seed: u32) -> Planes {
        match self.sensor() {
            Some(sensor) => sensor.photograph(&image, seed),
            None => image,
        }
    }

    fn sensor(&self) -> Option<Sensor> {
        self.recipe.vary.as_ref().and_then(|vary| vary.sensor)
    }

    /// Draws by a seed what an image gets: the lens of its camera, and the rest.
    pub fn draw(&self, camera: Camera, seed: u32) -> (Camera, Option<Variation>) {
        let size = [self.recipe.resolution.height, self.recipe.resolution.width];
        draw::draw(self.recipe.vary.as_ref(), self.recipe.effect, &self.base, camera, size, seed)
    }

    /// The scene as an image shows it. Images share triangles and hierarchies, but for those of moving objects.
    ///
    /// # Errors
    /// If a texture or an animated file cannot be read, there can be no fog in the scene, or moving objects leave what can be
    /// traced.
    pub fn shown(
        &self,
        camera: &Camera,
        variation: Option<&Variation>,
    ) -> Result<Arc<TracedScene>, DatasetError> {
        let Some(variation) = variation else { return Ok(Arc::clone(&self.base)) };
        let nothing = Vary::default();
        let vary = self.recipe.vary.as_ref().unwrap_or(&nothing);
        let posed = self.posed(variation.seed)?;
        let scene = posed.with_look(look::look(&posed, vary, variation, self.props)?)?;
        let Some(range) = vary.motion else { return Ok(Arc::new(scene)) };
        let size = [self.recipe.resolution.height, self.recipe.resolution.width];
        let displacements = motion::displacements(&posed, camera, size, range, variation.seed);
        Ok(Arc::new(scene.with_motion(displacements)?))
    }

    /// The scene in the middle of an image's exposure: as it is, or at a random time of its animation.
    fn posed(&self, seed: u32) -> Result<Arc<TracedScene>, DatasetError> {
        let Some(Animation { path, span }) = &self.animation else { return Ok(Arc::clone(&self.base)) };
        let time = between(*span, uniform(&[u64::from(seed), purpose::TIME]));
        Ok(Arc::new(prepared(Scene::load_moving(path, time, SHUTTER)?, self.recipe)?))
    }

    /// What `make` gives of some of the scene's views, in their order. They are made at the same time, but for images of
    /// moving objects, each of which has a hierarchy of its own.
    pub(crate) fn each<R: Send>(
        &self,
        views: &[PlannedView],
        make: impl Fn(&PlannedView) -> Result<R, DatasetError> + Sync + Send,
    ) -> Result<Vec<R>, DatasetError> {
        let moves = self.recipe.vary.as_ref().is_some_and(|vary| vary.motion.is_some());
        if moves { views.iter().map(make).collect() } else { views.par_iter().map(make).collect() }
    }
}

/// A scene with what the looks of its images need, ready for rays.
fn prepared(mut scene: Scene, recipe: &Recipe) -> Result<TracedScene, DatasetError> {
    if let Some(vary) = &recipe.vary {
        look::prepare(&mut scene, vary);
    }
    Ok(TracedScene::new(scene)?)
}
