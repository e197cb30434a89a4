//! Choosing points on lights: lights without an extent, emissive triangles, the environment.
//!
//! One light a sample: each light without an extent in proportion to what would arrive from it at the very point (so
//! that one that does not shine there is never taken, and costs nothing but the look), all emissive triangles together
//! in proportion to a rough estimate of what would, the environment to what would arrive from a hemisphere of its mean.
//! Emissive triangles share by power (Pharr, Jakob and Humphreys, "Physically Based Rendering", 12.6).

mod arrival;
mod emitters;
#[cfg(test)]
mod tests;

pub use arrival::Arrival;

use super::sampler::Stream;
use crate::bvh::{Hit, TracedScene};
use crate::scene::Environment;
use emitters::Emitters;
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// All lights of a scene, ready to be sampled.
#[derive(Debug)]
pub struct Lights<'a> {
    scene: &'a TracedScene,
    emitters: Option<Emitters>,
    environment: Option<&'a Environment>,
    /// What would arrive from a hemisphere of the environment's mean.
    environment_importance: f32,
}

/// Light that would arrive at a point if nothing were in between.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Unit direction to the light.
    pub direction: Vec3,
    /// How far away it is, metres; infinite for the environment and directional lights. A ray of that length ends
    /// before it meets an emissive triangle.
    pub distance: f32,
    /// Radiance over density; of a light without an extent, irradiance on a surface that faces it over the probability
    /// of having chosen it.
    pub radiance: Vec3,
    /// Of the direction, per steradian, for weighing against other ways of finding the same light; `None` for lights
    /// without an extent, which nothing else finds.
    pub density: Option<f32>,
}

/// How likely each kind of light is to be chosen at a point, not normalised.
struct Importance {
    without_extent: f32,
    emitters: f32,
    environment: f32,
}

impl Importance {
    fn total(&self) -> f32 {
        self.without_extent + self.emitters + self.environment
    }
}

impl<'a> Lights<'a> {
    /// The lights of a scene.
    pub fn new(scene: &'a TracedScene) -> Self {
        let environment = scene.scene().environment.as_deref();
        let environment_importance =
            environment.map_or(0.0, |environment| PI * brightness(environment.mean()));
        Self { scene, emitters: Emitters::new(scene), environment, environment_importance }
    }

    /// One light, chosen at random; `None` where no light can shine on the point, which is where the ray to the light
    /// will start: off a surface, not on it. Takes four numbers.
    pub fn sample(&self, point: Vec3, stream: &mut Stream) -> Option<LightSample> {
        let (kind, which, square) = (stream.next_1d(), stream.next_1d(), stream.next_2d());
        let importance = self.importance(point);
        let total = importance.total();
        let mut left = kind * total;
        if left < importance.without_extent {
            return self.sample_without_extent(point, left, total);
        }
        left -= importance.without_extent;
        if left < importance.emitters {
            return self.sample_emitters(point, which, square, importance.emitters / total);
        }
        self.sample_environment(square, importance.environment / total)
    }

    /// Density per steradian with which [`Lights::sample`] takes the direction in which a ray from `point` met an
    /// emissive triangle; 0 where that does not emit.
    pub fn density_of_hit(&self, point: Vec3, direction: Vec3, hit: &Hit) -> f32 {
        let Some(emitters) = &self.emitters else { return 0.0 };
        let density = emitters.density(self.scene.scene(), direction, hit);
        if density == 0.0 {
            return 0.0;
        }
        let importance = self.importance(point);
        density * importance.emitters / importance.total()
    }

    /// Radiance of the environment in a direction.
    pub fn environment(&self, direction: Vec3) -> Vec3 {
        self.environment.map_or(Vec3::ZERO, |environment| environment.radiance(direction))
    }

    /// Density per steradian with which [`Lights::sample`], at some point, takes that direction for the environment.
    pub fn density_of_environment(&self, point: Vec3, direction: Vec3) -> f32 {
        let Some(environment) = self.environment else { return 0.0 };
        let importance = self.importance(point);
        let total = importance.total();
        if total > 0.0 { environment.density(direction) * importance.environment / total } else { 0.0 }
    }

    /// What would arrive from each light without an extent, in order.
    fn arrivals(&self, point: Vec3) -> impl Iterator<Item = Arrival> {
        let scene = self.scene.scene();
        scene.lights.iter().map(move |light| Arrival::new(scene, light, point))
    }

    fn importance(&self, point: Vec3) -> Importance {
        Importance {
            without_extent: self.arrivals(point).map(|arrival| brightness(arrival.irradiance)).sum(),
            emitters: self.emitters.as_ref().map_or(0.0, |emitters| emitters.importance(point)),
            environment: self.environment_importance,
        }
    }

    /// The light without an extent at `left` of the `total` importance.
    fn sample_without_extent(&self, point: Vec3, mut left: f32, total: f32) -> Option<LightSample> {
        let mut chosen = None;
        for arrival in self.arrivals(point) {
            let importance = brightness(arrival.irradiance);
            if importance > 0.0 {
                chosen = Some((arrival, importance));
                if left < importance {
                    break;
                }
            }
            left -= importance;
        }
        let (Arrival { direction, distance, irradiance }, importance) = chosen?;
        Some(LightSample { direction, distance, radiance: irradiance * total / importance, density: None })
    }

    fn sample_emitters(&self, point: Vec3, which: f32, square: Vec2, share: f32) -> Option<LightSample> {
        let sample = self.emitters.as_ref()?.sample(self.scene.scene(), point, which, square)?;
        let to_light = sample.position - point;
        let distance = to_light.length();
        let density = sample.density * share;
        Some(LightSample {
            direction: to_light / distance,
            distance,
            radiance: sample.radiance / density,
            density: Some(density),
        })
    }

    fn sample_environment(&self, square: Vec2, share: f32) -> Option<LightSample> {
        let sample = self.environment?.sample(square)?;
        let density = sample.density * share;
        Some(LightSample {
            direction: sample.direction,
            distance: f32::INFINITY,
            radiance: sample.radiance / density,
            density: Some(density),
        })
    }
}

/// Mean of the colours.
fn brightness(light: Vec3) -> f32 {
    light.element_sum() / 3.0
}
