//! Where rays start above a triangle.
//!
//! A hit point is rounded where it is stored, so that it lies in front of its triangle or behind. Rays start
//! above it by a bound of that error (Waechter and Binder, "A Fast and Robust Method for Avoiding
//! Self-Intersection", Ray Tracing Gems, 2019; Pharr, Jakob and Humphreys, "Physically Based Rendering",
//! 6.8). The error has two parts: roundings of the world's coordinates, which grow with the distance from the
//! world's origin, and roundings on the triangle, which grow with its size. Both bounds are tight: what a ray
//! starts too high is lost in corners.
//!
//! In a corner even the least lift can reach through the next wall, from where the ray would leave the room.
//! Rays therefore start away from the triangle's edges as well, by a few times the lift: so they stay on
//! their side of every wall that meets the triangle at an edge by more than 18 degrees. Nothing else moves:
//! the point that is shaded stays.

use glam::Vec3;

/// Roundings of a coordinate, in parts of it: half the distance to the next number of f32 for the point, for
/// the start above it and for the corners of triangles that move, and one more.
const OF_COORDINATES: f32 = 2.4e-7;

/// Roundings on a triangle, in parts of its extent: 34 of 6e-8. The point, blended from the corners, and the
/// triangle's plane, seen from there, make fewer than 30.
const OF_EXTENT: f32 = 2e-6;

/// How far from the edges of its triangle a ray starts, in parts of the lift: the cotangent of 18 degrees.
const INSET: f32 = 3.0;

/// How far along its triangle a start may move, in parts of the distance from the edges that is wanted: on a
/// strip narrower than that the middle may be far away.
const FARTHEST: f32 = 10.0;

/// Where rays start at a point of a triangle, as far as it does not depend on the side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Start {
    /// Not too near to the edges, world space, metres.
    on_triangle: Vec3,
    /// How far above the triangle, metres.
    lift: f32,
}

impl Start {
    /// At the point with these weights of the corners, of a triangle with this unit normal.
    pub(crate) fn new(corners: [Vec3; 3], weights: [f32; 3], normal: Vec3) -> Self {
        let rounding = corners.map(Vec3::abs).into_iter().fold(Vec3::ZERO, Vec3::max) * OF_COORDINATES;
        let on_plane = extent(corners) * OF_EXTENT;
        let weights = away_from_edges(corners, weights, INSET * (on_plane + rounding.length()));
        Self { on_triangle: blended(corners, weights), lift: on_plane + normal.abs().dot(rounding) }
    }

    /// The same, above which rays start at least so many metres.
    #[must_use]
    pub(crate) fn raised(self, by: f32) -> Self {
        Self { lift: self.lift.max(by), ..self }
    }

    /// Where rays start on the side of a unit normal.
    pub(crate) fn above(&self, normal: Vec3) -> Vec3 {
        self.on_triangle + normal * self.lift
    }
}

/// The point of a triangle with these weights of its corners: from one corner, so that rounding of the
/// weights does not leave the triangle's plane, and with one rounding of the world's coordinates.
pub(crate) fn blended([a, b, c]: [Vec3; 3], weights: [f32; 3]) -> Vec3 {
    a + ((b - a) * weights[1] + (c - a) * weights[2])
}

/// The longest side of the box around a triangle.
fn extent([a, b, c]: [Vec3; 3]) -> f32 {
    (a.max(b).max(c) - a.min(b).min(c)).max_element()
}

/// Weights of the corners of a point that is at least `margin` metres from each edge, or as far from all as
/// the triangle allows: moved square to the edges that are too near, and where that brings it too near to
/// another, towards the middle of the inscribed circle. Points that are far enough stay as they are.
fn away_from_edges(corners: [Vec3; 3], weights: [f32; 3], margin: f32) -> [f32; 3] {
    let edges = Edges::new(corners);
    let near = |weights: [f32; 3]| (0..3).any(|edge| weights[edge] < edges.least(edge, margin));
    if !near(weights) || edges.twice_area == 0.0 {
        return weights;
    }
    let moved = (0..3).fold(weights, |weights, edge| edges.at_least(weights, edge, margin));
    if near(moved) { edges.towards_middle(moved, margin) } else { moved }
}

/// The edges of a triangle, each opposite the corner of its number.
struct Edges {
    edges: [Vec3; 3],
    lengths: [f32; 3],
    twice_area: f32,
}

impl Edges {
    fn new([a, b, c]: [Vec3; 3]) -> Self {
        let edges = [c - b, a - c, b - a];
        let twice_area = edges[0].cross(edges[1]).length();
        Self { edges, lengths: edges.map(Vec3::length), twice_area }
    }

    /// The weight of a corner where a point is `margin` metres from the edge opposite.
    fn least(&self, edge: usize, margin: f32) -> f32 {
        self.lengths[edge] * margin / self.twice_area
    }

    /// Weights of the point, moved square to an edge until it is `margin` metres from it, if it is nearer.
    fn at_least(&self, weights: [f32; 3], edge: usize, margin: f32) -> [f32; 3] {
        let missing = self.least(edge, margin) - weights[edge];
        if missing <= 0.0 {
            return weights;
        }
        // What one corner's weight gains the two others lose, each by the cosine of the angle at the other.
        let squared = self.lengths[edge] * self.lengths[edge];
        let mut moved = weights;
        moved[edge] += missing;
        for other in [(edge + 1) % 3, (edge + 2) % 3] {
            moved[other] += missing * self.edges[other].dot(self.edges[edge]) / squared;
        }
        moved
    }

    /// Weights of the first point on the way to the middle of the inscribed circle that is `margin` metres
    /// from all edges, or of the middle itself, but no farther than [`FARTHEST`] margins away.
    fn towards_middle(&self, weights: [f32; 3], margin: f32) -> [f32; 3] {
        let perimeter: f32 = self.lengths.iter().sum();
        let middle = self.lengths.map(|length| length / perimeter);
        // Of the way, what each edge asks for.
        let share = |edge: usize| {
            let missing = self.least(edge, margin) - weights[edge];
            missing / (middle[edge] - weights[edge]).max(missing)
        };
        let share = (0..3).filter(|edge| weights[*edge] < self.least(*edge, margin)).map(share);
        let way = self.edges[2] * (middle[1] - weights[1]) - self.edges[1] * (middle[2] - weights[2]);
        let farthest = FARTHEST * margin / way.length().max(f32::MIN_POSITIVE);
        let share = share.fold(0.0f32, f32::max).min(1.0).min(farthest);
        [0, 1, 2].map(|corner| weights[corner] + (middle[corner] - weights[corner]) * share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [Vec3; 3] = [Vec3::ZERO, Vec3::new(4.0, 0.0, 0.0), Vec3::new(0.0, 3.0, 0.0)];

    /// Distances of a point of the triangle of sides 3, 4 and 5 from its edges.
    fn distances(weights: [f32; 3]) -> [f32; 3] {
        let point = blended(CORNERS, weights);
        [point.y, point.x, (12.0 - 3.0 * point.x - 4.0 * point.y) / 5.0]
    }

    fn least(weights: [f32; 3]) -> f32 {
        distances(weights).into_iter().fold(f32::INFINITY, f32::min)
    }

    #[test]
    fn points_keep_away_from_the_edges_and_others_stay() {
        for weights in [[1.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.01, 0.98, 0.01], [0.0, 0.2, 0.8]] {
            assert!(least(weights) < 0.05);
            let moved = away_from_edges(CORNERS, weights, 0.1);
            assert!((least(moved) - 0.1).abs() < 1e-5, "{:?}", distances(moved));
            assert!((moved.iter().sum::<f32>() - 1.0).abs() < 1e-6);
        }
        let inside = [0.3, 0.3, 0.4];
        assert_eq!(away_from_edges(CORNERS, inside, 0.1), inside);
    }

    #[test]
    fn points_move_square_to_the_edge_that_is_near() {
        // Half way along the longest edge, and of a splinter a thousand times as long as it is high.
        let splinter = [Vec3::ZERO, Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.1, 1e-3, 0.0)];
        for (corners, weights, edge, margin) in
            [(CORNERS, [0.0, 0.5, 0.5], 0, 0.1), (splinter, [0.4, 0.6, 0.0], 2, 1e-5)]
        {
            let moved = blended(corners, away_from_edges(corners, weights, margin));
            let way = moved - blended(corners, weights);
            let along = (corners[(edge + 1) % 3] - corners[(edge + 2) % 3]).normalize();
            assert!((way.length() / margin - 1.0).abs() < 1e-2, "{way}");
            assert!(way.dot(along).abs() < 2e-2 * margin, "{way} along {along}");
        }
    }

    #[test]
    fn on_a_strip_narrower_than_the_margin_a_start_stays_near() {
        let strip = [Vec3::ZERO, Vec3::new(10.0, 0.0, 0.0), Vec3::new(0.0, 1e-4, 0.0)];
        let (weights, margin) = ([0.2, 0.7, 0.1], 5e-4);
        let moved = blended(strip, away_from_edges(strip, weights, margin));
        let way = (moved - blended(strip, weights)).length();
        assert!(way > margin && way < 1.01 * FARTHEST * margin, "{way}");
    }

    #[test]
    fn too_wide_a_margin_leads_to_the_middle_of_the_inscribed_circle() {
        let middle = distances(away_from_edges(CORNERS, [1.0, 0.0, 0.0], 5.0));
        assert!(middle.iter().all(|distance| (distance - 1.0).abs() < 1e-5), "{middle:?}");
        let without_area = [Vec3::ZERO, Vec3::X, Vec3::X * 2.0];
        assert_eq!(away_from_edges(without_area, [0.2, 0.3, 0.5], 0.1), [0.2, 0.3, 0.5]);
    }

    #[test]
    fn the_lift_follows_the_triangle_s_extent_and_its_coordinate_across() {
        let lift = |offset: Vec3, normal| {
            let corners = CORNERS.map(|corner| corner + offset);
            Start::new(corners, [0.3, 0.3, 0.4], normal).lift
        };
        assert!((lift(Vec3::ZERO, Vec3::Z) - 4.0 * OF_EXTENT).abs() < 1e-9);
        // Along the wall, nothing is rounded that would count.
        assert!((lift(Vec3::X * 1e5, Vec3::Z) - 4.0 * OF_EXTENT).abs() < 1e-9);
        let far = lift(Vec3::Z * 1e5, Vec3::Z);
        assert!(far > 1e5 * f32::EPSILON && far < 4.0 * 1e5 * f32::EPSILON, "{far}");
    }
}
