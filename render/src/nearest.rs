//! The point of a triangle that is next to another point.

use glam::Vec3;

/// The weights of a triangle's corners at its point next to `point` (Ericson 2004, "Real-Time Collision
/// Detection", 5.1.5: which of the corners, edges and the inside it is next to is told by signs of products).
pub fn nearest_in_triangle([a, b, c]: [Vec3; 3], point: Vec3) -> [f32; 3] {
    let (ab, ac) = (b - a, c - a);
    let along = |corner: Vec3| (ab.dot(point - corner), ac.dot(point - corner));
    let ((d1, d2), (d3, d4), (d5, d6)) = (along(a), along(b), along(c));
    let (of_a, of_b, of_c) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
    let share = |part: f32, whole: f32| if whole > 0.0 { (part / whole).clamp(0.0, 1.0) } else { 0.0 };
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    if of_c <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let to_b = share(d1, d1 - d3);
        return [1.0 - to_b, to_b, 0.0];
    }
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    if of_b <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let to_c = share(d2, d2 - d6);
        return [1.0 - to_c, 0.0, to_c];
    }
    if of_a <= 0.0 && d4 >= d3 && d5 >= d6 {
        let to_c = share(d4 - d3, (d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - to_c, to_c];
    }
    let whole = of_a + of_b + of_c;
    let (to_b, to_c) = (share(of_b, whole), share(of_c, whole));
    [1.0 - to_b - to_c, to_b, to_c]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn vector() -> impl Strategy<Value = Vec3> {
        [-2.0f32..2.0, -2.0..2.0, -2.0..2.0].prop_map(Vec3::from_array)
    }

    proptest! {
        #[test]
        fn nothing_in_the_triangle_is_nearer(
            a in vector(), b in vector(), c in vector(), point in vector(), u in 0.0f32..1.0, v in 0.0f32..1.0,
        ) {
            prop_assume!((b - a).cross(c - a).length() > 1e-2);
            let at = |[x, y, z]: [f32; 3]| a * x + b * y + c * z;
            let weights = nearest_in_triangle([a, b, c], point);
            prop_assert!(weights.iter().all(|weight| (-1e-5..=1.00001).contains(weight)), "{weights:?}");
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let other = at([1.0 - u - v, u, v]);
            prop_assert!(at(weights).distance(point) <= other.distance(point) + 1e-3);
        }
    }
}
