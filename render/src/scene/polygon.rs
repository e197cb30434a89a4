//! Polygons as triangles.

use earcut::Earcut;
use glam::{DVec2, DVec3, Vec3};

/// Twice a polygon's area along its normal (Newell; Sutherland et al. 1974, "A Characterization of Ten
/// Hidden-Surface Algorithms", 3.1), relative to its first corner.
pub(super) fn area_vector(corners: &[Vec3]) -> DVec3 {
    let from_first = |corner: &Vec3| (*corner - corners[0]).as_dvec3();
    corners.windows(2).map(|edge| from_first(&edge[0]).cross(from_first(&edge[1]))).sum()
}

/// Cuts polygons into triangles; kept from one to the next for its memory.
pub(super) struct Cutter {
    earcut: Earcut<f64>,
    flat: Vec<DVec2>,
    triangles: Vec<u32>,
}

impl Cutter {
    pub fn new() -> Self {
        Self { earcut: Earcut::new(), flat: Vec::new(), triangles: Vec::new() }
    }

    /// Triangles of a polygon of three corners or more, as places in its list, wound as it is: a fan around
    /// the first corner where that covers it, as it does where the polygon is convex, else ears that are cut
    /// off in its own plane.
    pub fn triangles(&mut self, corners: &[Vec3]) -> impl Iterator<Item = [u32; 3]> + '_ {
        let normal = area_vector(corners);
        self.triangles.clear();
        if corners.len() > 3 && !is_covered_by_fan(corners, normal) {
            self.cut_ears(corners, normal);
        }
        // Nothing can be cut off a polygon without an area.
        if self.triangles.is_empty() {
            self.triangles.extend((2..corners.len() as u32).flat_map(|i| [0, i - 1, i]));
        }
        self.triangles.as_chunks::<3>().0.iter().copied()
    }

    fn cut_ears(&mut self, corners: &[Vec3], normal: DVec3) {
        let Some(axis) = normal.try_normalize() else { return };
        let (right, up) = axis.any_orthonormal_pair();
        let flat = |corner: &Vec3| {
            let from_first = (*corner - corners[0]).as_dvec3();
            DVec2::new(from_first.dot(right), from_first.dot(up))
        };
        self.flat.clear();
        self.flat.extend(corners.iter().map(flat));
        if !self.flat.iter().all(|corner| corner.is_finite()) {
            return;
        }
        let points = self.flat.iter().map(DVec2::to_array);
        self.earcut.earcut(points, &[], &mut self.triangles);
        for triangle in self.triangles.as_chunks_mut::<3>().0 {
            let [a, b, c] = triangle.map(|corner| self.flat[corner as usize]);
            if (b - a).perp_dot(c - a) < 0.0 {
                triangle.swap(1, 2);
            }
        }
    }
}

/// Whether no triangle of the fan around the first corner is turned over.
fn is_covered_by_fan(corners: &[Vec3], normal: DVec3) -> bool {
    let from_first = |corner: &Vec3| (*corner - corners[0]).as_dvec3();
    let least = -1e-6 * normal.length_squared();
    corners[1..].windows(2).all(|edge| from_first(&edge[0]).cross(from_first(&edge[1])).dot(normal) >= least)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cut(corners: &[Vec3]) -> Vec<[u32; 3]> {
        Cutter::new().triangles(corners).collect()
    }

    /// Twice the areas along an axis of the triangles that hold a point of the plane across it.
    fn covering(corners: &[Vec3], point: Vec3, axis: Vec3) -> Vec<f32> {
        let side = |a: Vec3, b: Vec3, p: Vec3| (b - a).cross(p - a).dot(axis);
        let holds = |[a, b, c]: &[Vec3; 3]| {
            let sides = [side(*a, *b, point), side(*b, *c, point), side(*c, *a, point)];
            sides.iter().all(|side| *side > 0.0) || sides.iter().all(|side| *side < 0.0)
        };
        let triangles = cut(corners).into_iter().map(|t| t.map(|corner| corners[corner as usize]));
        triangles.filter(holds).map(|[a, b, c]| side(a, b, c)).collect()
    }

    #[test]
    fn convex_polygons_are_fans() {
        let corner = |i: usize| Vec3::new((i as f32).cos(), (i as f32).sin(), 2.0);
        let hexagon: Vec<Vec3> = (0..6).map(corner).collect();
        assert_eq!(cut(&hexagon), [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]);
        assert_eq!(cut(&hexagon[..3]), [[0, 1, 2]]);
    }

    #[test]
    fn a_notch_stays_empty_wherever_the_polygon_begins_and_however_it_lies() {
        let flat = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [0.0, -0.5], [-1.0, 1.0]];
        type Embedding = fn(f32, f32) -> Vec3;
        let places: [(Embedding, Vec3); 3] = [
            (|x, y| Vec3::new(x, y, 3.0), Vec3::Z),
            (|x, y| Vec3::new(7.0, x, y), Vec3::X),
            (|x, y| Vec3::new(y, 100.0, x), Vec3::Y),
        ];
        for (place, axis) in places {
            for first in 0..5 {
                let mut corners = flat.map(|[x, y]| place(x, y)).to_vec();
                corners.rotate_left(first);
                let inside = covering(&corners, place(0.1, -0.9), axis);
                assert!(inside.len() == 1 && inside[0] > 0.0, "{inside:?}, {axis} from {first}");
                assert!(covering(&corners, place(0.0, 0.3), axis).is_empty(), "{axis} from {first}");
                corners.reverse();
                let back = covering(&corners, place(0.1, -0.9), axis);
                assert!(back.len() == 1 && back[0] < 0.0, "{back:?}: wound as the polygon is");
            }
        }
    }

    #[test]
    fn a_polygon_without_an_area_or_with_infinite_corners_is_a_fan() {
        let line: Vec<Vec3> = [0.0, 1.0, 2.0, 0.5].map(Vec3::splat).to_vec();
        assert_eq!(cut(&line), [[0, 1, 2], [0, 2, 3]]);
        let infinite = [Vec3::ZERO, Vec3::X * f32::INFINITY, Vec3::NAN, Vec3::Y];
        assert_eq!(cut(&infinite), [[0, 1, 2], [0, 2, 3]]);
    }
}
