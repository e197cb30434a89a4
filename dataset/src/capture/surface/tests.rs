//! Planes, a sphere, steps and holes, whose normals are known.

use super::*;
use glam::{Vec2, Vec3Swizzles};

const SIZE: [usize; 2] = [60, 80];
/// With a principal point beside the middle and pixels that are not square.
const INTRINSICS: Intrinsics = Intrinsics { fx: 260.0, fy: 250.0, centre: Vec2::new(37.0, 33.0) };

/// The depths at which the rays of all pixels end, 0 where they do not.
fn depths(end: impl Fn(Vec3) -> Option<f32>) -> Planes {
    Planes::from_fn(1, SIZE[0], SIZE[1], |_, y, x| end(INTRINSICS.position(x, y, 1.0)).unwrap_or(0.0))
}

/// The depth of a plane through a point of the view's axis.
fn plane(normal: Vec3, distance: f32) -> impl Fn(Vec3) -> Option<f32> {
    move |ray| Some(normal.z * -distance / normal.dot(ray)).filter(|depth| *depth > 0.0)
}

fn vector(gbuffer: &GBuffer, attribute: Attribute, x: usize, y: usize) -> Vec3 {
    let first = gbuffer.first_plane(attribute).expect("it is there");
    Vec3::from_array(std::array::from_fn(|c| gbuffer.planes().at(first + c, y, x)))
}

fn valid(gbuffer: &GBuffer, x: usize, y: usize) -> bool {
    gbuffer.seen().expect("a mask")[y * SIZE[1] + x]
}

#[test]
fn a_plane_of_any_tilt_has_its_normal_everywhere() {
    for tilt in [0.0f32, 20.0, 45.0, 60.0, 70.0] {
        for turn in [0.0f32, 30.0, 90.0, 135.0, 200.0, 315.0] {
            let aside = Vec2::from_angle(turn.to_radians()) * tilt.to_radians().sin();
            let normal = aside.extend(tilt.to_radians().cos());
            let seen = surface(&depths(plane(normal, 1.5)), &INTRINSICS);
            for (x, y) in (0..SIZE[0]).flat_map(|y| (0..SIZE[1]).map(move |x| (x, y))) {
                let found = vector(&seen, Attribute::Normal, x, y);
                assert!(valid(&seen, x, y), "tilt {tilt}, turn {turn}: nothing at {x}, {y}");
                assert!((found - normal).length() < 1e-3, "tilt {tilt}, turn {turn}: {found} at {x}, {y}");
                let on_plane = normal.dot(vector(&seen, Attribute::Position, x, y)) + 1.5 * normal.z;
                assert!(on_plane.abs() < 1e-4, "{on_plane} m off the plane");
            }
        }
    }
}

#[test]
fn a_flipped_axis_is_found_out() {
    // The control of the test above: what another handedness would give is far from what is right.
    let normal = Vec3::new(0.3, 0.5, 0.6).normalize();
    let found = vector(&surface(&depths(plane(normal, 1.5)), &INTRINSICS), Attribute::Normal, 40, 30);
    for flipped in [normal * Vec3::new(-1.0, 1.0, 1.0), normal * Vec3::new(1.0, -1.0, 1.0), normal.yxz()] {
        assert!((found - flipped).length() > 0.1);
    }
}

#[test]
fn a_sphere_has_its_normals_within_a_degree_where_it_is_not_grazed() {
    let (centre, radius) = (Vec3::new(0.02, -0.01, -1.2), 0.12f32);
    let met = |ray: Vec3| {
        let (a, b) = (ray.length_squared(), ray.dot(centre));
        let root = b * b - a * (centre.length_squared() - radius * radius);
        (root > 0.0).then(|| (b - root.sqrt()) / a)
    };
    let seen = surface(&depths(met), &INTRINSICS);
    let mut checked = 0;
    for (x, y) in
        (0..SIZE[0]).flat_map(|y| (0..SIZE[1]).map(move |x| (x, y))).filter(|(x, y)| valid(&seen, *x, *y))
    {
        let position = vector(&seen, Attribute::Position, x, y);
        let expected = (position - centre) / radius;
        // Tilted by more than 45 degrees, fewer pixels of the window see the sphere, most of them on one
        // side.
        let facing = expected.dot(-position.normalize());
        let degrees = expected.dot(vector(&seen, Attribute::Normal, x, y)).min(1.0).acos().to_degrees();
        assert!(degrees < if facing > 0.7 { 1.0 } else { 20.0 }, "{degrees} degrees off at {x}, {y}");
        checked += usize::from(facing > 0.7);
    }
    assert!(checked > 1000, "{checked} pixels");
}

#[test]
fn a_window_does_not_cross_a_step() {
    let (left, right) = (Vec3::new(-0.5, 0.2, 0.8).normalize(), Vec3::new(0.3, 0.4, 0.7).normalize());
    let (near, far) = (plane(left, 1.0), plane(right, 1.3));
    let both = depths(|ray| if ray.x < 0.0 { near(ray) } else { far(ray) });
    let seen = surface(&both, &INTRINSICS);
    for (x, y) in (0..SIZE[0]).flat_map(|y| (0..SIZE[1]).map(move |x| (x, y))) {
        let expected = if (x as f32) + 0.5 < INTRINSICS.centre.x { left } else { right };
        let found = vector(&seen, Attribute::Normal, x, y);
        assert!(valid(&seen, x, y) && (found - expected).length() < 1e-3, "{found} at {x}, {y}");
    }
    // The control: a crease has no step, and is rounded off.
    let crease = surface(
        &depths(|ray| if ray.x < 0.0 { plane(left, 1.0)(ray) } else { plane(right, 1.0)(ray) }),
        &INTRINSICS,
    );
    let found = vector(&crease, Attribute::Normal, 37, 33);
    assert!((found - left).length() > 0.05 && (found - right).length() > 0.05, "{found}");
}

#[test]
fn holes_and_specks_show_nothing_and_spoil_nothing() {
    let normal = Vec3::new(0.2, 0.5, 0.8).normalize();
    let mut depth = depths(plane(normal, 1.2));
    let hole = |x: usize, y: usize| (x / 5 + y / 7).is_multiple_of(4);
    for (x, y) in (0..SIZE[0]).flat_map(|y| (0..SIZE[1]).map(move |x| (x, y))) {
        if hole(x, y) {
            depth.data_mut()[y * SIZE[1] + x] = 0.0;
        }
    }
    // A speck floats before the plane.
    depth.data_mut()[41 * SIZE[1] + 41] = 0.8;
    let seen = surface(&depth, &INTRINSICS);
    assert!(!hole(41, 41) && !valid(&seen, 41, 41), "one pixel is no surface");
    for (x, y) in (0..SIZE[0]).flat_map(|y| (0..SIZE[1]).map(move |x| (x, y))).filter(|at| *at != (41, 41)) {
        assert_eq!(valid(&seen, x, y), !hole(x, y), "{x}, {y}");
        let found = vector(&seen, Attribute::Normal, x, y);
        let expected = if hole(x, y) { Vec3::ZERO } else { normal };
        assert!((found - expected).length() < 1e-3, "{found} at {x}, {y}");
    }
}

#[test]
fn edges_are_higher_where_noise_is() {
    assert!(highest_step(3.0, 500.0) > 3.0 * highest_step(1.0, 500.0));
    assert!(highest_step(1.0, 250.0) > highest_step(1.0, 500.0), "pixels are larger");
}
