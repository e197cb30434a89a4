//! glTF 2.0 (.gltf and .glb): nodes, meshes, materials, textures, cameras, lights, skins and morph targets,
//! posed at one moment and flattened to world space. Source: Khronos glTF 2.0 specification (ISO/IEC
//! 12113:2022) and the extensions in [`document::SUPPORTED_EXTENSIONS`].
//!
//! A file is untrusted: the JSON is validated as a whole, every accessor is held against its buffer before it
//! is read, and sizes are added up before anything is instantiated. Extensions that a file uses without
//! requiring them, and that are not in the list, are left out as the specification allows (sheen,
//! iridescence, ...), which [`Scene::warnings`] say.

mod animation;
mod buffers;
mod check;
mod compressed;
mod document;
mod instances;
mod layers;
mod light;
mod material;
mod mesh;
mod morph;
mod node;
mod posed;
mod reach;
mod rig;
mod skin;
mod texture;
mod vertex_transform;
mod warnings;

pub use morph::MorphTarget;
pub use rig::{Rig, RigPart, RigPose};

use super::{Mesh, Scene, SceneError};
use animation::Pose;
use document::File;
use glam::Mat4;
use node::Hierarchy;
use std::path::Path;
use texture::TextureList;

/// Reads a glTF file, posed by its first animation at `time` seconds, with the displacements of its vertices
/// in the `shutter` seconds around that. Times outside the animation give its ends. The file's default scene
/// is read, else its first, else all of its nodes.
///
/// # Errors
/// If the file, or one that it refers to, is missing, damaged, or needs an extension that is not supported.
pub fn load(path: &Path, time: f32, shutter: f32) -> Result<Scene, SceneError> {
    if !time.is_finite() {
        return Err(SceneError::invalid(path, format!("cannot be posed at {time} seconds")));
    }
    let file = File::open(path)?;
    let pose = Pose::at(&file, time)?;
    let hierarchy = Hierarchy::new(&file, &pose)?;
    let mut textures = TextureList::default();
    let materials = material::read(&file, &mut textures)?;
    let lights = light::lights(&file, &hierarchy, &mut textures)?;
    let mut meshes = mesh::read(&file, &hierarchy, &pose)?;
    if shutter > 0.0 && file.document.animations().len() > 0 {
        displace(&file, &mut meshes, [time - 0.5 * shutter, time + 0.5 * shutter])?;
    }
    let warnings = warnings::warnings(&file, &textures, &meshes, &materials);
    Ok(Scene {
        name: path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        meshes: meshes.into(),
        materials,
        textures: textures.load(&file)?,
        lights,
        cameras: light::cameras(&file, &hierarchy)?,
        environment: None,
        medium: None,
        glow: None,
        warnings,
    })
}

/// What of a glTF file moves, for the meshes that [`load`] gives, in their order; `None` where nothing does.
///
/// # Errors
/// If the file, or one that it refers to, is missing or damaged.
pub fn rig(path: &Path) -> Result<Option<Rig>, SceneError> {
    Rig::read(&File::open(path)?)
}

/// A mesh in another place. Its displacements turn with it.
pub fn moved(mesh: &Mesh, place: Mat4) -> Mesh {
    let turn = |way: &glam::Vec3| place.transform_vector3(*way);
    let displacements = mesh.displacements.iter().map(turn).collect();
    let place = vertex_transform::VertexTransform::new(place);
    Mesh { displacements, ..vertex_transform::placed(mesh, |_| place) }
}

/// When a glTF file's first animation begins and ends, seconds; `None` where nothing is animated.
///
/// # Errors
/// If the file, or one that it refers to, is missing or damaged.
pub fn animation_span(path: &Path) -> Result<Option<[f32; 2]>, SceneError> {
    animation::span(&File::open(path)?)
}

/// Gives the meshes that move between two times how far each of their vertices does. A file's meshes and
/// vertices are the same at all times.
fn displace(file: &File<'_>, meshes: &mut [Mesh], times: [f32; 2]) -> Result<(), SceneError> {
    let posed = |time| {
        let pose = Pose::at(file, time)?;
        mesh::read(file, &Hierarchy::new(file, &pose)?, &pose)
    };
    let [before, after] = [posed(times[0])?, posed(times[1])?];
    for (mesh, (before, after)) in meshes.iter_mut().zip(before.iter().zip(&after)) {
        if before.positions != after.positions {
            let vertices = before.positions.iter().zip(&after.positions);
            mesh.displacements = vertices.map(|(before, after)| *after - *before).collect();
        }
    }
    Ok(())
}
