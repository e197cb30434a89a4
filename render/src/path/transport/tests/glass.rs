//! Light through panes and bodies of glass.

use super::*;
use crate::path::proving::sphere;
use crate::scene::transmission::{Transmission, Walls};

const SOLID: Walls = Walls::Solid { absorption: Vec3::ZERO };

fn glass(walls: Walls, roughness: f32, colour: Vec3) -> Material {
    let transmission = Some(Transmission { share: 1.0, texture: None, walls });
    Material { transmission, roughness, ..Material::matte("glass", colour) }
}

/// Meshes of one material in a white sky.
fn in_white_sky(meshes: Vec<Mesh>, material: Material) -> TracedScene {
    traced(Scene {
        meshes: meshes.into(),
        materials: vec![material],
        environment: Some(Environment::uniform(Vec3::ONE).into()),
        ..Scene::default()
    })
}

#[test]
fn glass_in_a_white_sky_is_invisible() {
    let ball = || vec![sphere(Vec3::ZERO, 1.0)];
    for (walls, roughness, lost) in [(SOLID, 0.0, 0.0), (Walls::Thin, 0.0, 0.0), (SOLID, 0.3, 0.12)] {
        let scene = in_white_sky(ball(), glass(walls, roughness, Vec3::ONE));
        let transport = Transport::new(&scene);
        for aside in [0.1f32, 0.6, 0.9] {
            let origin = Vec3::new(aside, 0.03, 3.0);
            let found = measured(20_000, |stream| transport.radiance(origin, Vec3::NEG_Z, stream).x);
            println!("{walls:?}, roughness {roughness}, {aside}: {found:?}");
            let least = 1.0 - lost - 3.0 * found.error.x - 2e-3;
            assert!(found.mean.x > least && found.mean.x < 1.0 + 3.0 * found.error.x + 2e-3, "{found:?}");
        }
    }
    let grey = in_white_sky(ball(), glass(SOLID, 0.0, Vec3::splat(0.98)));
    let transport = Transport::new(&grey);
    let from = Vec3::new(0.1, 0.03, 3.0);
    let found = measured(20_000, |stream| transport.radiance(from, Vec3::NEG_Z, stream).x);
    assert!(found.mean.x < 0.98, "2 % at each surface are noticed: {found:?}");
}

#[test]
fn a_sheet_of_glass_has_the_closed_form() {
    // Two surfaces a metre apart that face away from each other, seen straight from above, in a white sky:
    // what is reflected and what passes, each a geometric series of reflections within.
    let absorption = Vec3::new(0.2, 0.7, 1.9);
    let material = glass(Walls::Solid { absorption }, 0.0, Vec3::ONE);
    let mut lower = square(-1.0, 500.0, 0);
    lower.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
    let scene = in_white_sky(vec![square(0.0, 500.0, 0), lower], material);
    let transport = Transport::new(&scene);
    let from = Vec3::new(0.3, 2.0, 0.7);
    let found = MeanWithError::of_independent(|stream| transport.radiance(from, Vec3::NEG_Y, stream), 60_000);
    let (reflected, left) = (0.04f32, absorption.map(|each| (-each).exp()));
    let within = (Vec3::ONE - reflected * reflected * left * left).recip();
    let through = (1.0 - reflected).powi(2) * left * within;
    let expected = Vec3::splat(reflected) + through + reflected * through * left;
    prove("glass/sheet", found, expected);
    let without_ends = through + Vec3::splat(reflected);
    found.refutes("glass/sheet", without_ends);
}

#[test]
fn panes_tint_light_whichever_way_it_is_found() {
    // A lamp over a floor of albedo 1/2 that a pane covers, which lets three quarters through and reflects
    // nothing; then a real one.
    let lamp = Material { emission: Vec3::splat(5.0), ..lambert(0.0) };
    let tint = Vec3::new(0.75, 0.5, 0.25);
    let scene = |ior: f32| {
        let pane = Material { ior, ..glass(Walls::Thin, 0.0, tint) };
        traced(Scene {
            meshes: vec![square(0.0, 1.0, 0), square(0.5, 500.0, 1), square(1.0, 1.0, 2)].into(),
            materials: vec![lambert(0.5), pane, lamp.clone()],
            environment: Some(Environment::uniform(Vec3::ONE).into()),
            ..Scene::default()
        })
    };
    // Form factor of two coaxial parallel squares of edge 2 at distance 1, at the middle of one.
    let a = 0.5f32.sqrt();
    let form_factor = 4.0 / PI * a * a.atan();
    let expected = 0.5 * tint * ((1.0 - form_factor) + 5.0 * form_factor);
    for ior in [1.0, 1.5] {
        let scene = scene(ior);
        let found = |finding, from: Vec3| {
            let transport = Transport::new(&scene).with_finding(finding);
            let one = |stream: &mut Stream| transport.radiance(from, Vec3::NEG_Y, stream);
            MeanWithError::of_independent(one, 100_000)
        };
        let [both, paths] = [Finding::Both, Finding::Paths].map(|finding| found(finding, Vec3::Y * 0.25));
        if ior == 1.0 {
            let lights = found(Finding::Lights, Vec3::Y * 0.25);
            [both, lights, paths].iter().for_each(|found| found.proves("glass/pane", expected));
            both.refutes("glass/pane", expected * 1.02);
            // Through the pane from above.
            let from = Vec3::new(0.003, 0.75, 0.001);
            found(Finding::Both, from).proves("glass/pane", tint * expected);
        }
        let error = both.error.length().hypot(paths.error.length());
        let off = (both.mean - paths.mean).length();
        assert!(off < 3.0 * error && error < 0.02 * paths.mean.length(), "{both:?}, {paths:?}");
    }
}

#[test]
fn a_lamp_shines_through_a_pane_and_not_for_a_route() {
    let pane = glass(Walls::Thin, 0.0, Vec3::new(1.0, 0.5, 0.0));
    let sun = Light::Directional { direction: Vec3::NEG_Y, irradiance: Vec3::splat(2.0), pattern: None };
    let scene = traced(Scene {
        meshes: vec![square(0.0, 9.0, 0), square(1.0, 9.0, 1)].into(),
        materials: vec![lambert(0.5), pane],
        lights: vec![sun],
        ..Scene::default()
    });
    let radiance = |transport: &Transport<'_>| {
        let from = Vec3::new(0.3, 0.5, 0.1);
        MeanWithError::of_independent(|stream| transport.split(from, Vec3::NEG_Y, stream).direct, 1_000).mean
    };
    let expected = 2.0 * 0.5 * FRAC_1_PI * 0.96 * Vec3::new(1.0, 0.5, 0.0);
    let found = radiance(&Transport::new(&scene));
    assert!((found - expected).abs().max_element() < 1e-4, "{found} is not {expected}");
    assert_eq!(radiance(&Transport::new(&scene).with_route(Route::Surfaces)), Vec3::ZERO);
}

#[test]
fn rough_glass_and_lights_find_the_same_light() {
    // A lamp in front of frosted glass, seen through it; in a body, too.
    for walls in [Walls::Thin, SOLID] {
        let lamp = Material { emission: Vec3::splat(5.0), ..lambert(0.0) };
        let mut lower = square(0.3, 5.0, 0);
        lower.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
        let mut meshes = vec![square(0.5, 5.0, 0), square(-0.7, 0.6, 1)];
        if walls == SOLID {
            meshes.push(lower);
        }
        let scene = traced(Scene {
            meshes: meshes.into(),
            materials: vec![glass(walls, 0.5, Vec3::new(0.9, 0.8, 0.7)), lamp],
            environment: Some(Environment::uniform(Vec3::splat(0.3)).into()),
            ..Scene::default()
        });
        let found = [Finding::Both, Finding::Lights, Finding::Paths].map(|finding| {
            let transport = Transport::new(&scene).with_finding(finding);
            measured(100_000, |stream| transport.radiance(Vec3::new(0.1, 2.0, 0.2), EYE.1, stream).x)
        });
        for other in &found[1..] {
            let error = found[0].error.x.hypot(other.error.x);
            let off = (found[0].mean.x - other.mean.x).abs();
            assert!(off < 3.0 * error && error < 0.05 * other.mean.x, "{walls:?}: {found:?}");
        }
    }
}
