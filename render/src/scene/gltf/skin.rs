//! Skins: vertices that follow the joints of a skeleton (glTF 2.0, 3.7.3).

use super::{super::SceneError, document::File, node::Hierarchy};
use glam::Mat4;
use gltf::Skin;

/// Four joints of each vertex, with their weights.
#[derive(Clone, Debug)]
pub(super) struct Influences {
    pub joints: Vec<[u32; 4]>,
    pub weights: Vec<[f32; 4]>,
}

/// For each joint of a skin the matrix from the mesh at rest to the world.
pub(super) fn joint_matrices(
    file: &File<'_>,
    skin: &Skin<'_>,
    hierarchy: &Hierarchy,
) -> Result<Vec<Mat4>, SceneError> {
    let inverse = inverse_bind_matrices(file, skin)?;
    Ok(skin.joints().zip(inverse).map(|(joint, inverse)| hierarchy.worlds[joint.index()] * inverse).collect())
}

/// For each joint of a skin the matrix from the mesh at rest to the joint.
pub(super) fn inverse_bind_matrices(file: &File<'_>, skin: &Skin<'_>) -> Result<Vec<Mat4>, SceneError> {
    let joints = skin.joints().count();
    let Some(accessor) = skin.inverse_bind_matrices() else { return Ok(vec![Mat4::IDENTITY; joints]) };
    let user = format!("inverse bind matrices of skin {}", skin.index());
    let mut inverse = file.floats::<16>(&accessor, &user)?;
    if inverse.len() < joints {
        return Err(file.invalid(format!("{user}: {} for {joints} joints", inverse.len())));
    }
    inverse.truncate(joints);
    Ok(inverse.iter().map(Mat4::from_cols_array).collect())
}

/// The joint that a vertex follows and that there is not, if any.
pub(super) fn missing_joint(influences: &[Influences], joints: usize) -> Option<u32> {
    let used =
        influences.iter().flat_map(|set| set.joints.iter().flatten().zip(set.weights.iter().flatten()));
    used.filter(|(_, weight)| **weight != 0.0)
        .map(|(joint, _)| *joint)
        .find(|joint| *joint as usize >= joints)
}

/// The matrix that takes a vertex from the mesh at rest to the world: the mean of its joints' by their
/// weights. A vertex without any weight stays where it is.
pub(super) fn vertex_matrix(influences: &[Influences], joints: &[Mat4], vertex: usize) -> Mat4 {
    let mut sum = Mat4::ZERO;
    let mut total = 0.0;
    for set in influences {
        for (joint, weight) in set.joints[vertex].iter().zip(set.weights[vertex]) {
            if weight != 0.0 {
                sum += joints[*joint as usize] * weight;
                total += weight;
            }
        }
    }
    if total > 0.0 { sum * (1.0 / total) } else { Mat4::IDENTITY }
}
