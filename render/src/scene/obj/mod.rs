//! Wavefront OBJ with MTL materials. Source: "Object Files (.obj)" and "MTL material format", Alias|Wavefront
//! Advanced Visualizer manual.
//!
//! What is wrong in one line does not lose the scene: what has a meaning is read, the rest is passed over with a
//! warning. A face with a corner that there is not, and a vertex without a position, refuse the file, since they
//! are what damage looks like.

mod library;
mod map;
mod material;
mod mesh;
mod parse;
mod polygon;
mod statement;
mod warnings;

use super::finish::finish;
use super::{Material, MaterialId, Scene, SceneError, file};
use crate::memory;
use material::Library;
use parse::{Named, Obj};
use std::borrow::Cow;
use std::path::{Path, PathBuf};
use warnings::Warnings;

/// Reads an OBJ file and its material libraries. Faces of a material that is in no library are white and rough;
/// the scene's warnings name it.
///
/// # Errors
/// If the file, a library or a texture is missing or damaged, or if there are more triangles than memory holds.
pub fn load(path: &Path) -> Result<Scene, SceneError> {
    let bytes = file::read(path)?;
    let text = text(&bytes);
    let most = memory::most_triangles(memory::available());
    let mut warnings = Warnings::default();
    let obj = parse::parse(&text, most, &mut warnings).map_err(|what| SceneError::invalid(path, what))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut about_libraries = Vec::new();
    let libraries = libraries(folder, path, &obj.libraries, &mut about_libraries)?;
    let (mut materials, textures) = material::convert(folder, &libraries)?;
    let ids = ids(&obj, &materials, &mut warnings);
    let without = MaterialId(materials.len() as u32);
    let id = |run: &parse::Run| run.material.and_then(|material| ids[material]).unwrap_or(without);
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

/// Text of a file; what is no UTF-8 in it, as names in older encodings, is replaced.
fn text(bytes: &[u8]) -> Cow<'_, str> {
    String::from_utf8_lossy(bytes)
}

/// The libraries that a file names, each read once.
fn libraries(
    folder: &Path,
    obj: &Path,
    named: &[Named],
    warnings: &mut Vec<String>,
) -> Result<Vec<Library>, SceneError> {
    let mut libraries: Vec<Library> = Vec::new();
    for Named { name, line } in named {
        for path in
            paths(folder, name).map_err(|what| SceneError::invalid(obj, format!("line {line}: {what}")))?
        {
            if libraries.iter().any(|library| library.path == path) {
                continue;
            }
            let mut about = Warnings::default();
            let materials = library::parse(&text(&file::read(&path)?), &mut about);
            warnings.append(&mut about.about(&path));
            libraries.push(Library { path, materials });
        }
    }
    Ok(libraries)
}

/// The files that follow `mtllib`: one whose name has spaces, where there is one, or else several.
fn paths(folder: &Path, names: &str) -> Result<Vec<PathBuf>, String> {
    let beside = |name: &str| file::beside(folder, Path::new(""), name.replace('\\', "/"));
    match beside(names.trim_matches('"')) {
        Ok(path) if path.is_file() => Ok(vec![path]),
        _ => names.split_whitespace().map(beside).collect(),
    }
}

/// The material of each name that faces use: that of the first library that has it.
fn ids(obj: &Obj, materials: &[Material], warnings: &mut Warnings) -> Vec<Option<MaterialId>> {
    let id = |Named { name, line }: &Named| {
        let found = materials.iter().position(|material| material.name == *name);
        if found.is_none() {
            let name = parse::short(name);
            warnings.add(*line, format!("no library has the material `{name}`; its faces are white"));
        }
        found.map(|index| MaterialId(index as u32))
    };
    obj.materials.iter().map(id).collect()
}
