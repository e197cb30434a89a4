//! `ray-march`: single scattering by steps along every view ray, each of which looks into the shadow map.
//!
//! The method that all others are held against (Baran et al. 2010, section 2.1; Max 1986 before it). Steps
//! are as many on every ray and shifted by a number of the pixel's own, so that what they miss is noise and
//! no bands. Of distant lamps in a medium that is the same throughout they are of equal length, what reaches
//! the eye of a lit step is exact, and the walk through the shadow map is straight ([`distant`]). Of other
//! lamps they are of equal angle, as seen from the lamp, which bring the same light each (Kulla and Fajardo
//! 2012). Through grids the optical depth is summed along the view ray, and from each step along the way to
//! the light ([`general`]).
//!
//! Why it: nothing lies between it and the medium, grids neither. Why not: it costs pixels times steps, and
//! shadows thinner than a step are noise.

mod distant;
mod general;

use super::Quality;
use super::shafts::{Haze, Integration, IntegrationInputs, LampPosition};
use crate::sampler::hash;
use distant::Distant;
use general::General;
use glam::Vec3;
use rayon::prelude::*;

/// What it may take.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct RayMarchParameters {
    /// Steps along each view ray.
    #[schemars(range(min = 1, max = 8192))]
    pub steps: u32,
    /// Steps from each of them to the light, through grids.
    #[schemars(range(min = 1, max = 256))]
    pub light_steps: u32,
    /// Texels along an edge of a shadow map; the nested maps of a sun have as many together.
    #[schemars(range(min = 64, max = 8192), extend("unit" = "texels", "multipleOf" = 64))]
    pub shadow_size: usize,
    /// Whether steps are shifted from pixel to pixel.
    pub jitter: bool,
}

impl RayMarchParameters {
    /// More time is more steps.
    pub const fn of(quality: Quality) -> Self {
        let (steps, light_steps, shadow_size) = match quality {
            Quality::Low => (32, 4, 1024),
            Quality::Medium => (128, 8, 1024),
            Quality::High => (512, 16, 2048),
            Quality::Ultra => (2048, 32, 4096),
        };
        Self { steps, light_steps, shadow_size, jitter: true }
    }
}

impl Integration for RayMarchParameters {
    const NAME: &'static str = "ray-march";
    const WANTS_EVEN_FOG: bool = false;

    fn shadow_size(&self) -> usize {
        self.shadow_size
    }

    fn add(&self, lit: &IntegrationInputs<'_>, radiance: &mut [Vec3]) {
        let march = March::new(lit, self.light_steps);
        match self.jitter {
            true => march.add(self.steps, radiance),
            false => march.add_each(radiance, |ray| march.along(ray, self.steps, 0.5)),
        }
    }
}

/// A number in [0, 1) of a view ray's own.
pub fn shift(ray: usize, seed: u32) -> f32 {
    (hash(ray as u32 ^ hash(seed)) >> 8) as f32 / 16_777_216.0
}

/// Steps along view rays, for others that need some.
#[derive(Debug)]
pub struct March<'a> {
    lit: IntegrationInputs<'a>,
    /// Metres in the medium after which nothing is seen.
    deep: f32,
    way: Way<'a>,
}

/// A ray from the eye, and how it is cut into steps.
#[derive(Clone, Copy, Debug)]
struct Ray {
    /// Unit vector.
    direction: Vec3,
    /// From which distance to which it is in the medium, metres.
    span: [f32; 2],
    /// How many steps there are.
    count: u32,
    /// Where in a step light is looked for, from 0 to 1.
    jitter: f32,
}

/// How steps are taken.
#[derive(Debug)]
enum Way<'a> {
    Distant(Distant<'a>),
    General(General<'a>),
}

impl<'a> March<'a> {
    /// Towards a lamp; from each step `light_steps` to the light, where the medium is a grid.
    pub fn new(lit: &IntegrationInputs<'a>, light_steps: u32) -> Self {
        let haze = Haze::of(lit.medium);
        let deep = haze.map_or(f32::INFINITY, |haze| haze.deep());
        let way = match (haze, lit.lamp.position) {
            (Some(haze), LampPosition::Distant(towards)) => Way::Distant(Distant::new(lit, haze, towards)),
            (haze, _) => Way::General(General::new(lit, haze, light_steps)),
        };
        Self { lit: *lit, deep, way }
    }

    /// Adds the radiance of every view ray.
    pub fn add(&self, steps: u32, radiance: &mut [Vec3]) {
        self.add_each(radiance, |ray| self.shifted(ray, steps));
    }

    fn add_each(&self, radiance: &mut [Vec3], of: impl Fn(usize) -> Vec3 + Sync) {
        radiance.par_iter_mut().enumerate().for_each(|(ray, radiance)| *radiance += of(ray));
    }

    /// Radiance of one of the view rays, its steps shifted by a number of its own.
    pub fn shifted(&self, ray: usize, steps: u32) -> Vec3 {
        self.along(ray, steps, shift(ray, self.lit.seed))
    }

    /// Radiance of one of the view rays. The steps begin at `jitter` in [0, 1) of their length.
    pub fn along(&self, ray: usize, steps: u32, jitter: f32) -> Vec3 {
        let rays = self.lit.rays;
        let [near, far] = rays.spans[ray];
        let span = [near, far.min(near + self.deep)];
        let ray = Ray { direction: rays.directions[ray], span, count: steps, jitter };
        if ray.span[0] >= ray.span[1] || steps == 0 {
            return Vec3::ZERO;
        }
        match &self.way {
            Way::Distant(distant) => distant.radiance(ray),
            Way::General(general) => general.radiance(ray),
        }
    }
}
