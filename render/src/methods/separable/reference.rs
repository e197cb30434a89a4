//! The slow, plain version of `blur.wgsl`, kept so close to it that both can be read side by side.

use super::SeparableUniforms;
use crate::methods::Translucent;
use deepshade_shaders::{Planes, wgsl::uniforms};
use glam::IVec2;

/// Light scattered along rows, and along both, radiance, `[3, height, width]` each.
pub fn shade(surface: &Translucent, settings: &SeparableUniforms) -> [Planes; 2] {
    let [rows, columns] = &settings.passes;
    let light = surface.picture.image(|pixel| surface.picture.light_at(pixel));
    let half = scatter_along(surface, rows, &settings.taps, &light);
    let whole = scatter_along(surface, columns, &settings.taps, &half);
    [half, whole]
}

/// One of the two passes over `light`, `[3, height, width]`.
fn scatter_along(
    surface: &Translucent,
    settings: &uniforms::Separable,
    taps: &[[f32; 4]],
    light: &Planes,
) -> Planes {
    surface.image(light, |pixel, channel, mean_free_path| {
        gather_channel(surface, settings, taps, light, pixel, channel, mean_free_path)
    })
}

fn gather_channel(
    surface: &Translucent,
    settings: &uniforms::Separable,
    taps: &[[f32; 4]],
    unblurred: &Planes,
    pixel: IVec2,
    channel: usize,
    mean_free_path: f32,
) -> f32 {
    let at_pixel = |at: IVec2| unblurred.at(channel, at.y as usize, at.x as usize);
    let here = surface.position_at(pixel);
    let size = -here.z / settings.focal_length;
    let mut light = taps[0][1] * at_pixel(pixel);
    let mut weights = taps[0][1];
    for [distance, share, ..] in &taps[1..settings.taps as usize] {
        let offset = (distance * mean_free_path / size + 0.5).floor();
        for side in [-1, 1] {
            let at = pixel + side * offset as i32 * IVec2::new(settings.step_x, settings.step_y);
            if !surface.picture.contains(at) || !surface.picture.valid_at(at) {
                continue;
            }
            let farther = (surface.position_at(at).distance(here) - offset * size).max(0.0);
            let weight = share * (-settings.follow * farther / mean_free_path).exp();
            light += weight * at_pixel(at);
            weights += weight;
        }
    }
    light / weights
}
