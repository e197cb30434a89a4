//! Ambient occlusion by surfels (thesis 4.3): the sum of their form factors.

use super::around::Ending;
use super::{Plain, Surfel, SurfelEffect, passes, reference};
use crate::screen::Compiled;
use crate::surfels::Tree;
use crate::surfels::reference::Disk;
use deepshade_shaders::wgsl;
use deepshade_shaders::{Effect, MissingAttribute, Planes};

/// The effect.
#[derive(Clone, Copy, Debug)]
pub struct Occlusion;

/// The method, compiled for a device.
pub type SurfelOcclusion = Compiled<Surfel<Occlusion>>;

impl SurfelEffect for Occlusion {
    const EFFECT: Effect = Effect::Ao;

    fn shaders() -> passes::Shaders {
        passes::Shaders {
            tree: Tree::All,
            splat: &wgsl::SURFEL_OCCLUSION,
            add: &wgsl::SURFEL_OPENNESS,
            channels: 1,
            lit: None,
            ending: Ending::Sum,
        }
    }

    fn plain(plain: &Plain<'_>, disks: Vec<Disk>) -> Result<Planes, MissingAttribute> {
        Ok(reference::openness(plain.surface, &disks, plain.parameters, plain.view))
    }
}
