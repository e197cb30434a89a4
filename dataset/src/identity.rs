//! What tells scenes apart: their contents, not their files, so that a change of a file that a scene file
//! refers to is noticed, and so is a scene that was exported anew.

use crate::random::mix;
use deepshade_render::scene::{Bounds, Filter, Material, Scene, Texture};

/// Cells along the diagonal of a scene's box that corners are rounded to: exporting moves them by far less.
const CELLS: f32 = 16_384.0;
/// Scenes that have this share of the triangles of either in common are the same.
const SAME: f64 = 0.5;

/// A scene's contents and shape.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    /// [`scene_hash`].
    pub hash: String,
    /// A hash of every triangle, ascending, none twice. Corners are relative to the scene's box and rounded,
    /// so that order, names, materials, the unit of length and the last digits do not matter.
    triangles: Vec<u64>,
}

impl Identity {
    /// The identity of a scene.
    pub fn of(scene: &Scene) -> Self {
        Self { hash: scene_hash(scene), triangles: triangle_hashes(scene) }
    }

    /// Whether two scenes are the same in all or in most of their triangles.
    pub fn same(&self, other: &Self) -> bool {
        let in_both =
            self.triangles.iter().filter(|hash| other.triangles.binary_search(hash).is_ok()).count();
        let fewer = self.triangles.len().min(other.triangles.len());
        self.hash == other.hash || (fewer > 0 && in_both as f64 >= SAME * fewer as f64)
    }
}

/// A scene's materials without glass and clear coats, and the textures that are left of it then. Most effects
/// do not see these layers, and hashes from before them stay what they were.
fn bare(scene: &Scene) -> (Vec<Material>, Vec<&Texture>) {
    let strip = |material: &Material| Material {
        name: String::new(),
        transmission: None,
        coat: None,
        ..material.clone()
    };
    let mut materials: Vec<Material> = scene.materials.iter().map(strip).collect();
    let reads = |materials: &[Material], index: u32| {
        materials.iter().flat_map(Material::textures).any(|slot| slot.texture.0 == index)
    };
    let is_left = |index: &u32| reads(&materials, *index) || !reads(&scene.materials, *index);
    let left: Vec<u32> = (0..scene.textures.len() as u32).filter(is_left).collect();
    for material in &mut materials {
        let normal = material.normal_texture.as_mut().map(|(slot, _)| slot);
        let others = [
            &mut material.base_colour_texture,
            &mut material.metallic_roughness_texture,
            &mut material.emission_texture,
        ];
        for slot in others.into_iter().flat_map(Option::as_mut).chain(normal) {
            slot.texture.0 = left.partition_point(|index| *index < slot.texture.0) as u32;
        }
    }
    (materials, left.iter().map(|index| &*scene.textures[*index as usize]).collect())
}

/// A bare material as text, which states every number exactly, and every property that materials may get.
fn in_words(material: &Material) -> String {
    format!("{material:?}").replace(", ior: 1.5, transmission: None, coat: None", "")
}

/// BLAKE3 hash, in hexadecimal, of all that a scene shows: triangles, materials, textures and lights, in
/// their order. Names, cameras, glass and clear coats do not count.
pub fn scene_hash(scene: &Scene) -> String {
    let mut hasher = blake3::Hasher::new();
    let mut list = |bytes: Vec<u8>| {
        hasher.update(&(bytes.len() as u64).to_le_bytes());
        hasher.update(&bytes);
    };
    for mesh in &scene.meshes {
        let vectors = mesh.positions.iter().chain(&mesh.normals);
        let counts = [mesh.positions.len(), mesh.normals.len(), mesh.material.0 as usize];
        list(counts.iter().flat_map(|count| (*count as u64).to_le_bytes()).collect());
        list(floats(vectors.flat_map(|vector| vector.to_array())));
        list(floats(mesh.tangents.iter().flat_map(|vector| vector.to_array())));
        list(floats(mesh.colours.iter().flat_map(|vector| vector.to_array())));
        mesh.uvs.iter().for_each(|uvs| list(floats(uvs.iter().flat_map(|uv| uv.to_array()))));
        list(mesh.triangles.as_flattened().iter().flat_map(|vertex| vertex.to_le_bytes()).collect());
    }
    let (materials, textures) = bare(scene);
    for material in &materials {
        list(in_words(material).into_bytes());
    }
    for texture in textures {
        list(format!("{:?} {:?} {:?}", texture.size(), texture.encoding(), texture.wrap()).into_bytes());
        list(texture.texels().as_flattened().to_vec());
        // Hashes from before there were two ways stay what they were.
        if texture.filter() == Filter::Nearest {
            list(b"nearest".to_vec());
        }
    }
    list(format!("{:?}", scene.lights).into_bytes());
    if let Some(medium) = &scene.medium {
        list(format!("{medium:?}").into_bytes());
    }
    if let Some(environment) = &scene.environment {
        list(format!("{environment:?}").into_bytes());
    }
    hasher.finalize().to_hex().to_string()
}

fn floats(values: impl Iterator<Item = f32>) -> Vec<u8> {
    values.flat_map(f32::to_le_bytes).collect()
}

/// The hashes of a scene's triangles, but for those that are too small to be told from others.
fn triangle_hashes(scene: &Scene) -> Vec<u64> {
    let Bounds { min, .. } = scene.bounds();
    let scale = CELLS / scene.bounds().diagonal();
    let cell = |corner: glam::Vec3| {
        let [x, y, z] = ((corner - min) * scale).round().to_array().map(|value| value as u64);
        x << 32 | y << 16 | z
    };
    let triangles = scene.meshes.iter().flat_map(|mesh| (0..mesh.triangles.len()).map(|i| mesh.corners(i)));
    let mut hashes: Vec<u64> = triangles
        .filter_map(|corners| {
            let mut cells = corners.map(cell);
            cells.sort_unstable();
            (cells[0] != cells[1] && cells[1] != cells[2]).then(|| mix(&cells))
        })
        .collect();
    hashes.sort_unstable();
    hashes.dedup();
    hashes
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_render::scene::coat::Coat;
    use deepshade_render::scene::procedural::Family;
    use deepshade_render::scene::{Encoding, Mesh, TextureId, TextureSlot, Wrap};
    use glam::{Affine2, Vec3};
    use std::sync::Arc;

    fn scene() -> Scene {
        Family::Stairs.scene(1)
    }

    /// A scene as another program might write it: meshes and triangles in another order, every corner a
    /// vertex of its own, in centimetres, with the digits that are left then.
    fn exported(scene: &Scene) -> Scene {
        let meshes = scene.meshes.iter().rev().map(|mesh| {
            let corners = (0..mesh.triangles.len()).rev().flat_map(|i| mesh.corners(i));
            let positions: Vec<Vec3> = corners.map(|corner| (corner + 0.123) * 100.0).collect();
            let triangles = (0..positions.len() as u32 / 3).map(|i| [3 * i + 1, 3 * i + 2, 3 * i]).collect();
            Mesh { name: "exported".to_owned(), positions, triangles, ..Mesh::default() }
        });
        Scene { meshes: meshes.collect(), materials: vec![Material::default()], ..Scene::default() }
    }

    #[test]
    fn everything_that_is_seen_changes_the_hash_and_names_do_not() {
        let mut plain = scene();
        plain
            .textures
            .push(Texture::new(1, 1, vec![[1, 2, 3, 255]], Encoding::Linear, [Wrap::Clamp; 2]).into());
        let hash = scene_hash(&plain);
        let changed = |change: fn(&mut Scene)| {
            let mut scene = plain.clone();
            change(&mut scene);
            scene_hash(&scene)
        };
        let changes: [fn(&mut Scene); 6] = [
            |scene| scene.meshes[0].positions[0].x += 1e-3,
            |scene| scene.meshes[0].triangles[0].swap(0, 1),
            |scene| scene.materials[0].base_colour.w = 0.5,
            |scene| scene.materials[0].ior = 1.4,
            |scene| {
                let texel = vec![[1, 2, 3, 254]];
                scene.textures[0] = Texture::new(1, 1, texel, Encoding::Linear, [Wrap::Clamp; 2]).into();
            },
            |scene| scene.meshes.swap(0, 1),
        ];
        assert!(changes.into_iter().all(|change| changed(change) != hash));
        let renamed = changed(|scene| {
            scene.name = "other".to_owned();
            scene.meshes[0].name = "other".to_owned();
            scene.materials[0].name = "other".to_owned();
        });
        assert_eq!(renamed, hash);
        // A coat's own texture comes before that of the surface below.
        let layered = |coated: bool| {
            let texture = |value: u8| {
                Arc::new(Texture::new(1, 1, vec![[value; 4]], Encoding::Linear, [Wrap::Clamp; 2]))
            };
            let slot = |index: u32| {
                Some(TextureSlot { texture: TextureId(index), transform: Affine2::IDENTITY, uv_set: 0 })
            };
            let coat = coated.then(|| Coat { share: 0.5, texture: slot(0), ..Coat::default() });
            let base_colour_texture = slot(u32::from(coated));
            let materials = vec![Material { base_colour_texture, coat, ..Material::default() }];
            let textures = if coated { vec![texture(9), texture(1)] } else { vec![texture(1)] };
            scene_hash(&Scene { materials, textures, ..Scene::default() })
        };
        assert_eq!(layered(true), layered(false));
        assert!(in_words(&Material::default()).ends_with("alpha: Opaque }"), "as before there were coats");
    }

    #[test]
    fn a_scene_that_is_exported_anew_is_the_same_and_another_is_not() {
        let (scene, again) = (scene(), exported(&scene()));
        let [original, exported] = [&scene, &again].map(Identity::of);
        assert_ne!(original.hash, exported.hash);
        assert!(original.same(&exported) && exported.same(&original) && original.same(&original));
        let other = Identity::of(&Family::Stairs.scene(2));
        assert!(!original.same(&other) && !other.same(&original));
        let other = Identity::of(&Family::Room.scene(1));
        assert!(!original.same(&other));
    }
}
