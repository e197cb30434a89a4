//! A scene of data, and how it is shown in each of its images.

use super::draw::{between, purpose};
use super::{Props, Timeline, TimelineMoment, Variation, Vary, draw, look, motion, timeline};
use crate::plan::PlannedView;
use crate::random::uniform;
use crate::recipe::Viewpoint;
use crate::{DatasetError, Recipe, SceneOrCapture, SceneRecord, Sensor, views};
use deepshade_render::bvh::TracedScene;
use deepshade_render::gbuffer;
use deepshade_render::methods::estimate::Estimator;
use deepshade_render::scene::{AnimatedScene, Camera, Scene, SceneSource};
use deepshade_shaders::{GBuffer, Planes};
use glam::Vec3;
use rayon::prelude::*;
use std::path::PathBuf;
use std::sync::Arc;

/// A scene of data, ready to be shown as each of its images wants it.
#[derive(Debug)]
pub struct StagedScene<'a> {
    base: Arc<TracedScene>,
    /// Of a scene that moves by itself.
    animation: Option<Animation>,
    /// The same in a timeline, with the triangles of `base`.
    in_timeline: Option<AnimatedScene>,
    recipe: &'a Recipe,
    pub(super) props: &'a Props,
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
        let read = scene.read(&recipe.folder)?;
        let vary = recipe.vary.as_ref();
        let goes_on = vary.is_some_and(|vary| vary.timeline.is_some());
        let moves = goes_on || vary.is_some_and(|vary| vary.motion.is_some());
        let (mut base, mut animation, mut in_timeline) = (read, None, None);
        if let SceneOrCapture::Scene(SceneSource::File(path)) = &scene.source
            && moves
        {
            let path = recipe.folder.join(path);
            animation = Scene::animation_span(&path)?.map(|span| Animation { path: path.clone(), span });
            if goes_on && animation.is_some() {
                let animated = AnimatedScene::load(&SceneSource::File(path), 0.0)?;
                base = animated.at(0.0, 0.0)?;
                in_timeline = Some(animated);
            }
        }
        Ok(Self { base: Arc::new(prepared(base, recipe)?), animation, in_timeline, recipe, props })
    }

    /// The methods that estimate what networks read of its images.
    pub fn estimators(&self) -> &[Estimator] {
        self.props.estimators()
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

    /// What is known of an image's surfaces, with [`Recipe::seen_attributes`]: what is seen, or what the
    /// recipe's sensor measures of that, by the image's seed. In a timeline direct light is that of lamps
    /// that shine at the image's moment.
    pub fn gbuffer(&self, shown: &TracedScene, camera: &Camera, seed: u32) -> GBuffer {
        let [height, width] = self.size(seed);
        let lit = self.timeline().map(|_| timeline::shining(shown));
        let lit = lit.as_ref().unwrap_or(shown);
        let seen = gbuffer::render(lit, camera, height, width, &self.recipe.seen_attributes());
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

    /// How far the effect reaches in the image of a camera with this seed, metres.
    pub fn radius(&self, camera: &Camera, seed: u32) -> f32 {
        let size @ [height, _] = self.size(seed);
        let pixel = || {
            let depth = views::median_depth(&self.base, camera, size);
            depth.map_or(f32::INFINITY, |depth| depth / camera.focal_length(height))
        };
        self.recipe.radius.of_view(seed, self.base.diagonal(), pixel)
    }

    /// Rows and columns of an image with this seed.
    pub fn size(&self, seed: u32) -> [usize; 2] {
        self.recipe.size(seed)
    }

    fn timeline(&self) -> Option<&Timeline> {
        self.recipe.vary.as_ref()?.timeline.as_ref()
    }

    /// What of the scene is animated in a timeline.
    pub(super) const fn timeline_animation(&self) -> Option<&AnimatedScene> {
        self.in_timeline.as_ref()
    }

    fn sensor(&self) -> Option<Sensor> {
        self.recipe.vary.as_ref().and_then(|vary| vary.sensor)
    }

    /// The camera of one of its views, as [`Self::camera`] gives it, and what its image gets: drawn by the
    /// view's seed, or in a timeline by that of the first frame of its sequence, whose look, lamp and
    /// movements it shares.
    ///
    /// # Errors
    /// As [`Self::camera`].
    pub fn drawn(&self, key: u64, view: &PlannedView) -> Result<(Camera, Option<Variation>), DatasetError> {
        let camera = self.camera(key, view.index)?;
        let Some((timeline, sequence)) = self.timeline().zip(self.recipe.sequence) else {
            return Ok(self.draw(camera, view.seed));
        };
        let frame = view.index % sequence.frames;
        let first = view.index - frame;
        let (first, variation) = self.draw(self.camera(key, first)?, self.recipe.view_seed(key, first));
        let moment = Some(TimelineMoment { time: timeline.time(frame), first });
        Ok((camera, variation.map(|variation| Variation { moment, ..variation })))
    }

    /// Draws by a seed what an image gets: the lens of its camera, and the rest.
    pub(crate) fn draw(&self, camera: Camera, seed: u32) -> (Camera, Option<Variation>) {
        draw::draw(self.recipe.vary.as_ref(), self.recipe.effect, &self.base, camera, self.size(seed), seed)
    }

    /// The scene as an image shows it. Images share triangles and hierarchies, but for those of moving
    /// objects.
    ///
    /// # Errors
    /// If a texture or an animated file cannot be read, there can be no fog in the scene, or moving objects
    /// leave what can be traced.
    pub fn shown(
        &self,
        camera: &Camera,
        variation: Option<&Variation>,
    ) -> Result<Arc<TracedScene>, DatasetError> {
        let Some(variation) = variation else { return Ok(Arc::clone(&self.base)) };
        let nothing = Vary::default();
        let vary = self.recipe.vary.as_ref().unwrap_or(&nothing);
        if let Some((timeline, moment)) = vary.timeline.as_ref().zip(variation.moment.as_ref()) {
            return Ok(Arc::new(self.at_moment((vary, timeline), variation, moment)?));
        }
        let posed = self.posed(variation.seed)?;
        let scene = posed.with_look(look::look(&posed, vary, variation, self.props)?)?;
        let Some(range) = vary.motion else { return Ok(Arc::new(scene)) };
        let displacements =
            motion::displacements(&posed, camera, self.size(variation.seed), range, variation.seed);
        Ok(Arc::new(scene.with_motion(displacements)?))
    }

    /// How far every vertex of every mesh of a shown scene goes from one frame of a sequence to the next: as
    /// it does while the shutter is open; where it stands still then, for three of four things a way that is
    /// drawn, of so many pixels.
    pub fn ways(&self, shown: &TracedScene, camera: &Camera, pixels: [f32; 2], seed: u32) -> Vec<Vec<Vec3>> {
        motion::displacements(shown, camera, self.size(seed), pixels, seed)
    }

    /// The scene in the middle of an image's exposure: as it is, or at a random time of its animation.
    fn posed(&self, seed: u32) -> Result<Arc<TracedScene>, DatasetError> {
        let Some(Animation { path, span }) = &self.animation else { return Ok(Arc::clone(&self.base)) };
        let time = between(*span, uniform(&[u64::from(seed), purpose::TIME]));
        Ok(Arc::new(prepared(Scene::load_moving(path, time, SHUTTER)?, self.recipe)?))
    }

    /// What `make` gives of some of the scene's views, in their order. They are made at the same time, but
    /// for images of moving objects, each of which has a hierarchy of its own.
    pub(crate) fn each<R: Send>(
        &self,
        views: &[PlannedView],
        make: impl Fn(&PlannedView) -> Result<R, DatasetError> + Sync + Send,
    ) -> Result<Vec<R>, DatasetError> {
        let moves = |vary: &Vary| vary.motion.is_some() || vary.timeline.is_some();
        if self.recipe.vary.as_ref().is_some_and(moves) {
            views.iter().map(make).collect()
        } else {
            views.par_iter().map(make).collect()
        }
    }
}

/// A scene with what the looks of its images need, ready for rays.
fn prepared(mut scene: Scene, recipe: &Recipe) -> Result<TracedScene, DatasetError> {
    if let Some(vary) = &recipe.vary {
        look::prepare(&mut scene, vary);
    }
    Ok(TracedScene::new(scene)?)
}
