//! Shells around surfels and the levels of the interleaved framebuffer that they are splatted to (thesis
//! 4.2.2).

use super::SurfelParameters;
use crate::screen::View;
use deepshade_shaders::random::hash;
use deepshade_shaders::wgsl::uniforms;
use glam::UVec2;

/// Over its radius, the distance of a disk at which its form factor is a threshold, seen face to face:
/// `r^2 / (r^2 + d^2)`.
pub fn reach(threshold: f32) -> f32 {
    (1.0 / threshold - 1.0).sqrt()
}

/// What the passes of a level read. A surfel does something worth the threshold up to [`reach`] times its
/// radius, as it is; on level l it stands for 4^l, so that the shell is 2^l times as large.
pub fn level(parameters: &SurfelParameters, level: u32, view: &View) -> uniforms::SplatLevel {
    let (enlarged, reach) = ((1u32 << level) as f32, reach(parameters.threshold));
    uniforms::SplatLevel {
        width: view.width as u32,
        height: view.height as u32,
        level,
        seed: view.seed,
        last: u32::from(level + 1 == parameters.levels),
        nearest: if level == 0 { 0.0 } else { 0.5 * enlarged * reach },
        farthest: enlarged * reach,
        stands_for: enlarged * enlarged,
        reach: view.radius,
    }
}

/// A number below `4^level` for each, all different: a bijection for each key. `shared/interleaved.wgsl`.
pub fn permuted(number: u32, level: u32, key: u32) -> u32 {
    let mask = (1 << (2 * level)) - 1;
    let shift = level.max(1);
    let mut it = (number ^ key) & mask;
    it = it.wrapping_mul((key >> 8) | 1) & mask;
    it ^= it >> shift;
    it = it.wrapping_mul((key >> 16) | 1) & mask;
    it ^ (it >> shift)
}

/// What the order of the sub-buffers' pixels in a block follows from.
pub fn key(place: UVec2, level: u32, seed: u32) -> u32 {
    let rest = hash(level.wrapping_add(hash(seed)));
    hash(place.x.wrapping_add(hash(place.y.wrapping_add(rest))))
}

/// The pixel that has this place in a sub-buffer.
pub fn pixel(sub_buffer: u32, place: UVec2, level: u32, seed: u32) -> UVec2 {
    pixel_of(sub_buffer, place, level, key(place, level, seed))
}

/// The pixel that has this place, of a block with this key, in a sub-buffer.
pub fn pixel_of(sub_buffer: u32, place: UVec2, level: u32, key: u32) -> UVec2 {
    let part = permuted(sub_buffer, level, key);
    (place << level) + UVec2::new(part & ((1 << level) - 1), part >> level)
}
