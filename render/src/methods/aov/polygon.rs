//! The form factor from a point with a normal to the part of a facet that is above the point's tangent plane
//! and within reach, in plain Rust: `shared/facet_form_factor.wgsl`.
//!
//! The integral along the outline of the part (Lambert 1760; Baum, Rushmeier and Winget 1989, "Improving
//! Radiosity Solutions Through the Use of Analytically Determined Form-Factors"): a piece of an edge
//! contributes the angle that it subtends times the cosine of its plane to the normal, an arc of the circle
//! in which the facet's plane cuts the sphere of the reach what `normal . (r x dr) / reach^2` integrates to.

use glam::Vec3;
use std::f32::consts::TAU;

/// The circle in which a plane cuts the sphere around the point, which is the origin.
struct Circle {
    centre: Vec3,
    /// Unit normal of the plane, away from the point; outlines go round it counter-clockwise.
    axis: Vec3,
    radius: f32,
    /// Of the sphere.
    reach: f32,
    /// The point's.
    normal: Vec3,
}

/// What edges contribute to an outline.
struct Outline {
    /// Along it so far, times two pi.
    sum: f32,
    /// Whether an edge is in the circle.
    touched: bool,
    /// Whether the circle's centre is to the left of all edges.
    around: bool,
}

/// The share of the cosine-weighted hemisphere around `normal` that a triangle fills as far as it is within
/// `reach`; nothing if its corners, which are relative to the point, go round clockwise seen from there.
pub fn form_factor(corners: [Vec3; 3], normal: Vec3, reach: f32) -> f32 {
    let [a, b, c] = corners;
    let outwards = (b - a).cross(c - a);
    let distance = -a.dot(outwards) / outwards.length();
    // Not what is no number either.
    let within = distance > 0.0 && distance < reach;
    if !within {
        return 0.0;
    }
    let axis = -outwards.normalize();
    let radius = (reach * reach - distance * distance).sqrt();
    let circle = Circle { centre: distance * axis, axis, radius, reach, normal };
    let mut outline = Outline { sum: 0.0, touched: false, around: true };
    // Seen from the point the corners go round the other way.
    let above = above_horizon(&[c, b, a], normal);
    for (index, begin) in above.iter().enumerate() {
        circle.add_edge(&mut outline, *begin, above[(index + 1) % above.len()]);
    }
    match (outline.touched, outline.around && !above.is_empty()) {
        (true, _) => (outline.sum / TAU).max(0.0),
        (false, true) => normal.dot(axis).max(0.0) * (radius / reach).powi(2),
        (false, false) => 0.0,
    }
}

/// The part of a polygon above the tangent plane of the origin (Sutherland and Hodgman 1974).
fn above_horizon(polygon: &[Vec3], normal: Vec3) -> Vec<Vec3> {
    let mut above = Vec::new();
    for (index, begin) in polygon.iter().enumerate() {
        let end = polygon[(index + 1) % polygon.len()];
        let heights = [normal.dot(*begin), normal.dot(end)];
        if heights[0] > 0.0 {
            above.push(*begin);
        }
        if (heights[0] > 0.0) != (heights[1] > 0.0) {
            above.push(begin.lerp(end, heights[0] / (heights[0] - heights[1])));
        }
    }
    above
}

impl Circle {
    fn add_edge(&self, outline: &mut Outline, begin: Vec3, end: Vec3) {
        let way = end - begin;
        let a = way.length_squared();
        if a == 0.0 {
            return;
        }
        outline.around &= self.axis.dot((begin - self.centre).cross(way)) >= 0.0;
        let b = begin.dot(way);
        let inside = b * b - a * (begin.length_squared() - self.reach * self.reach);
        let half = inside.max(0.0).sqrt();
        let (first, last) = (((-b - half) / a).max(0.0), ((half - b) / a).min(1.0));
        if inside <= 0.0 || first >= last {
            outline.sum += self.round(begin, end);
            return;
        }
        outline.touched = true;
        let (enters, leaves) = (begin + first * way, begin + last * way);
        outline.sum += straight(enters, leaves, self.normal);
        if first > 0.0 {
            outline.sum += self.round(begin, enters);
        }
        if last < 1.0 {
            outline.sum += self.round(leaves, end);
        }
    }

    /// Along the circle, from the direction of one point seen from its centre to that of another.
    fn round(&self, begin: Vec3, end: Vec3) -> f32 {
        let (from, to) = (begin - self.centre, end - self.centre);
        let angle = self.axis.dot(from.cross(end - begin)).atan2(from.dot(to));
        let chord = self.radius * (to.normalize() - from.normalize());
        let swept = self.centre.cross(chord) + self.radius * self.radius * angle * self.axis;
        self.normal.dot(swept) / (self.reach * self.reach)
    }
}

/// Along a straight piece.
fn straight(begin: Vec3, end: Vec3, normal: Vec3) -> f32 {
    // As exact for a short edge as for a long one, which begin.cross(end) is not.
    let across = begin.cross(end - begin);
    let (size, along) = (across.length(), begin.dot(end));
    if size < 1e-30 {
        return 0.0;
    }
    let squared = (size / along).powi(2);
    // Where all angles are small they cancel but for a remainder, which atan2 alone is not exact enough for:
    // a series.
    let angle_over_size = match size < 0.3 * along {
        true => {
            (1.0 - squared * (1.0 / 3.0 - squared * (0.2 - squared * (1.0 / 7.0 - squared / 9.0)))) / along
        }
        false => size.atan2(along) / size,
    };
    angle_over_size * normal.dot(across)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::proving::hemisphere_mean;

    /// A quadrilateral as two triangles; its corners go round counter-clockwise seen from the origin.
    fn quad(corners: [Vec3; 4], normal: Vec3, reach: f32) -> f32 {
        let [a, b, c, d] = corners;
        form_factor([a, b, c], normal, reach) + form_factor([a, c, d], normal, reach)
    }

    /// A horizontal rectangle above the origin, facing down, from one corner to the opposite one.
    fn ceiling(from: [f32; 2], to: [f32; 2], height: f32) -> [Vec3; 4] {
        [[from[0], from[1]], [to[0], from[1]], [to[0], to[1]], [from[0], to[1]]]
            .map(|[x, z]| Vec3::new(x, height, z))
    }

    #[test]
    fn closed_forms() {
        // A rectangle a x b parallel to the surface, a corner straight above at height 1 (Howell,
        // configuration B-3).
        for (a, b) in [(1.0f32, 1.0f32), (0.3, 2.0), (5.0, 0.1)] {
            let (x, y) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
            let right = (a / x * (b / x).atan() + b / y * (a / y).atan()) / TAU;
            let found = quad(ceiling([0.0, 0.0], [a, b], 1.0), Vec3::Y, 1e3);
            assert!((found - right).abs() < 1e-5, "{a} x {b}: {found}, not {right}");
        }
        // A wall without an end at distance d hides half of the sky as d goes to 0, and of what is within
        // reach r the share of a disk beyond a chord at d / r.
        let wall = |d: f32, half: f32| {
            [(-half, 0.0), (half, 0.0), (half, half), (-half, half)].map(|(x, y)| Vec3::new(x, y, -d))
        };
        assert!((quad(wall(1e-3, 1e3), Vec3::Y, 1e4) - 0.5).abs() < 1e-3);
        for d in [0.01f32, 0.3, 0.6, 0.95] {
            let right = (d.acos() - d * (1.0 - d * d).sqrt()) / (0.5 * TAU);
            for half in [1.0, 30.0] {
                let found = quad(wall(d, half), Vec3::Y, 1.0);
                assert!((found - right).abs() < 1e-5, "{d}, {half}: {found}, not {right}");
            }
        }
        // Of a ceiling at height h, within reach r: 1 - (h / r)^2.
        for height in [0.1f32, 0.5, 0.99] {
            let found = quad(ceiling([-7.0, -9.0], [9.0, 7.0], height), Vec3::Y, 1.0);
            assert!((found - (1.0 - height * height)).abs() < 1e-5, "{height}: {found}");
        }
    }

    /// Where a ray from the origin meets a triangle.
    fn distance([a, b, c]: [Vec3; 3], ray: Vec3) -> Option<f32> {
        let normal = (b - a).cross(c - a);
        let at = a.dot(normal) / ray.dot(normal);
        let inside =
            [(a, b), (b, c), (c, a)].iter().all(|(p, q)| normal.dot((q - p).cross(at * ray - p)) >= 0.0);
        (at > 0.0 && inside).then_some(at)
    }

    #[test]
    fn any_triangle_is_the_mean_over_the_hemisphere() {
        let number = |i: u32, of: u32| 2.0 * deepshade_shaders::random::random(i, of, 7, 0) - 1.0;
        let corner = |i: u32, of: u32| {
            Vec3::new(number(i, of), number(i, of + 1), number(i, of + 2)) * (0.5 + i as f32 / 40.0)
        };
        let mut hidden = 0;
        for i in 0..60 {
            let normal = corner(i, 9).normalize();
            let mut corners = [corner(i, 0), corner(i, 3), corner(i, 6)];
            if corners[0].dot(corners[1].cross(corners[2])) > 0.0 {
                assert_eq!(form_factor(corners, normal, 1.0), 0.0, "seen from behind");
                corners.swap(1, 2);
            }
            let right = hemisphere_mean(normal, |ray| {
                f32::from(distance(corners, ray).is_some_and(|distance| distance < 1.0))
            });
            let found = form_factor(corners, normal, 1.0);
            assert!((found - right).abs() < 4e-3, "{i}: {found}, not {right}");
            hidden += usize::from(right > 0.02);
        }
        assert!(hidden > 15, "{hidden}");
    }

    #[test]
    fn parts_add_up() {
        let [a, b, c] = [Vec3::new(-2.0, 0.3, -1.0), Vec3::new(3.0, 0.5, -2.0), Vec3::new(0.5, 0.1, 4.0)];
        let [ab, bc, ca] = [a.midpoint(b), b.midpoint(c), c.midpoint(a)];
        let normal = Vec3::new(0.4, 1.0, 0.1).normalize();
        let whole = form_factor([a, b, c], normal, 1.0);
        let parts = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [bc, ca, ab]];
        let sum: f32 = parts.into_iter().map(|part| form_factor(part, normal, 1.0)).sum();
        assert!(whole > 0.3 && (whole - sum).abs() < 1e-5, "{whole}, in parts {sum}");
    }

    #[test]
    fn degenerate_triangles_hide_nothing() {
        let nan = Vec3::splat(f32::NAN);
        for corners in [[Vec3::Y; 3], [Vec3::Y, Vec3::Y, Vec3::X + Vec3::Y], [Vec3::ZERO; 3], [nan; 3]] {
            assert_eq!(form_factor(corners, Vec3::Y, 1.0), 0.0, "{corners:?}");
        }
        let above = ceiling([-1.0, -1.0], [1.0, 1.0], 0.5);
        assert_eq!(quad(above, Vec3::Y, 0.0), 0.0, "an effect that reaches nowhere");
    }
}
