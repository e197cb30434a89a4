//! The reference against closed forms, and the GPU against the reference, pixel by pixel.

use super::*;
use crate::methods::proving::{
    Tolerance, agree, everything, mean_difference, on_gpu, prove_comparator, prove_twin, view,
};
use crate::path::bsdf::Phong;
use crate::path::proving::{coloured, integral, spotted, with_environment};
use crate::path::{self, Sampling, Shot};
use crate::scene::procedural::sky;
use crate::screen::ScreenMethod;
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{GBuffer, Planes};
use std::f32::consts::{FRAC_1_PI, PI};

const DIFFUSE: Vec3 = Vec3::new(0.5, 0.3, 0.1);
const SPECULAR: Vec3 = Vec3::new(0.2, 0.4, 0.3);

/// Device and processor differ by 1e-5 in arc tangents: that is 1e-4 of a texel, times what neighbouring ones
/// differ by.
const TOLERANCE: Tolerance = Tolerance { usual: 1e-4, worst: 0.02 };

/// Among neighbours of a sun that is a few texels large.
const BESIDE_A_SUN: Tolerance = Tolerance { usual: 0.02, worst: 0.2 };

/// Surfaces that face up, one a pixel, seen at an angle from the normal: width is the number of roughnesses.
fn floor(degrees: f32, roughnesses: &[f32], diffuse: Vec3, specular: Vec3) -> GBuffer {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let planes = Planes::from_fn(14, 1, roughnesses.len(), |channel, _, x| match channel {
        0..3 => [0.0, 1.0, 0.0][channel],
        3..6 => [sin, cos, 0.0][channel - 3],
        6..9 => diffuse[channel - 6],
        9..12 => specular[channel - 9],
        12 => 1.0 - roughnesses[x],
        _ => 1.0,
    });
    GBuffer::new(ATTRIBUTES.to_vec(), planes)
}

/// What Phong's model reflects of an environment there: `path/bsdf.rs` written down once more.
fn expected(environment: &Environment, degrees: f32, roughness: f32) -> Vec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let mirror = Vec3::new(-sin, cos, 0.0);
    let phong = Phong::new(roughness);
    integral(environment, |light| {
        let lobe = DIFFUSE * FRAC_1_PI + SPECULAR * phong.reflectance(mirror.dot(light));
        lobe * light.y.max(0.0)
    })
}

fn shade(gbuffer: &GBuffer, environment: &Filtered) -> Vec<Vec3> {
    let image = reference::shade(gbuffer, environment).expect("all attributes");
    (0..gbuffer.width()).map(|x| Vec3::from_array([0, 1, 2].map(|channel| image.at(channel, 0, x)))).collect()
}

const ROUGHNESSES: [f32; 5] = [0.15, 0.3, 0.5, 0.8, 1.0];

#[test]
fn a_uniform_environment_gives_the_colours_times_their_energy() {
    let environment = Environment::uniform(Vec3::new(0.5, 1.0, 2.0));
    let filtered = PrefilteredParameters::of(Quality::Low).filtered(Some(&environment));
    for degrees in [3.0, 50.0, 80.0, 89.0] {
        let found = shade(&floor(degrees, &ROUGHNESSES, DIFFUSE, SPECULAR), &filtered);
        for (roughness, found) in ROUGHNESSES.into_iter().zip(found) {
            let expected = expected(&environment, degrees, roughness);
            let error = (found / expected - 1.0).abs().max_element();
            assert!(error < 0.01, "{degrees} degrees, roughness {roughness}: {found} and {expected}");
            // Were the lobe not cut and weighed, all of the specular colour would be reflected.
            let whole = (DIFFUSE + SPECULAR) * Vec3::new(0.5, 1.0, 2.0);
            assert!(
                degrees < 50.0 || (whole / expected - 1.0).max_element() > 0.05,
                "{whole} and {expected}"
            );
        }
        let matte = shade(&floor(degrees, &[0.5], DIFFUSE, Vec3::ZERO), &filtered)[0];
        assert!((matte / (DIFFUSE * Vec3::new(0.5, 1.0, 2.0)) - 1.0).abs().max_element() < 1e-4, "{matte}");
    }
}

#[test]
fn irradiance_of_a_small_sun_errs_by_less_than_a_hundredth() {
    let environment = spotted();
    let map = &PrefilteredParameters::of(Quality::Low).filtered(Some(&environment)).maps[0];
    let largest = integral(&environment, |_| Vec3::splat(FRAC_1_PI)).x;
    for i in 0..20 {
        let normal = if i == 0 {
            Vec3::Y
        } else {
            Vec3::from_array([1, 2, 3].map(|k| ((i * k * k) as f32).sin())).normalize()
        };
        let expected = integral(&environment, |light| Vec3::splat(FRAC_1_PI * normal.dot(light).max(0.0))).x;
        let error = (map.radiance(normal).x - expected).abs();
        assert!(error < 0.01 * largest, "{normal}: {} and {expected}", map.radiance(normal).x);
    }
}

#[test]
fn seen_from_above_a_lobe_is_exact_but_for_the_maps() {
    let environment = spotted();
    let filtered = PrefilteredParameters::of(Quality::Medium).filtered(Some(&environment));
    // The light is 60 degrees from the normal, at the lobes' edges.
    let found = shade(&floor(0.1, &ROUGHNESSES[2..], DIFFUSE, SPECULAR), &filtered);
    for (roughness, found) in ROUGHNESSES[2..].iter().zip(found) {
        let expected = expected(&environment, 0.1, *roughness);
        assert!((found / expected - 1.0).abs().max_element() < 0.03, "{roughness}: {found} and {expected}");
    }
}

/// Mean error, relative to the mean, over angles around the environment.
fn errors(filtered: &Filtered, roughness: f32, degrees: f32) -> f32 {
    let turns = 5;
    let (mut error, mut sum) = (0.0, 0.0);
    for turn in 0..turns {
        let environment = spotted().rotated(2.0 * PI * turn as f32 / turns as f32);
        let maps = filter::maps(&environment, 64);
        let filtered = Filtered { maps, table: filtered.table.clone() };
        let found = shade(&floor(degrees, &[roughness], DIFFUSE, SPECULAR), &filtered)[0].x;
        let expected = expected(&environment, degrees, roughness).x;
        error += (found - expected).abs();
        sum += expected;
    }
    error / sum
}

#[test]
fn the_table_of_lobes_is_nearer_to_the_integral_than_whole_lobes() {
    let modelled = PrefilteredParameters::of(Quality::Low).filtered(None);
    // Lobes of the surfaces' own exponents around the mirrored direction, with the right energy.
    let whole = |i: usize, lobe: &Vec3| Vec3::new(lobe.x, 0.0, 0.5 * (i / ANGLES) as f32);
    let table = modelled.table.iter().enumerate().map(|(i, lobe)| whole(i, lobe)).collect();
    let whole = Filtered { table, ..modelled.clone() };
    for (roughness, degrees) in [(0.6, 80.0), (0.8, 70.0), (0.9, 50.0), (1.0, 30.0)] {
        let [error, naive] = [&modelled, &whole].map(|filtered| errors(filtered, roughness, degrees));
        assert!(error < 0.1 && error < 0.7 * naive, "{roughness}, {degrees}: {error} and {naive}");
    }
}

#[test]
fn gpu_and_reference_agree_at_every_pixel() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let prefiltered = ScreenMethod::new(&gpu, PrefilteredParameters::of(Quality::Low));
    let environment = coloured().rotated(0.7);
    for (height, width) in [(37, 50), (1, 1), (17, 5)] {
        let (_, view, gbuffer) = everything(height, width);
        prove_twin(&prefiltered, &gbuffer, Some(&environment), &view, TOLERANCE);
    }
    let (_, view, gbuffer) = everything(9, 12);
    prove_twin(&prefiltered, &gbuffer, None, &view, TOLERANCE);
    let finer = prefiltered.with(PrefilteredParameters::of(Quality::Medium));
    prove_twin(&finer, &gbuffer, Some(&sky(1)), &view, BESIDE_A_SUN);
    let flat = floor(70.0, &ROUGHNESSES, DIFFUSE, SPECULAR);
    prove_twin(&finer, &flat, Some(&sky(1)), &self::view(1, ROUGHNESSES.len(), 1.0), BESIDE_A_SUN);
}

#[test]
fn the_comparator_rejects_what_is_wrong() {
    let (_, _, gbuffer) = everything(37, 50);
    let shade = |environment: &Environment| {
        reference::shade(&gbuffer, &PrefilteredParameters::of(Quality::Low).filtered(Some(environment)))
            .expect("attributes")
    };
    let right = shade(&coloured());
    prove_comparator(&right, TOLERANCE);
    assert!(agree(&right, &shade(&coloured().rotated(0.3)), TOLERANCE).is_err(), "a turned environment");
    let seen = gbuffer.seen().expect("a mask");
    assert!(seen.iter().any(|seen| !seen), "some sky");
    assert!((0..seen.len()).all(|i| seen[i] == (right.plane(0)[i] > 0.0)), "black where nothing is seen");
}

#[test]
fn the_method_is_nearer_to_truth_than_light_from_everywhere() {
    let (scene, view, gbuffer) = everything(43, 61);
    let environment = sky(5);
    let even = Environment::uniform(environment.mean());
    let scene = with_environment(scene, environment.clone());
    let shot = Shot::new(&scene, &view.camera, [view.height, view.width], view.radius);
    let truth = path::render(Effect::Ibl, &shot, Sampling::one(256, 1)).mean;
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let prefiltered = ScreenMethod::new(&gpu, PrefilteredParameters::of(Quality::High));
    let error =
        |environment| mean_difference(&on_gpu(&prefiltered, &gbuffer, Some(environment), &view), &truth);
    let (found, even) = (error(&environment), error(&even));
    assert!(even > 0.05 && found < 0.2 * even, "{found}, with light from everywhere {even}");
}
