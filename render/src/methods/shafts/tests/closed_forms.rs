//! Closed forms, in f64.

use super::*;
use crate::path::medium::HenyeyGreenstein;

/// Integral by midpoints.
fn integral(from: f64, to: f64, function: impl Fn(f64) -> f64) -> f64 {
    let steps = 4000;
    let step = (to - from) / f64::from(steps);
    (0..steps).map(|i| function(from + (f64::from(i) + 0.5) * step)).sum::<f64>() * step
}

/// Methods that do not interpolate between pixels, at their best, without noise.
fn exact() -> [Box<dyn Method>; 3] {
    let steps =
        ray_march::RayMarchParameters { jitter: false, ..ray_march::RayMarchParameters::of(Quality::Ultra) };
    let [_, epipolar, _, min_max] = methods(Quality::Ultra);
    [Box::new(Shafts(steps)), epipolar, min_max]
}

/// With four terms for each colour, as many light rays as at their best.
fn four_terms() -> [Box<dyn Method>; 1] {
    let best = epipolar::EpipolarParameters::of(Quality::Ultra);
    [Box::new(Shafts(epipolar::EpipolarParameters { terms: epipolar::Terms::Four, ..best }))]
}

/// The same fog without colours.
fn grey(medium: &Medium) -> Medium {
    let [absorption, scattering] = [medium.absorption, medium.scattering].map(|share| Vec3::splat(share.y));
    Medium { absorption, scattering, ..medium.clone() }
}

fn wall(x: f32) -> Mesh {
    quad([(-9., -9.), (-9., 9.), (9., 9.), (9., -9.)].map(|(y, z)| Vec3::new(x, y, z)))
}

/// Asserts that each colour is within a share of what is expected.
fn assert_is(found: [f32; 3], expected: [f64; 3], tolerance: f64, name: &str) {
    for (found, expected) in found.into_iter().zip(expected) {
        assert!((f64::from(found) / expected - 1.0).abs() < tolerance, "{name}: {found} is not {expected}");
    }
}

fn middle(image: &Planes) -> [f32; 3] {
    std::array::from_fn(|c| image.at(c, image.height() / 2, image.width() / 2))
}

/// Through a roof with slits, at 1 m above the eye, sunlight falls straight down; the eye looks along x at a
/// wall. The edges of slits are those of steps and of texels: the last map shows 10.04 m of 1004 texels, a
/// pixel more than the view ray, and each other map a quarter of the next.
#[test]
fn slits_of_sunlight_are_as_bright_as_their_lit_segment() {
    let roof = |x: [f32; 2]| {
        quad([(x[0], -5.), (x[0], 5.), (x[1], 5.), (x[1], -5.)].map(|(x, z)| Vec3::new(x, 1.0, z)))
    };
    let meshes = vec![roof([-0.01, 0.5]), roof([1.7, 4.0]), roof([4.5, 10.24]), wall(10.0)];
    let medium = fog(0.6, [[-1.0, -6.0, -5.0], [20.0, 2.0, 5.0]]);
    let phase = f64::from(HenyeyGreenstein::new(0.6).evaluate(0.0));
    let expected: [f64; 3] = std::array::from_fn(|c| {
        let (extinction, scattering) = (f64::from(medium.extinction()[c]), f64::from(medium.scattering[c]));
        let segment =
            |[from, to]: [f64; 2]| ((-extinction * from).exp() - (-extinction * to).exp()) / extinction;
        let lit = segment([0.5, 1.7]) + segment([4.0, 4.5]);
        [30.0, 20.0, 10.0][c] * phase * scattering * (-2.0 * extinction).exp() * lit
    });
    let scene = scene(meshes, vec![sun(Vec3::NEG_Y)], medium);
    let vertical_fov = 2.0 * (0.5f32 / 250.0).atan();
    let camera = Camera { vertical_fov, ..Camera::look_at(Vec3::ZERO, Vec3::X) };
    let shadow_size = 2 * 1008;
    let steps = 2000;
    let light_rays = 40_000;
    let methods: [Box<dyn Method>; 4] = [
        Box::new(Shafts(ray_march::RayMarchParameters {
            steps,
            shadow_size,
            ..ray_march::RayMarchParameters::of(Quality::Ultra)
        })),
        Box::new(Shafts(epipolar::EpipolarParameters {
            light_rays,
            shadow_size,
            ..epipolar::EpipolarParameters::of(Quality::Ultra)
        })),
        Box::new(Shafts(epipolar_sampling::EpipolarSamplingParameters {
            steps,
            shadow_size,
            ..epipolar_sampling::EpipolarSamplingParameters::of(Quality::Ultra)
        })),
        Box::new(Shafts(min_max::MinMaxParameters {
            light_rays,
            shadow_size,
            ..min_max::MinMaxParameters::of(Quality::Ultra)
        })),
    ];
    for method in methods {
        let found = image(method.as_ref(), &scene, &camera, [1, 1]).expect("an image");
        assert_is(middle(&found), expected, 1e-4, method.name());
    }
}

#[test]
fn sunlight_that_nothing_hides_is_exact() {
    let coloured = fog(-0.4, [[-1.0, -8.0, -8.0], [6.0, 8.0, 8.0]]);
    let towards = -Vec3::new(0.3, -0.8, 0.2).normalize();
    // So narrow that slices, too, are as near to each other as in a large image.
    let camera = Camera { vertical_fov: 0.3, ..Camera::look_at(Vec3::ZERO, Vec3::X) };
    for medium in [grey(&coloured), coloured] {
        let scene = scene(vec![wall(7.0)], vec![sun(-towards)], medium.clone());
        let check = |method: &dyn Method, tolerance: f64| {
            let found = image(method, &scene, &camera, [96, 128]).expect("an image");
            for (x, y) in [(12, 8), (64, 48), (120, 84)] {
                let direction = camera.direction(glam::Vec2::new(x as f32 + 0.5, y as f32 + 0.5), 96, 128);
                let phase = f64::from(HenyeyGreenstein::new(-0.4).evaluate(towards.dot(direction)));
                let [near, far] = medium.density.span(Vec3::ZERO, direction, f32::INFINITY).expect("inside");
                let expected = std::array::from_fn(|c| {
                    let extinction = f64::from(medium.extinction()[c]);
                    let lit = integral(near.into(), far.into(), |s| {
                        let span = medium.density.span(direction * s as f32, towards, f32::INFINITY);
                        (-extinction * (s + f64::from(span.unwrap_or_default()[1]))).exp()
                    });
                    [30.0, 20.0, 10.0][c] * phase * f64::from(medium.scattering[c]) * lit
                });
                let colours = std::array::from_fn(|c| found.at(c, y, x));
                assert_is(colours, expected, tolerance, method.name());
            }
        };
        exact().iter().for_each(|method| check(method.as_ref(), 1e-4));
        four_terms().iter().for_each(|method| check(method.as_ref(), 1e-3));
        on_gpu().iter().for_each(|method| check(method.as_ref(), 1e-2));
    }
}

/// Airlight of a lamp in endless fog before a wall and without one (Sun et al. 2005, equation 11, is this
/// integral without anisotropy).
#[test]
fn airlight_of_a_lamp_is_suns() {
    let position = Vec3::new(2.0, 1.1, -0.3);
    let coloured = |anisotropy: f32| {
        let [absorption, scattering] = [Vec3::new(0.05, 0.2, 0.1), Vec3::new(0.25, 0.4, 0.9)];
        Medium::new(absorption, scattering, anisotropy, Density::Everywhere).expect("fog")
    };
    for (anisotropy, is_grey, distance) in [
        (0.0, false, 3.5),
        (0.5, false, 3.5),
        (0.5, true, 3.5),
        (-0.3, true, 3.5),
        (0.5, false, f32::INFINITY),
    ] {
        let medium = coloured(anisotropy);
        let medium = if is_grey { grey(&medium) } else { medium };
        let phase = HenyeyGreenstein::new(anisotropy);
        // The wall is behind the eye where none is to be seen.
        let scene = scene(
            vec![wall(if distance < 10.0 { distance } else { -5.0 })],
            vec![lamp(position)],
            medium.clone(),
        );
        let camera = Camera { vertical_fov: 0.5, ..Camera::look_at(Vec3::ZERO, Vec3::X) };
        let check = |method: &dyn Method, tolerance: f64| {
            let found = image(method, &scene, &camera, [96, 128]).expect("an image");
            for (x, y) in [(12, 80), (48, 36), (64, 48), (112, 16)] {
                let direction = camera.direction(glam::Vec2::new(x as f32 + 0.5, y as f32 + 0.5), 96, 128);
                // After 60 metres not a billionth is left.
                let far = f64::from((distance / direction.x).min(60.0));
                let expected = std::array::from_fn(|c| {
                    let extinction = f64::from(medium.extinction()[c]);
                    let lit = integral(0.0, far, |s| {
                        let offset = (position - direction * s as f32).as_dvec3();
                        let distance = offset.length();
                        let cosine = offset.dot(direction.as_dvec3()) / distance;
                        let turned = f64::from(phase.evaluate(cosine as f32));
                        turned * (-extinction * (s + distance)).exp() / (distance * distance)
                    });
                    [20.0, 30.0, 40.0][c] * f64::from(medium.scattering[c]) * lit
                });
                let colours = std::array::from_fn(|c| found.at(c, y, x));
                let name = format!("{} at ({x}, {y}), {anisotropy}, {is_grey}, {distance} m", method.name());
                assert_is(colours, expected, tolerance, &name);
            }
        };
        exact().iter().for_each(|method| check(method.as_ref(), if distance < 10.0 { 1e-4 } else { 1e-3 }));
        four_terms().iter().for_each(|method| check(method.as_ref(), 1e-2));
        let [march, sums, _] = on_gpu();
        [march, sums].iter().for_each(|method| check(method.as_ref(), 1e-2));
    }
}
