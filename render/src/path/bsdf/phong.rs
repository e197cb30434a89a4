//! The energy-normalised Phong lobe, `(n + 2) / (2 pi) cos^n` of the angle to the mirrored direction
//! (Lafortune and Willems 1994): all light at normal incidence, less towards grazing, where part of the lobe
//! is below the surface.
//!
//! Directions are in the frame of the shading normal, which is z, and point away from the surface.

use crate::sampler::frame;
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// Smoother surfaces have this lobe, whose exponent is 4,998.
const NARROWEST_ALPHA: f32 = 0.02;

/// The squared roughness that a lobe is as wide as, at least 0.02.
pub fn phong_alpha(roughness: f32) -> f32 {
    (roughness * roughness).max(NARROWEST_ALPHA)
}

/// A lobe around the direction of a mirror.
#[derive(Clone, Copy, Debug)]
pub struct Phong {
    exponent: f32,
}

impl Phong {
    /// The lobe as wide as a GGX lobe of a perceptual roughness: `n = 2 / alpha^2 - 2`, alpha the squared
    /// roughness, at least 0.02 (Walter et al. 2007, the exponent of a Blinn-Phong distribution of the same
    /// width).
    pub fn new(roughness: f32) -> Self {
        let alpha = phong_alpha(roughness);
        Self { exponent: (2.0 / (alpha * alpha) - 2.0).max(0.0) }
    }

    /// The power of the cosine.
    pub const fn exponent(&self) -> f32 {
        self.exponent
    }

    /// What comes from one direction per steradian of another, without the cosine: by the cosine of the angle
    /// between one and the other mirrored.
    pub fn reflectance(&self, cosine: f32) -> f32 {
        (self.exponent + 2.0) / TAU * self.power(cosine)
    }

    /// A direction to the light. May be below the surface.
    pub fn sample(&self, viewer: Vec3, square: Vec2) -> Vec3 {
        let cosine = square.y.powf(1.0 / (self.exponent + 1.0));
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let (sin, cos) = (TAU * square.x).sin_cos();
        frame(mirrored(viewer)) * Vec3::new(sine * cos, sine * sin, cosine)
    }

    /// Density of [`Phong::sample`], per steradian, by the same cosine.
    pub fn density(&self, cosine: f32) -> f32 {
        (self.exponent + 1.0) / TAU * self.power(cosine)
    }

    fn power(&self, cosine: f32) -> f32 {
        // With exponent 0, too, the lobe ends at a right angle, as wide lobes do.
        if cosine > 0.0 { cosine.min(1.0).powf(self.exponent) } else { 0.0 }
    }
}

/// Where a mirror would send a direction.
pub fn mirrored(direction: Vec3) -> Vec3 {
    Vec3::new(-direction.x, -direction.y, direction.z)
}
