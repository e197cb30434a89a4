//! Where geometry or the medium degenerates: images are defined, finite and not negative.

use super::*;
use crate::methods::proving::view;
use crate::path::proving::quad;
use crate::scene::{Camera, DensityGrid, Light, Material};

fn room(lights: Vec<Light>, eye: Vec3, target: Vec3, medium: Option<Medium>) -> ViewedScene {
    let (scene, _, _) = corner();
    let view = View { camera: Camera::look_at(eye, target), radius: 1.0, ..view(24, 32, 1.0) };
    seen_in(Scene { lights, ..scene.scene().clone() }, medium, view)
}

fn lamp(position: Vec3) -> Light {
    Light::Point { position, intensity: Vec3::new(2.0, 3.0, 4.0), range: f32::INFINITY }
}

fn sun(direction: Vec3) -> Light {
    Light::Directional {
        direction: direction.normalize(),
        irradiance: Vec3::new(3.0, 2.0, 1.0),
        pattern: None,
    }
}

fn spot(position: Vec3, direction: Vec3) -> Light {
    let [intensity, direction] = [Vec3::splat(30.0), direction.normalize()];
    Light::Spot { position, direction, intensity, range: 30.0, cos_inner: 0.95, cos_outer: 0.85, slide: None }
}

#[test]
fn light_may_come_from_anywhere() {
    let gpu = gpu();
    let (eye, target) = (Vec3::new(-1.0, 1.0, 1.5), Vec3::new(0.5, 0.8, -0.5));
    let ahead = (target - eye).normalize();
    for (name, light) in [
        ("behind the camera", lamp(eye - ahead)),
        ("in the frame", lamp(eye + 0.8 * ahead)),
        ("at the eye", lamp(eye)),
        ("parallel to the view", sun(ahead)),
        ("against the view", sun(Vec3::new(-ahead.x, -0.5, -ahead.z))),
    ] {
        let image = image(&gpu, coarse(), &room(vec![light], eye, target, Some(fog(0.3))));
        assert!(is_sound(&image) && mean(&image) > 1e-4, "{name}: {}", mean(&image));
    }
}

#[test]
fn a_camera_in_shadow_sees_what_is_lit_beyond_it() {
    let gpu = gpu();
    // Behind a wall that the sun shines on from the other side.
    let (scene, _, _) = corner();
    let wall = quad([(0.0, -4.0), (2.0, -4.0), (2.0, 4.0), (0.0, 4.0)].map(|(y, z)| Vec3::new(-1.5, y, z)));
    let meshes = scene.scene().meshes.iter().cloned().chain([wall]).collect::<Vec<_>>();
    let camera = Camera::look_at(Vec3::new(-1.0, 0.5, 0.0), Vec3::new(0.5, 0.5, 0.0));
    let view = View { camera, radius: 1.0, ..view(24, 32, 1.0) };
    let lights =
        |light| Scene { meshes: meshes.clone().into(), lights: vec![light], ..scene.scene().clone() };
    let lit = |light| image(&gpu, coarse(), &seen_in(lights(light), Some(fog(0.5)), view));
    // Flat along the floor nothing but the wall's far side is lit; from above the other wall is.
    let (flat, steep) = (lit(sun(Vec3::X)), lit(sun(Vec3::new(1.0, -0.8, 0.0))));
    assert!(is_sound(&flat) && is_sound(&steep));
    assert!(mean(&flat) < 0.05 * mean(&steep), "{} and {}", mean(&flat), mean(&steep));
}

#[test]
fn a_spot_behind_a_wall_lights_nothing() {
    let gpu = gpu();
    let (eye, target) = (Vec3::new(-1.0, 1.0, 1.5), Vec3::new(0.5, 0.8, -0.5));
    let behind = spot(Vec3::new(2.0, 1.0, 0.0), Vec3::X);
    assert!(is_black(&image(&gpu, coarse(), &room(vec![behind], eye, target, Some(fog(0.3))))));
    // It shines against the wall's back, which is open: no closed body, but nothing comes through.
    let before = spot(Vec3::new(-2.0, 1.0, 0.0), Vec3::X);
    assert!(!is_black(&image(&gpu, coarse(), &room(vec![before], eye, target, Some(fog(0.3))))));
}

#[test]
fn where_nothing_scatters_it_is_black() {
    let gpu = gpu();
    let (eye, target) = (Vec3::new(-1.0, 1.0, 1.5), Vec3::new(0.5, 0.8, -0.5));
    let absorbs = Medium { scattering: Vec3::ZERO, ..fog(0.5) };
    let away = Bounds { min: Vec3::splat(50.0), max: Vec3::splat(60.0) };
    let away = Medium { density: Density::Within(away), ..fog(0.5) };
    let nothing = DensityGrid::new(BOX, [4, 4, 4], vec![0.0; 64]).expect("a grid");
    let nothing = Medium { density: Density::Grid(nothing), ..fog(0.5) };
    for medium in [None, Some(absorbs), Some(away), Some(nothing), Some(fog(0.0))] {
        for improvements in [Improvements::ALL, Improvements::NONE] {
            let parameters = VolumeShellParameters { improvements, ..coarse() };
            let seen = room(vec![lamp(Vec3::new(0.0, 1.5, 0.0))], eye, target, medium.clone());
            assert!(is_black(&image(&gpu, parameters, &seen)), "{medium:?}");
        }
    }
    let dark = room(vec![], eye, target, Some(fog(0.5)));
    assert!(is_black(&image(&gpu, coarse(), &dark)));
}

#[test]
fn opaque_media_hide_what_is_lit() {
    let gpu = gpu();
    let (eye, target) = (Vec3::new(-1.0, 1.0, 1.5), Vec3::new(0.5, 0.8, -0.5));
    let lit = |extinction: f32| {
        let seen = room(vec![lamp(Vec3::new(0.0, 1.5, 0.0))], eye, target, Some(fog(extinction)));
        let image = image(&gpu, coarse(), &seen);
        assert!(is_sound(&image), "{extinction}");
        mean(&image)
    };
    let [thin, thick, opaque] = [0.3, 30.0, 1e6].map(lit);
    assert!(thick < 1e-3 * thin && opaque <= thick, "{thin}, {thick}, {opaque}");
}

#[test]
fn an_endless_medium_is_seen_as_far_as_it_is_clear() {
    let gpu = gpu();
    let (eye, target) = (Vec3::new(-1.0, 1.0, 1.5), Vec3::new(0.5, 0.8, -0.5));
    let light = || vec![lamp(Vec3::new(0.0, 1.5, 0.0))];
    let endless = Medium { density: Density::Everywhere, ..fog(0.3) };
    let boxed = image(&gpu, coarse(), &room(light(), eye, target, Some(fog(0.3))));
    let endless = image(&gpu, coarse(), &room(light(), eye, target, Some(endless)));
    assert!(is_sound(&endless) && mean(&endless) > 0.9 * mean(&boxed), "{}", mean(&endless) / mean(&boxed));
}

#[test]
fn densities_that_are_no_numbers_are_refused() {
    let mut values = vec![1.0; 8];
    values[3] = f32::NAN;
    let error = DensityGrid::new(BOX, [2, 2, 2], values).expect_err("a NaN").to_string();
    assert!(error.contains("density NaN at cell (1, 1, 0)"), "{error}");
}

#[test]
fn a_scene_without_a_surface_in_view_shows_its_medium() {
    let gpu = gpu();
    let (scene, _, _) = corner();
    let camera = Camera::look_at(Vec3::new(-3.9, 1.0, 0.0), Vec3::new(-9.0, 1.5, 0.0));
    let view = View { camera, radius: 1.0, ..view(24, 32, 1.0) };
    let around = Bounds { min: Vec3::splat(-9.0), max: Vec3::splat(9.0) };
    let medium = Medium { density: Density::Within(around), ..fog(0.2) };
    let scene = Scene { materials: vec![Material::default()], ..scene.scene().clone() };
    let image = image(&gpu, coarse(), &seen_in(scene, Some(medium), view));
    assert!(is_sound(&image) && mean(&image) > 1e-4, "{}", mean(&image));
}
