//! Random walks against half spaces and slabs whose reflection is known.

use super::*;
use crate::path::{Sampling, render};
use crate::scene::{Camera, Light, Material, Mesh, Scene};
use deepshade_shaders::Effect;
use std::f32::consts::PI;

/// Radiance pi times of one pixel that looks straight down at the middle, its standard error, RGB.
fn seen_from_above(meshes: Vec<Mesh>, material: Material, suns: &[Vec3], samples: u32) -> [Vec3; 2] {
    let sun =
        |direction: &Vec3| Light::Directional { direction: *direction, irradiance: Vec3::ONE, pattern: None };
    let lights = suns.iter().map(sun).collect();
    let scene = Scene { meshes: meshes.into(), materials: vec![material], lights, ..Scene::default() };
    let scene = TracedScene::new(scene).expect("triangles");
    let camera = Camera::look_at(Vec3::new(0.13, 0.17, 1.0), Vec3::new(0.13, 0.17, 0.0));
    let estimate =
        render(Effect::Subsurface, &Shot::new(&scene, &camera, [1, 1], 1.0), Sampling::scrambled(samples, 3));
    let variance = estimate.variance.expect("scramblings");
    let vector = |value: &dyn Fn(usize) -> f32| Vec3::new(value(0), value(1), value(2));
    [vector(&|c| PI * estimate.mean.at(c, 0, 0)), vector(&|c| PI * variance.at(c, 0, 0).sqrt())]
}

fn wax(colour: Vec3, mean_free_path: Vec3) -> Material {
    Material { mean_free_path, ..Material::matte("wax", colour) }
}

/// A square of 2 `reach` metres at height `z`, its front up or down.
fn square(z: f32, reach: f32, front: f32) -> Mesh {
    let corners = [(-1., -1.), (front, -front), (1., 1.), (-front, front)];
    Mesh {
        positions: corners.map(|(x, y)| Vec3::new(x * reach, y * reach, z)).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

#[test]
fn a_half_space_reflects_its_diffuse_colour() {
    // Far below and beside, where no path comes, the half space may end.
    for (colour, lengths) in [
        (Vec3::new(0.9, 0.5, 0.2), Vec3::splat(0.01)),
        (Vec3::new(0.8, 0.3, 0.05), Vec3::new(0.02, 0.01, 0.004)),
    ] {
        let [found, error] =
            seen_from_above(vec![square(0.0, 50.0, 1.0)], wax(colour, lengths), &[Vec3::NEG_Z], 8_192);
        let off = (found - colour).abs();
        // Van de Hulst's formula is good to 1 %, and to 3 % for what is almost black.
        let off_by_formula = Vec3::new(0.012, 0.012, 0.035) * colour;
        assert!(
            off.cmple(3.0 * error + off_by_formula).all() && error.max_element() < 6e-3,
            "{found} +- {error} is not {colour}"
        );
        let wrong = colour
            .map(|a| (1.0 - a).max(0.0).sqrt())
            .map(|s| (1.0 - s) * (1.0 - 0.139 * s) / (1.0 + 1.17 * s));
        assert!(
            (found - wrong).abs().cmpgt(3.0 * error + off_by_formula).all(),
            "the albedo of collisions is another"
        );
    }
}

#[test]
fn the_albedo_of_collisions_has_its_ends() {
    assert_eq!(single_scattering_albedo(0.0), 0.0);
    assert_eq!(single_scattering_albedo(1.0), 1.0);
    let s = (1.0f32 - single_scattering_albedo(0.6)).sqrt();
    assert!(((1.0 - s) * (1.0 - 0.139 * s) / (1.0 + 1.17 * s) - 0.6).abs() < 1e-5);
}

/// A wide slab of some thickness, closed by its height in the middle only: its edges are too far away to
/// matter.
fn slab(thickness: f32) -> Vec<Mesh> {
    vec![square(0.0, 50.0, 1.0), square(-thickness, 50.0, -1.0)]
}

#[test]
fn a_slab_lets_through_what_is_known() {
    // Conservative isotropic scattering between surfaces in even light, exact: Heaslet and Warming 1965,
    // "Radiative transport and wall temperature slip in an absorbing planar medium", table of the heat flux
    // for optical thickness 0.5, 1 and 2. Each colour has another.
    let known = Vec3::new(0.7040, 0.5532, 0.3900);
    let material = || wax(Vec3::ONE, 0.01 / Vec3::new(0.5, 1.0, 2.0));
    let [through, error] = seen_from_above(slab(0.01), material(), &[Vec3::Z], 8_192);
    assert!(
        (through - known).abs().cmple(3.0 * error + 1e-3).all() && error.max_element() < 1.2e-2,
        "{through} +- {error}"
    );
    let [back, back_error] = seen_from_above(slab(0.01), material(), &[Vec3::NEG_Z], 8_192);
    assert!((back + known - 1.0).abs().cmple(3.0 * back_error + 1e-3).all(), "{back} +- {back_error}");
    assert!(
        (through - 1.05 * known).abs().cmpgt(3.0 * error + 1e-3).any(),
        "a light 5 % brighter is noticed"
    );
    // In light from both sides nothing is lost.
    let [both, both_error] = seen_from_above(slab(0.01), material(), &[Vec3::Z, Vec3::NEG_Z], 1_024);
    assert!((both - 1.0).abs().cmple(3.0 * both_error + 1e-4).all(), "{both} +- {both_error}");
    // Without paths below, nothing comes through.
    let [opaque, _] = seen_from_above(slab(0.01), wax(Vec3::ONE, Vec3::ZERO), &[Vec3::Z], 64);
    assert_eq!(opaque, Vec3::ZERO);
}

#[test]
fn what_does_not_enter_is_reflected_diffusely() {
    let colour = Vec3::new(0.7, 0.6, 0.5);
    let sun = Vec3::new(0.6, 0.0, -0.8);
    for lengths in [Vec3::ZERO, Vec3::splat(1e-9)] {
        let [found, error] = seen_from_above(slab(0.1), wax(colour, lengths), &[sun], 64);
        assert!((found - 0.8 * colour).abs().max_element() < 1e-5, "{found}");
        assert_eq!(error, Vec3::ZERO);
    }
    // Colours are apart: green enters alone.
    let [found, error] = seen_from_above(slab(1.0), wax(colour, Vec3::new(0.0, 0.01, 0.0)), &[sun], 4_096);
    assert!(
        (found - 0.8 * colour).abs().cmple(3.0 * error + Vec3::new(1e-5, 0.01, 1e-5)).all(),
        "{found} +- {error}"
    );
    assert!(error.x == 0.0 && error.y > 0.0 && error.z == 0.0);
}

#[test]
fn meshes_turned_inside_out_look_the_same() {
    let turned = || vec![square(0.0, 50.0, -1.0), square(-0.01, 50.0, 1.0)];
    let material = || wax(Vec3::splat(0.8), Vec3::splat(0.01));
    let [found, _] = seen_from_above(slab(0.01), material(), &[Vec3::Z, Vec3::NEG_Z], 1_024);
    let [other, _] = seen_from_above(turned(), material(), &[Vec3::Z, Vec3::NEG_Z], 1_024);
    assert!((found - other).abs().max_element() < 1e-3, "{found} {other}");
}

#[test]
fn light_is_lost_through_holes() {
    // The half space without a floor loses the paths that leave the small square's shadow; nothing is not a
    // number.
    let material = || wax(Vec3::splat(0.95), Vec3::splat(0.1));
    let [whole, _] = seen_from_above(vec![square(0.0, 50.0, 1.0)], material(), &[Vec3::NEG_Z], 4_096);
    let [open, error] = seen_from_above(vec![square(0.0, 0.3, 1.0)], material(), &[Vec3::NEG_Z], 4_096);
    assert!(open.is_finite() && open.cmpgt(Vec3::splat(0.1)).all());
    assert!((whole - open).cmpgt(10.0 * error).all(), "{whole} {open}");
}
