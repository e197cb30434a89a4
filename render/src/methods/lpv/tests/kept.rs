//! Light that a medium kept.

use super::room::{fog, from_a_corner, glowing, over_truth, shining};
use super::*;
use crate::lpv::injection::sent_by_medium;
use crate::scene::glow::tests::{glow, paint};
use crate::scene::medium::Weather;
use crate::scene::{Bounds, Glow};
use std::f32::consts::PI;

/// A room without a lamp, in fog that is full of light, with a wall that is, too, or not.
fn in_glowing_fog(has_wall: bool) -> Scene {
    let scene = glowing(Some(fog()));
    let mut full = (**scene.glow.as_ref().expect("a paint")).clone();
    full.medium = Some(paint(&[0.7, 0.3]));
    if !has_wall {
        full.surfaces.clear();
    }
    Scene { glow: Some(full.into()), ..scene }
}

/// A room in smoke that glows more where a lamp was nearer, which has gone out.
fn in_smoke_after_a_lamp() -> Scene {
    let bounds = Bounds { min: Vec3::splat(-1.0), max: Vec3::ONE };
    let density = Density::Grid(Weather::smoke(3, 1.5, 0.9).grid(bounds, 12, 0.0).expect("smoke"));
    let (absorption, scattering) = (Vec3::new(0.5, 0.35, 0.2), Vec3::new(0.5, 0.6, 0.7));
    let smoke = Medium::new(absorption, scattering, 0.0, density).expect("a medium");
    let kept =
        Glow { surfaces: Vec::new(), medium: Some(paint(&[0.7, 0.3])), ..glow(&[], &[[0.5, 2.0]], 2.0) };
    Scene { glow: Some(kept.into()), ..shining(false, Some(smoke)) }
}

#[test]
fn a_medium_sends_what_its_volume_has_alike_in_all_directions() {
    let bounds = Bounds { min: Vec3::new(-1.0, 0.0, -1.0), max: Vec3::ONE };
    let absorption = Vec3::new(0.1, 0.2, 0.3);
    let medium = Medium::new(absorption, Vec3::splat(0.5), 0.3, Density::Within(bounds)).expect("a medium");
    let grid = LightGrid::around(Bounds { min: Vec3::splat(-1.3), max: Vec3::splat(1.4) }, 11);
    let light = sent_by_medium(&grid, &medium, |at| Vec3::splat(2.0 + at.x));
    let sum = light.iter().fold([Vec4::ZERO; 3], |sum, of| [0, 1, 2].map(|c| sum[c] + of[c]));
    for c in 0..3 {
        // Of radiance 2 on average, and of four cubic metres.
        let expected = 4.0 * PI * absorption[c] * 2.0 * 4.0;
        assert!((sum[c] - expected * Vec4::W).abs().max_element() < 1e-4 * expected, "{sum:?}");
    }
}

#[test]
fn fog_that_gives_back_light_fills_a_room_about_as_truth_has_it() {
    let parameters = LpvParameters { cells: 16, iterations: 64, ..FEW };
    let scene = || in_glowing_fog(false);
    let indirect = over_truth(&InMedium::indirect(parameters), Effect::FogIndirect, scene(), 1024);
    let multiple = over_truth(&InMedium::multiple(parameters), Effect::FogMultiple, scene(), 1024);
    assert!([indirect, multiple].iter().all(|ratio| (0.6..1.6).contains(ratio)), "{indirect} {multiple}");
}

#[test]
fn fog_that_gives_back_light_is_as_the_plain_version_has_it() {
    let gpu = gpu();
    for scene in [in_smoke_after_a_lamp(), in_glowing_fog(true)] {
        let frame = from_a_corner(scene);
        let parameters = LpvParameters { cells: 10, ..FEW };
        let indirect = ScreenMethod::new(&gpu, InMedium::indirect(parameters));
        // It is faint.
        let tolerance = Tolerance { usual: 1e-4, ..OF_MEDIUM };
        prove_twin(&indirect, &frame, tolerance);
        let multiple = ScreenMethod::new(&gpu, InMedium::multiple(parameters));
        prove_twin(&multiple, &frame, tolerance);
    }
}
