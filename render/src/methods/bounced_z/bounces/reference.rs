//! Paths over disks in plain Rust: every ray against every disk.

use super::super::reference::{PixelRay, Ray, met, place_on_disk};
use super::super::{Matte, Reflector};
use super::BOUNCES;
use crate::raster::patches::Patch;
use crate::surfels::reference::Disk;
use deepshade_shaders::random::hash;
use deepshade_shaders::wgsl::uniforms;
use glam::Vec3;

/// The radiance that arrives along a ray which meets a disk: `bounce.wgsl`. `sky` is the environment's in
/// camera space.
pub fn light_of_path(
    bounces: &uniforms::Bounces,
    (disks, patches): (&[Disk], &[Patch]),
    sky: &impl Fn(Vec3) -> Vec3,
    ray: &PixelRay,
    first: &Disk,
) -> Vec3 {
    let PixelRay { pixel, number, mut direction } = *ray;
    let (mut share, mut disk) = (Vec3::ONE, first);
    for bounce in 0..BOUNCES {
        let is_back = direction.dot(disk.normal) >= 0.0;
        if is_back && !disk.open {
            break;
        }
        share *= patches[disk.patch as usize].colour();
        let normal = if is_back { -disk.normal } else { disk.normal };
        let spread = [bounces.directions, hash(bounces.seed.wrapping_add(bounce))];
        direction = Matte(normal).direction(place_on_disk(pixel, number, spread));
        match met(bounces, disks, &Ray { origin: disk.place, normal, direction }) {
            Some(next) => disk = next,
            None => return share * sky(direction),
        }
    }
    Vec3::ZERO
}
