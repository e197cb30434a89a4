//! The slow, plain version of `occlusion.wgsl`, and the blur.

use super::Settings;
use crate::methods::{Surface, march, slices};
use deepshade_shaders::{Planes, wgsl::uniforms};
use glam::Vec3;

/// Openness before the blur, after that along rows, and after both, `[1, height, width]` each.
pub fn shade(surface: &Surface, settings: &Settings) -> [Planes; 3] {
    march::blurred(surface, &settings.blurs, occlude(surface, &settings.march))
}

/// Openness before the blur, `[1, height, width]`: `occlusion.wgsl`.
pub fn occlude(surface: &Surface, settings: &uniforms::Slices) -> Planes {
    // Only what is covered counts.
    let sent = |_, _| Vec3::ZERO;
    surface.image(1.0, |pixel| [slices::gather(surface, settings, pixel, sent).open])
}
