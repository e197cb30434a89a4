//! Truth for subsurface scattering in screen space: direct light gathered from all pixels of the image, by
//! the distance of their surfaces in space (thesis 7.4), with the normalised diffusion profile of Christensen
//! and Burley, "Approximate Reflectance Profiles for Efficient Subsurface Scattering" (2015), equation 2:
//! `R(r) = (exp(-r / d) + exp(-r / (3 d))) / (8 pi d r)`, of which a disc of radius r holds
//! `1 - exp(-r / d) / 4 - 3 exp(-r / (3 d)) / 4`.
//!
//! Each colour has its own `d`: the mean free path of the pixel that receives. The paper divides that by a
//! number which depends on the albedo, 1.0 to 1.4 for albedos above 0.65; the thesis' network is not told the
//! albedo, so here it is 1. A pixel weighs as much as the profile at its distance times the area of the
//! surface that it shows; itself, as the disc of that area. Weights are divided by their sum, so that evenly
//! lit surfaces stay as they are. All surfaces in the image give and those out of it do not, whatever they
//! belong to. A colour without a mean free path is not scattered. What is gathered is the attribute `L`,
//! without emission.
//!
//! The result has no noise: samples and footprint do not matter, and the variance is 0. Groups of pixels too
//! far away for the profile to tell them apart count as one (Jensen and Buhler 2002), see [`TOLERANCE`]: in a
//! test the image is within 0.2 % of the sum over all pairs of pixels (root mean square), and no pixel off by
//! more than 2 %.

mod tree;

use super::{Integrator, Shot};
use crate::gbuffer;
use crate::sampler::{PixelSampler, Stream};
use deepshade_shaders::{Attribute, Planes, shows_surface};
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::f32::consts::PI;
use tree::Tree;

/// Pixels are taken together where the profile varies over them by less than this, in parts of all that it
/// gathers.
const TOLERANCE: f32 = 1e-3;

/// Beyond this many lengths `d` less than 1e-4 of the profile is left: `3 exp(-r / (3 d)) / 4`.
const SUPPORT: f32 = 26.8;

/// The cosine that seen surfaces have at least, where their area is computed: a pixel that shows an edge does
/// not outweigh the image.
const LEAST_COSINE: f32 = 0.05;

/// Scattered light of a whole image: radiance.
#[derive(Clone, Debug)]
pub struct ScreenSpaceScattering {
    /// `[height][width]`.
    image: Vec<Vec3>,
    height: usize,
    width: usize,
}

/// What a pixel shows.
#[derive(Clone, Copy, Debug)]
struct Patch {
    /// Camera space, metres.
    position: Vec3,
    /// Square metres.
    area: f32,
    /// Radiance.
    light: Vec3,
    /// Metres.
    mean_free_path: Vec3,
}

impl ScreenSpaceScattering {
    /// Gathers the shot's image.
    pub fn new(shot: &Shot<'_>) -> Self {
        let patches = patches(shot);
        let seen: Vec<Patch> = patches.iter().flatten().copied().collect();
        let tree = Tree::new(seen);
        let scatter = |patch: &Option<Patch>| patch.as_ref().map_or(Vec3::ZERO, |patch| tree.gather(patch));
        let image = patches.par_iter().map(scatter).collect();
        Self { image, height: shot.height, width: shot.width }
    }
}

impl Integrator for ScreenSpaceScattering {
    fn sample(&self, at: Vec2, _stream: &mut Stream) -> Vec3 {
        let inside = |at: f32, count: usize| (at as usize).min(count - 1);
        self.image[inside(at.y, self.height) * self.width + inside(at.x, self.width)]
    }

    fn pixel(&self, shot: &Shot<'_>, x: usize, y: usize, _sampler: PixelSampler, _count: u32) -> Vec3 {
        self.image[y * shot.width + x]
    }
}

/// What the pixels of a shot show, row by row; `None` where that is nothing.
fn patches(shot: &Shot<'_>) -> Vec<Option<Patch>> {
    const ATTRIBUTES: [Attribute; 5] =
        [Attribute::Position, Attribute::Normal, Attribute::Light, Attribute::MeanFreePath, Attribute::Valid];
    let gbuffer = gbuffer::render(shot.scene, shot.camera, shot.height, shot.width, &ATTRIBUTES);
    let planes: &Planes = gbuffer.planes();
    let focal_length = shot.camera.focal_length(shot.height);
    let patch = |pixel: usize| {
        let vector = |first: usize| Vec3::from_array(std::array::from_fn(|c| planes.plane(first + c)[pixel]));
        let (position, normal) = (vector(0), vector(3));
        // The pixel's solid angle, cos^3 / f^2, at the distance, over the cosine of the surface.
        let cosine = (-normal.dot(position.normalize_or_zero())).max(LEAST_COSINE);
        let depth = -position.z;
        let area = depth.powi(3) / (position.length() * focal_length * focal_length * cosine);
        shows_surface(planes.plane(12)[pixel]).then(|| Patch {
            position,
            area,
            light: vector(6),
            mean_free_path: vector(9),
        })
    };
    (0..planes.pixels()).map(patch).collect()
}

/// Christensen and Burley's profile for the scale `d` at distance `r > 0`, per square metre.
pub fn profile(r: f32, d: f32) -> f32 {
    // The two exponentials in one: the first is the second's third power.
    let slow = (-r / (3.0 * d)).exp();
    (slow * slow * slow + slow) / (8.0 * PI * d * r)
}

/// The share of the profile within a disc of radius `r`.
fn within(r: f32, d: f32) -> f32 {
    let slow = (-r / (3.0 * d)).exp();
    1.0 - 0.25 * slow * slow * slow - 0.75 * slow
}

#[cfg(test)]
mod tests;
