//! Walls and boxes whose depth is known.

use super::*;
use glam::Vec2;

const SIZE: [usize; 2] = [96, 128];
const INTRINSICS: Intrinsics = Intrinsics { fx: 274.0, fy: 274.0, centre: Vec2::new(64.0, 48.0) };

/// A g-buffer of surfaces: depth and normal by pixel.
fn seen(surface: impl Fn(usize, usize) -> Option<(f32, Vec3)>) -> GBuffer {
    let planes = Planes::from_fn(7, SIZE[0], SIZE[1], |channel, y, x| {
        surface(x, y).map_or(0.0, |(depth, normal)| match channel {
            0..3 => INTRINSICS.position(x, y, depth)[channel],
            3..6 => normal[channel - 3],
            _ => 1.0,
        })
    });
    GBuffer::new(crate::capture::surface::ATTRIBUTES.to_vec(), planes)
}

fn wall(depth: f32) -> GBuffer {
    seen(|_, _| Some((depth, Vec3::Z)))
}

/// A wall 1.5 m away with a square board 1 m away before it.
fn board() -> GBuffer {
    seen(|x, y| Some((if on_board(x, y) { 1.0 } else { 1.5 }, Vec3::Z)))
}

fn on_board(x: usize, y: usize) -> bool {
    (40..90).contains(&x) && (20..70).contains(&y)
}

#[test]
fn a_wall_has_the_published_noise_and_no_bias() {
    for depth in [0.6f32, 1.0, 2.0, 3.5] {
        let measured = measured(&wall(depth), &INTRINSICS, 5);
        let count = measured.data().len() as f64;
        let mean = measured.data().iter().map(|value| f64::from(*value)).sum::<f64>() / count;
        let variance =
            measured.data().iter().map(|value| (f64::from(*value) - mean).powi(2)).sum::<f64>() / count;
        let noise = f64::from(axial_noise(depth));
        // Rounding to steps adds a twelfth of their square.
        let step = f64::from(depth * depth / (STEPS * FOCAL * BASE_LINE));
        let expected = (noise * noise + step * step / 12.0).sqrt();
        assert!(
            (variance.sqrt() / expected - 1.0).abs() < 0.06,
            "{depth} m: {}, not {expected}",
            variance.sqrt()
        );
        // Half a step of bias would be far more.
        assert!(
            (mean - f64::from(depth)).abs() < 0.1 * expected + 2e-3 * f64::from(depth) * expected,
            "{depth} m: {mean}"
        );
    }
    assert!((axial_noise(1.4) - 0.0031).abs() < 1e-7 && (lateral_noise(0.0) - 0.8).abs() < 1e-7);
    assert!(axial_noise_at(1.0, 1.3) > axial_noise_at(1.0, 1.0) && lateral_noise(1.3) > 0.95);
}

#[test]
fn depths_are_those_of_whole_steps_of_disparity() {
    for depth in measured(&wall(2.2), &INTRINSICS, 5).data() {
        let steps = STEPS * FOCAL * BASE_LINE / depth;
        assert!((steps - steps.round()).abs() < 1e-3, "{depth} m is {steps} steps");
    }
    // 2.9 mm at one metre.
    assert!((quantised(1.0) - quantised(1.0 + 0.00285)).abs() < 0.006 && quantised(1.0) != quantised(1.006));
}

#[test]
fn the_projector_leaves_a_shadow_on_the_left_as_wide_as_its_base_line_makes_it() {
    let measured = measured(&board(), &INTRINSICS, 3);
    let expected = INTRINSICS.fx * BASE_LINE * (1.0 / 1.0 - 1.0 / 1.5);
    let holes = |y: usize| (0..SIZE[1]).filter(|x| measured.at(0, y, *x) == 0.0).collect::<Vec<_>>();
    for y in 24..66 {
        let holes = holes(y);
        // The edges fray by a pixel or two.
        assert!(
            (holes.len() as f32 - expected).abs() <= 3.0,
            "row {y}: {} holes, not {expected}",
            holes.len()
        );
        assert!(holes.iter().all(|x| (40 - 9..42).contains(x)), "row {y}: {holes:?}");
    }
    assert!((0..16).chain(74..96).all(|y| holes(y).is_empty()), "elsewhere there is no edge");
}

#[test]
fn edges_fray_and_surfaces_stay() {
    let measured = measured(&board(), &INTRINSICS, 3);
    let near = |x: usize, y: usize| measured.at(0, y, x) < 1.25;
    let swapped = (24..66).filter(|y| near(90, *y) || !near(89, *y)).count();
    assert!((4..42).contains(&swapped), "{swapped} of 42 rows have a frayed right edge");
    for (x, y) in (20..66).flat_map(|y| (92..128).map(move |x| (x, y))) {
        assert!((measured.at(0, y, x) - 1.5).abs() < 0.03, "{x}, {y}");
    }
}

#[test]
fn what_is_grazed_too_near_or_too_far_is_not_measured() {
    let tilted = |degrees: f32| {
        let normal = Vec3::new(0.0, degrees.to_radians().sin(), degrees.to_radians().cos());
        // Rays near the axis meet it at this angle.
        let depths = measured(&seen(|_, _| Some((1.5, normal))), &INTRINSICS, 1);
        depths.at(0, 48, 64)
    };
    assert!(tilted(70.0) > 1.4 && tilted(84.0) == 0.0);
    for (depth, expected) in [(0.3, false), (0.7, true), (4.0, true), (6.0, false)] {
        let depths = measured(&wall(depth), &INTRINSICS, 1);
        assert!(depths.data().iter().all(|value| (*value > 0.0) == expected), "{depth} m");
    }
    let nothing = measured(&seen(|_, _| None), &INTRINSICS, 1);
    assert!(nothing.data().iter().all(|value| *value == 0.0));
}

#[test]
fn frames_have_noise_of_their_own_and_a_seed_the_same() {
    let [first, again, other] = [1, 1, 2].map(|seed| measured(&wall(1.3), &INTRINSICS, seed));
    assert_eq!(first, again);
    let same = first.data().iter().zip(other.data()).filter(|(a, b)| a == b).count();
    assert!(same < first.pixels() / 2, "{same} pixels are the same");
}

#[test]
fn normals_of_a_noisy_wall_are_a_few_degrees_off() {
    for depth in [0.8f32, 1.2, 2.0] {
        let surface = crate::capture::surface(&measured(&wall(depth), &INTRINSICS, 9), &INTRINSICS);
        let z = surface.planes().plane(5);
        let seen = surface.seen().expect("a mask");
        let degrees: Vec<f32> = z
            .iter()
            .zip(&seen)
            .filter(|(_, seen)| **seen)
            .map(|(z, _)| z.min(1.0).acos().to_degrees())
            .collect();
        let mean = degrees.iter().sum::<f32>() / degrees.len() as f32;
        assert!(
            degrees.len() > 9 * seen.len() / 10 && (0.5..7.0).contains(&mean),
            "{depth} m: {mean} degrees"
        );
    }
}
