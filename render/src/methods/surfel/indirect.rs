//! Diffuse indirect light by surfels (thesis 4.3): the sum of what they send. Of `gi` that is what they reflect once of the
//! scene's lights, with shadows; of `phosphor-gi` what they give back of light that they kept, each part of all surface with
//! states of its own.
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

/// The effect `gi`.
#[derive(Clone, Copy, Debug)]
pub struct Indirect;

/// The effect `phosphor-gi`.
#[derive(Clone, Copy, Debug)]
pub struct KeptLight;

/// `gi`, compiled for a device.
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

impl SurfelEffect for KeptLight {
    const EFFECT: Effect = Effect::PhosphorGi;

    fn shaders() -> passes::Shaders {
        passes::Shaders { lit: Some(Lit::Kept), ..Indirect::shaders() }
    }

    fn plain(plain: &Plain<'_>, disks: Vec<Disk>) -> Result<Planes, MissingAttribute> {
        Indirect::plain(plain, disks)
    }
}
