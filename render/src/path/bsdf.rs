//! How surfaces reflect: Lambert, GGX microfacets and the energy-normalised Phong lobe; and, where they are
//! asked with all of their [layers](Bsdf::layered), what they let through ([`passing`]) and how they are
//! coated ([`coat`]).
//!
//! Without layers surfaces are opaque and alike from both sides. The colours are [`Surface`]'s; how the
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
mod coat;
mod fresnel;
mod ggx;
mod passing;
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
use coat::CoatLobe;
use glam::{Mat3, Vec2, Vec3};
use passing::Passing;
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
    /// What passes, where layers are asked for.
    passing: Option<Passing>,
    /// What is over it, where layers are asked for.
    coat: Option<CoatLobe>,
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

/// Light that a surface lets on as it came.
#[derive(Clone, Copy, Debug)]
pub struct Straight {
    /// Share of it.
    pub share: Vec3,
    /// How likely a path should follow it, and not what is reflected.
    pub probability: f32,
}

/// About what a surface sends to a viewer, summed over the colours.
struct Sent {
    diffuse: f32,
    /// Reflected by microfacets, or let through by them.
    specular: f32,
}

impl Bsdf {
    /// The reflectance of a point.
    pub fn new(point: &SurfacePoint) -> Self {
        Self::of(&point.surface, point.normal, point.geometric_normal)
    }

    /// The same with what the point lets through and the coat over it.
    pub fn layered(point: &SurfacePoint) -> Self {
        let (bsdf, surface) = (Self::new(point), &point.surface);
        if surface.gloss != Gloss::Microfacets {
            return bsdf;
        }
        let bsdf = Self { coat: CoatLobe::new(point), ..bsdf };
        let Some(passage) = surface.transmission else { return bsdf };
        let (ggx, fresnel) = (Ggx::new(surface.roughness), Fresnel::new(surface.specular));
        let (passing, fresnel) = Passing::new(point, passage, &ggx, fresnel);
        let diffuse = surface.diffuse * (1.0 - passage.share);
        Self { diffuse, lobe: Lobe::Microfacets(ggx, fresnel), passing: Some(passing), ..bsdf }
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
        let diffuse = surface.diffuse;
        Self { to_world: frame(normal), geometric_normal, diffuse, lobe, passing: None, coat: None }
    }

    /// Reflectance from one direction to another, times the cosine of the light's, per steradian; below the
    /// surface what passes, but for what goes straight on.
    pub fn evaluate(&self, to_viewer: Vec3, to_light: Vec3) -> Vec3 {
        let base = self.evaluate_base(to_viewer, to_light);
        let Some(coat) = &self.coat else { return base };
        let left = base * coat.left(to_viewer, to_light);
        if self.is_above(to_light) { left + coat.evaluate(to_viewer, to_light) } else { left }
    }

    /// Density with which [`Bsdf::sample`] takes a direction, per steradian.
    pub fn density(&self, to_viewer: Vec3, to_light: Vec3) -> f32 {
        let base = self.density_of_base(to_viewer, to_light);
        let Some(coat) = &self.coat else { return base };
        let of_coat = if self.is_above(to_light) { coat.density(to_viewer, to_light) } else { 0.0 };
        let share = self.coat_share(coat, to_viewer);
        share * of_coat + (1.0 - share) * base
    }

    /// A direction to look for light in; `None` where the sample falls on the wrong side of the surface, and
    /// of a black one. Lobes are chosen between by what they send to the viewer, and the density is that of
    /// all together (the one-sample model of multiple importance sampling, Veach 1997, 9.2.4).
    pub fn sample(&self, to_viewer: Vec3, stream: &mut Stream) -> Option<BsdfSample> {
        let (choice, square) = (stream.next_1d(), stream.next_2d());
        let direction = match &self.coat {
            None => self.sample_base(to_viewer, choice, square)?,
            Some(coat) => {
                let share = self.coat_share(coat, to_viewer);
                if choice < share {
                    Some(coat.sample(to_viewer, square)).filter(|direction| self.is_above(*direction))?
                } else {
                    self.sample_base(to_viewer, (choice - share) / (1.0 - share), square)?
                }
            }
        };
        let density = self.density(to_viewer, direction);
        let weight = self.evaluate(to_viewer, direction) / density;
        (density > 0.0).then_some(BsdfSample { direction, weight, density })
    }

    /// What goes on as it came, which is no part of the other functions; `None` where nothing does.
    pub fn straight(&self, to_viewer: Vec3) -> Option<Straight> {
        let Lobe::Microfacets(_, fresnel) = &self.lobe else { return None };
        let passing = self.passing.as_ref().filter(|passing| passing.is_straight())?;
        let viewer = self.to_world.transpose() * to_viewer;
        let coat = self.coat.as_ref().map_or(0.0, |coat| coat.reflected(to_viewer));
        let (share, Sent { diffuse, specular }) =
            (passing.share(fresnel, viewer.z) * (1.0 - coat), self.sent(viewer));
        let (passed, reflected) = (share.element_sum(), diffuse + specular + 3.0 * coat);
        (passed > 0.0).then(|| Straight { share, probability: passed / (passed + reflected) })
    }

    /// Whether light from below the shading normal's horizon may be sent to the viewer, other than straight
    /// on: from behind, or by a coat, whose normal is another.
    pub fn looks_below_horizon(&self) -> bool {
        self.spreading().is_some() || self.coat.is_some()
    }

    /// What a metre of what is below takes; `None` where that is what is above.
    pub fn beyond(&self) -> Option<Vec3> {
        self.passing.as_ref().and_then(Passing::beyond)
    }

    fn evaluate_base(&self, to_viewer: Vec3, to_light: Vec3) -> Vec3 {
        if let Some([viewer, light]) = self.above([to_viewer, to_light]) {
            return (self.diffuse(viewer, light) + self.specular(viewer, light)) * light.z;
        }
        match (&self.lobe, self.spreading(), self.through([to_viewer, to_light])) {
            (Lobe::Microfacets(ggx, fresnel), Some(passing), Some([viewer, light])) => {
                passing.evaluate(ggx, fresnel, viewer, light)
            }
            _ => Vec3::ZERO,
        }
    }

    fn density_of_base(&self, to_viewer: Vec3, to_light: Vec3) -> f32 {
        let Some([viewer, light]) = self.above([to_viewer, to_light]) else {
            return self.density_below([to_viewer, to_light]);
        };
        let share = self.specular_share(viewer);
        let specular = match &self.lobe {
            Lobe::None => 0.0,
            Lobe::Microfacets(ggx, fresnel) => {
                let density = ggx.density(viewer, light);
                self.spreading().map_or(density, |passing| {
                    let half = (viewer + light).normalize_or(Vec3::Z);
                    density * (1.0 - passing.probability(fresnel, viewer.dot(half)))
                })
            }
            Lobe::Phong(phong, _) => phong.density(mirrored(viewer).dot(light)),
        };
        share.map_or(0.0, |share| share * specular + (1.0 - share) * light.z * FRAC_1_PI)
    }

    fn density_below(&self, directions: [Vec3; 2]) -> f32 {
        match (&self.lobe, self.spreading(), self.through(directions)) {
            (Lobe::Microfacets(ggx, fresnel), Some(passing), Some([viewer, light])) => {
                let share = self.specular_share(viewer).unwrap_or(0.0);
                share * passing.density(ggx, fresnel, viewer, light)
            }
            _ => 0.0,
        }
    }

    /// A direction of the base alone.
    fn sample_base(&self, to_viewer: Vec3, choice: f32, square: Vec2) -> Option<Vec3> {
        let viewer = self.to_world.transpose() * to_viewer;
        let share = self.specular_share(viewer)?;
        let passed = match (&self.lobe, self.spreading()) {
            (Lobe::Microfacets(ggx, fresnel), Some(passing)) if choice < share => {
                let facet = ggx.facet(viewer, square);
                let probability = passing.probability(fresnel, viewer.dot(facet));
                (choice < share * probability).then(|| passing.through(viewer, facet))
            }
            _ => None,
        };
        let light = passed.unwrap_or_else(|| match &self.lobe {
            Lobe::Microfacets(ggx, _) if choice < share => ggx.sample(viewer, square),
            Lobe::Phong(phong, _) if choice < share => phong.sample(viewer, square),
            _ => cosine_hemisphere(square.x, square.y),
        });
        let direction = (self.to_world * light).normalize();
        (self.is_above(direction) == passed.is_none()).then_some(direction)
    }

    /// What passes spread or bent.
    fn spreading(&self) -> Option<&Passing> {
        self.passing.as_ref().filter(|passing| !passing.is_straight())
    }

    /// Whether a direction is above the triangle.
    fn is_above(&self, direction: Vec3) -> bool {
        direction.dot(self.geometric_normal) > 0.0
    }

    /// Directions in the shading normal's frame; `None` if one is below the surface.
    fn above(&self, directions: [Vec3; 2]) -> Option<[Vec3; 2]> {
        let local = directions.map(|direction| self.to_world.transpose() * direction);
        let seen = directions.into_iter().all(|direction| self.is_above(direction));
        (seen && local.iter().all(|local| local.z > 0.0)).then_some(local)
    }

    /// The same; `None` unless the first is above the surface and the second below.
    fn through(&self, [above, below]: [Vec3; 2]) -> Option<[Vec3; 2]> {
        let local = [above, below].map(|direction| self.to_world.transpose() * direction);
        let apart = self.is_above(above) && below.dot(self.geometric_normal) < 0.0;
        (apart && local[0].z > 0.0 && local[1].z < 0.0).then_some(local)
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

    /// Probability of sampling the specular lobe: about its share of what is sent to a viewer. `None` of a
    /// black surface.
    fn specular_share(&self, viewer: Vec3) -> Option<f32> {
        let Sent { diffuse, specular } = self.sent(viewer);
        (diffuse + specular > 0.0).then(|| specular / (diffuse + specular))
    }

    /// Probability of sampling the coat.
    fn coat_share(&self, coat: &CoatLobe, to_viewer: Vec3) -> f32 {
        let reflected = coat.reflected(to_viewer);
        let Sent { diffuse, specular } = self.sent(self.to_world.transpose() * to_viewer);
        let base = (1.0 - reflected) * (diffuse + specular) / 3.0;
        if base > 0.0 { reflected / (reflected + base) } else { 1.0 }
    }

    /// What is sent to a viewer, but for what goes straight on.
    fn sent(&self, viewer: Vec3) -> Sent {
        let (diffuse, specular) = match &self.lobe {
            Lobe::None => (self.diffuse, Vec3::ZERO),
            Lobe::Microfacets(_, fresnel) => {
                let reflected = fresnel.reflected(viewer.z);
                let passed = self.spreading().map(|passing| passing.share(fresnel, viewer.z));
                (
                    self.diffuse * fresnel.let_through(viewer.z),
                    passed.map_or(reflected, |passed| reflected + passed),
                )
            }
            Lobe::Phong(_, colour) => (self.diffuse, *colour),
        };
        Sent { diffuse: diffuse.element_sum(), specular: specular.element_sum() }
    }
}
