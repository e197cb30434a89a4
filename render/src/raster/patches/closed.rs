//! Which triangles belong to closed surfaces. Of these only fronts are seen from outside, so that a body
//! hides what is behind it once: with their backs, of which surfels know nothing else, its far half would
//! hide as much again.

use crate::scene::Mesh;
use rayon::prelude::*;

/// Vertices nearer than this share of the mesh's diagonal are at one place.
const ONE_PLACE: f32 = 1e-5;

/// Of each triangle of a mesh, whether the surface that it is connected to has no edge: beside each of its
/// triangles, the way round that triangles that share an edge have, lies another one. Vertices at one place
/// are one: seams are no edges.
pub fn closed(mesh: &Mesh) -> Vec<bool> {
    let places = places(mesh);
    let corners = |triangle: &[u32; 3]| triangle.map(|vertex| places[vertex as usize]);
    let mut surfaces = Forest::new(places.len());
    let mut edges = Vec::with_capacity(3 * mesh.triangles.len());
    for [a, b, c] in mesh.triangles.iter().map(corners) {
        surfaces.join(a, b);
        surfaces.join(b, c);
        let sides = [(a, b), (b, c), (c, a)].into_iter().filter(|(from, to)| from != to);
        edges.extend(sides.map(|(from, to)| (from.min(to), from.max(to), from < to)));
    }
    edges.par_sort_unstable();
    let mut open = vec![false; places.len()];
    for edge in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let forwards = edge.iter().filter(|(.., forwards)| *forwards).count();
        if 2 * forwards != edge.len() {
            open[surfaces.root(edge[0].0) as usize] = true;
        }
    }
    mesh.triangles.iter().map(|triangle| !open[surfaces.root(corners(triangle)[0]) as usize]).collect()
}

/// Of each vertex the one that stands for all at its place. Places are the cells of a grid, and of three more
/// that lie a quarter of a cell farther along each axis: of two vertices a rounding error apart, one of them
/// has both in one cell.
fn places(mesh: &Mesh) -> Vec<u32> {
    let bounds = mesh.bounds();
    let cell = (ONE_PLACE * bounds.diagonal()).max(f32::MIN_POSITIVE);
    let mut places = Forest::new(mesh.positions.len());
    let mut order: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    for quarters in [0.0, 0.25, 0.5, 0.75] {
        let of = |vertex: u32| {
            ((mesh.positions[vertex as usize] - bounds.min) / cell + quarters).to_array().map(|at| at as u32)
        };
        order.par_sort_unstable_by_key(|vertex| (of(*vertex), *vertex));
        for together in order.chunk_by(|a, b| of(*a) == of(*b)) {
            together.iter().for_each(|vertex| places.join(together[0], *vertex));
        }
    }
    (0..mesh.positions.len() as u32).map(|vertex| places.root(vertex)).collect()
}

/// What of some numbered things belongs together: each leads to another one, and the root to itself.
struct Forest(Vec<u32>);

impl Forest {
    fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    /// What stands for all that belong together with one.
    fn root(&mut self, one: u32) -> u32 {
        let mut at = one;
        while self.0[at as usize] != at {
            // Half of the way is cut each time.
            self.0[at as usize] = self.0[self.0[at as usize] as usize];
            at = self.0[at as usize];
        }
        at
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
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
    fn rounding_opens_no_seam() {
        // A turn of a full circle does not quite end where it began.
        let mut body = tetrahedron(Vec3::splat(0.371));
        for (index, position) in body.positions.iter_mut().enumerate() {
            *position +=
                3e-7 * Vec3::new(index as f32 % 3.0 - 1.0, index as f32 % 2.0, 1.0 - index as f32 % 3.0);
        }
        assert_eq!(closed(&body), [true; 4]);
        body.positions[0] += 1e-3;
        assert_eq!(closed(&body), [false; 4]);
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
