//! Environment maps: radiance from infinitely far away as an equirectangular image, from HDR or EXR files.

use glam::Vec3;

/// Radiance for every direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    width: usize,
    height: usize,
    /// Row by row from the top, RGB.
    texels: Vec<Vec3>,
    /// Turned about the world's y axis, radians.
    rotation: f32,
}
