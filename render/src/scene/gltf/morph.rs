//! Morph targets: displacements of vertices, added by weight (glTF 2.0, 3.7.2.2).

use super::{
    super::{Mesh, SceneError},
    document::File,
};
use glam::Vec3;
use gltf::{Accessor, Primitive};

/// What a morph target adds to a mesh at full weight. Each may be empty.
#[derive(Clone, Debug, Default)]
pub struct MorphTarget {
    /// To positions, metres.
    pub positions: Vec<Vec3>,
    /// To normals.
    pub normals: Vec<Vec3>,
    /// To tangents.
    pub tangents: Vec<Vec3>,
}

impl MorphTarget {
    /// Adds its share to a mesh.
    pub(super) fn add_to(&self, mesh: &mut Mesh, weight: f32) {
        for (position, offset) in mesh.positions.iter_mut().zip(&self.positions) {
            *position += *offset * weight;
        }
        for (normal, offset) in mesh.normals.iter_mut().zip(&self.normals) {
            *normal += *offset * weight;
        }
        for (tangent, offset) in mesh.tangents.iter_mut().zip(&self.tangents) {
            *tangent += (*offset * weight).extend(0.0);
        }
    }
}

/// A mesh at rest with its morph targets added; `None` where no target has a weight.
pub(super) fn morphed(
    file: &File<'_>,
    primitive: &Primitive<'_>,
    rest: &Mesh,
    weights: &[f32],
) -> Result<Option<Mesh>, SceneError> {
    let mut mesh = None;
    for ((index, target), weight) in primitive.morph_targets().enumerate().zip(weights) {
        if *weight != 0.0 {
            let mesh = mesh.get_or_insert_with(|| rest.clone());
            read_target(file, index, &target, rest)?.add_to(mesh, *weight);
        }
    }
    Ok(mesh)
}

/// All morph targets of a primitive.
pub(super) fn targets(
    file: &File<'_>,
    primitive: &Primitive<'_>,
    rest: &Mesh,
) -> Result<Vec<MorphTarget>, SceneError> {
    primitive
        .morph_targets()
        .enumerate()
        .map(|(index, target)| read_target(file, index, &target, rest))
        .collect()
}

fn read_target(
    file: &File<'_>,
    index: usize,
    target: &gltf::mesh::MorphTarget<'_>,
    rest: &Mesh,
) -> Result<MorphTarget, SceneError> {
    let user = format!("morph target {index} of mesh `{}`", rest.name);
    let displacements = |accessor: Option<Accessor<'_>>, vertices: usize| match accessor {
        Some(accessor) if vertices > 0 => displacements(file, &accessor, vertices, &user),
        _ => Ok(Vec::new()),
    };
    Ok(MorphTarget {
        positions: displacements(target.positions(), rest.positions.len())?,
        normals: displacements(target.normals(), rest.normals.len())?,
        tangents: displacements(target.tangents(), rest.tangents.len())?,
    })
}

/// One displacement a vertex.
fn displacements(
    file: &File<'_>,
    accessor: &Accessor<'_>,
    vertices: usize,
    user: &str,
) -> Result<Vec<Vec3>, SceneError> {
    if accessor.count() != vertices {
        return Err(
            file.invalid(format!("{user}: {} displacements for {vertices} vertices", accessor.count()))
        );
    }
    Ok(file.floats::<3>(accessor, user)?.into_iter().map(Vec3::from).collect())
}
