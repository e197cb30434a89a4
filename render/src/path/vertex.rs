//! Where a path turns: on a surface or in the medium. Shared by all integrators that follow paths through a
//! medium.

use super::bsdf::{Bsdf, BsdfSample, Straight};
use super::medium::{HenyeyGreenstein, Media};
use crate::intersection::SurfacePoint;
use crate::sampler::Stream;
use glam::Vec3;

/// A point where a path from the eye turns.
#[expect(clippy::large_enum_variant, reason = "it lives on the stack, one a path; a box would cost more")]
pub enum Vertex {
    /// On a surface.
    Surface {
        /// Where.
        point: SurfacePoint,
        /// How it reflects.
        bsdf: Bsdf,
        /// Unit direction to the vertex before.
        to_viewer: Vec3,
    },
    /// In the medium.
    Medium {
        /// Where.
        point: Vec3,
        /// How it scatters.
        phase: HenyeyGreenstein,
        /// Unit direction that the path came along.
        direction: Vec3,
    },
}

impl Vertex {
    /// On a surface that the path came to along `direction`, with all of its layers.
    pub fn surface(point: SurfacePoint, direction: Vec3) -> Self {
        let point = point.reflecting(-direction);
        Self::Surface { bsdf: Bsdf::layered(&point), point, to_viewer: -direction }
    }

    /// The same, taken for opaque and without a coat.
    pub fn opaque(point: SurfacePoint, direction: Vec3) -> Self {
        let point = point.reflecting(-direction);
        Self::Surface { bsdf: Bsdf::new(&point), point, to_viewer: -direction }
    }

    /// In the medium, at a point that the path came to along `direction`.
    pub fn medium(media: &Media<'_>, point: Vec3, direction: Vec3) -> Self {
        Self::Medium { point, phase: media.phase(), direction }
    }

    /// Where rays in a direction start.
    pub fn ray_origin_towards(&self, direction: Vec3) -> Vec3 {
        match self {
            Self::Surface { point, .. } if point.geometric_normal.dot(direction) < 0.0 => self.behind(),
            _ => self.ray_origin(),
        }
    }

    /// Where what goes straight on through a surface does.
    pub fn behind(&self) -> Vec3 {
        match self {
            Self::Surface { point, .. } => point.ray_origin_below(),
            Self::Medium { point, .. } => *point,
        }
    }

    /// Light that goes on as it came.
    pub fn straight(&self) -> Option<Straight> {
        match self {
            Self::Surface { bsdf, to_viewer, .. } => bsdf.straight(*to_viewer),
            Self::Medium { .. } => None,
        }
    }

    /// What a metre takes in a direction, for each colour, where a metre takes `here` before the vertex.
    pub fn absorption_towards(&self, direction: Vec3, here: Vec3) -> Vec3 {
        match self {
            Self::Surface { point, bsdf, .. } if point.geometric_normal.dot(direction) < 0.0 => {
                bsdf.beyond().unwrap_or(here)
            }
            _ => here,
        }
    }

    /// From where lights are sampled, and rays to the viewer's side start.
    pub fn ray_origin(&self) -> Vec3 {
        match self {
            Self::Surface { point, .. } => point.ray_origin(),
            Self::Medium { point, .. } => *point,
        }
    }

    /// Share of light from a direction that is turned to the vertex before, per steradian; with the cosine on
    /// surfaces, and but for what goes straight on.
    pub fn evaluate(&self, to_light: Vec3) -> Vec3 {
        match self {
            Self::Surface { bsdf, to_viewer, .. } => bsdf.evaluate(*to_viewer, to_light),
            Self::Medium { phase, direction, .. } => Vec3::splat(phase.evaluate(direction.dot(to_light))),
        }
    }

    /// Density with which [`Vertex::sample`] takes a direction, per steradian.
    pub fn density(&self, to_light: Vec3) -> f32 {
        match self {
            Self::Surface { bsdf, to_viewer, .. } => bsdf.density(*to_viewer, to_light),
            Self::Medium { phase, direction, .. } => phase.evaluate(direction.dot(to_light)),
        }
    }

    /// A direction to look for light in.
    pub fn sample(&self, stream: &mut Stream) -> Option<BsdfSample> {
        match self {
            Self::Surface { bsdf, to_viewer, .. } => bsdf.sample(*to_viewer, stream),
            Self::Medium { phase, direction, .. } => {
                let turned = phase.sample(*direction, stream.next_2d());
                let density = phase.evaluate(direction.dot(turned));
                Some(BsdfSample { direction: turned, weight: Vec3::ONE, density })
            }
        }
    }
}
