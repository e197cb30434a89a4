//! Choosing points on lights: lights without an extent, emissive triangles, the environment.

use super::sampler::Stream;
use crate::bvh::{Hit, TracedScene};
use glam::Vec3;

/// All lights of a scene, ready to be sampled.
pub struct Lights<'a> {
    scene: &'a TracedScene,
}

/// Light that would arrive at a point if nothing were in between.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Unit direction to the light.
    pub direction: Vec3,
    /// How far away it is, metres; infinite for the environment and directional lights.
    pub distance: f32,
    /// Radiance over density; of a light without an extent, irradiance on a surface that faces it over the probability
    /// of having chosen it.
    pub radiance: Vec3,
    /// Of the direction, per steradian, for weighing against other ways of finding the same light; `None` for lights
    /// without an extent, which nothing else finds.
    pub density: Option<f32>,
}

impl<'a> Lights<'a> {
    /// The lights of a scene.
    pub fn new(scene: &'a TracedScene) -> Self {
        Self { scene }
    }

    /// One light, chosen at random; `None` where no light can shine on the point.
    pub fn sample(&self, _point: Vec3, _stream: &mut Stream) -> Option<LightSample> {
        unimplemented!("{:?}", self.scene)
    }

    /// Density per steradian with which [`Lights::sample`] takes the direction in which a ray from `point` met an
    /// emissive triangle; 0 where that does not emit.
    pub fn density_of_hit(&self, _point: Vec3, _direction: Vec3, _hit: &Hit) -> f32 {
        unimplemented!()
    }

    /// Radiance of the environment in a direction.
    pub fn environment(&self, _direction: Vec3) -> Vec3 {
        unimplemented!()
    }

    /// Density per steradian with which [`Lights::sample`] takes that direction for the environment.
    pub fn density_of_environment(&self, _direction: Vec3) -> f32 {
        unimplemented!()
    }
}
