//! When a scene is seen, and for how long the shutter is open.

use anyhow::{Context, Result};
use deepshade_render::scene::{Scene, SceneSource};
use deepshade_shaders::Effect;

/// The moment of an image.
#[derive(clap::Args, Clone, Copy, Debug)]
pub struct Args {
    /// Moment of animations, skins and morph targets, seconds.
    #[arg(long, default_value_t = 0.0)]
    time: f32,
    /// How long the shutter is open around that moment, seconds, for motion-blur.
    #[arg(long, default_value_t = 0.04)]
    shutter: f32,
}

impl Args {
    /// The scene at the moment, with what moves while the shutter is open where the effect shows it.
    ///
    /// # Errors
    /// If the file is missing or damaged, or the time is none.
    pub fn scene(self, source: &SceneSource, effect: Effect) -> Result<Scene> {
        let scene = match source {
            SceneSource::File(path) if effect == Effect::MotionBlur => {
                Scene::load_moving(path, self.time, self.shutter)
            }
            source => source.scene(self.time),
        };
        scene.with_context(|| format!("scene {source}"))
    }
}

impl std::fmt::Display for Args {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} s, shutter open for {} s", self.time, self.shutter)
    }
}
