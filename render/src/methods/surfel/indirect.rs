//! Diffuse indirect light of one bounce by surfels (thesis 4.3): the sum of what they send, lit by the scene's lights
//! with shadows.
//!
//! Unlike the paper's, shells are as wide for a dim surfel as for a bright one, so that the threshold has no unit;
//! surfels without light are left out.

use super::around::Ending;
use super::{Plain, Surfel, SurfelEffect, passes, reference};
use crate::screen::Compiled;
use crate::surfels::reference::Disk;
use crate::surfels::{Lit, Tree};
use deepshade_shaders::wgsl;
use deepshade_shaders::{Effect, MissingAttribute, Planes};

/// The effect.
#[derive(Clone, Copy, Debug)]
pub struct Indirect;

/// The method, compiled for a device.
pub type SurfelIndirect = Compiled<Surfel<Indirect>>;

impl SurfelEffect for Indirect {
    const EFFECT: Effect = Effect::Gi;

    fn shaders() -> passes::Shaders {
        passes::Shaders {
            tree: Tree::Lit,
            splat: &wgsl::SURFEL_LIGHT,
            add: &wgsl::SURFEL_INDIRECT,
            channels: 3,
            lit: Some(Lit::Reflected),
            ending: Ending::Sum,
        }
    }

    fn plain(plain: &Plain<'_>, disks: Vec<Disk>) -> Result<Planes, MissingAttribute> {
        Ok(reference::sums(plain.surface, &disks, reference::LIGHT, plain.parameters, plain.view))
    }
}
