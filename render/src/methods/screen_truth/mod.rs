//! Truth traced against what the screen shows alone: how far from truth every method is that reads the
//! screen.
//!
//! The surfaces that the camera sees are meshed pixel by pixel ([`proxy`]), and truth's own integrator traces
//! that mesh in place of the scene, from the points that the pixels show. What the screen does not show is
//! not there, and nothing else is wrong but noise: no thickness is guessed, nothing is blurred, no step is
//! too long. A network is held by the same limit, but for what it has learnt to expect behind things.
//!
//! Two things can be shown beside the image. A second layer is what the camera's rays meet next: Mara,
//! McGuire, Nowrouzezahrai and Luebke, "Deep G-Buffers for Stable Global Illumination Approximation", HPG
//! 2016; the layers are a pixel's footprint apart at least. A guard band is an image that is larger on each
//! side.
//!
//! Limits. The mesh is as fine as the pixels. Which of them are of one surface is asked of the scene, which a
//! method that has the screen alone would have to guess. What is more than half transparent is not there, and
//! what is less is opaque.
//!
//! For studies: it takes seconds, and the scene itself to find out what the screen shows.

pub mod layers;
pub mod links;
pub mod proxy;
#[cfg(test)]
mod tests;

use super::Quality;
use crate::bvh::TracedScene;
use crate::method::{Clock, Frame, Method, MethodError, Repeats, Shaded};
use crate::path::at_surface::{SurfaceEffect, Visible};
use crate::path::{Ao, Shot};
use crate::sampler::{PixelSampler, hash};
use crate::scene::SceneError;
use deepshade_shaders::lists::median;
use deepshade_shaders::{Effect, Planes};
use glam::{Vec2, Vec3};
use layers::{Eye, Screen};
use rayon::prelude::*;
use web_time::Instant;

/// The method's name.
pub const NAME: &str = "screen-truth";

/// How far above the mesh rays start, in footprints of a pixel: more than rounding, less than anything that
/// is shown.
const CLEARANCE: f32 = 0.02;

/// Keeps samples apart from those of truth, which may have the same seed: noise that both share is no noise.
const SALT: u32 = 0x5c12_ee47;

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct ScreenTruthParameters {
    /// How many surfaces one behind the other each pixel shows.
    #[schemars(range(min = 1, max = 2))]
    pub layers: usize,
    /// Share of the image's height and width that is seen beyond each of its sides.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub guard: f32,
    /// Samples of a pixel.
    #[schemars(range(min = 1, max = 65536))]
    pub samples: u32,
}

impl ScreenTruthParameters {
    /// Those of a quality: more samples have less noise. One layer without a guard band is what a g-buffer
    /// holds.
    pub const fn of(quality: Quality) -> Self {
        let samples = match quality {
            Quality::Low => 16,
            Quality::Medium => 32,
            Quality::High => 64,
            Quality::Ultra => 256,
        };
        Self { layers: 1, guard: 0.0, samples }
    }

    /// What the screen shows as a scene; `None` where it shows nothing.
    fn proxy(&self, frame: &Frame<'_>) -> Result<Option<TracedScene>, SceneError> {
        let [height, width] = [frame.gbuffer.height(), frame.gbuffer.width()];
        let guard = [height, width].map(|edge| (self.guard * edge as f32).round() as usize);
        let eye = Eye { scene: frame.scene, camera: frame.camera, height, width };
        proxy::scene(&eye, &Screen::new(&eye, guard, self.layers))
    }

    /// The effect of a frame, its occluders those that the screen shows.
    fn image(&self, frame: &Frame<'_>) -> Result<Planes, MethodError> {
        let missing = |source| MethodError::Missing { method: NAME, source };
        let seen = frame.gbuffer.seen().map_err(missing)?;
        let other = |error: SceneError| MethodError::Other { method: NAME, what: error.to_string() };
        let (height, width) = (frame.gbuffer.height(), frame.gbuffer.width());
        let channels = Effect::Ao.channels();
        let Some(proxy) = self.proxy(frame).map_err(other)? else {
            return Ok(Planes::filled(channels, height, width, Ao::BACKGROUND.x));
        };
        let real = Shot::new(frame.scene, frame.camera, [height, width], frame.radius);
        let effect = Ao::new(&Shot { scene: &proxy, ..real });
        let seed = hash(frame.seed ^ SALT);
        let values = at_pixels(&real, &seen, |visible, x, y| {
            effect.mean(visible, PixelSampler::new(x, y, seed), self.samples)
        });
        let value = |pixel: usize| values[pixel].unwrap_or(Ao::BACKGROUND);
        Ok(Planes::from_fn(channels, height, width, |c, y, x| value(y * width + x)[c]))
    }
}

/// What there is at the surface of each pixel (x, y), above which rays start by [`CLEARANCE`]; `None` where
/// none is seen.
fn at_pixels(
    shot: &Shot<'_>,
    seen: &[bool],
    value: impl Fn(&Visible, usize, usize) -> Vec3 + Sync,
) -> Vec<Option<Vec3>> {
    let focal_length = shot.camera.focal_length(shot.height);
    let pixel = |(index, seen): (usize, &bool)| {
        let (x, y) = (index % shot.width, index / shot.width);
        let visible = seen.then(|| Visible::at(shot, Vec2::new(x as f32 + 0.5, y as f32 + 0.5)))??;
        let depth = -shot.camera.to_camera(visible.point.position).z;
        let point = visible.point.raised(CLEARANCE * depth / focal_length);
        Some(value(&Visible { point, ..visible }, x, y))
    };
    seen.par_iter().enumerate().map(pixel).collect()
}

impl Method for ScreenTruthParameters {
    fn name(&self) -> &'static str {
        NAME
    }

    fn effect(&self) -> Effect {
        Effect::Ao
    }

    fn shade(&self, frame: &Frame<'_>, repeats: Repeats) -> Result<Shaded, MethodError> {
        for _ in 0..repeats.warm_up {
            self.image(frame)?;
        }
        let mut times = Vec::new();
        let mut timed = || {
            let start = Instant::now();
            let image = self.image(frame);
            times.push(start.elapsed().as_secs_f64() * 1e3);
            image
        };
        let mut image = timed()?;
        for _ in 1..repeats.timed {
            image = timed()?;
        }
        Ok(Shaded { image, milliseconds: median(times), clock: Clock::Cpu, device: "processor".to_owned() })
    }
}
