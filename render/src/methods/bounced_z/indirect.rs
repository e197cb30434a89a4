//! Diffuse indirect light of one bounce by a bounced z-buffer: what the nearest surfels send, lit by the scene's lights
//! with shadows. Surfels without light hide those behind them, so none is left out.

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

/// The effect.
#[derive(Clone, Copy, Debug)]
pub struct Indirect;

/// The method, compiled for a device.
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
