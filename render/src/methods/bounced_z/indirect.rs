//! Diffuse indirect light of one bounce by a bounced z-buffer: what the nearest surfels send, lit by the scene's lights with
//! shadows. Surfels without light hide those behind them, so none is left out.

use super::{BouncedEffect, BouncedZ};
use crate::screen::Compiled;
use crate::surfels::reference::Disk;
use deepshade_shaders::Effect;
use deepshade_shaders::wgsl::{self, Shader};
use glam::Vec3;

/// The effect.
#[derive(Clone, Copy, Debug)]
pub struct Indirect;

/// The method, compiled for a device.
pub type BouncedIndirect = Compiled<BouncedZ<Indirect>>;

impl BouncedEffect for Indirect {
    const EFFECT: Effect = Effect::Gi;
    const LIT: bool = true;

    fn shader() -> &'static Shader {
        &wgsl::BOUNCED_LIGHT
    }

    fn arriving(met: Option<&Disk>, direction: Vec3) -> Vec3 {
        let sent = |disk: &Disk| disk.sent[usize::from(direction.dot(disk.normal) >= 0.0)];
        met.map_or(Vec3::ZERO, sent)
    }
}
