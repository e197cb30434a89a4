//! Closed solids: boxes, spheres and the like. All stand on y = 0 unless they say otherwise.

use super::shape::Shape;
use super::sweep::{lathe, sweep};
use glam::{Vec2, Vec3};
use std::collections::HashMap;
use std::f32::consts::{PI, TAU};

/// The six directions of a cube's faces, each with two that span the face: `normal = right x up`.
const FACES: [[Vec3; 3]; 6] = [
    [Vec3::X, Vec3::NEG_Z, Vec3::Y],
    [Vec3::NEG_X, Vec3::Z, Vec3::Y],
    [Vec3::Y, Vec3::X, Vec3::NEG_Z],
    [Vec3::NEG_Y, Vec3::X, Vec3::Z],
    [Vec3::Z, Vec3::X, Vec3::Y],
    [Vec3::NEG_Z, Vec3::NEG_X, Vec3::Y],
];

/// A box with edges `x`, `y` and `z`.
pub fn cuboid(x: f32, y: f32, z: f32) -> Shape {
    let half = 0.5 * Vec3::new(x, y, z);
    let mut shape = Shape::default();
    for [normal, right, up] in FACES {
        let corner = |a: f32, b: f32| (normal + right * a + up * b) * half + Vec3::Y * half.y;
        shape.polygon(&[corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
    }
    shape
}

/// A box between two opposite corners, the first the lowest.
pub fn block(low: Vec3, high: Vec3) -> Shape {
    let size = high - low;
    cuboid(size.x, size.y, size.z).moved(0.5 * (low.x + high.x), low.y, 0.5 * (low.z + high.z))
}

/// A box with edges and corners rounded with `radius`, in `steps` steps from face to edge.
pub fn rounded_box(x: f32, y: f32, z: f32, radius: f32, steps: usize) -> Shape {
    let half = 0.5 * Vec3::new(x, y, z);
    let radius = radius.min(0.999 * half.min_element());
    let core = half - Vec3::splat(radius);
    let mut shape = Shape::default();
    for [normal, right, up] in FACES {
        let first = shape.positions.len() as u32;
        let lines = 2 * steps as u32 + 2;
        // Two lines of vertices on the flat part's borders, the others on the rounded rims.
        let line = |i: u32, half: f32| {
            let step = radius / steps as f32;
            let side = i.min(lines - 1 - i) as f32 * step;
            if i <= steps as u32 { side - half } else { half - side }
        };
        for row in 0..lines {
            for column in 0..lines {
                let a = line(column, right.dot(half).abs());
                let b = line(row, up.dot(half).abs());
                let on_cube = normal * half + right * a + up * b;
                let inner = on_cube.clamp(-core, core);
                let outward = (on_cube - inner).normalize();
                shape.vertex(inner + outward * radius + Vec3::Y * half.y, outward, Vec2::new(a, -b));
            }
        }
        for row in 0..lines - 1 {
            for column in 0..lines - 1 {
                let at = first + row * lines + column;
                shape.connect([at, at + 1, at + lines + 1, at + lines]);
            }
        }
    }
    shape
}

/// A bevelled box: [`rounded_box`] in the least number of steps.
pub fn bevelled_box(x: f32, y: f32, z: f32, bevel: f32) -> Shape {
    rounded_box(x, y, z, bevel, 1)
}

/// A cylinder.
pub fn cylinder(radius: f32, height: f32, sides: usize) -> Shape {
    frustum(radius, radius, height, sides)
}

/// A cone without its tip, or with it where `top` is 0.
pub fn frustum(bottom: f32, top: f32, height: f32, sides: usize) -> Shape {
    lathe(&[Vec2::ZERO, Vec2::new(bottom, 0.0), Vec2::new(top, height), Vec2::new(0.0, height)], sides)
}

/// A cylinder without a middle.
pub fn pipe(outer: f32, inner: f32, height: f32, sides: usize) -> Shape {
    let corners = [(inner, 0.0), (outer, 0.0), (outer, height), (inner, height), (inner, 0.0)];
    lathe(&corners.map(|(x, y)| Vec2::new(x, y)), sides)
}

/// A sphere that stands on y = 0, with `sides` meridians.
pub fn sphere(radius: f32, sides: usize) -> Shape {
    let rings = (sides / 2).max(3);
    let point = |i| Vec2::from_angle(PI * (i as f32 / rings as f32 - 0.5)) * radius + Vec2::Y * radius;
    let mut profile: Vec<Vec2> = (0..=rings).map(point).collect();
    profile[0].x = 0.0;
    profile[rings].x = 0.0;
    lathe(&profile, sides)
}

/// A ring around the y axis with its middle on y = 0; `radius` to the middle of the tube.
pub fn torus(radius: f32, tube: f32, sides: usize, tube_sides: usize) -> Shape {
    let point = |i| {
        Vec2::new(radius, 0.0) + Vec2::from_angle(TAU * (i % tube_sides) as f32 / tube_sides as f32) * tube
    };
    lathe(&(0..=tube_sides).map(point).collect::<Vec<_>>(), sides)
}

/// A bar of rectangular section from one point to another; `height` is measured upwards as far as the bar
/// allows.
pub fn beam(from: Vec3, to: Vec3, width: f32, height: f32) -> Shape {
    let half = 0.5 * Vec2::new(width, height);
    let section = [-half, Vec2::new(half.x, -half.y), half, Vec2::new(-half.x, half.y)];
    sweep(&section, &[from, to], |_| 1.0)
}

/// A sphere around the origin of nearly equal triangles (20 * 4^`divisions`), made to be bent: its vertices
/// are shared.
pub fn icosphere(radius: f32, divisions: u32) -> Shape {
    let (mut points, mut triangles) = icosahedron();
    for _ in 0..divisions {
        triangles = divided(&mut points, &triangles);
    }
    let positions: Vec<Vec3> = points.iter().map(|point| point * radius).collect();
    let uvs = positions.iter().map(|position| Vec2::new(position.x + position.z, position.y)).collect();
    Shape { positions, normals: points, uvs, triangles }
}

/// Corners and faces of the regular icosahedron of circumradius 1.
fn icosahedron() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let ring = |start: usize, y: f32| {
        (0..5).map(move |i| {
            let around = Vec2::from_angle(-TAU * (2 * i + start) as f32 / 10.0) * 2.0;
            Vec3::new(around.x, y, around.y) / 5f32.sqrt()
        })
    };
    let points =
        [Vec3::Y].into_iter().chain(ring(0, 1.0)).chain(ring(1, -1.0)).chain([Vec3::NEG_Y]).collect();
    let mut triangles = Vec::new();
    for i in 0..5 {
        let next = (i + 1) % 5;
        let (upper, upper_next, lower, lower_next) = (1 + i, 1 + next, 6 + i, 6 + next);
        triangles.push([0, upper, upper_next]);
        triangles.push([upper, lower, upper_next]);
        triangles.push([upper_next, lower, lower_next]);
        triangles.push([11, lower_next, lower]);
    }
    (points, triangles)
}

/// Cuts every triangle into four, with the new vertices on the unit sphere.
fn divided(points: &mut Vec<Vec3>, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut middles = HashMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            points.push((points[a as usize] + points[b as usize]).normalize());
            points.len() as u32 - 1
        })
    };
    let mut finer = Vec::with_capacity(4 * triangles.len());
    for &[a, b, c] in triangles {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    finer
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Volumes within `tolerance` of the closed form, from below: inscribed polygons are smaller.
    fn check(shape: &Shape, volume: f32, tolerance: f32) {
        let ratio = shape.signed_volume() / volume;
        assert!(ratio > 1.0 - tolerance && ratio < 1.0 + 1e-4, "{ratio}");
        for (triangle, corners) in shape.triangles.iter().map(|t| (t, t.map(|v| shape.positions[v as usize])))
        {
            let flat = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            assert!(triangle.iter().all(|v| flat.dot(shape.normals[*v as usize]) > 0.0));
        }
        assert!(shape.normals.iter().all(|normal| (normal.length() - 1.0).abs() < 1e-4));
    }

    #[test]
    fn solids_are_closed_with_outward_triangles() {
        check(&cuboid(1.0, 2.0, 3.0), 6.0, 1e-5);
        check(&block(Vec3::new(1.0, 2.0, 3.0), Vec3::new(2.0, 4.0, 6.0)), 6.0, 1e-5);
        check(&rounded_box(1.0, 2.0, 3.0, 0.05, 3), 6.0, 0.02);
        check(&bevelled_box(1.0, 2.0, 3.0, 0.01), 6.0, 0.01);
        check(&cylinder(0.5, 2.0, 64), PI * 0.5, 0.01);
        check(&frustum(1.0, 0.0, 3.0, 64), PI, 0.01);
        check(&pipe(1.0, 0.5, 1.0, 64), PI * 0.75, 0.01);
        check(&sphere(1.0, 64), 4.0 / 3.0 * PI, 0.01);
        check(&torus(2.0, 0.5, 64, 32), TAU * 2.0 * PI * 0.25, 0.02);
        check(&beam(Vec3::new(1.0, 2.0, 0.0), Vec3::new(1.0, 2.0, 5.0), 0.2, 0.4), 0.4, 1e-4);
        check(&beam(Vec3::new(1.0, 2.0, 0.0), Vec3::new(1.0, 7.0, 0.0), 0.2, 0.4), 0.4, 1e-4);
        check(&icosphere(1.0, 4), 4.0 / 3.0 * PI, 0.01);
    }

    #[test]
    fn reversed_solids_have_negative_volume() {
        assert!(cuboid(1.0, 1.0, 1.0).reversed().signed_volume() < -0.99);
    }

    #[test]
    fn beams_are_as_high_as_they_say() {
        let shape = beam(Vec3::ZERO, Vec3::new(3.0, 0.0, 0.0), 0.2, 0.6);
        let highest = shape.positions.iter().fold(0f32, |highest, position| highest.max(position.y));
        assert!((highest - 0.3).abs() < 1e-6);
    }
}
