//! What the page shows: a scene with an effect's methods, pass by pass, and its truth.

use crate::complete::Additions;
use crate::exposure_time;
use crate::learned::Learned;
use crate::live::animated_view::{self, AnimatedView, ViewRequest};
use crate::live::{Live, LiveSettings};
use crate::methods::{self, LEARNED};
use crate::radius;
use crate::report::images::ExposedTruth;
use crate::{props, views};
use anyhow::{Context, Result, ensure};
use deepshade_infer::Model;
use deepshade_render::bvh::TracedScene;
use deepshade_render::methods::Quality;
use deepshade_render::metrics::{Scores, exposure};
use deepshade_render::path::estimate::SCRAMBLINGS;
use deepshade_render::path::{Estimate, Refinement, Shot, Taken};
use deepshade_render::scene::{Camera, Glow, SceneSource};
use deepshade_shaders::effect::EffectSetting;
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{Attribute, Effect, Planes};
use glam::Vec3;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Chooses random numbers of all that is shown.
const SEED: u32 = 0;
/// As the window begins: what is looked at shall move.
const QUALITY: Quality = Quality::Medium;

/// What is to be shown.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PageRequest {
    /// The scene.
    pub scene: SceneSource,
    /// The number of a view sampled in it.
    pub view: usize,
    /// What is computed.
    pub effect: Effect,
    /// By which methods.
    pub methods: Vec<String>,
    /// Rows and columns.
    pub size: [usize; 2],
    /// Extinction of fog all over the scene, per metre; without it none, or what the effect needs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fog: Option<f64>,
}

/// A scene on the GPU with its methods.
pub struct ShownScene {
    /// The scene.
    pub animated_view: AnimatedView,
    /// Its passes.
    pub live: Live,
    /// The methods of the live scene, in its order.
    pub names: Vec<&'static str>,
    /// How far the effect reaches, metres.
    pub radius: f32,
}

/// A scene for rays, and what is computed of it.
pub struct TracedView {
    scene: TracedScene,
    effect: Effect,
    size: [usize; 2],
    radius: f32,
}

impl PageRequest {
    /// The scene, with what the effect needs of it.
    ///
    /// # Errors
    /// If there is no such scene, or no view of it can be found.
    pub fn open(&self) -> Result<AnimatedView> {
        animated_view::Args::default().open(&ViewRequest {
            source: &self.scene,
            time: 0.0,
            effects: &[self.effect],
            size: self.size,
            props: &props::Args::default(),
            viewpoint: &views::Viewpoint::sampled(self.view),
            additions: &Additions {
                extinction: self.fog.map(|fog| Vec3::splat(fog as f32)),
                ..Additions::default()
            },
            seed: SEED,
            learned: None,
        })
    }

    /// How long the shutter is open, seconds.
    fn shutter(&self) -> f32 {
        exposure_time::Args::new(None, None).shutter()
    }
}

impl ShownScene {
    /// Prepares everything; `model` is the network of the method `learned`.
    ///
    /// # Errors
    /// If there is no such scene or method, or the device refuses.
    pub fn new(gpu: &Gpu, wish: &PageRequest, model: Option<&Model>) -> Result<Self> {
        let animated_view = wish.open()?;
        let screen: Vec<&String> = wish.methods.iter().filter(|name| *name != LEARNED).collect();
        let open = |name: &&String| methods::open_screen(wish.effect, name, gpu, QUALITY);
        let opened = screen.iter().map(open).collect::<Result<Vec<_>>>()?;
        let learned = wish.methods.iter().any(|name| name == LEARNED).then(|| -> Result<Learned> {
            let model = model.context("no model is given")?;
            let (made, wanted) = (model.spec.effect, wish.effect);
            ensure!(made == wanted, "the network is for {made}, not for {wanted}");
            Ok(Learned::new(gpu, model)?)
        });
        let learned = learned.transpose()?;
        let mut names: Vec<&'static str> = opened.iter().map(|method| method.name()).collect();
        names.extend(learned.as_ref().map(|_| LEARNED));
        let reach = learned.as_ref().map(|learned| learned.spec().reach);
        let radius = radius::wanted(None, reach, &[wish.effect], animated_view.space());
        let wanted = LiveSettings {
            size: wish.size,
            methods: opened,
            learned,
            attributes: vec![Attribute::Valid],
            temporal: false,
            radius,
            shutter: wish.shutter(),
        };
        let live = Live::new(gpu, &animated_view.animated, &animated_view.camera, wanted)?;
        Ok(Self { animated_view, live, names, radius })
    }

    /// Makes the frame of a moment, seconds; milliseconds are as those of [`Live::make`].
    ///
    /// # Errors
    /// If the device fails.
    pub async fn make(&mut self, time: f32, camera: &Camera) -> Result<Option<Vec<f64>>> {
        self.live.make_async(time, SEED, camera).await
    }
}

impl TracedView {
    /// A scene at a moment, seconds, for an effect that reaches so many metres.
    ///
    /// # Errors
    /// If there is no such scene.
    pub fn new(wish: &PageRequest, animated_view: &AnimatedView, time: f32, radius: f32) -> Result<Self> {
        let shutter = if wish.effect.listens_to(EffectSetting::Shutter) { wish.shutter() } else { 0.0 };
        let mut scene = animated_view.animated.at(time, shutter)?;
        let glow = animated_view.animated.scene.glow.as_deref();
        scene.glow = glow.map(|glow| Arc::new(Glow { moment: time, ..glow.clone() }));
        let PageRequest { effect, size, .. } = *wish;
        Ok(Self { scene: TracedScene::new(scene)?, effect, size, radius })
    }

    /// Takes so many more samples of each scrambling than were taken.
    pub fn refine(&self, camera: &Camera, taken: Option<Taken>, count: u32) -> (Estimate, Taken) {
        let shot = Shot::new(&self.scene, camera, self.size, self.radius);
        let mut refinement = match taken {
            Some(taken) => Refinement::going_on(self.effect, &shot, taken),
            None => Refinement::new(self.effect, &shot, SCRAMBLINGS, SEED),
        };
        refinement.refine(count, |_, _| true, |_| {});
        (refinement.estimate(), refinement.taken())
    }
}

/// Scores of an image against truth, as the window and `compare` have them.
pub fn scores(effect: Effect, image: &Planes, truth: &Planes) -> Scores {
    ExposedTruth { effect, image: truth, exposure: exposure(effect, truth) }.scores(image)
}
