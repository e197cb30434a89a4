//! When a scene is seen, and for how long the shutter is open.

use crate::complete::listeners;
use crate::props;
use anyhow::{Context, Result};
use deepshade_render::scene::{Scene, SceneSource};
use deepshade_shaders::Effect;
use deepshade_shaders::effect::EffectSetting;

/// How long the shutter is open where nothing is said, seconds.
const SHUTTER: f32 = 0.04;

/// The moment of an image.
#[derive(clap::Args, Clone, Copy, Debug, PartialEq)]
pub struct Args {
    /// Moment of animations, skins, morph targets and of a medium that drifts, seconds; 0 by default.
    #[arg(long)]
    time: Option<f32>,
    /// How long the shutter is open around that moment, seconds, for motion-blur; 0.04 by default.
    #[arg(long)]
    shutter: Option<f32>,
}

impl Args {
    /// A moment, and for how long the shutter is open around it, seconds, as far as they are stated.
    pub const fn new(time: Option<f32>, shutter: Option<f32>) -> Self {
        Self { time, shutter }
    }

    /// The moment, seconds.
    pub fn time(self) -> f32 {
        self.time.unwrap_or(0.0)
    }

    /// What is stated: the moment, and how long the shutter is open.
    pub const fn stated(self) -> (Option<f32>, Option<f32>) {
        (self.time, self.shutter)
    }

    /// How long the shutter is open, seconds.
    pub fn shutter(self) -> f32 {
        self.shutter.unwrap_or(SHUTTER)
    }

    /// Whether the effect has a shutter, where one is stated.
    ///
    /// # Errors
    /// If not.
    pub fn check(self, effect: Effect) -> Result<()> {
        listeners::check(effect, EffectSetting::Shutter, &[("--shutter", self.shutter.is_some())])
    }

    /// The scene at the moment, with what is put into it, and with what moves while the shutter is open where
    /// the effect shows it.
    ///
    /// # Errors
    /// If a file is missing or damaged, the time is none, or the effect has no shutter.
    pub fn scene(self, source: &SceneSource, props: &props::Args, effect: Effect) -> Result<Scene> {
        self.check(effect)?;
        let load = |source: &SceneSource| {
            let scene = match source {
                SceneSource::File(path) if effect.listens_to(EffectSetting::Shutter) => {
                    Scene::load_moving(path, self.time(), self.shutter())
                }
                source => source.scene(self.time()),
            };
            scene.with_context(|| format!("scene {source}"))
        };
        let mut scene = load(source)?;
        for prop in props.all() {
            scene.add(load(&prop.source)?, prop.place());
        }
        Ok(scene)
    }
}

impl std::fmt::Display for Args {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} s, shutter open for {} s", self.time(), self.shutter())
    }
}
