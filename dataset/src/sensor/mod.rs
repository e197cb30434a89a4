//! A model of an RGBD camera: what it makes of what a perfect one would see, so that a network is trained on
//! what photographs bring.
//!
//! Every random number is drawn by the frame's seed and the pixel.

mod colour;
mod depth;
mod normal;

pub use depth::axial_noise;

use crate::capture::{self, Intrinsics};
use deepshade_render::scene::Camera;
use deepshade_shaders::{GBuffer, Planes};
use serde::{Deserialize, Serialize};

/// A kind of RGBD camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sensor {
    /// A projector of infrared dots beside an infrared camera, as in the first Kinect, with a small colour
    /// camera.
    StructuredLight,
}

impl Sensor {
    /// What is known of the surfaces of a frame: depth with noise and holes, and what follows from it, as of
    /// a real capture. Of `seen` the positions, normals and validity are read; the result holds
    /// [`capture::surface::ATTRIBUTES`].
    ///
    /// # Panics
    /// If `seen` lacks one of these.
    pub fn surface(self, seen: &GBuffer, camera: &Camera, seed: u32) -> GBuffer {
        let Self::StructuredLight = self;
        let intrinsics = Intrinsics::of(camera, [seen.height(), seen.width()]);
        capture::surface(&depth::measured(seen, &intrinsics, seed), &intrinsics)
    }

    /// The photograph of some radiance, `[3, height, width]`: radiance again, with noise, clipped and in
    /// steps of a byte.
    pub fn photograph(self, radiance: &Planes, seed: u32) -> Planes {
        let Self::StructuredLight = self;
        colour::photograph(radiance, seed)
    }
}

#[cfg(test)]
mod tests;
