//! Cameras and lenses against geometry worked out by hand.

use super::*;

#[test]
fn camera_looks_down_minus_z_with_y_up() {
    let camera = Camera::look_at(Vec3::new(0.0, 0.0, 5.0), Vec3::ZERO);
    let middle = camera.direction(Vec2::new(50.0, 25.0), 50, 100);
    assert!((middle - Vec3::NEG_Z).length() < 1e-6);
    let top_right = camera.direction(Vec2::new(100.0, 0.0), 50, 100);
    assert!(top_right.x > 0.0 && top_right.y > 0.0);
    let point = camera.to_camera(Vec3::new(1.0, 2.0, 3.0));
    assert!((point - Vec3::new(1.0, 2.0, -2.0)).length() < 1e-6);
}

#[test]
fn top_of_the_image_is_half_the_field_of_view_away() {
    let camera = Camera::look_at(Vec3::new(3.0, 1.0, 2.0), Vec3::new(-1.0, 0.5, 0.0));
    let middle = camera.direction(Vec2::new(32.0, 32.0), 64, 64);
    let top = camera.direction(Vec2::new(32.0, 0.0), 64, 64);
    assert!((middle.angle_between(top) - 25f32.to_radians()).abs() < 1e-5);
}

/// A camera askew with a lens.
fn with_lens(radius: f32, focus: f32) -> Camera {
    let camera = Camera::look_at(Vec3::new(3.0, 1.0, 2.0), Vec3::new(-1.0, 0.5, 0.0));
    Camera { lens: Some(Lens::new(radius, focus).expect("a lens")), ..camera }
}

/// Points of the unit square, the rim of the lens among them.
fn on_lens() -> impl Iterator<Item = Vec2> {
    (0..36).map(|i| Vec2::new((i % 6) as f32, (i / 6) as f32) / 5.0)
}

#[test]
fn the_plane_in_focus_is_seen_alike_from_all_over_the_lens() {
    let camera = with_lens(0.05, 2.5);
    let at = Vec2::new(11.3, 40.2);
    let sharp = camera.direction(at, 48, 64);
    let focused = sharp * (2.5 / -camera.direction_to_camera(sharp).z);
    for square in on_lens() {
        let (origin, direction) = camera.ray(at, 48, 64, square);
        let from_middle = camera.to_camera(origin);
        assert!(from_middle.length() < 0.05 + 1e-6 && from_middle.z.abs() < 1e-6);
        let towards = (camera.position + focused - origin).normalize();
        assert!((direction - towards).length() < 1e-6);
    }
}

#[test]
fn points_spread_to_their_circle_of_confusion() {
    let camera = with_lens(0.05, 2.5);
    for (depth, radius) in [(1.0, 0.05f32), (2.4, 0.05), (7.0, 0.05), (1e6, 0.05)] {
        let point = Vec3::new(0.13 * depth, -0.2 * depth, -depth);
        let middle = camera.project(point, 48, 64).expect("in front");
        let expected = camera.circle_of_confusion(depth, 48);
        for square in on_lens() {
            let offset = camera.to_camera(camera.ray(middle, 48, 64, square).0);
            // Where the plane in focus is met by the line from the lens through the point, and its image.
            let focused = offset + (point - offset) * (2.5 / depth);
            let at = camera.project(focused, 48, 64).expect("in front");
            let (origin, direction) = camera.ray(at, 48, 64, square);
            let towards = (point - offset).normalize();
            assert!((camera.direction_to_camera(direction) - towards).length() < 1e-5);
            assert!((camera.to_camera(origin) - offset).length() < 1e-5);
            let share = offset.length() / radius;
            assert!((at.distance(middle) - share * expected).abs() < 1e-3 * expected.max(0.1));
        }
    }
}

#[test]
fn the_circle_of_confusion_is_the_textbook_s() {
    let camera = with_lens(0.02, 3.0);
    // A lens of focal length f has its image at v = f df / (df - f), which is the pinhole's focal length.
    let (aperture, f, focus) = (0.04f32, 0.1f32, 3.0f32);
    let pixels_per_metre = camera.focal_length(512) / (f * focus / (focus - f));
    for d in [0.5f32, 2.0, 3.0, 20.0] {
        let diameter = aperture * f * (d - focus).abs() / (d * (focus - f)) * pixels_per_metre;
        let radius = camera.circle_of_confusion(d, 512);
        assert!((radius - 0.5 * diameter).abs() < 1e-4, "at {d}: {radius}");
        let other = Camera { lens: Some(Lens { radius: 0.02, focus: 3.06 }), ..camera };
        assert!(
            (other.circle_of_confusion(d, 512) - 0.5 * diameter).abs() > 1e-2,
            "another focus is noticed"
        );
        assert!((radius - camera.focal_distance(d).abs() * camera.blur_at_infinity(512) / d).abs() < 1e-5);
    }
}

#[test]
fn the_lens_is_covered_evenly() {
    let camera = with_lens(0.5, 2.0);
    let offsets: Vec<Vec3> = (0..64 * 64)
        .map(|i| Vec2::new((i % 64) as f32 + 0.5, (i / 64) as f32 + 0.5) / 64.0)
        .map(|square| camera.to_camera(camera.ray(Vec2::splat(8.0), 16, 16, square).0) / 0.5)
        .collect();
    let mean = |value: fn(&Vec3) -> f32| offsets.iter().map(value).sum::<f32>() / offsets.len() as f32;
    // Of the unit disk: E x = 0, E x^2 = 1/4, E r = 2/3, half the points within sqrt(1/2).
    assert!(mean(|o| o.x).abs() < 1e-3 && (mean(|o| o.x * o.x) - 0.25).abs() < 1e-3);
    assert!((mean(|o| o.length()) - 2.0 / 3.0).abs() < 1e-3);
    assert!((mean(|o| f32::from(o.length_squared() < 0.5)) - 0.5).abs() < 0.03);
}

#[test]
fn a_lens_of_radius_zero_is_a_pinhole() {
    let (pinhole, point) = (Camera { lens: None, ..with_lens(0.0, 1.0) }, with_lens(0.0, 1.0));
    for square in on_lens() {
        let at = square * 40.0;
        assert_eq!(point.ray(at, 40, 40, square), pinhole.ray(at, 40, 40, square));
    }
    assert_eq!((point.circle_of_confusion(3.0, 40), point.focal_distance(3.0)), (0.0, 2.0));
    assert_eq!((pinhole.circle_of_confusion(3.0, 40), pinhole.focal_distance(3.0)), (0.0, 0.0));
}

#[test]
fn lenses_that_cannot_be_are_refused_by_number() {
    for bad in [-0.1, f32::NAN, f32::INFINITY] {
        let error = Lens::new(bad, 1.0).expect_err("a radius").to_string();
        assert_eq!(error, format!("a lens cannot have a radius of {bad} m"));
    }
    for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        let error = Lens::new(0.1, bad).expect_err("a depth").to_string();
        assert_eq!(error, format!("a lens cannot focus at a depth of {bad} m"));
    }
    let read = |radius: f32| {
        let numbers = [("radius", radius), ("focus", 2.0)].into_iter();
        Lens::deserialize(serde::de::value::MapDeserializer::<_, serde::de::value::Error>::new(numbers))
    };
    assert_eq!(read(0.25), Ok(Lens { radius: 0.25, focus: 2.0 }));
    assert!(read(-0.25).is_err());
}

#[test]
fn projection_is_the_inverse_of_direction() {
    let camera = with_lens(0.0, 1.0);
    let at = Vec2::new(3.7, 29.1);
    let seen = camera.position + camera.direction(at, 48, 64) * 4.0;
    let found = camera.project(camera.to_camera(seen), 48, 64).expect("in front");
    assert!((found - at).length() < 1e-4);
    assert_eq!(camera.project(Vec3::new(0.0, 0.0, 1.0), 48, 64), None);
    assert_eq!(camera.project(Vec3::ZERO, 48, 64), None);
}

#[test]
fn points_of_a_lens_are_spread_evenly() {
    use crate::path::chi_square::{p_value, proves, refutes};
    use crate::sampler::Stream;
    use std::f32::consts::{FRAC_1_PI, TAU};
    // Points of a disk, lifted to the hemisphere above it, have the density cosine / pi (Malley's method).
    let lifted = |at: Vec2| Some(at.extend((1.0 - at.length_squared()).max(0.0).sqrt()));
    let density = |direction: Vec3| direction.z.max(0.0) * FRAC_1_PI;
    let camera = with_lens(0.3, 2.0);
    let name = "chi_square/lens";
    let sampled = |stream: &mut Stream| {
        let (origin, _) = camera.ray(Vec2::new(3.0, 20.0), 32, 32, stream.next_2d());
        lifted((camera.rotation.transpose() * (origin - camera.position)).truncate() / 0.3)
    };
    proves(name, p_value(Vec3::Z, sampled, density), 1);
    // A polar map without its square root crowds the middle.
    let crowded = |stream: &mut Stream| {
        let square = stream.next_2d();
        lifted(Vec2::from_angle(TAU * square.x) * square.y)
    };
    refutes(name, p_value(Vec3::Z, crowded, density), 1);
}
