//! Wavefront OBJ with MTL materials, parsed by `tobj`. Polygons become fans of triangles. Source: "Object Files (.obj)" and
//! "MTL material format", Alias|Wavefront Advanced Visualizer manual.
//!
//! The parser trusts its input in a few places and does not say where an error is, so [`lines`] looks at the text first.

mod lines;
mod material;

use super::{Material, MaterialId, Mesh, Scene, SceneError, file, finish::finish};
use crate::memory;
use glam::{Vec2, Vec3};
use material::Library;
use std::path::Path;

/// One index a vertex, triangles only.
const OPTIONS: tobj::LoadOptions =
    tobj::LoadOptions { single_index: true, triangulate: true, ignore_points: true, ignore_lines: true };

/// Reads an OBJ file and its material libraries. Faces of a material that is in no library are white and rough.
///
/// # Errors
/// If the file, a library or a texture is missing or damaged, or if there are more triangles than memory holds.
pub fn load(path: &Path) -> Result<Scene, SceneError> {
    let bytes = file::read(path)?;
    let text = String::from_utf8_lossy(&bytes);
    let most = memory::most_triangles(memory::available());
    lines::check_faces(&text, most).map_err(|what| SceneError::invalid(path, what))?;
    let library = Library::new(path);
    let parsed = tobj::load_obj_buf(&mut text.as_bytes(), &OPTIONS, |name| library.read(name));
    library.failure()?;
    let (models, materials) = parsed.map_err(|error| SceneError::invalid(path, error.to_string()))?;
    let materials = materials.map_err(|error| SceneError::invalid(path, error.to_string()))?;
    let (mut materials, textures) = material::convert(path, &materials)?;
    let without = materials.len();
    if models.iter().any(|model| model.mesh.material_id.is_none()) {
        materials.push(Material { name: "none".to_owned(), ..Material::default() });
    }
    let meshes = models
        .into_iter()
        .map(|model| finish(mesh(model, without)).map_err(|what| SceneError::invalid(path, what)))
        .collect::<Result<_, _>>()?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok(Scene { name, meshes, materials, textures, ..Scene::default() })
}

/// A mesh from the parser's rows of numbers. Normals, coordinates and colours that only some of the vertices have are
/// left out. `v` points up in OBJ, down here.
fn mesh(model: tobj::Model, without_material: usize) -> Mesh {
    let tobj::Model { mesh, name } = model;
    let vertices = mesh.positions.len() / 3;
    let vectors =
        |values: &[f32]| -> Vec<Vec3> { values.as_chunks::<3>().0.iter().map(|v| Vec3::from(*v)).collect() };
    let complete = |vectors: Vec<Vec3>| if vectors.len() == vertices { vectors } else { Vec::new() };
    let uvs: Vec<_> = mesh.texcoords.as_chunks::<2>().0.iter().map(|[u, v]| Vec2::new(*u, 1.0 - v)).collect();
    let usable = uvs.len() == vertices && uvs.iter().all(|uv| uv.is_finite());
    let colours = complete(vectors(&mesh.vertex_color));
    let colours = if colours.iter().all(|colour| colour.is_finite()) { colours } else { Vec::new() };
    Mesh {
        name,
        material: MaterialId(mesh.material_id.unwrap_or(without_material) as u32),
        positions: vectors(&mesh.positions),
        normals: complete(vectors(&mesh.normals)),
        uvs: [if usable { uvs } else { Vec::new() }, Vec::new()],
        colours: colours.into_iter().map(|colour| colour.extend(1.0)).collect(),
        triangles: mesh.indices.as_chunks::<3>().0.to_vec(),
        ..Mesh::default()
    }
}
