//! Gathers shapes, materials and lights into a scene.

use super::random::Random;
use super::shape::Shape;
use crate::scene::{Light, Material, MaterialId, Mesh, Scene, Texture, TextureId, TextureSlot};
use glam::{Affine2, Vec2, Vec3, Vec4};
use std::sync::Arc;

/// Least area of a triangle, m^2: smaller ones have no direction that is worth anything.
const LEAST_AREA: f32 = 1e-10;

/// A scene in the making.
pub struct SceneBuilder {
    scene: Scene,
}

impl SceneBuilder {
    /// An empty scene.
    pub fn new(name: String) -> Self {
        Self { scene: Scene { name, ..Scene::default() } }
    }

    /// Adds a material.
    pub fn material(&mut self, material: Material) -> MaterialId {
        self.scene.materials.push(material);
        MaterialId(self.scene.materials.len() as u32 - 1)
    }

    /// A material that was added.
    pub fn get(&self, id: MaterialId) -> &Material {
        self.scene.material(id)
    }

    /// Adds a texture that is `width` metres wide.
    pub fn texture(&mut self, texture: Texture, width: f32) -> TextureSlot {
        self.scene.textures.push(Arc::new(texture));
        let texture = TextureId(self.scene.textures.len() as u32 - 1);
        TextureSlot { texture, uv_set: 0, transform: Affine2::from_scale(Vec2::splat(1.0 / width)) }
    }

    /// Adds a thing.
    pub fn add(&mut self, name: &str, material: MaterialId, shape: Shape) {
        if shape.triangles.is_empty() {
            return;
        }
        let mapped = self.scene.material(material).normal_texture.is_some();
        let mut mesh = Mesh {
            name: name.to_owned(),
            material,
            displacements: Vec::new(),
            tangents: if mapped { tangents(&shape) } else { Vec::new() },
            positions: shape.positions,
            normals: shape.normals,
            uvs: [shape.uvs, Vec::new()],
            colours: Vec::new(),
            triangles: shape.triangles,
        };
        let positions = &mesh.positions;
        mesh.triangles.retain(|triangle| {
            let [a, b, c] = triangle.map(|vertex| positions[vertex as usize]);
            0.5 * (b - a).cross(c - a).length() > LEAST_AREA
        });
        self.scene.meshes.push(mesh);
    }

    /// Adds a sun somewhere above.
    pub fn sun(&mut self, random: &mut Random) {
        let mut to_sun = random.direction();
        to_sun.y = to_sun.y.abs() + 0.4;
        let irradiance = Vec3::new(1.0, 0.95, 0.85) * random.within(2.0, 4.0);
        self.scene.lights.push(Light::Directional {
            direction: -to_sun.normalize(),
            irradiance,
            pattern: None,
        });
    }

    /// Adds a lamp at a point.
    pub fn lamp(&mut self, position: Vec3, random: &mut Random) {
        let warmth = random.unit();
        let colour = Vec3::new(1.0, 0.95 - 0.25 * warmth, 0.9 - 0.5 * warmth);
        let intensity = colour * random.within(4.0, 12.0);
        self.scene.lights.push(Light::Point { position, intensity, range: f32::INFINITY });
    }

    /// The scene.
    pub fn finish(self) -> Scene {
        self.scene
    }
}

/// Many shapes of a few materials, which become one mesh a material.
pub struct ShapesByMaterial {
    parts: Vec<(MaterialId, Shape)>,
}

impl ShapesByMaterial {
    /// No shapes of these materials, of which there is at least one.
    pub fn new(materials: Vec<MaterialId>) -> Self {
        Self { parts: materials.into_iter().map(|material| (material, Shape::default())).collect() }
    }

    /// Puts a shape with one of the materials by chance.
    pub fn put(&mut self, shape: Shape, random: &mut Random) {
        let material = random.count(0, self.parts.len() - 1);
        self.parts[material].1.join(shape);
    }

    /// Adds all shapes to the scene.
    pub fn add_to(self, builder: &mut SceneBuilder, name: &str) {
        for (material, shape) in self.parts {
            builder.add(name, material, shape);
        }
    }
}

/// Tangents along u, averaged over the triangles around each vertex (glTF 2.0: the bitangent's sign is in w;
/// texture coordinates' origin is top left, so the bitangent of the map's green channel points against v).
fn tangents(shape: &Shape) -> Vec<Vec4> {
    let mut along_u = vec![Vec3::ZERO; shape.positions.len()];
    let mut along_v = along_u.clone();
    for triangle in &shape.triangles {
        let [a, b, c] = triangle.map(|vertex| shape.positions[vertex as usize]);
        let [ta, tb, tc] = triangle.map(|vertex| shape.uvs[vertex as usize]);
        let (edge, other) = (tb - ta, tc - ta);
        let sign = edge.perp_dot(other).signum();
        for vertex in triangle.map(|vertex| vertex as usize) {
            along_u[vertex] += ((b - a) * other.y - (c - a) * edge.y) * sign;
            along_v[vertex] += ((c - a) * edge.x - (b - a) * other.x) * sign;
        }
    }
    (0..shape.positions.len())
        .map(|vertex| {
            let normal = shape.normals[vertex];
            let tangent = along_u[vertex].reject_from_normalized(normal);
            let tangent = tangent.normalize_or(normal.any_orthonormal_vector());
            let sign = if normal.cross(tangent).dot(-along_v[vertex]) < 0.0 { -1.0 } else { 1.0 };
            tangent.extend(sign)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::procedural::surface::sheet;

    #[test]
    fn tangents_follow_u_with_the_bitangent_against_v() {
        let shape = sheet(2, 2, |u, v| Vec3::new(u, 0.0, v));
        for tangent in tangents(&shape) {
            assert!((tangent.truncate() - Vec3::X).length() < 1e-5);
            let bitangent = Vec3::Y.cross(tangent.truncate()) * tangent.w;
            assert!((bitangent - Vec3::NEG_Z).length() < 1e-5);
        }
    }

    #[test]
    fn triangles_without_an_area_are_left_out() {
        let mut builder = SceneBuilder::new(String::new());
        let material = builder.material(Material::default());
        let mut shape = Shape::default();
        shape.polygon(&[Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y]);
        shape.polygon(&[Vec3::ZERO, Vec3::X, Vec3::X * 2.0]);
        builder.add("thing", material, shape);
        assert_eq!(builder.finish().triangle_count(), 1);
    }
}
