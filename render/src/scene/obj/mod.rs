//! Wavefront OBJ with MTL materials. Source: "Object Files (.obj)" and "MTL material format", Alias|Wavefront
//! Advanced Visualizer manual.
//!
//! What is wrong in one line does not lose the scene: what has a meaning is read, the rest is passed over
//! with a warning, and a library or an image that is not there is left out with one. A face with a corner
//! that there is not, a vertex without a position and a damaged image refuse the file, since they are what
//! damage looks like.

mod colours;
mod files;
mod known;
mod libraries;
mod library;
mod map;
mod map_options;
mod material;
mod mesh;
mod parse;
mod statement;
mod warnings;

use super::finish::finish;
use super::{Material, MaterialId, Scene, SceneError, file};
use crate::scene::memory;
use std::borrow::Cow;
use std::path::Path;
use warnings::Warnings;

/// Reads an OBJ file and its material libraries. Faces of a material that is in no library are white and
/// rough; the scene's warnings name it, as they name libraries and images that are not in the scene's folder.
///
/// # Errors
/// If the file is missing or damaged, an image is damaged, a library cannot be read, or if there are more
/// triangles than memory holds.
pub fn load(path: &Path) -> Result<Scene, SceneError> {
    let bytes = file::read(path)?;
    let text = text(&bytes);
    let most = memory::most_triangles(memory::available());
    let mut warnings = Warnings::default();
    let obj = parse::parse(&text, most, &mut warnings).map_err(|what| SceneError::invalid(path, what))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut about_libraries = Vec::new();
    let libraries = libraries::libraries(folder, path, &obj.libraries, &mut warnings, &mut about_libraries)?;
    let (mut materials, textures) = material::convert(&libraries)?;
    let ids = known::ids(&obj, &materials, &mut warnings);
    let without = MaterialId(materials.len() as u32);
    let id = |run: &parse::FaceRun| run.material.and_then(|material| ids[material]).unwrap_or(without);
    if obj.runs.iter().any(|run| id(run) == without) {
        materials.push(Material { name: "none".to_owned(), ..Material::default() });
    }
    let meshes = obj
        .runs
        .iter()
        .map(|run| finish(mesh::mesh(&obj, run, id(run))).map_err(|what| SceneError::invalid(path, what)));
    let meshes = meshes.collect::<Result<_, _>>()?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let mut warnings = warnings.about(path);
    warnings.append(&mut about_libraries);
    Ok(Scene { name, meshes, materials, textures, warnings, ..Scene::default() })
}

/// Text of a file: UTF-16 where it begins with that one's byte order mark, else UTF-8. What is neither, as
/// names in older encodings, is replaced.
fn text(bytes: &[u8]) -> Cow<'_, str> {
    let of = |rest: &[u8], unit: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = rest.as_chunks().0.iter().map(|pair| unit(*pair)).collect();
        Cow::Owned(String::from_utf16_lossy(&units))
    };
    match bytes {
        [0xff, 0xfe, rest @ ..] => of(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => of(rest, u16::from_be_bytes),
        _ => String::from_utf8_lossy(bytes),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_read_in_the_encoding_that_its_mark_names() {
        let said = "usemtl röd\nf 1 2 3\n";
        let marked = format!("\u{feff}{said}");
        let little: Vec<u8> = marked.encode_utf16().flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> = marked.encode_utf16().flat_map(u16::to_be_bytes).collect();
        assert_eq!([text(said.as_bytes()), text(&little), text(&big)], [said; 3]);
        assert_eq!(text(b"r\xf6d"), "r\u{fffd}d");
    }
}
