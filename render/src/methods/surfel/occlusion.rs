//! Ambient occlusion by surfels (thesis 4.3): the sum of their form factors.

use super::around::Ending;
use super::{SurfelParameters, passes::Shading, reference};
use crate::methods::disks::{DiskEffect, SURFACE};
use crate::surfels::Tree;
use deepshade_shaders::Effect;
use deepshade_shaders::wgsl::Shader;

/// The effect `ao`.
pub const OCCLUSION: DiskEffect<SurfelParameters> = DiskEffect {
    effect: Effect::Ao,
    attributes: SURFACE,
    lit: None,
    passes: Shading {
        tree: Tree::All,
        splat: Shader::at("methods/surfel/occlusion"),
        add: Shader::at("methods/surfel/openness"),
        channels: 1,
        ending: Ending::Sum,
    },
    plain: |plain, disks| Ok(reference::openness(plain.surface, disks, plain.parameters, plain.view)),
    on_processor: None,
};
