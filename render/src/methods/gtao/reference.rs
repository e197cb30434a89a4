//! The slow, plain version of `occlusion.wgsl`.

use crate::methods::{Surface, slices};
use deepshade_shaders::{Planes, wgsl::uniforms};
use glam::Vec3;

/// Openness before the blur, `[1, height, width]`: `occlusion.wgsl`.
pub fn occlude(surface: &Surface, settings: &uniforms::Slices) -> Planes {
    // Only what is covered counts.
    let sent = |_, _| Vec3::ZERO;
    surface.image(1.0, |pixel| [slices::gather(surface, settings, pixel, sent).open])
}
