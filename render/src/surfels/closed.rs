//! Which triangles belong to closed surfaces. Of these only fronts are seen from outside, so that a body hides what is behind it
//! once: with their backs, of which surfels know nothing else, its far half would hide as much again.

use crate::scene::Mesh;
use rayon::prelude::*;

/// Of each triangle of a mesh, whether the surface that it is connected to has no edge: beside each of its triangles, the way
/// round that triangles that share an edge have, lies another one. Vertices at one place are one.
pub fn closed(mesh: &Mesh) -> Vec<bool> {
    let places = places(mesh);
    let corners = |triangle: &[u32; 3]| triangle.map(|vertex| places[vertex as usize]);
    let mut surfaces = Surfaces::new(places.len());
    let mut edges = Vec::with_capacity(3 * mesh.triangles.len());
    for [a, b, c] in mesh.triangles.iter().map(corners) {
        surfaces.join(a, b);
        surfaces.join(b, c);
        edges.extend([(a, b), (b, c), (c, a)].map(|(from, to)| (from.min(to), from.max(to), from < to)));
    }
    edges.par_sort_unstable();
    let mut open = vec![false; places.len()];
    for edge in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let forwards = edge.iter().filter(|(.., forwards)| *forwards).count();
        if 2 * forwards != edge.len() {
            open[surfaces.of(edge[0].0) as usize] = true;
        }
    }
    mesh.triangles.iter().map(|triangle| !open[surfaces.of(corners(triangle)[0]) as usize]).collect()
}

/// Of each vertex the first one that is where it is.
fn places(mesh: &Mesh) -> Vec<u32> {
    // 0 and -0 are one place.
    let bits = |vertex: u32| (mesh.positions[vertex as usize] + 0.0).to_array().map(f32::to_bits);
    let mut order: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    order.par_sort_unstable_by_key(|vertex| (bits(*vertex), *vertex));
    let mut places = vec![0; order.len()];
    for together in order.chunk_by(|a, b| bits(*a) == bits(*b)) {
        together.iter().for_each(|vertex| places[*vertex as usize] = together[0]);
    }
    places
}

/// Vertices that edges connect, as a forest: each leads to another one, and the root to itself.
struct Surfaces(Vec<u32>);

impl Surfaces {
    fn new(vertices: usize) -> Self {
        Self((0..vertices as u32).collect())
    }

    /// The root of a vertex.
    fn of(&mut self, vertex: u32) -> u32 {
        let mut at = vertex;
        while self.0[at as usize] != at {
            // Half of the way is cut each time.
            self.0[at as usize] = self.0[self.0[at as usize] as usize];
            at = self.0[at as usize];
        }
        at
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.of(a), self.of(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// A tetrahedron whose sides have vertices of their own.
    fn tetrahedron(at: Vec3) -> Mesh {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let sides = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let positions = sides.iter().flatten().map(|corner| at + corners[*corner]).collect();
        let triangles = (0..4).map(|side| [3 * side, 3 * side + 1, 3 * side + 2]).collect();
        Mesh { positions, triangles, ..Mesh::default() }
    }

    #[test]
    fn a_body_is_closed_until_a_side_is_missing_or_turned_over() {
        let body = tetrahedron(Vec3::ZERO);
        assert_eq!(closed(&body), [true; 4]);
        let mut holed = body.clone();
        holed.triangles.pop();
        assert_eq!(closed(&holed), [false; 3]);
        let mut turned = body.clone();
        turned.triangles[1].swap(0, 1);
        assert_eq!(closed(&turned), [false; 4]);
        let mut nothing = body;
        nothing.triangles.clear();
        assert!(closed(&nothing).is_empty());
    }

    #[test]
    fn surfaces_of_one_mesh_are_told_apart() {
        let (mut both, other) = (tetrahedron(Vec3::ZERO), tetrahedron(Vec3::new(5.0, 0.0, 0.0)));
        both.positions.extend(other.positions);
        both.triangles.extend(other.triangles[..3].iter().map(|triangle| triangle.map(|vertex| vertex + 12)));
        assert_eq!(closed(&both), [true, true, true, true, false, false, false]);
    }

    #[test]
    fn a_sheet_with_two_sides_is_closed() {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        let one = Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() };
        assert_eq!(closed(&one), [false]);
        let two = Mesh { triangles: vec![[0, 1, 2], [0, 2, 1]], ..one };
        assert_eq!(closed(&two), [true, true]);
    }
}
