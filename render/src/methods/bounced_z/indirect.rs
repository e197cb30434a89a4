//! Diffuse indirect light of one bounce by a bounced z-buffer: what the nearest surfels send, lit by the scene's lights
//! with shadows; of `phosphor-gi` what they give back of light that they kept. Surfels without light hide those behind them, so none is left out.

use super::technique::{Reflectors, Shaders};
use super::{BouncedEffect, BouncedZ, Matte};
use crate::methods::Surface;
use crate::methods::surfel::reference::sent;
use crate::screen::Compiled;
use crate::surfels::Lit;
use crate::surfels::reference::Disk;
use deepshade_shaders::wgsl;
use deepshade_shaders::{Effect, GBuffer, MissingAttribute};
use glam::Vec3;

/// The effect `gi`.
#[derive(Clone, Copy, Debug)]
pub struct Indirect;

/// The effect `phosphor-gi`.
#[derive(Clone, Copy, Debug)]
pub struct KeptLight;

/// `gi`, compiled for a device.
pub type BouncedIndirect = Compiled<BouncedZ<Indirect>>;

impl BouncedEffect for Indirect {
    const EFFECT: Effect = Effect::Gi;
    const LIT: Option<Lit> = Some(Lit::Reflected);

    type Reflector = Matte;

    fn shaders() -> Shaders {
        Shaders { trace: &wgsl::BOUNCED_TRACE, arrive: &wgsl::BOUNCED_LIGHT, filter: &wgsl::BOUNCED_FILTER }
    }

    fn reflectors<'a>(_: &GBuffer, surface: &'a Surface) -> Result<Reflectors<'a, Matte>, MissingAttribute> {
        Ok(Box::new(Matte::all_over(surface)))
    }

    fn arriving(met: Option<&Disk>, direction: Vec3) -> Vec3 {
        met.map_or(Vec3::ZERO, |disk| sent(direction, disk))
    }
}

impl BouncedEffect for KeptLight {
    const EFFECT: Effect = Effect::PhosphorGi;
    const LIT: Option<Lit> = Some(Lit::Kept);

    type Reflector = Matte;

    fn shaders() -> Shaders {
        Indirect::shaders()
    }

    fn reflectors<'a>(
        gbuffer: &GBuffer,
        surface: &'a Surface,
    ) -> Result<Reflectors<'a, Matte>, MissingAttribute> {
        Indirect::reflectors(gbuffer, surface)
    }

    fn arriving(met: Option<&Disk>, direction: Vec3) -> Vec3 {
        Indirect::arriving(met, direction)
    }
}
