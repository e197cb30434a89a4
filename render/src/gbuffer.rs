//! The g-buffer of a scene and a camera, by one ray through the middle of every pixel.

use crate::bvh::{TracedScene, bundle::BUNDLE};
use crate::intersection::SurfacePoint;
use crate::path::direct::direct_light;
use crate::scene::Camera;
use deepshade_shaders::{Attribute, GBuffer, Planes};
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// Edge of the squares of pixels whose rays are traced together.
const TILE: usize = BUNDLE.isqrt();

/// Ids are modulo this, so that half floats hold them exactly.
const OBJECT_IDS: u32 = 2048;

/// The attributes that a scene and a camera determine; lens, motion and scattering attributes need more.
pub const RENDERED: [Attribute; 13] = [
    Attribute::Position,
    Attribute::Normal,
    Attribute::WorldNormal,
    Attribute::Depth,
    Attribute::ToCamera,
    Attribute::Diffuse,
    Attribute::Specular,
    Attribute::Glossiness,
    Attribute::Light,
    Attribute::DiffuseLight,
    Attribute::ObjectId,
    Attribute::Emission,
    Attribute::Valid,
];

/// Renders some attributes. Where nothing is seen, all of them are 0.
///
/// # Panics
/// If an attribute is not one of [`RENDERED`].
pub fn render(
    scene: &TracedScene,
    camera: &Camera,
    height: usize,
    width: usize,
    attributes: &[Attribute],
) -> GBuffer {
    assert!(attributes.iter().all(|attribute| RENDERED.contains(attribute)), "attributes that are rendered");
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
                let values = &mut rows[(y * width + x) * channels..][..channels];
                write_pixel(values, attributes, &Seen::new(scene, camera, &point, *direction, lit));
            }
        }
    });
    let planes = Planes::from_fn(channels, height, width, |c, y, x| pixels[(y * width + x) * channels + c]);
    GBuffer::new(attributes.to_vec(), planes)
}

/// What a pixel sees, in the spaces of the attributes.
struct Seen<'a> {
    point: &'a SurfacePoint,
    position: Vec3,
    normal: Vec3,
    to_camera: Vec3,
    light: Vec3,
    diffuse_light: Vec3,
}

impl<'a> Seen<'a> {
    fn new(
        scene: &TracedScene,
        camera: &Camera,
        point: &'a SurfacePoint,
        direction: Vec3,
        lit: bool,
    ) -> Self {
        let direct = if lit { direct_light(scene, point, -direction) } else { Default::default() };
        Self {
            point,
            position: camera.to_camera(point.position),
            normal: camera.direction_to_camera(point.normal),
            to_camera: -direction,
            light: direct.diffuse + direct.specular,
            diffuse_light: direct.diffuse,
        }
    }
}

fn write_pixel(values: &mut [f32], attributes: &[Attribute], seen: &Seen<'_>) {
    let surface = &seen.point.surface;
    let mut at = 0;
    for attribute in attributes {
        let value = match attribute {
            Attribute::Position => seen.position,
            Attribute::Normal => seen.normal,
            Attribute::WorldNormal => seen.point.normal,
            Attribute::ToCamera => seen.to_camera,
            Attribute::Diffuse => surface.diffuse,
            Attribute::Specular => surface.specular,
            Attribute::Light => seen.light,
            Attribute::DiffuseLight => seen.diffuse_light,
            Attribute::Emission => surface.emission,
            Attribute::Depth => Vec3::splat(-seen.position.z),
            Attribute::Glossiness => Vec3::splat(1.0 - surface.roughness),
            Attribute::ObjectId => Vec3::splat((seen.point.mesh % OBJECT_IDS) as f32),
            Attribute::Valid => Vec3::ONE,
            Attribute::FocalDistance
            | Attribute::CircleOfConfusion
            | Attribute::MeanFreePath
            | Attribute::Motion => unreachable!("checked by render"),
        };
        let width = attribute.width();
        values[at..at + width].copy_from_slice(&value.to_array()[..width]);
        at += width;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Material, Mesh, Scene};

    /// A square of 2 x 2 m in the plane z = 0 that faces +z.
    fn square() -> TracedScene {
        let mesh = Mesh {
            positions: [(-1., -1.), (1., -1.), (1., 1.), (-1., 1.)]
                .map(|(x, y)| Vec3::new(x, y, 0.0))
                .to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        let materials = vec![Material::matte("red", Vec3::new(0.8, 0.1, 0.2))];
        TracedScene::new(Scene { meshes: vec![mesh], materials, ..Scene::default() }).expect("a square")
    }

    #[test]
    fn a_square_seen_aslant_has_the_plane_it_lies_in() {
        let scene = square();
        let camera = Camera::look_at(Vec3::new(1.0, 0.5, 2.0), Vec3::ZERO);
        let gbuffer = render(&scene, &camera, 33, 47, &RENDERED);
        let all =
            gbuffer.select(&[Attribute::Position, Attribute::Normal, Attribute::Depth, Attribute::Valid]);
        let all = all.expect("all rendered");
        let plane_normal = camera.direction_to_camera(Vec3::Z);
        let origin = camera.to_camera(Vec3::ZERO);
        let mut seen = 0;
        for y in 0..33 {
            for x in 0..47 {
                let at = |first| Vec3::from_array(std::array::from_fn(|c| all.at(first + c, y, x)));
                if all.at(7, y, x) == 0.0 {
                    assert!(all.at(6, y, x) == 0.0 && at(0) == Vec3::ZERO);
                    continue;
                }
                seen += 1;
                assert!((at(3) - plane_normal).length() < 1e-5);
                assert!((at(0) - origin).dot(plane_normal).abs() < 1e-5);
                assert!((all.at(6, y, x) + at(0).z).abs() < 1e-6);
                let towards = at(0).normalize();
                let world = camera.direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5), 33, 47);
                assert!((towards - camera.direction_to_camera(world)).length() < 1e-5);
            }
        }
        assert!(seen > 300 && seen < 33 * 47, "{seen} pixels see the square");
    }

    #[test]
    fn every_pixel_shows_what_its_own_ray_meets() {
        let scene = crate::scene::procedural::Family::Room.scene(1);
        let scene = TracedScene::new(scene).expect("a room");
        let camera = Camera::look_at(scene.bounds().centre(), scene.bounds().min);
        let (height, width) = (37, 51);
        let gbuffer = render(&scene, &camera, height, width, &[Attribute::Depth]);
        for y in 0..height {
            for x in 0..width {
                let direction = camera.direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5), height, width);
                let hit = scene.hit(camera.position, direction, f32::INFINITY);
                let depth =
                    hit.map_or(0.0, |hit| -camera.to_camera(camera.position + direction * hit.distance).z);
                let found = gbuffer.planes().at(0, y, x);
                assert!((found - depth).abs() < 1e-4 * depth.max(1.0), "({x}, {y}): {found} is not {depth}");
            }
        }
    }

    #[test]
    fn material_channels_are_the_materials() {
        let camera = Camera::look_at(Vec3::new(0.0, 0.0, 1.0), Vec3::ZERO);
        let gbuffer = render(&square(), &camera, 8, 8, &[Attribute::Diffuse, Attribute::Glossiness]);
        let values: Vec<f32> = (0..4).map(|c| gbuffer.planes().at(c, 4, 4)).collect();
        assert_eq!(values, vec![0.8, 0.1, 0.2, 0.0]);
    }
}
