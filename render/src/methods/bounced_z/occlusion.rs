//! Ambient occlusion by a bounced z-buffer: the light of a white sky that nothing within the radius hides.

use super::passes::{Arrives, Rays};
use super::reference::{Arriving, shade};
use super::{BouncedZParameters, Matte};
use crate::methods::disks::{DiskEffect, SURFACE};
use deepshade_shaders::Effect;
use deepshade_shaders::wgsl::Shader;
use glam::Vec3;

/// What of a white sky arrives past disks.
pub const SKY: Arriving<'_> =
    Arriving { effect: Effect::Ao, of: &|met, _| if met.is_some() { Vec3::ZERO } else { Vec3::ONE } };

/// The effect `ao`.
pub const OCCLUSION: DiskEffect<BouncedZParameters> = DiskEffect {
    effect: Effect::Ao,
    attributes: SURFACE,
    lit: None,
    passes: Rays {
        trace: Shader::at("methods/bounced-z/trace"),
        arrives: Arrives::OfSurfels(Shader::at("methods/bounced-z/sky")),
        filter: Shader::at("methods/bounced-z/filter"),
    },
    plain: |plain, disks| {
        let matte = Matte::all_over(plain.surface);
        Ok(shade(plain.surface, &matte, disks, &SKY, (plain.parameters, plain.view)))
    },
    on_processor: None,
};
