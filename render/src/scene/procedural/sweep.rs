//! Solids made by moving a flat outline: turned about an axis, pushed along a line, drawn along a curve.

use super::shape::Shape;
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// Cosine of the angle between two pieces of an outline beyond which the edge between them is sharp: 40
/// degrees.
const SHARP: f32 = 0.766;

/// Turns an outline, x the distance from the y axis, about that axis. Going up means facing outwards; an
/// outline from the axis to the axis, or one that ends where it began, gives a closed solid.
pub fn lathe(outline: &[Vec2], sides: usize) -> Shape {
    let mut shape = Shape::default();
    let closed = outline.first() == outline.last();
    let open_part = if closed { &outline[1..] } else { outline };
    let widest = outline.iter().fold(0f32, |widest, point| widest.max(point.x));
    let mut length = 0.0;
    for (i, [start, end]) in edge_normals(open_part, closed).into_iter().enumerate() {
        let (from, to) = (open_part[i], open_part[(i + 1) % open_part.len()]);
        let next_length = length + from.distance(to);
        let first = shape.positions.len() as u32;
        for side in 0..=sides {
            // The last side repeats the first exactly, so that the seam is closed.
            let around = Vec2::from_angle(TAU * (side % sides) as f32 / sides as f32);
            let turn = |point: Vec2| Vec3::new(point.x * around.x, point.y, point.x * around.y);
            let u = TAU * widest * side as f32 / sides as f32;
            shape.vertex(turn(from), turn(start), Vec2::new(u, -length));
            shape.vertex(turn(to), turn(end), Vec2::new(u, -next_length));
        }
        for side in 0..sides as u32 {
            let at = first + 2 * side;
            if to.x > 0.0 {
                shape.triangles.push([at, at + 1, at + 3]);
            }
            if from.x > 0.0 {
                shape.triangles.push([at, at + 3, at + 2]);
            }
        }
        length = next_length;
    }
    shape
}

/// Draws a closed outline, counter-clockwise seen against the path's direction, along a path, scaled by
/// `scale` of the share of the path's points that have passed. A path that ends where it began has no caps.
/// The outline's y points up where the path is level.
pub fn sweep(outline: &[Vec2], path: &[Vec3], scale: impl Fn(f32) -> f32) -> Shape {
    let frames = frames(path);
    let last = path.len() - 1;
    let closed = path[0] == path[last];
    let place = |k: usize, point: Vec2| {
        let [right, up] = frames[k];
        right * point.x + up * point.y
    };
    let size = |k: usize| scale(k as f32 / last as f32);
    let mut shape = Shape::default();
    let mut around = 0.0;
    for (i, [start, end]) in edge_normals(outline, true).into_iter().enumerate() {
        let (from, to) = (outline[i], outline[(i + 1) % outline.len()]);
        let next_around = around + from.distance(to);
        let first = shape.positions.len() as u32;
        let mut along = 0.0;
        for k in 0..=last {
            along += if k > 0 { path[k].distance(path[k - 1]) } else { 0.0 };
            shape.vertex(path[k] + place(k, from * size(k)), place(k, start), Vec2::new(along, around));
            shape.vertex(path[k] + place(k, to * size(k)), place(k, end), Vec2::new(along, next_around));
        }
        for k in 0..last as u32 {
            let at = first + 2 * k;
            shape.connect([at, at + 1, at + 3, at + 2]);
        }
        around = next_around;
    }
    if !closed {
        let cap =
            |k: usize| -> Vec<Vec3> { outline.iter().map(|p| path[k] + place(k, *p * size(k))).collect() };
        shape.join(flat(outline, &cap(0)).reversed());
        shape.join(flat(outline, &cap(last)));
    }
    shape
}

/// A round bar along a path, its radius scaled by `scale` of the share of the path's points that have passed.
pub fn tapered_tube(path: &[Vec3], radius: f32, sides: usize, scale: impl Fn(f32) -> f32) -> Shape {
    sweep(&circle(radius, sides), path, scale)
}

/// A round bar along a path.
pub fn tube(path: &[Vec3], radius: f32, sides: usize) -> Shape {
    tapered_tube(path, radius, sides, |_| 1.0)
}

/// A round bar from one point to another.
pub fn rod(from: Vec3, to: Vec3, radius: f32, sides: usize) -> Shape {
    tube(&[from, to], radius, sides)
}

/// Pushes an outline in x and y, counter-clockwise seen from +z, from z = -`depth` / 2 to `depth` / 2. The
/// outline may be dented, but not cross itself.
pub fn extrude(outline: &[Vec2], depth: f32) -> Shape {
    sweep(outline, &[Vec3::Z * -0.5 * depth, Vec3::Z * 0.5 * depth], |_| 1.0)
}

/// A polygon around a circle.
pub fn circle(radius: f32, sides: usize) -> Vec<Vec2> {
    (0..sides).map(|i| Vec2::from_angle(TAU * i as f32 / sides as f32) * radius).collect()
}

/// Points on a smooth curve through `knots` (Catmull and Rom 1974), `steps` from knot to knot.
pub fn curve(knots: &[Vec3], steps: usize) -> Vec<Vec3> {
    let knot = |i: isize| knots[i.clamp(0, knots.len() as isize - 1) as usize];
    let count = (knots.len() - 1) * steps;
    let point = |k: usize| {
        let i = (k / steps).min(knots.len() - 2) as isize;
        let t = k as f32 / steps as f32 - i as f32;
        let [a, b, c, d] = [knot(i - 1), knot(i), knot(i + 1), knot(i + 2)];
        let linear = (c - a) * t + (a * 2.0 - b * 5.0 + c * 4.0 - d) * (t * t);
        b + 0.5 * (linear + (b * 3.0 - a - c * 3.0 + d) * (t * t * t))
    };
    (0..=count).map(point).collect()
}

/// Unit normals at both ends of each edge of an outline, to the right of its direction; shared where edges
/// meet smoothly.
fn edge_normals(outline: &[Vec2], closed: bool) -> Vec<[Vec2; 2]> {
    let count = outline.len();
    let edges = if closed { count } else { count - 1 };
    let flat: Vec<Vec2> = (0..edges)
        .map(|i| outline[(i + 1) % count] - outline[i])
        .map(|edge| Vec2::new(edge.y, -edge.x).normalize_or(Vec2::X))
        .collect();
    let shared = |own: usize, other: Option<usize>| match other.map(|other| flat[other]) {
        Some(normal) if normal.dot(flat[own]) > SHARP => (normal + flat[own]).normalize(),
        _ => flat[own],
    };
    let before = |i: usize| if i > 0 { Some(i - 1) } else { closed.then_some(edges - 1) };
    let after = |i: usize| if i + 1 < edges { Some(i + 1) } else { closed.then_some(0) };
    (0..edges).map(|i| [shared(i, before(i)), shared(i, after(i))]).collect()
}

/// Two unit vectors across the path at each of its points, `right x up` along the path, turning as little as
/// possible.
fn frames(path: &[Vec3]) -> Vec<[Vec3; 2]> {
    let last = path.len() - 1;
    let closed = path[0] == path[last];
    let tangent = |k: usize| {
        let before = if k > 0 { k - 1 } else { if closed { last - 1 } else { 0 } };
        let after = if k < last { k + 1 } else { if closed { 1 } else { last } };
        (path[after] - path[before]).normalize_or(Vec3::Z)
    };
    let start = tangent(0);
    let mut up = if start.y.abs() > 0.99 { Vec3::NEG_Z } else { Vec3::Y };
    let mut frames = Vec::with_capacity(path.len());
    for k in 0..=last {
        let along = tangent(k);
        let right = up.cross(along).normalize_or(along.any_orthonormal_vector());
        up = along.cross(right);
        frames.push([right, up]);
    }
    if closed {
        frames[last] = frames[0];
    }
    frames
}

/// A flat face of the triangles between the points of an outline, facing the side from which the outline is
/// counter-clockwise.
fn flat(outline: &[Vec2], corners: &[Vec3]) -> Shape {
    let triangles = triangulated(outline);
    let mut shape = Shape { triangles, ..Shape::default() };
    for (corner, uv) in corners.iter().zip(outline) {
        shape.vertex(*corner, Vec3::ZERO, *uv);
    }
    shape.smoothed()
}

/// The triangles of a simple, counter-clockwise polygon, by cutting off ears (Meisters 1975).
fn triangulated(outline: &[Vec2]) -> Vec<[u32; 3]> {
    let mut left: Vec<u32> = (0..outline.len() as u32).collect();
    let mut triangles = Vec::with_capacity(outline.len() - 2);
    let point = |vertex: u32| outline[vertex as usize];
    while left.len() > 3 {
        let count = left.len();
        let corner = |i: usize| [left[(i + count - 1) % count], left[i], left[(i + 1) % count]];
        let is_ear = |i: &usize| {
            let [a, b, c] = corner(*i).map(point);
            let holds = |p: Vec2| turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
            let ours = corner(*i);
            turn(a, b, c) > 0.0 && !left.iter().any(|vertex| !ours.contains(vertex) && holds(point(*vertex)))
        };
        // The roundest ear first keeps triangles from becoming needles; without any ear the outline was not
        // simple, or all its points are in line.
        let best = (0..count).filter(is_ear).max_by(|i, j| {
            let roundness = |i: usize| {
                let [a, b, c] = corner(i).map(point);
                turn(a, b, c) / (a.distance_squared(b) + b.distance_squared(c) + c.distance_squared(a))
            };
            roundness(*i).total_cmp(&roundness(*j))
        });
        let cut = best.unwrap_or(0);
        triangles.push(corner(cut));
        left.remove(cut);
    }
    triangles.push([left[0], left[1], left[2]]);
    triangles
}

/// Twice the area of a triangle, positive where it is counter-clockwise.
fn turn(a: Vec2, b: Vec2, c: Vec2) -> f32 {
    (b - a).perp_dot(c - a)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An L of area 3.
    const DENTED: [Vec2; 6] = [
        Vec2::new(0.0, 0.0),
        Vec2::new(2.0, 0.0),
        Vec2::new(2.0, 1.0),
        Vec2::new(1.0, 1.0),
        Vec2::new(1.0, 2.0),
        Vec2::new(0.0, 2.0),
    ];

    #[test]
    fn dented_outlines_are_filled_without_overlap() {
        let triangles = triangulated(&DENTED);
        let areas: Vec<f32> = triangles
            .iter()
            .map(|t| t.map(|v| DENTED[v as usize]))
            .map(|[a, b, c]| 0.5 * turn(a, b, c))
            .collect();
        assert_eq!(triangles.len(), 4);
        assert!(areas.iter().all(|area| *area > 0.0));
        assert!((areas.iter().sum::<f32>() - 3.0).abs() < 1e-6);
    }

    #[test]
    fn swept_solids_have_the_volume_of_area_times_length() {
        assert!((extrude(&DENTED, 0.5).signed_volume() - 1.5).abs() < 1e-5);
        let path = [Vec3::ZERO, Vec3::new(0.0, 3.0, 0.0)];
        assert!((sweep(&DENTED, &path, |_| 1.0).signed_volume() - 9.0).abs() < 1e-4);
        let ring: Vec<Vec3> = circle(2.0, 64).iter().map(|p| Vec3::new(p.x, 0.0, p.y)).collect();
        let closed: Vec<Vec3> = ring.iter().chain(&ring[..1]).copied().collect();
        let volume = tube(&closed, 0.25, 32).signed_volume();
        assert!((volume / (TAU * 2.0 * std::f32::consts::PI * 0.0625) - 1.0).abs() < 0.02, "{volume}");
    }

    #[test]
    fn curves_pass_through_their_knots() {
        let knots = [Vec3::ZERO, Vec3::X, Vec3::ONE, Vec3::new(3.0, 0.0, 1.0)];
        let points = curve(&knots, 5);
        assert_eq!(points.len(), 16);
        assert!(knots.iter().enumerate().all(|(i, knot)| points[5 * i].distance(*knot) < 1e-6));
    }

    #[test]
    fn edges_are_smooth_only_where_the_outline_is() {
        let sharp = edge_normals(&DENTED, true);
        assert_eq!(sharp[0], [Vec2::NEG_Y, Vec2::NEG_Y]);
        let round = edge_normals(&circle(1.0, 32), true);
        assert!((round[4][0] - circle(1.0, 32)[4]).length() < 1e-5);
    }
}
