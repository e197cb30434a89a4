//! Choosing points on lights: lights without an extent, emissive triangles, the environment.
//!
//! One light a sample. Each light without an extent counts by what would arrive from it at the very point if
//! nothing were in between, so that one that does not shine there is never taken, and costs nothing but the
//! look; all emissive triangles together count by a rough estimate of the same, the environment by what would
//! arrive from a hemisphere of its mean. What is in between is not known, so a fifth of the choice is spread
//! evenly over all that count: of `n` lights, one that is the only one seen is taken with a probability of at
//! least `1 / 5 n`, however strong those are that a wall keeps off. Emissive triangles share by power (Pharr,
//! Jakob and Humphreys, "Physically Based Rendering", 12.6).

mod arrival;
mod at;
mod emitters;
#[cfg(test)]
mod tests;

pub use arrival::Arrival;
pub(crate) use arrival::axes;
pub use at::LightsAt;

use crate::bvh::TracedScene;
use crate::intersection::SurfacePoint;
use crate::scene::Environment;
use emitters::Emitters;
use glam::Vec3;
use std::f32::consts::PI;

/// All lights of a scene, ready to be sampled.
#[derive(Debug)]
pub struct Lights<'a> {
    scene: &'a TracedScene,
    emitters: Option<Emitters>,
    /// Which lights without an extent shine: all, but for those that [`Glow`](crate::scene::Glow) has
    /// switched off.
    on: Vec<bool>,
    environment: Option<&'a Environment>,
    /// What would arrive from a hemisphere of the environment's mean.
    environment_importance: f32,
}

/// Light that would arrive at a point if nothing were in between.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Unit direction to the light.
    pub direction: Vec3,
    /// How far away it is, metres; infinite for the environment and directional lights. A ray of that length
    /// ends before it meets an emissive triangle.
    pub distance: f32,
    /// Radiance over density; of a light without an extent, irradiance on a surface that faces it over the
    /// probability of having chosen it.
    pub radiance: Vec3,
    /// Of the direction, per steradian, for weighing against other ways of finding the same light; `None` for
    /// lights without an extent, which nothing else finds.
    pub density: Option<f32>,
}

impl<'a> Lights<'a> {
    /// The lights of a scene.
    pub fn new(scene: &'a TracedScene) -> Self {
        let environment = scene.scene().shining_environment();
        let environment_importance =
            environment.map_or(0.0, |environment| PI * brightness(environment.mean()));
        let glow = scene.scene().glow.as_deref();
        let shines = |light: usize| glow.is_none_or(|glow| glow.shines(light));
        let on = (0..scene.scene().lights.len()).map(shines).collect();
        Self { scene, emitters: Emitters::new(scene), on, environment, environment_importance }
    }

    /// As they are from a point of the medium.
    pub fn at(&self, point: Vec3) -> LightsAt<'_> {
        LightsAt::new(self, point, None)
    }

    /// As they are from a surface, whose other side none of them lights. Those without an extent that stand
    /// below its horizon are never taken.
    pub fn at_surface(&self, point: &SurfacePoint) -> LightsAt<'_> {
        LightsAt::new(self, point.ray_origin(), Some([point.normal, point.geometric_normal]))
    }

    /// Whether any of them can be met by a ray.
    pub const fn have_extent(&self) -> bool {
        self.emitters.is_some() || self.environment.is_some()
    }

    /// Radiance of the environment in a direction.
    pub fn environment(&self, direction: Vec3) -> Vec3 {
        self.environment.map_or(Vec3::ZERO, |environment| environment.radiance(direction))
    }
}

/// Mean of the colours.
fn brightness(light: Vec3) -> f32 {
    light.element_sum() / 3.0
}
