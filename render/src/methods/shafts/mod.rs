//! What the methods share that integrate single scattering along view rays on the processor ([`ray_march`],
//! [`epipolar`], [`epipolar_sampling`], [`min_max`]): view rays ([`ViewRays`]), lamps ([`Lamp`]), their
//! shadow maps ([`ShadowMap`]), a medium that is the same throughout ([`Haze`]), and [`Shafts`], which makes
//! a [`Method`] of a way to integrate.
//!
//! The clock holds what the way to integrate does, for all lamps one after the other. View rays with their
//! depths and shadow maps are given, as in Baran et al. 2010 (section 10): a renderer has them anyway.
//!
//! Limits of all of them: light of point, spot and directional lights only, not of emissive surfaces and of
//! the environment; shadows as fine as the texels of the map; blended surfaces hide light from an opacity of
//! one half on, where truth's hide their share; the camera is a pinhole.
//!
//! [`ray_march`]: super::ray_march
//! [`epipolar`]: super::epipolar
//! [`epipolar_sampling`]: super::epipolar_sampling
//! [`min_max`]: super::min_max

mod faces;
mod haze;
mod lamp;
mod parallel;
mod shadow_map;
#[cfg(test)]
mod tests;
mod view_rays;

pub use faces::{Faces, mean_decay};
pub use haze::{DEEP, Haze, UNEVEN};
pub use lamp::{Lamp, LampPosition};
pub use parallel::{CASCADES, Cascade, Parallel};
pub use shadow_map::{Projection, ShadowMap, Stereographic, TOGETHER};
pub use view_rays::ViewRays;

use crate::method::{Clock, Frame, Method, MethodError, Repeats, Shaded};
use crate::scene::Medium;
use deepshade_shaders::{Effect, Planes};
use glam::Vec3;
use web_time::Instant;

/// What one lamp's light is integrated from.
#[derive(Clone, Copy, Debug)]
pub struct IntegrationInputs<'a> {
    /// The view rays.
    pub rays: &'a ViewRays,
    /// What scatters.
    pub medium: &'a Medium,
    /// What shines.
    pub lamp: &'a Lamp<'a>,
    /// What hides it.
    pub map: &'a ShadowMap,
    /// Chooses the random numbers of who uses some.
    pub seed: u32,
}

/// A way to integrate what a medium scatters of a lamp's light to the eye.
pub trait Integration: Send + Sync {
    /// The method's name.
    const NAME: &'static str;
    /// As [`Method::wants_even_fog`].
    const WANTS_EVEN_FOG: bool;

    /// Texels along an edge of a lamp's shadow map, a multiple of [`shadow_map::TILE`]; the [`CASCADES`] of a
    /// distant one have as many together.
    fn shadow_size(&self) -> usize;

    /// Adds a lamp's radiance to each view ray's.
    fn add(&self, lit: &IntegrationInputs<'_>, radiance: &mut [Vec3]);
}

/// A way to integrate as a method of the effect `fog-direct`.
#[derive(Clone, Copy, Debug)]
pub struct Shafts<I>(pub I);

impl<I: Integration> Method for Shafts<I> {
    fn name(&self) -> &'static str {
        I::NAME
    }

    fn effect(&self) -> Effect {
        Effect::FogDirect
    }

    fn wants_even_fog(&self) -> bool {
        I::WANTS_EVEN_FOG
    }

    fn shade(&self, frame: &Frame<'_>, repeats: Repeats) -> Result<Shaded, MethodError> {
        let rays = ViewRays::of(frame);
        let mut radiance = vec![Vec3::ZERO; rays.count()];
        let mut milliseconds = 0.0;
        let scene = frame.scene.scene();
        if let Some(medium) = scene.medium.as_deref().filter(|medium| medium.scattering != Vec3::ZERO) {
            if I::WANTS_EVEN_FOG && Haze::of(medium).is_none() {
                return Err(MethodError::Other { method: I::NAME, what: UNEVEN.to_owned() });
            }
            for light in &scene.lights {
                let lamp = Lamp::new(scene, light);
                let map = ShadowMap::new(frame.scene, &lamp, &rays, [CASCADES, self.0.shadow_size()]);
                let lit = IntegrationInputs { rays: &rays, medium, lamp: &lamp, map: &map, seed: frame.seed };
                milliseconds += self.timed(&lit, repeats, &mut radiance);
            }
        }
        let (height, width) = (rays.height(), rays.width());
        let image = Planes::from_fn(3, height, width, |channel, y, x| radiance[y * width + x][channel]);
        Ok(Shaded { image, milliseconds, clock: Clock::Cpu, device: "processor".to_owned() })
    }
}

impl<I: Integration> Shafts<I> {
    /// Adds one lamp's light and gives the median of the runs' times, milliseconds.
    fn timed(&self, lit: &IntegrationInputs<'_>, repeats: Repeats, radiance: &mut [Vec3]) -> f64 {
        let before = radiance.to_vec();
        let mut times = Vec::new();
        for run in 0..repeats.warm_up + repeats.timed.max(1) {
            radiance.copy_from_slice(&before);
            let start = Instant::now();
            self.0.add(lit, radiance);
            if run >= repeats.warm_up {
                times.push(start.elapsed().as_secs_f64() * 1e3);
            }
        }
        deepshade_shaders::lists::median(times)
    }
}
