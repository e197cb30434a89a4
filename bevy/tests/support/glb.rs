//! A scene of deepshade's as a glTF file, for Bevy to load: triangles, normals and base colours.

use deepshade_render::scene::{Material, Mesh, Scene};
use glam::Vec3;
use serde_json::{Value, json};
use std::fs;
use std::io;
use std::path::Path;

/// `UNSIGNED_INT` and `FLOAT` of glTF's accessors.
const U32: u32 = 5125;
const F32: u32 = 5126;

/// Writes a scene as a binary glTF file.
///
/// # Errors
/// If the file cannot be written.
pub fn write(scene: &Scene, path: &Path) -> io::Result<()> {
    let mut parts = Parts::default();
    let meshes: Vec<Value> = scene.meshes.iter().map(|mesh| parts.mesh(mesh)).collect();
    let nodes: Vec<Value> = (0..meshes.len()).map(|mesh| json!({ "mesh": mesh })).collect();
    let document = json!({
        "asset": { "version": "2.0" }, "scene": 0,
        "scenes": [{ "nodes": (0..nodes.len()).collect::<Vec<_>>() }],
        "nodes": nodes, "meshes": meshes,
        "materials": scene.materials.iter().map(material).collect::<Vec<_>>(),
        "accessors": parts.accessors, "bufferViews": parts.views,
        "buffers": [{ "byteLength": parts.bytes.len() }],
    });
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let chunk =
        |kind: &[u8; 4], bytes: &[u8]| [&(bytes.len() as u32).to_le_bytes()[..], &kind[..], bytes].concat();
    let chunks = [chunk(b"JSON", &text), chunk(b"BIN\0", &parts.bytes)].concat();
    let length = 12 + chunks.len() as u32;
    fs::write(path, [&b"glTF"[..], &2u32.to_le_bytes(), &length.to_le_bytes(), &chunks].concat())
}

/// How bright surfaces are whose texture is left out.
const TEXTURED: f32 = 0.5;

/// Seen from both sides, as all of deepshade's surfaces are.
fn material(material: &Material) -> Value {
    let brightness = if material.base_colour_texture.is_some() { TEXTURED } else { 1.0 };
    let colour = material.base_colour.truncate() * brightness;
    json!({ "doubleSided": true, "pbrMetallicRoughness": {
        "baseColorFactor": colour.extend(1.0).to_array(), "metallicFactor": 0.0, "roughnessFactor": 1.0,
    } })
}

/// What the binary chunk holds, and the lists that say where.
#[derive(Default)]
struct Parts {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Parts {
    fn mesh(&mut self, mesh: &Mesh) -> Value {
        // A mesh without normals has flat triangles, each with vertices of its own.
        let corners = mesh.triangles.as_flattened();
        let (positions, normals, indices): (Vec<Vec3>, Vec<Vec3>, Vec<u32>) = match mesh.normals.is_empty() {
            true => {
                let normal = |triangle: usize| {
                    let [a, b, c] = mesh.corners(triangle);
                    [(b - a).cross(c - a).normalize_or_zero(); 3]
                };
                let positions = corners.iter().map(|vertex| mesh.positions[*vertex as usize]).collect();
                let normals = (0..mesh.triangles.len()).flat_map(normal).collect();
                (positions, normals, (0..corners.len() as u32).collect())
            }
            false => (mesh.positions.clone(), mesh.normals.clone(), corners.to_vec()),
        };
        let (low, high) = positions
            .iter()
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), at| (low.min(*at), high.max(*at)));
        let range = json!({ "min": low.to_array(), "max": high.to_array() });
        let position = self.add(bytemuck::cast_slice(&vectors(&positions)), F32, "VEC3", positions.len());
        if let (Some(accessor), Value::Object(range)) = (self.accessors[position].as_object_mut(), range) {
            accessor.extend(range);
        }
        let normal = self.add(bytemuck::cast_slice(&vectors(&normals)), F32, "VEC3", normals.len());
        let triangles = self.add(bytemuck::cast_slice(&indices), U32, "SCALAR", indices.len());
        json!({ "name": mesh.name, "primitives": [{
            "attributes": { "POSITION": position, "NORMAL": normal }, "indices": triangles,
            "material": mesh.material.0,
        }] })
    }

    /// Adds numbers; the index of their accessor.
    fn add(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
        let view = json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        self.bytes.extend_from_slice(bytes);
        self.views.push(view);
        let accessor = json!({
            "bufferView": self.views.len() - 1, "componentType": component, "count": count, "type": kind,
        });
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }
}

fn vectors(vectors: &[Vec3]) -> Vec<[f32; 3]> {
    vectors.iter().map(Vec3::to_array).collect()
}
