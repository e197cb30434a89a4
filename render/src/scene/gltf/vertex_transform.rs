//! Taking the vertices of a mesh into the world.

use super::super::Mesh;
use glam::{Mat3, Mat4, Vec3};

/// A transform of vertices: points, directions and normals each in their way.
#[derive(Clone, Copy, Debug)]
pub(super) struct VertexTransform {
    point: Mat4,
    direction: Mat3,
    normal: Mat3,
    mirrored: bool,
}

impl VertexTransform {
    /// The transform of an affine matrix, which may be singular. Normals go by the matrix of cofactors, the
    /// inverse transpose up to a factor, whose sign is put right for mirroring matrices.
    pub fn new(matrix: Mat4) -> Self {
        let direction = Mat3::from_mat4(matrix);
        let Mat3 { x_axis: x, y_axis: y, z_axis: z } = direction;
        let cofactors = Mat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
        let mirrored = direction.determinant() < 0.0;
        let normal = if mirrored { -cofactors } else { cofactors };
        Self { point: matrix, direction, normal, mirrored }
    }
}

/// A mesh with each vertex where `place` takes it. Mirrored triangles turn their winding, so that fronts stay
/// fronts (glTF 2.0, 3.7.4).
pub(super) fn placed(rest: &Mesh, place: impl Fn(usize) -> VertexTransform) -> Mesh {
    let places = || (0..rest.positions.len()).map(&place);
    let unit = |direction: Vec3| direction.normalize_or_zero();
    Mesh {
        name: rest.name.clone(),
        material: rest.material,
        positions: rest
            .positions
            .iter()
            .zip(places())
            .map(|(p, place)| place.point.transform_point3(*p))
            .collect(),
        normals: rest.normals.iter().zip(places()).map(|(n, place)| unit(place.normal * *n)).collect(),
        tangents: rest
            .tangents
            .iter()
            .zip(places())
            .map(|(t, place)| {
                let sign = if place.mirrored { -t.w } else { t.w };
                unit(place.direction * t.truncate()).extend(sign)
            })
            .collect(),
        displacements: Vec::new(),
        uvs: rest.uvs.clone(),
        colours: rest.colours.clone(),
        triangles: rest
            .triangles
            .iter()
            .map(|&[a, b, c]| if place(a as usize).mirrored { [a, c, b] } else { [a, b, c] })
            .collect(),
    }
}
