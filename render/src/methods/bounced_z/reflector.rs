//! What a pixel's surface makes of light, and where it looks for it: the plain versions of
//! `shared/bounced_matte.wgsl` and `shared/bounced_glossy.wgsl`.

use crate::methods::Surface;
use crate::methods::lobe::Lobe;
use glam::{IVec2, Vec2, Vec3};
use std::f32::consts::TAU;

/// How a surface reflects.
pub trait Reflector: Copy + Send + Sync {
    /// A direction that it looks into, camera space, which a place on the disk leads to: its radius squared,
    /// and its angle, turns.
    fn direction(&self, place: Vec2) -> Vec3;

    /// The density of such directions, but for a factor that is the same for all; never 0.
    fn density(&self, direction: Vec3) -> f32;

    /// What becomes of light from a direction, over the density.
    fn weight(&self, direction: Vec3) -> Vec3;
}

/// By the cosine to a normal.
#[derive(Clone, Copy, Debug)]
pub struct Matte(pub Vec3);

impl Matte {
    /// That of every pixel.
    pub fn all_over(surface: &Surface) -> impl Fn(IVec2) -> Option<Self> + Sync {
        |at| Some(Self(surface.normal_at(at)))
    }
}

/// Below this a cosine is rounding.
const LEAST_COSINE: f32 = 1e-3;
/// Less density of a lobe is rounding.
const LEAST_DENSITY: f32 = 1e-6;

impl Reflector for Matte {
    fn direction(&self, place: Vec2) -> Vec3 {
        let (tangent, bitangent) = self.0.any_orthonormal_pair();
        let (sin, cos) = (TAU * place.y).sin_cos();
        place.x.sqrt() * (cos * tangent + sin * bitangent) + (1.0 - place.x).sqrt() * self.0
    }

    fn density(&self, direction: Vec3) -> f32 {
        self.0.dot(direction).max(LEAST_COSINE)
    }

    fn weight(&self, _direction: Vec3) -> Vec3 {
        Vec3::ONE
    }
}

impl Reflector for Lobe {
    fn direction(&self, place: Vec2) -> Vec3 {
        Self::direction(self, place)
    }

    fn density(&self, direction: Vec3) -> f32 {
        Self::density(self, direction).max(LEAST_DENSITY)
    }

    fn weight(&self, direction: Vec3) -> Vec3 {
        Self::weight(self, direction)
    }
}
