//! A scene by hand in which nothing is symmetric: a letter, blocks of several heights and a ball on a floor
//! of four colours, under a lamp, a spot and a sun, so that a mirrored or turned picture, texture or light is
//! another one.

use super::CrosscheckScene;
use deepshade_render::scene::{
    Camera, Encoding, Gloss, Light, Material, MaterialId, Mesh, Scene, Texture, TextureId, TextureSlot, Wrap,
};
use glam::{Affine2, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

const FLOOR: MaterialId = MaterialId(0);
const RED: MaterialId = MaterialId(1);
const GREEN: MaterialId = MaterialId(2);
const WHITE: MaterialId = MaterialId(3);

/// Nothing moves.
pub fn still() -> CrosscheckScene {
    let meshes = [floor()].into_iter().chain(letter()).chain(others()).collect();
    let camera = Camera::look_at(Vec3::new(1.4, 1.7, 3.1), Vec3::new(0.1, 0.45, 0.0));
    CrosscheckScene {
        scene: Scene { name: "blocks".into(), meshes, lights: lights(), ..look() },
        camera,
        radius: 0.8,
    }
}

/// The letter moves to the right, the ball upwards, and the tall block leans over.
pub fn moving() -> CrosscheckScene {
    let mut setting = still();
    let count = setting.scene.meshes.len();
    for (index, mesh) in setting.scene.meshes.iter_mut().enumerate() {
        let displacement = |position: &Vec3| match index {
            1..4 => Vec3::new(0.25, 0.0, 0.1),
            4 => Vec3::new(0.3 * position.y, 0.0, 0.0),
            _ => Vec3::new(0.0, 0.3, 0.0),
        };
        if (1..5).contains(&index) || index + 1 == count {
            mesh.displacements = mesh.positions.iter().map(displacement).collect();
        }
    }
    setting
}

/// The blocks are metals and a dielectric, smoother and rougher.
pub fn glossy() -> CrosscheckScene {
    let mut setting = still();
    for (id, metallic, roughness) in [(RED, 1.0, 0.3), (GREEN, 0.6, 0.5), (WHITE, 0.0, 0.35)] {
        let material = &mut setting.scene.materials[id.0 as usize];
        *material = Material { gloss: Gloss::Microfacets, metallic, roughness, ..material.clone() };
    }
    setting
}

/// Matte blocks on a floor of rough metal, which meets no other glossy surface.
pub fn polished() -> CrosscheckScene {
    let mut setting = still();
    let floor = &mut setting.scene.materials[FLOOR.0 as usize];
    *floor = Material {
        base_colour: Vec3::new(0.9, 0.7, 0.5).extend(1.0),
        gloss: Gloss::Microfacets,
        metallic: 1.0,
        roughness: 0.45,
        ..Material::matte("metal", Vec3::ONE)
    };
    setting
}

/// Materials and textures.
fn look() -> Scene {
    let matte = |name: &str, colour: Vec3| Material { gloss: Gloss::None, ..Material::matte(name, colour) };
    let texels = vec![[230, 40, 40, 255], [40, 200, 60, 255], [50, 60, 220, 255], [240, 230, 90, 255]];
    let texture = Texture::new(2, 2, texels, Encoding::Srgb, [Wrap::Repeat; 2]);
    let slot = TextureSlot { texture: TextureId(0), uv_set: 0, transform: Affine2::IDENTITY };
    Scene {
        materials: vec![
            Material { base_colour_texture: Some(slot), ..matte("floor", Vec3::splat(0.9)) },
            matte("red", Vec3::new(0.8, 0.2, 0.1)),
            matte("green", Vec3::new(0.2, 0.6, 0.3)),
            matte("white", Vec3::splat(0.75)),
        ],
        textures: vec![texture.into()],
        ..Scene::default()
    }
}

fn lights() -> Vec<Light> {
    let spot = Vec3::new(-1.6, 2.4, 1.1);
    let outer = 22f32.to_radians().cos();
    vec![
        Light::Point {
            position: Vec3::new(1.3, 2.1, 0.9),
            intensity: Vec3::new(4.0, 3.4, 2.6),
            range: f32::INFINITY,
        },
        // As sharp a cone as there is: renderers differ in how cones fade out.
        Light::Spot {
            position: spot,
            direction: (Vec3::new(0.2, 0.0, -0.2) - spot).normalize(),
            intensity: Vec3::new(3.0, 6.0, 9.0),
            range: f32::INFINITY,
            cos_inner: outer + 1e-4,
            cos_outer: outer,
            slide: None,
        },
        Light::Directional {
            direction: Vec3::new(0.5, -1.0, -0.7).normalize(),
            irradiance: Vec3::new(0.8, 0.7, 0.5),
            pattern: None,
        },
    ]
}

fn floor() -> Mesh {
    let corners = [(-2.0, 2.0), (2.0, 2.0), (2.0, -2.0), (-2.0, -2.0)];
    Mesh {
        material: FLOOR,
        positions: corners.map(|(x, z)| Vec3::new(x, 0.0, z)).to_vec(),
        // Not whole numbers, so that borders of the texture are seen.
        uvs: [corners.map(|(x, z)| Vec2::new(0.4 * x + 0.1, 0.3 * z + 0.2)).to_vec(), vec![]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

/// An F, of a stem and two bars.
fn letter() -> [Mesh; 3] {
    let bar = |x: [f32; 2], y: [f32; 2]| block(RED, Vec3::new(x[0], y[0], -0.3), Vec3::new(x[1], y[1], -0.1));
    [bar([-0.6, -0.4], [0.013, 1.1]), bar([-0.4, 0.2], [0.9, 1.1]), bar([-0.4, 0.0], [0.5, 0.7])]
}

fn others() -> [Mesh; 3] {
    [
        block(GREEN, Vec3::new(0.5, 0.0, -0.6), Vec3::new(0.8, 0.8, -0.2)),
        block(WHITE, Vec3::new(-1.2, 0.0, 0.4), Vec3::new(-0.5, 0.25, 0.8)),
        ball(WHITE, Vec3::new(0.6, 0.3, 0.6), 0.29),
    ]
}

/// An axis-aligned box.
fn block(material: MaterialId, min: Vec3, max: Vec3) -> Mesh {
    let corner = |i: u32| {
        let pick = |axis: usize| if i >> axis & 1 == 1 { max[axis] } else { min[axis] };
        Vec3::new(pick(0), pick(1), pick(2))
    };
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    Mesh {
        material,
        positions: (0..8).map(corner).collect(),
        triangles: faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect(),
        ..Mesh::default()
    }
}

/// A ball of flat facets.
fn ball(material: MaterialId, centre: Vec3, radius: f32) -> Mesh {
    const RINGS: u32 = 12;
    const SEGMENTS: u32 = 24;
    let vertex = |i: u32| {
        let (sin, cos) = (PI * (i / SEGMENTS) as f32 / RINGS as f32).sin_cos();
        let (x, z) = (TAU * (i % SEGMENTS) as f32 / SEGMENTS as f32).sin_cos();
        centre + radius * Vec3::new(x * sin, cos, z * sin)
    };
    let quad = |i: u32| {
        let (ring, segment) = (i / SEGMENTS * SEGMENTS, i % SEGMENTS);
        let next = (segment + 1) % SEGMENTS;
        let [a, b, c, d] = [ring + segment, ring + SEGMENTS + segment, ring + SEGMENTS + next, ring + next];
        // At the poles one of the two has no area.
        let (first, last) = (i < SEGMENTS, i >= (RINGS - 1) * SEGMENTS);
        [(!last).then_some([a, b, c]), (!first).then_some([a, c, d])].into_iter().flatten()
    };
    Mesh {
        material,
        positions: (0..(RINGS + 1) * SEGMENTS).map(vertex).collect(),
        triangles: (0..RINGS * SEGMENTS).flat_map(quad).collect(),
        ..Mesh::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_meshes_face_outwards() {
        for mesh in [block(RED, Vec3::ZERO, Vec3::ONE), ball(RED, Vec3::ONE, 0.5)] {
            let centre = mesh.bounds().centre();
            for triangle in 0..mesh.triangles.len() {
                let [a, b, c] = mesh.corners(triangle);
                assert!((b - a).cross(c - a).dot(a - centre) > 0.0, "triangle {triangle}");
            }
        }
    }

    #[test]
    fn what_moves_moves_and_the_floor_stays() {
        let moving = moving().scene.meshes;
        assert!(moving[0].displacements.is_empty());
        assert_eq!(moving.iter().filter(|mesh| !mesh.displacements.is_empty()).count(), 5);
    }
}
