//! The g-buffer of a scene and a camera, by one ray through the middle of every pixel: of a pinhole, in the
//! middle of the exposure, whatever lens and motion blur what is made from it.

use crate::bvh::{TracedScene, bundle::BUNDLE};
use crate::intersection::SurfacePoint;
use crate::path::direct::{DirectLight, direct_light};
use crate::scene::Camera;
use deepshade_shaders::{Attribute, GBuffer, Planes};
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::f32::consts::PI;

/// Edge of the squares of pixels whose rays are traced together.
const TILE: usize = BUNDLE.isqrt();

/// Ids are modulo this, so that half floats hold them exactly.
pub const OBJECT_IDS: u32 = 2048;

/// Renders some attributes. Where nothing is seen, all of them are 0.
pub fn render(
    scene: &TracedScene,
    camera: &Camera,
    height: usize,
    width: usize,
    attributes: &[Attribute],
) -> GBuffer {
    let channels: usize = attributes.iter().map(|attribute| attribute.width()).sum();
    let lit = attributes.iter().any(|a| matches!(a, Attribute::Light | Attribute::DiffuseLight));
    let mut pixels = vec![0.0; channels * height * width];
    // Pixel by pixel first, since a ray gives all channels at once; planes afterwards.
    pixels.par_chunks_mut((channels * width * TILE).max(1)).enumerate().for_each(|(band, rows)| {
        for left in (0..width).step_by(TILE) {
            let columns = left..width.min(left + TILE);
            let inside =
                (0..rows.len() / (channels * width)).flat_map(|y| columns.clone().map(move |x| (x, y)));
            let direction = |(x, y): (usize, usize)| {
                let pixel = Vec2::new(x as f32 + 0.5, (band * TILE + y) as f32 + 0.5);
                camera.direction(pixel, height, width)
            };
            let directions: Vec<Vec3> = inside.clone().map(direction).collect();
            let hits = scene.hit_bundle(camera.position, &directions);
            for (((x, y), direction), hit) in inside.zip(&directions).zip(hits) {
                let Some(hit) = hit else { continue };
                let point = SurfacePoint::new(scene, &hit, *direction);
                let to_camera = -*direction;
                let direct = if lit { direct_light(scene, &point, to_camera) } else { Default::default() };
                let seen = PixelHit { camera, height, point: &point, to_camera, direct };
                let values = &mut rows[(y * width + x) * channels..][..channels];
                write_pixel(values, attributes, &seen);
            }
        }
    });
    let planes = Planes::from_fn(channels, height, width, |c, y, x| pixels[(y * width + x) * channels + c]);
    GBuffer::new(attributes.to_vec(), planes)
}

/// What a pixel sees.
struct PixelHit<'a> {
    camera: &'a Camera,
    /// Rows of the image.
    height: usize,
    point: &'a SurfacePoint,
    to_camera: Vec3,
    direct: DirectLight,
}

impl PixelHit<'_> {
    /// An attribute; components beyond its width are not used.
    fn value(&self, attribute: Attribute) -> Vec3 {
        let Self { camera, height, point, .. } = *self;
        let position = camera.to_camera(point.position);
        let depth = -position.z;
        match attribute {
            Attribute::Position => position,
            Attribute::Normal => camera.direction_to_camera(point.normal),
            Attribute::WorldNormal => point.normal,
            Attribute::ToCamera => self.to_camera,
            Attribute::Diffuse => point.surface.diffuse,
            Attribute::Specular => point.surface.specular,
            Attribute::MeanFreePath => point.surface.mean_free_path,
            Attribute::Light => self.direct.diffuse + self.direct.specular,
            Attribute::DiffuseLight => self.direct.diffuse,
            Attribute::Emission => point.surface.emission,
            Attribute::Depth => Vec3::splat(depth),
            Attribute::FocalDistance => Vec3::splat(camera.focal_distance(depth)),
            Attribute::CircleOfConfusion => Vec3::splat(camera.circle_of_confusion(depth, height)),
            Attribute::Blurriness => {
                Vec3::splat(camera.focal_distance(depth) * camera.blur_at_infinity(height))
            }
            Attribute::Glossiness => Vec3::splat(1.0 - point.surface.roughness),
            Attribute::Motion => {
                let displacement = camera.direction_to_camera(point.displacement);
                polar(movement(camera, height, position, displacement)).extend(0.0)
            }
            Attribute::ObjectId => Vec3::splat((point.mesh % OBJECT_IDS) as f32),
            Attribute::Valid => Vec3::ONE,
            // Nothing that a scene has.
            Attribute::Openness
            | Attribute::RawOpenness
            | Attribute::Estimate
            | Attribute::Relief
            | Attribute::PixelRadius
            | Attribute::Border
            | Attribute::SignedCircle
            | Attribute::Movement
            | Attribute::FreePathPixels => Vec3::ZERO,
        }
    }
}

/// Movement in the image, in pixels, x to the right and y up, of a point that is displaced while the shutter
/// is open: from where it is seen at the beginning to where at the end. Where it would be behind the camera
/// then, as it moves in the middle.
fn movement(camera: &Camera, height: usize, position: Vec3, displacement: Vec3) -> Vec2 {
    // The image's width moves both ends alike.
    let seen_at = |time: f32| camera.project(position + displacement * time, height, 0);
    match (seen_at(-0.5), seen_at(0.5)) {
        (Some(before), Some(after)) => Vec2::new(after.x - before.x, before.y - after.y),
        _ => {
            let depth = -position.z;
            let across = displacement + position * (displacement.z / depth);
            across.truncate() * (camera.focal_length(height) / depth)
        }
    }
}

/// Direction in [0, pi) and length of a movement: its sign is lost, since the shutter is the same in both
/// directions of time (thesis 7.3.1).
fn polar(movement: Vec2) -> Vec2 {
    let direction = movement.y.atan2(movement.x).rem_euclid(PI);
    // Rounding may give pi itself, which is the direction 0.
    Vec2::new(if direction < PI { direction } else { 0.0 }, movement.length())
}

fn write_pixel(values: &mut [f32], attributes: &[Attribute], seen: &PixelHit<'_>) {
    let mut at = 0;
    for attribute in attributes {
        let width = attribute.width();
        values[at..at + width].copy_from_slice(&seen.value(*attribute).to_array()[..width]);
        at += width;
    }
}

#[cfg(test)]
mod tests;
