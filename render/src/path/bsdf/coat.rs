//! A clear layer over a surface: microfacets of index 1.5 that reflect by Schlick's Fresnel, over a base that
//! gets what they let through (KHR_materials_clearcoat; its share and normal are its own). glTF dims the base
//! by the viewer's angle alone, which is not reciprocal. Here the base is dimmed by the viewer's or the
//! light's angle, whichever lets less through: what a mirror below reflects is the same, a matte base loses
//! some 5 % more.

use super::{Fresnel, Ggx};
use crate::intersection::SurfacePoint;
use crate::sampler::frame;
use glam::{Mat3, Vec2, Vec3};

/// What an index of 1.5 reflects at normal incidence.
const SPECULAR: f32 = 0.04;

/// The clear layer of a point.
#[derive(Clone, Copy, Debug)]
pub struct CoatLobe {
    /// From the coat normal's frame, in which it is z, to the world's.
    to_world: Mat3,
    ggx: Ggx,
    fresnel: Fresnel,
    /// How much of it there is.
    share: f32,
}

impl CoatLobe {
    /// That of a point, if it has one.
    pub fn new(point: &SurfacePoint) -> Option<Self> {
        let coat = point.surface.coat?;
        Some(Self {
            to_world: frame(point.coat_normal),
            ggx: Ggx::new(coat.roughness),
            fresnel: Fresnel::new(Vec3::splat(SPECULAR)),
            share: coat.share,
        })
    }

    /// Share of light that it reflects at an angle from its normal.
    pub fn reflected(&self, direction: Vec3) -> f32 {
        self.share * self.fresnel.reflected(self.to_world.z_axis.dot(direction).abs()).x
    }

    /// Share of what the base sends from one direction to another that is left.
    pub fn left(&self, to_viewer: Vec3, to_light: Vec3) -> f32 {
        1.0 - self.reflected(to_viewer).max(self.reflected(to_light))
    }

    /// What it reflects per steradian, times the cosine.
    pub fn evaluate(&self, to_viewer: Vec3, to_light: Vec3) -> f32 {
        let Some([viewer, light]) = self.above([to_viewer, to_light]) else { return 0.0 };
        let half = (viewer + light).normalize_or(Vec3::Z);
        self.share
            * self.fresnel.reflected(viewer.dot(half)).x
            * self.ggx.reflectance(viewer, light)
            * light.z
    }

    /// A direction to the light.
    pub fn sample(&self, to_viewer: Vec3, square: Vec2) -> Vec3 {
        self.to_world * self.ggx.sample(self.to_world.transpose() * to_viewer, square)
    }

    /// Density of [`CoatLobe::sample`], per steradian.
    pub fn density(&self, to_viewer: Vec3, to_light: Vec3) -> f32 {
        self.above([to_viewer, to_light]).map_or(0.0, |[viewer, light]| self.ggx.density(viewer, light))
    }

    /// Directions in its frame; `None` if one is below.
    fn above(&self, directions: [Vec3; 2]) -> Option<[Vec3; 2]> {
        let local = directions.map(|direction| self.to_world.transpose() * direction);
        local.iter().all(|local| local.z > 0.0).then_some(local)
    }
}
