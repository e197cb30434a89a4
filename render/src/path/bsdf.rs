//! How surfaces reflect: Lambert, GGX microfacets and the energy-normalised Phong lobe.
//!
//! Surfaces are opaque and alike from both sides. The colours are [`Surface`]'s; how the
//! specular one spreads says its [`Gloss`]:
//!
//! - `Gloss::None`: Lambert's law, `diffuse / pi`.
//! - `Gloss::Phong`: `diffuse / pi + specular (n + 2) / (2 pi) cos^n`. The sum reflects no more than it
//!   receives since the material caps the diffuse colour
//!   ([`Material::surface`](crate::scene::Material::surface)).
//! - `Gloss::Microfacets`: GGX microfacets with Schlick's Fresnel `F` over a diffuse base that only gets what
//!   `F` lets through, on its way in and out: `diffuse / pi (1 - F(in)) (1 - F(out)) / (1 - mean F)` (Shirley
//!   et al., "A Practitioners' Assessment of Light Reflection Models", 1997). Together they never reflect
//!   more than there is. A smooth white dielectric reflects all of it, of light from everywhere to within 0.2
//!   %; a rough one loses what its microfacets hide from each other: 1 % at roughness 0.3, 7 % at roughness
//!   1, most of it towards grazing.
//!
//! All are reciprocal. Where the shading normal is not the triangle's, light from below the triangle is not
//! reflected even if it is above the shading normal, so that none comes through the surface; that light is
//! lost.

mod albedo;
mod fresnel;
mod ggx;
mod phong;
#[cfg(test)]
mod tests;

pub use albedo::{directional_albedo, directional_table, hemispherical_albedo};
pub use fresnel::Fresnel;
pub use ggx::Ggx;
pub use phong::{Phong, phong_alpha};

use crate::intersection::SurfacePoint;
use crate::sampler::{Stream, cosine_hemisphere, frame};
use crate::scene::{Gloss, Surface};
use glam::{Mat3, Vec3};
use phong::mirrored;
use std::f32::consts::FRAC_1_PI;

/// How one point of a surface reflects light.
#[derive(Clone, Copy, Debug)]
pub struct Bsdf {
    /// From the shading normal's frame, in which it is z, to the world's.
    to_world: Mat3,
    geometric_normal: Vec3,
    diffuse: Vec3,
    lobe: Lobe,
}

/// What is reflected specularly. The functions of lobes are in the shading normal's frame.
#[derive(Clone, Copy, Debug)]
enum Lobe {
    None,
    Microfacets(Ggx, Fresnel),
    Phong(Phong, Vec3),
}

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
    pub fn new(point: &SurfacePoint) -> Self {
        Self::of(&point.surface, point.normal, point.geometric_normal)
    }

    /// The reflectance of a surface, with its unit shading normal and its triangle's unit normal.
    fn of(surface: &Surface, normal: Vec3, geometric_normal: Vec3) -> Self {
        let lobe = match surface.gloss {
            Gloss::Microfacets if surface.specular != Vec3::ZERO => {
                Lobe::Microfacets(Ggx::new(surface.roughness), Fresnel::new(surface.specular))
            }
            Gloss::Phong if surface.specular != Vec3::ZERO => {
                Lobe::Phong(Phong::new(surface.roughness), surface.specular)
            }
            _ => Lobe::None,
        };
        Self { to_world: frame(normal), geometric_normal, diffuse: surface.diffuse, lobe }
    }

    /// Reflectance from one direction to another, times the cosine of the light's, per steradian; 0 below the
    /// surface.
    pub fn evaluate(&self, to_viewer: Vec3, to_light: Vec3) -> Vec3 {
        let Some([viewer, light]) = self.above([to_viewer, to_light]) else { return Vec3::ZERO };
        (self.diffuse(viewer, light) + self.specular(viewer, light)) * light.z
    }

    /// Density with which [`Bsdf::sample`] takes a direction, per steradian.
    pub fn density(&self, to_viewer: Vec3, to_light: Vec3) -> f32 {
        let Some([viewer, light]) = self.above([to_viewer, to_light]) else { return 0.0 };
        let share = self.specular_share(viewer);
        let specular = match &self.lobe {
            Lobe::None => 0.0,
            Lobe::Microfacets(ggx, _) => ggx.density(viewer, light),
            Lobe::Phong(phong, _) => phong.density(mirrored(viewer).dot(light)),
        };
        share.map_or(0.0, |share| share * specular + (1.0 - share) * light.z * FRAC_1_PI)
    }

    /// A direction to look for light in; `None` where the sample falls below the surface, and of a black one.
    /// The diffuse and the specular lobe are chosen between by what they reflect, and the density is that of
    /// both together (the one-sample model of multiple importance sampling, Veach 1997, 9.2.4).
    pub fn sample(&self, to_viewer: Vec3, stream: &mut Stream) -> Option<BsdfSample> {
        let (choice, square) = (stream.next_1d(), stream.next_2d());
        let viewer = self.to_world.transpose() * to_viewer;
        let share = self.specular_share(viewer)?;
        let light = match &self.lobe {
            Lobe::Microfacets(ggx, _) if choice < share => ggx.sample(viewer, square),
            Lobe::Phong(phong, _) if choice < share => phong.sample(viewer, square),
            _ => cosine_hemisphere(square.x, square.y),
        };
        let direction = (self.to_world * light).normalize();
        let density = self.density(to_viewer, direction);
        let weight = self.evaluate(to_viewer, direction) / density;
        (density > 0.0).then_some(BsdfSample { direction, weight, density })
    }

    /// Directions in the shading normal's frame; `None` if one is below the surface.
    fn above(&self, directions: [Vec3; 2]) -> Option<[Vec3; 2]> {
        let local = directions.map(|direction| self.to_world.transpose() * direction);
        let seen = |direction: Vec3| direction.dot(self.geometric_normal) > 0.0;
        (directions.into_iter().all(seen) && local.iter().all(|local| local.z > 0.0)).then_some(local)
    }

    /// Per steradian, without the cosine.
    fn diffuse(&self, viewer: Vec3, light: Vec3) -> Vec3 {
        let let_through = match &self.lobe {
            Lobe::Microfacets(_, fresnel) => fresnel.let_through(viewer.z) * fresnel.let_out(light.z),
            Lobe::None | Lobe::Phong(..) => Vec3::ONE,
        };
        self.diffuse * let_through * FRAC_1_PI
    }

    /// Per steradian, without the cosine.
    fn specular(&self, viewer: Vec3, light: Vec3) -> Vec3 {
        match &self.lobe {
            Lobe::None => Vec3::ZERO,
            Lobe::Microfacets(ggx, fresnel) => {
                let half = (viewer + light).normalize_or(Vec3::Z);
                fresnel.reflected(viewer.dot(half)) * ggx.reflectance(viewer, light)
            }
            Lobe::Phong(phong, colour) => *colour * phong.reflectance(mirrored(viewer).dot(light)),
        }
    }

    /// Probability of sampling the specular lobe: about its share of what is reflected to a viewer. `None` of
    /// a black surface.
    fn specular_share(&self, viewer: Vec3) -> Option<f32> {
        let (diffuse, specular) = match &self.lobe {
            Lobe::None => (self.diffuse, Vec3::ZERO),
            Lobe::Microfacets(_, fresnel) => {
                (self.diffuse * fresnel.let_through(viewer.z), fresnel.reflected(viewer.z))
            }
            Lobe::Phong(_, colour) => (self.diffuse, *colour),
        };
        let (diffuse, specular) = (diffuse.element_sum(), specular.element_sum());
        (diffuse + specular > 0.0).then(|| specular / (diffuse + specular))
    }
}
