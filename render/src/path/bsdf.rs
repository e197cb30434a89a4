//! How surfaces reflect: Lambert, GGX microfacets and the energy-normalised Phong lobe.

use super::sampler::Stream;
use crate::intersection::SurfacePoint;
use glam::Vec3;

/// How one point of a surface reflects light.
#[derive(Clone, Copy, Debug)]
pub struct Bsdf;

/// A direction that light may come from.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// Unit direction to the light.
    pub direction: Vec3,
    /// Reflectance times cosine over density.
    pub weight: Vec3,
    /// Of the direction, per steradian.
    pub density: f32,
}

impl Bsdf {
    /// The reflectance of a point.
    pub fn new(_point: &SurfacePoint) -> Self {
        unimplemented!()
    }

    /// Reflectance from one direction to another, times the cosine of the light's, per steradian; 0 below the surface.
    pub fn evaluate(&self, _to_viewer: Vec3, _to_light: Vec3) -> Vec3 {
        unimplemented!()
    }

    /// Density with which [`Bsdf::sample`] takes a direction, per steradian.
    pub fn density(&self, _to_viewer: Vec3, _to_light: Vec3) -> f32 {
        unimplemented!()
    }

    /// A direction to look for light in; `None` where the sample falls below the surface.
    pub fn sample(&self, _to_viewer: Vec3, _stream: &mut Stream) -> Option<BsdfSample> {
        unimplemented!()
    }
}
