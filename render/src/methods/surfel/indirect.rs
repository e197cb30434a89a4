//! Diffuse indirect light by surfels (thesis 4.3): the sum of what they send. Of `gi` that is what they
//! reflect once of the scene's lights, with shadows; of `phosphor-gi` what they give back of light that they
//! kept, each part of all surface with states of its own.
//!
//! Unlike the paper's, shells are as wide for a dim surfel as for a bright one, so that the threshold has no
//! unit; surfels without light are left out.

use super::around::Ending;
use super::reference::{self, LIGHT};
use super::{SurfelParameters, passes::Shading, splat};
use crate::methods::disks::{DiskEffect, SURFACE};
use crate::surfels::{SurfelLight, Tree};
use deepshade_shaders::Effect;
use deepshade_shaders::wgsl::Shader;

/// The effect `gi`.
pub const INDIRECT: DiskEffect<SurfelParameters> = DiskEffect {
    effect: Effect::Gi,
    attributes: SURFACE,
    lit: Some(SurfelLight::Reflected),
    passes: Shading {
        tree: Tree::Lit,
        splat: Shader::at("methods/surfel/light"),
        add: Shader::at("methods/surfel/indirect"),
        channels: 3,
        ending: Ending::Sum,
    },
    plain: |plain, disks| Ok(reference::sums(plain.surface, disks, LIGHT, plain.parameters, plain.view)),
    on_processor: Some(|plain, disks| splat::light(plain.surface, disks, plain.parameters, plain.view)),
};

/// The effect `phosphor-gi`.
pub const KEPT_LIGHT: DiskEffect<SurfelParameters> =
    DiskEffect { effect: Effect::PhosphorGi, lit: Some(SurfelLight::Kept), ..INDIRECT };
