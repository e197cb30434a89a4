//! Diffuse indirect light of one bounce by a bounced z-buffer: what the nearest surfels send, lit by the
//! scene's lights with shadows; of `phosphor-gi` what they give back of light that they kept. Surfels without
//! light hide those behind them, so none is left out.

use super::passes::{Arrives, Rays};
use super::reference::{Arriving, shade};
use super::{BouncedZParameters, Matte};
use crate::methods::disks::{DiskEffect, SURFACE};
use crate::methods::surfel::reference::sent;
use crate::surfels::SurfelLight;
use deepshade_shaders::Effect;
use deepshade_shaders::wgsl::Shader;
use glam::Vec3;

/// What disks send.
pub const LIGHT: Arriving<'_> =
    Arriving { effect: Effect::Gi, of: &|met, ray| met.map_or(Vec3::ZERO, |disk| sent(ray.direction, disk)) };

/// The effect `gi`.
pub const INDIRECT: DiskEffect<BouncedZParameters> = DiskEffect {
    effect: Effect::Gi,
    attributes: SURFACE,
    lit: Some(SurfelLight::Reflected),
    passes: Rays {
        trace: Shader::at("methods/bounced-z/trace"),
        arrives: Arrives::OfSurfels(Shader::at("methods/bounced-z/light")),
        filter: Shader::at("methods/bounced-z/filter"),
    },
    plain: |plain, disks| {
        let matte = Matte::all_over(plain.surface);
        Ok(shade(plain.surface, &matte, disks, &LIGHT, (plain.parameters, plain.view)))
    },
    on_processor: None,
};

/// The effect `phosphor-gi`.
pub const KEPT_LIGHT: DiskEffect<BouncedZParameters> =
    DiskEffect { effect: Effect::PhosphorGi, lit: Some(SurfelLight::Kept), ..INDIRECT };
