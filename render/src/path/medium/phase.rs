//! Into which directions light is scattered.

use crate::sampler::frame;
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, TAU};

/// The phase function of Henyey and Greenstein (1941).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HenyeyGreenstein {
    anisotropy: f32,
}

impl HenyeyGreenstein {
    /// The phase function with a mean cosine of the scattering angle in (-1, 1).
    pub const fn new(anisotropy: f32) -> Self {
        Self { anisotropy }
    }

    /// Share of light that is scattered from one direction to another, per steradian; also the density with
    /// which [`HenyeyGreenstein::sample`] takes one of them. `cosine` is that between the directions of
    /// travel before and after, or, the same, between those of a path followed from the eye: on from the last
    /// vertex, and on to the light.
    pub fn evaluate(&self, cosine: f32) -> f32 {
        let g = self.anisotropy;
        // 1 + g^2 - 2 g cosine, without cancellation at the peak.
        let base = (1.0 - g.abs()).powi(2) + 2.0 * g.abs() * (1.0 - cosine * g.signum()).max(0.0);
        0.25 * FRAC_1_PI * (1.0 - g * g) / (base * base.sqrt())
    }

    /// The unit direction after scattering of what travelled in a unit direction, from two uniform numbers.
    pub fn sample(&self, direction: Vec3, at: Vec2) -> Vec3 {
        let g = self.anisotropy;
        let s = 2.0 * at.x - 1.0;
        // The inverse of the cumulated density, multiplied out so that g = 0 is no exception.
        let base = 1.0 + g * s;
        let cosine =
            (2.0 * s + g * (s * s + 3.0) + 2.0 * g * g * s + g * g * g * (s * s - 1.0)) / (2.0 * base * base);
        let cosine = cosine.clamp(-1.0, 1.0);
        let sine = ((1.0 - cosine) * (1.0 + cosine)).sqrt();
        let (sin, cos) = (TAU * at.y).sin_cos();
        frame(direction) * Vec3::new(sine * cos, sine * sin, cosine)
    }
}
