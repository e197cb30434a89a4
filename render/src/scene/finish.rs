//! The last step of loading a mesh: what a file may get wrong without being damaged is put right, the rest
//! refused.

use super::Mesh;
use glam::Vec3;

/// A mesh whose vertices are finite and whose normals have unit length; the error says what is wrong with it.
/// Normals without a direction are replaced by the mean of the triangles around the vertex. Tangents are
/// dropped where one of them has no direction, so that they are derived from the texture coordinates instead.
pub(super) fn finish(mut mesh: Mesh) -> Result<Mesh, String> {
    if let Some(vertex) = mesh.positions.iter().position(|position| !position.is_finite()) {
        return Err(format!("mesh `{}`: vertex {vertex} is not finite", mesh.name));
    }
    if !mesh.normals.iter().all(|normal| normal.is_normalized()) {
        repair_normals(&mut mesh);
    }
    if !mesh.tangents.iter().all(|tangent| tangent.truncate().is_normalized()) {
        mesh.tangents.clear();
    }
    Ok(mesh)
}

/// Brings all normals to unit length.
fn repair_normals(mesh: &mut Mesh) {
    let mut means = vec![Vec3::ZERO; mesh.positions.len()];
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
        let normal = (b - a).cross(c - a);
        for vertex in triangle {
            means[*vertex as usize] += normal;
        }
    }
    for (normal, mean) in mesh.normals.iter_mut().zip(means) {
        *normal = normal.try_normalize().unwrap_or_else(|| mean.normalize_or(Vec3::Y));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec4;

    fn triangle() -> Mesh {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        Mesh { name: "corner".into(), positions, triangles: vec![[0, 1, 2]], ..Mesh::default() }
    }

    #[test]
    fn a_normal_without_direction_becomes_that_of_its_triangles() {
        let normals = vec![Vec3::ZERO, Vec3::X * 3.0, Vec3::splat(f32::NAN)];
        let mesh = finish(Mesh { normals, ..triangle() }).expect("finite");
        assert_eq!(mesh.normals, [Vec3::Z, Vec3::X, Vec3::Z]);
    }

    #[test]
    fn tangents_without_direction_are_dropped() {
        let tangents = vec![Vec4::X, Vec4::W, Vec4::X];
        assert!(finish(Mesh { tangents, ..triangle() }).expect("finite").tangents.is_empty());
        let tangents = vec![Vec4::X; 3];
        assert_eq!(finish(Mesh { tangents, ..triangle() }).expect("finite").tangents.len(), 3);
    }

    #[test]
    fn a_vertex_that_is_not_finite_is_named() {
        for bad in [f32::NAN, f32::INFINITY] {
            let mut mesh = triangle();
            mesh.positions[1].y = bad;
            assert_eq!(finish(mesh).expect_err("not finite"), "mesh `corner`: vertex 1 is not finite");
        }
    }
}
