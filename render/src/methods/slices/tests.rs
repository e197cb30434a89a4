use super::*;

/// The tilt and the axes of a slice whose normal's projection has this angle from the eye, the normal leaning
/// out of the slice.
fn slice(angle: f32) -> (Tilt, Vec3, Vec3, Vec3) {
    let (to_eye, across) = (Vec3::Z, Vec3::X);
    let normal = Vec3::new(angle.sin(), 0.6, angle.cos()).normalize();
    (Tilt::new(normal, to_eye, across), to_eye, across, normal)
}

fn direction(angle: f32) -> Vec3 {
    Vec3::new(angle.sin(), 0.0, angle.cos())
}

/// The integral of the cosine to the projected normal times the slice's width, by midpoints.
fn integral(from: f32, to: f32, tilted: f32, weight: impl Fn(f32) -> f32) -> f64 {
    let count = 20_000;
    let at = |i: i32| from + (to - from) * (i as f32 + 0.5) / count as f32;
    let sum: f64 = (0..count).map(|i| f64::from((at(i) - tilted).cos() * weight(at(i)))).sum();
    sum * f64::from(to - from) / f64::from(count)
}

#[test]
fn directions_are_placed_by_their_cosine_weighted_solid_angle() {
    for tilted in [-1.4f32, -0.5, 0.0, 0.3, 1.2] {
        let (tilt, to_eye, across, normal) = slice(tilted);
        let [low, high] = [tilted - FRAC_PI_2, tilted + FRAC_PI_2];
        let whole = integral(low, high, tilted, |t| t.sin().abs());
        assert!((f64::from(tilt.extent()) - whole).abs() < 2e-4, "{tilted}: {} and {whole}", tilt.extent());
        for part in [0.0, 0.3, 0.7, 0.999] {
            let angle = part * high;
            let expected = integral(low, angle, tilted, |t| t.sin().abs()) / whole;
            let found = f64::from(tilt.place(direction(angle), to_eye, across, normal));
            assert!((found - expected).abs() < 1e-3, "{tilted}, {angle}: {found} and {expected}");
            // Were all directions of a slice as wide, the middle alone would agree.
            let flat = |to| integral(low, to, tilted, |_| 1.0);
            let even = flat(angle) / flat(high);
            assert!(
                tilted != 0.3 || part == 0.999 || (found - even).abs() > 0.02,
                "{part}: {found} and {even}"
            );
        }
        assert_eq!(tilt.place(direction(high + 0.01), to_eye, across, normal), 1.0);
    }
}

#[test]
fn slices_add_up_to_all_cosine_weighted_directions() {
    for normal in [Vec3::Z, Vec3::new(0.7, 0.2, 0.5), Vec3::new(-0.1, 0.99, 0.05)] {
        let count = 2000;
        let weight = |k: i32| {
            let (sin, cos) = (k as f32 * PI / count as f32).sin_cos();
            let tilt = Tilt::new(normal.normalize(), Vec3::Z, Vec3::new(cos, sin, 0.0));
            tilt.length * tilt.extent()
        };
        let mean = (0..count).map(weight).sum::<f32>() / count as f32;
        assert!((mean - 1.0).abs() < 1e-3, "{normal}: {mean}");
    }
}

#[test]
fn what_is_thin_covers_little_and_what_is_beyond_the_radius_nothing() {
    let settings = |thickness| uniforms::Slices {
        width: 9,
        height: 9,
        slices: 1,
        steps: 1,
        seed: 0,
        radius: 1.0,
        thickness,
        focal_length: 9.0,
    };
    // A floor point that sees something 0.5 m above it and aside, and the eye far above.
    let position = Vec3::new(0.0, 0.0, -100.0);
    let covered = |thickness, at: Vec3, normal: Vec3| {
        covered_by(&settings(thickness), position + at, position, normal, Vec3::Z, 0.5)
    };
    let at = Vec3::new(0.5, 0.0, 0.5);
    // A share of (1 + sin^2 t) / 2 lies before the angle t: sector 24 of 32 is the first at 45 degrees.
    assert_eq!(covered(1e-4, at, Vec3::Z), 0);
    assert_eq!(covered(0.25, at, Vec3::Z).trailing_zeros(), 24);
    assert_eq!(covered(0.25, at, Vec3::Z).count_ones(), 5, "sin^2 t goes from 1/2 to 4/5");
    // Three quarters of a metre below, it is within the floor, and covers all towards the horizon.
    assert_eq!(covered(0.75, at, Vec3::Z), 0xff00_0000);
    assert_eq!(covered(0.75, 1.5 * at, Vec3::Z), 0);
    // However thick, it ends at the radius, sqrt(3/4) below a point that sees further down.
    let aslant = Vec3::new(1.0, 0.0, 0.2).normalize();
    assert_eq!(covered(9.0, at, aslant), covered(0.5 + 0.75f32.sqrt(), at, aslant));
    assert_ne!(covered(9.0, at, aslant), covered(1.0, at, aslant));
}
