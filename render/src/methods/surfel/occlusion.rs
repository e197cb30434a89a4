//! Ambient occlusion by surfels (thesis 4.3): the sum of their form factors.

use super::{Parameters, Surfel, SurfelEffect, passes, reference};
use crate::bvh::TracedScene;
use crate::methods::Surface;
use crate::screen::{Compiled, View};
use crate::surfels::reference::Disk;
use deepshade_shaders::wgsl;
use deepshade_shaders::{Effect, Planes};

/// The effect.
#[derive(Clone, Copy, Debug)]
pub struct Occlusion;

/// The method, compiled for a device.
pub type SurfelOcclusion = Compiled<Surfel<Occlusion>>;

impl SurfelEffect for Occlusion {
    const EFFECT: Effect = Effect::Ao;

    fn shaders() -> passes::Shaders {
        passes::Shaders {
            leaves: &wgsl::SURFELS_LEAVES,
            splat: &wgsl::SURFEL_OCCLUSION,
            add: &wgsl::SURFEL_OPENNESS,
            lit: false,
        }
    }

    fn plain(
        surface: &Surface,
        _scene: &TracedScene,
        disks: Vec<Disk>,
        parameters: &Parameters,
        view: &View,
    ) -> Planes {
        reference::openness(surface, &disks, parameters, view)
    }
}
