//! Ambient occlusion by a bounced z-buffer: the light of a white sky that nothing within the radius hides.

use super::{BouncedEffect, BouncedZ};
use crate::screen::Compiled;
use crate::surfels::reference::Disk;
use deepshade_shaders::Effect;
use deepshade_shaders::wgsl::{self, Shader};
use glam::Vec3;

/// The effect.
#[derive(Clone, Copy, Debug)]
pub struct Occlusion;

/// The method, compiled for a device.
pub type BouncedOcclusion = Compiled<BouncedZ<Occlusion>>;

impl BouncedEffect for Occlusion {
    const EFFECT: Effect = Effect::Ao;
    const LIT: bool = false;

    fn shader() -> &'static Shader {
        &wgsl::BOUNCED_SKY
    }

    fn arriving(met: Option<&Disk>, _direction: Vec3) -> Vec3 {
        if met.is_some() { Vec3::ZERO } else { Vec3::ONE }
    }
}
