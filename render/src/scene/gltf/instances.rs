//! Which primitives a scene shows, and where: once a node, or many times with EXT_mesh_gpu_instancing.

use super::{
    super::SceneError,
    document::File,
    node::{Hierarchy, label},
};
use crate::scene::memory;
use glam::{Mat4, Quat};
use gltf::{Node, Primitive, Semantic, mesh::Mode};

/// Most vertices of a scene, and most triangles where memory holds as many.
const MOST: usize = 1 << 26;

/// A primitive where a node shows it.
#[derive(Clone, Debug)]
pub(super) struct Instance<'a> {
    pub node: Node<'a>,
    /// What errors and the scene call the primitive.
    pub name: String,
    /// Index of the mesh, and of the primitive in it.
    pub key: (usize, usize),
    pub primitive: Primitive<'a>,
    pub world: Mat4,
    /// From the primitive to its node: of an instance its own transform.
    pub local: Mat4,
}

/// All primitives made of triangles that the scene shows. Points and lines have no surface and are left out,
/// as is what has no positions.
pub(super) fn instances<'a>(
    file: &'a File<'_>,
    hierarchy: &Hierarchy,
) -> Result<Vec<Instance<'a>>, SceneError> {
    let mut instances = Vec::new();
    let (mut vertices, mut corners) = (0usize, 0usize);
    let most = MOST.min(memory::most_triangles(memory::available()));
    for (node, world) in hierarchy.nodes(file) {
        let Some(mesh) = node.mesh() else { continue };
        let name =
            mesh.name().or(node.name()).map_or_else(|| format!("mesh {}", mesh.index()), str::to_owned);
        let locals = locals(file, &node)?;
        for primitive in mesh.primitives().filter(is_surface) {
            let positions = primitive.get(&Semantic::Positions).map_or(0, |accessor| accessor.count());
            let indices = primitive.indices().map_or(positions, |accessor| accessor.count());
            vertices = vertices.saturating_add(positions.saturating_mul(locals.len()));
            corners = corners.saturating_add(indices.saturating_mul(locals.len()));
            if vertices > MOST || corners > 3 * most {
                let what = format!("above {MOST} vertices or the {most} triangles that memory holds");
                return Err(file.invalid(format!("mesh `{name}` brings the scene {what}")));
            }
            let name = match mesh.primitives().len() {
                1 => name.clone(),
                _ => format!("{name}/{}", primitive.index()),
            };
            let key = (mesh.index(), primitive.index());
            let instance =
                Instance { node: node.clone(), name, key, primitive, world, local: Mat4::IDENTITY };
            let placed = |local: &Mat4| Instance { world: world * *local, local: *local, ..instance.clone() };
            instances.extend(locals.iter().map(placed));
        }
    }
    Ok(instances)
}

fn is_surface(primitive: &Primitive<'_>) -> bool {
    has_positions(primitive)
        && matches!(primitive.mode(), Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)
}

/// Whether it is known where a primitive's vertices are; else it should be left out (3.7.2.1).
pub(super) fn has_positions(primitive: &Primitive<'_>) -> bool {
    primitive.get(&Semantic::Positions).is_some()
}

/// The places of a mesh beside its node: the node's own, or one for each of its instances.
fn locals(file: &File<'_>, node: &Node<'_>) -> Result<Vec<Mat4>, SceneError> {
    let Some(extension) = node.extension_value("EXT_mesh_gpu_instancing") else {
        return Ok(vec![Mat4::IDENTITY]);
    };
    let user = format!("instances of {}", label(node));
    let accessor = |name: &str| {
        let index = extension.get("attributes")?.get(name)?.as_u64()?;
        Some((index, file.document.accessors().nth(usize::try_from(index).ok()?)))
    };
    let known = |name: &str| match accessor(name) {
        None => Ok(None),
        Some((_, Some(accessor))) => Ok(Some(accessor)),
        Some((index, None)) => Err(file.invalid(format!("{user}: there is no accessor {index}"))),
    };
    let (translations, rotations, scales) = (known("TRANSLATION")?, known("ROTATION")?, known("SCALE")?);
    let counts: Vec<_> =
        [&translations, &rotations, &scales].into_iter().flatten().map(|a| a.count()).collect();
    let count = counts.first().copied().unwrap_or(0);
    if count == 0 || counts.iter().any(|other| *other != count) {
        return Err(file.invalid(format!("{user}: translations, rotations and scales number {counts:?}")));
    }
    let translations = translations.map(|a| file.floats::<3>(&a, &user)).transpose()?;
    let rotations = rotations.map(|a| file.floats::<4>(&a, &user)).transpose()?;
    let scales = scales.map(|a| file.floats::<3>(&a, &user)).transpose()?;
    let instance = |index: usize| {
        let translation = translations.as_ref().map_or([0.0; 3], |values| values[index]);
        let rotation =
            rotations.as_ref().map_or(Quat::IDENTITY, |values| Quat::from_array(values[index]).normalize());
        let scale = scales.as_ref().map_or([1.0; 3], |values| values[index]);
        Mat4::from_scale_rotation_translation(scale.into(), rotation, translation.into())
    };
    Ok((0..count).map(instance).collect())
}
