//! Morph targets: displacements of vertices, added by weight (glTF 2.0, 3.7.2.2).

use super::{
    super::{Mesh, SceneError},
    document::File,
};
use glam::Vec3;
use gltf::{Accessor, Primitive};

/// A mesh at rest with its morph targets added; `None` where no target has a weight.
pub(super) fn morphed(
    file: &File<'_>,
    primitive: &Primitive<'_>,
    rest: &Mesh,
    weights: &[f32],
) -> Result<Option<Mesh>, SceneError> {
    let mut mesh = None;
    for ((index, target), weight) in primitive.morph_targets().enumerate().zip(weights) {
        if *weight == 0.0 {
            continue;
        }
        let mesh = mesh.get_or_insert_with(|| rest.clone());
        let user = format!("morph target {index} of mesh `{}`", rest.name);
        let displacements = |accessor: Option<Accessor<'_>>, vertices: usize| match accessor {
            Some(accessor) if vertices > 0 => displacements(file, &accessor, vertices, &user),
            _ => Ok(Vec::new()),
        };
        let (positions, normals, tangents) = (&mut mesh.positions, &mut mesh.normals, &mut mesh.tangents);
        for (position, offset) in
            positions.iter_mut().zip(displacements(target.positions(), rest.positions.len())?)
        {
            *position += offset * *weight;
        }
        for (normal, offset) in normals.iter_mut().zip(displacements(target.normals(), rest.normals.len())?) {
            *normal += offset * *weight;
        }
        for (tangent, offset) in
            tangents.iter_mut().zip(displacements(target.tangents(), rest.tangents.len())?)
        {
            *tangent += (offset * *weight).extend(0.0);
        }
    }
    Ok(mesh)
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
