//! glTF 2.0 (.gltf and .glb): nodes, meshes, materials, textures, cameras, lights, skins and morph targets, posed at one
//! moment and flattened to world space. Source: Khronos glTF 2.0 specification (ISO/IEC 12113:2022) and the extensions in
//! [`document::SUPPORTED_EXTENSIONS`].
//!
//! A file is untrusted: the JSON is validated as a whole, every accessor is held against its buffer before it is read,
//! and sizes are added up before anything is instantiated. Extensions that a file uses without requiring them, and that
//! are not in the list, are left out as the specification allows (clear coat, transmission, ...).

mod animation;
mod buffers;
mod document;
mod instances;
mod light;
mod material;
mod mesh;
mod morph;
mod node;
mod place;
mod skin;
mod texture;

use super::{Scene, SceneError};
use animation::Pose;
use document::File;
use node::Hierarchy;
use std::path::Path;

/// Reads a glTF file, posed by its first animation at `time` seconds. Times outside the animation give its ends.
/// The file's default scene is read, else its first, else all of its nodes.
///
/// # Errors
/// If the file, or one that it refers to, is missing, damaged, or needs an extension that is not supported.
pub fn load(path: &Path, time: f32) -> Result<Scene, SceneError> {
    if !time.is_finite() {
        return Err(SceneError::invalid(path, format!("cannot be posed at {time} seconds")));
    }
    let file = File::open(path)?;
    let pose = Pose::at(&file, time)?;
    let hierarchy = Hierarchy::new(&file, &pose)?;
    let (materials, textures) = material::read(&file)?;
    Ok(Scene {
        name: path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        meshes: mesh::read(&file, &hierarchy, &pose)?,
        materials,
        textures,
        lights: light::lights(&file, &hierarchy)?,
        cameras: light::cameras(&file, &hierarchy)?,
        environment: None,
        medium: None,
    })
}
