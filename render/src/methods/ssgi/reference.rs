//! The slow, plain version of `light.wgsl`.

use crate::methods::{Surface, slices, surface::vector};
use deepshade_shaders::{Planes, wgsl::uniforms};
use glam::{IVec2, Vec3};

/// Irradiance over pi before the blur, `[3, height, width]`, of direct light that is reflected diffusely,
/// [`Attribute::DiffuseLight`](deepshade_shaders::Attribute::DiffuseLight): `light.wgsl`.
pub fn gather_light(surface: &Surface, diffuse_light: &Planes, settings: &uniforms::Slices) -> Planes {
    // The other side of a surface may be lit or not, but is not seen.
    let sent = |at: IVec2, toward: Vec3| {
        let faces = surface.normal_at(at).dot(toward) < 0.0;
        if faces { vector(diffuse_light, at) } else { Vec3::ZERO }
    };
    surface.image(0.0, |pixel| slices::gather(surface, settings, pixel, sent).light.to_array())
}
