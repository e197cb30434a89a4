//! Ambient occlusion by a bounced z-buffer: the light of a white sky that nothing within the radius hides.

use super::technique::{Reflectors, Shaders};
use super::{BouncedEffect, BouncedZ, Matte};
use crate::methods::Surface;
use crate::screen::Compiled;
use crate::surfels::Lit;
use crate::surfels::reference::Disk;
use deepshade_shaders::wgsl;
use deepshade_shaders::{Effect, GBuffer, MissingAttribute};
use glam::Vec3;

/// The effect.
#[derive(Clone, Copy, Debug)]
pub struct Occlusion;

/// The method, compiled for a device.
pub type BouncedOcclusion = Compiled<BouncedZ<Occlusion>>;

impl BouncedEffect for Occlusion {
    const EFFECT: Effect = Effect::Ao;
    const LIT: Option<Lit> = None;

    type Reflector = Matte;

    fn shaders() -> Shaders {
        Shaders { trace: &wgsl::BOUNCED_TRACE, arrive: &wgsl::BOUNCED_SKY, filter: &wgsl::BOUNCED_FILTER }
    }

    fn reflectors<'a>(_: &GBuffer, surface: &'a Surface) -> Result<Reflectors<'a, Matte>, MissingAttribute> {
        Ok(Box::new(Matte::all_over(surface)))
    }

    fn arriving(met: Option<&Disk>, _direction: Vec3) -> Vec3 {
        if met.is_some() { Vec3::ZERO } else { Vec3::ONE }
    }
}
