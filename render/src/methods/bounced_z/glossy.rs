//! Glossy indirect light by a bounced z-buffer: what a surface's specular lobe reflects to the eye of what
//! the nearest surfels send. Directions are spread as the lobe's visible microfacets mirror the eye's.

use super::BouncedZParameters;
use super::indirect::LIGHT;
use super::passes::{Arrives, Rays};
use super::reference::{Arriving, shade};
use crate::methods::disks::DiskEffect;
use crate::methods::lobe::{self, Gloss};
use crate::surfels::SurfelLight;
use deepshade_shaders::Effect;
use deepshade_shaders::wgsl::Shader;
use glam::Vec3;

/// The effect `glossy`.
pub const GLOSSY: DiskEffect<BouncedZParameters> = DiskEffect {
    effect: Effect::Glossy,
    attributes: lobe::ATTRIBUTES,
    lit: Some(SurfelLight::Reflected),
    passes: Rays {
        trace: Shader::at("methods/bounced-z/glossy_trace"),
        arrives: Arrives::OfSurfels(Shader::at("methods/bounced-z/light")),
        filter: Shader::at("methods/bounced-z/glossy_filter"),
    },
    plain: |plain, disks| {
        let (gloss, surface) = (Gloss::of(plain.gbuffer)?, plain.surface);
        let lobe = |at| gloss.lobe_at(surface, at).filter(|lobe| lobe.usual_colour() != Vec3::ZERO);
        let arriving = Arriving { effect: Effect::Glossy, ..LIGHT };
        Ok(shade(surface, &lobe, disks, &arriving, (plain.parameters, plain.view)))
    },
    on_processor: None,
};
