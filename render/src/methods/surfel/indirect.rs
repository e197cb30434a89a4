//! Diffuse indirect light of one bounce by surfels (thesis 4.3): the sum of what they send, lit by the scene's lights with
//! shadows.
//!
//! Unlike the paper's, shells are as wide for a dim surfel as for a bright one, so that the threshold has no unit; surfels
//! without light are left out.

use super::around::Ending;
use super::{Plain, Surfel, SurfelEffect, passes, reference};
use crate::screen::Compiled;
use crate::surfels::reference::{Disk, lit};
use crate::surfels::{Lit, patches};
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
            leaves: &wgsl::SURFELS_LIT_LEAVES,
            splat: &wgsl::SURFEL_LIGHT,
            add: &wgsl::SURFEL_INDIRECT,
            channels: 3,
            lit: Some(Lit::Reflected),
            ending: Ending::Sum,
        }
    }

    fn plain(plain: &Plain<'_>, disks: Vec<Disk>) -> Result<Planes, MissingAttribute> {
        let Plain { surface, scene, parameters, view, .. } = *plain;
        let disks = lit(scene, &patches::of_scene(scene.scene()), disks, &view.camera);
        Ok(reference::sums(surface, &disks, reference::LIGHT, parameters, view))
    }
}
