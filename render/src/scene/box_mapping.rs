//! Texture coordinates for meshes that have none: an object is put into a box, and every triangle takes the
//! picture from the side of the box that it faces most ("automatic per-object box mapping", thesis 7.3.1).

use super::Mesh;
use glam::{Vec2, Vec3};

/// Gives a mesh its first set of texture coordinates where that is empty: across and down each side of the
/// mesh's box, in lengths of the box's longest edge. Vertices that triangles of different sides share become
/// several. A mesh with coordinates, or without triangles, stays as it is.
pub fn box_map(mesh: &mut Mesh) {
    if !mesh.uvs[0].is_empty() || mesh.triangles.is_empty() {
        return;
    }
    let bounds = mesh.bounds();
    let longest = bounds.size().max_element();
    let mut mapped =
        Mesh { name: std::mem::take(&mut mesh.name), material: mesh.material, ..Mesh::default() };
    // What a vertex has become on each of the six sides.
    let mut places = vec![[u32::MAX; 6]; mesh.positions.len()];
    for triangle in 0..mesh.triangles.len() {
        let side = side_of(mesh.corners(triangle));
        let corners = mesh.triangles[triangle].map(|vertex| {
            let place = &mut places[vertex as usize][side];
            if *place == u32::MAX {
                *place = mapped.positions.len() as u32;
                copy_vertex(mesh, vertex as usize, &mut mapped);
                let inside = (mesh.positions[vertex as usize] - bounds.min) / longest;
                mapped.uvs[0].push(across(inside, side));
            }
            *place
        });
        mapped.triangles.push(corners);
    }
    *mesh = mapped;
}

/// Which side of a box a triangle faces most: twice the axis, and one more where it faces against it.
fn side_of([a, b, c]: [Vec3; 3]) -> usize {
    let normal = (b - a).cross(c - a);
    let axis = normal.abs().max_position();
    2 * axis + usize::from(normal[axis] < 0.0)
}

/// Coordinates of a point of a side, seen from outside: to the right and, as images go, down.
fn across(point: Vec3, side: usize) -> Vec2 {
    let Vec3 { x, y, z } = point;
    match side {
        0 => Vec2::new(-z, -y),
        1 => Vec2::new(z, -y),
        2 => Vec2::new(x, z),
        3 => Vec2::new(x, -z),
        4 => Vec2::new(x, -y),
        _ => Vec2::new(-x, -y),
    }
}

/// Appends a vertex with all that it has but its first set of texture coordinates.
fn copy_vertex(from: &Mesh, vertex: usize, to: &mut Mesh) {
    to.positions.push(from.positions[vertex]);
    to.normals.extend(from.normals.get(vertex));
    to.displacements.extend(from.displacements.get(vertex));
    to.tangents.extend(from.tangents.get(vertex));
    to.uvs[1].extend(from.uvs[1].get(vertex));
    to.colours.extend(from.colours.get(vertex));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box of 2 x 1 x 4 m with eight vertices.
    fn block() -> Mesh {
        let corner = |i: u32| Vec3::new((i & 1) as f32 * 2.0, (i >> 1 & 1) as f32, (i >> 2) as f32 * 4.0);
        let faces = [[0u32, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        Mesh {
            positions: (0..8).map(corner).collect(),
            colours: (0..8).map(|i| glam::Vec4::splat(i as f32)).collect(),
            triangles: faces.iter().flat_map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]]).collect(),
            ..Mesh::default()
        }
    }

    #[test]
    fn every_side_shows_the_picture_upright_and_unstretched() {
        let (before, mut mesh) = (block(), block());
        box_map(&mut mesh);
        assert_eq!((mesh.positions.len(), mesh.uvs[0].len()), (24, 24), "a vertex of its own for each side");
        for triangle in 0..12 {
            assert_eq!(mesh.corners(triangle), before.corners(triangle));
            let [p, q, r] = mesh.corners(triangle);
            let [a, b, c] = mesh.triangles[triangle].map(|vertex| mesh.uvs[0][vertex as usize]);
            // Lengths are those of space in units of the longest edge, and the picture is not mirrored: v
            // points down.
            assert!(((b - a).length() - (q - p).length() / 4.0).abs() < 1e-6);
            let area = (b - a).perp_dot(c - a);
            assert!((area + (q - p).cross(r - p).length() / 16.0).abs() < 1e-6, "{triangle}: {area}");
        }
        for (vertex, colour) in mesh.colours.iter().enumerate() {
            assert_eq!(
                mesh.positions[vertex], before.positions[colour.x as usize],
                "what a vertex has moves with it"
            );
        }
    }

    #[test]
    fn what_has_coordinates_keeps_them() {
        let uvs = [vec![Vec2::splat(0.25); 8], Vec::new()];
        let mut mesh = Mesh { uvs, ..block() };
        box_map(&mut mesh);
        assert_eq!((mesh.positions.len(), mesh.uvs[0][3]), (8, Vec2::splat(0.25)));
    }
}
