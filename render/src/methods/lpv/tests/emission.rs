//! Light that surfaces emit and others reflect.

use super::super::lit_volume::LitVolumes;
use super::room::room;
use super::*;
use crate::methods::proving::view;
use crate::scene::{Gloss, Material, MaterialId};
use std::f32::consts::PI;

/// The same frame with a floor that glows.
fn with_a_glow((scene, view, gbuffer): ViewedScene) -> ViewedScene {
    let mut scene = scene.scene().clone();
    scene.materials.push(Material { emission: Vec3::new(2.0, 1.0, 0.5), ..scene.materials[0].clone() });
    scene.meshes.iter_mut().take(1).for_each(|floor| floor.material = MaterialId(1));
    (TracedScene::new(scene).expect("triangles"), view, gbuffer)
}

#[test]
fn emitted_light_that_is_reflected_is_as_the_plain_version_has_it() {
    let gpu = gpu();
    let frames = [corner(), foggy().remove(0), foggy().remove(1)].map(with_colours).map(with_a_glow);
    let method = ScreenMethod::new(&gpu, ReflectedEmission(FEW));
    frames.iter().for_each(|frame| prove_twin(&method, frame, OF_MEDIUM));
}

#[test]
fn where_nothing_emits_there_is_none() {
    let (scene, view, gbuffer) = with_colours(corner());
    let inputs = PlainInputs { gbuffer: &gbuffer, environment: None, scene: Some(&scene) };
    let image = ReflectedEmission(FEW).reference(&inputs, &view).expect("attributes").remove(0);
    assert!(image.iter().all(|value| *value == 0.0));
}

/// Irradiance on the walls of a closed room that all emit the same and reflect so much of it, of light that
/// was reflected, over that of light that was not.
fn reflected(reflectance: f32) -> f32 {
    let matte = Material { gloss: Gloss::None, ..Material::matte("wall", Vec3::splat(reflectance)) };
    let wall = Material { emission: Vec3::ONE, ..matte };
    let scene = Scene { materials: vec![wall], lights: Vec::new(), ..room(false) };
    let scene = TracedScene::new(scene).expect("triangles");
    let camera = Camera::look_at(Vec3::new(-0.9, 0.4, 0.9), Vec3::new(0.3, -0.3, -0.5));
    let view = View { camera, radius: 20.0, ..view(12, 16, 1.0) };
    let parameters = LpvParameters { cells: 16, iterations: 24, ..FEW };
    let volumes = LitVolumes::new(&scene, parameters, &view, Filled::ReflectedEmission, f32::MAX);
    let places = (0..8).map(|i| (i as f32 + 0.5) / 4.0 - 1.0);
    let wall = |out: Vec3| {
        let (along, up) = (Vec3::new(out.y, out.z, out.x), Vec3::new(out.z, out.x, out.y));
        let points = places.clone().flat_map(|a| places.clone().map(move |b| out + a * along + b * up));
        points.map(|point| volumes.irradiance(point, -out).x / 64.0).sum::<f32>()
    };
    let all: f32 = [Vec3::X, Vec3::Y, Vec3::Z].into_iter().map(|axis| wall(axis) + wall(-axis)).sum();
    all / 6.0 / PI
}

#[test]
fn what_walls_reflect_on_and_on_is_no_more_than_a_geometric_series() {
    for (reflectance, least) in [(0.2, 0.8), (0.5, 0.65), (0.8, 0.35)] {
        let series = reflectance / (1.0 - reflectance);
        let ratio = reflected(reflectance) / series;
        assert!((least..1.05).contains(&ratio), "{reflectance}: {ratio}");
    }
    assert_eq!(reflected(0.0), 0.0);
}
