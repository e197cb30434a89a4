//! A medium under a sky.

use super::room::shaded;
use super::*;
use crate::scene::{Bounds, Environment, Material, Mesh};

/// Half an edge of the box of fog, metres.
const HALF: f32 = 1.0;

/// Fog of such an optical depth along an edge, which scatters all light, and next to no surfaces, under a sky
/// of a radiance.
fn box_of_fog(depth: f32, radiance: Vec3) -> Scene {
    let bounds = Bounds { min: Vec3::splat(-HALF), max: Vec3::splat(HALF) };
    let speck = |corner: Vec3| {
        let inward = -1e-3 * corner;
        Mesh {
            positions: vec![corner, corner + inward * Vec3::X, corner + inward * Vec3::Y],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        }
    };
    let scattering = Vec3::splat(depth / (2.0 * HALF));
    let medium = Medium::new(Vec3::ZERO, scattering, 0.0, Density::Within(bounds)).expect("fog");
    Scene {
        meshes: vec![speck(bounds.min), speck(bounds.max)].into(),
        materials: vec![Material::default()],
        medium: Some(medium.into()),
        environment: Some(Environment::uniform(radiance).into()),
        ..Scene::default()
    }
}

#[test]
fn fog_that_scatters_all_is_as_bright_as_an_even_sky_around_it() {
    let camera = Camera::look_at(Vec3::new(0.3, 0.2, 6.0), Vec3::ZERO);
    let radiance = Vec3::new(0.5, 1.0, 2.0);
    for (depth, off) in [(0.3, 0.02), (1.0, 0.05), (4.0, 0.15)] {
        let scene = box_of_fog(depth, radiance);
        let medium = scene.medium.clone().expect("fog");
        let parameters = LpvParameters { cells: 12, iterations: 40, steps: 48, scale: 1, ..FEW };
        let scattered = shaded(&InMedium::all(parameters), scene, camera);
        let (mut sum, mut all) = (0.0, 0.0);
        for (pixel, scattered) in scattered.iter().take(12 * 16).enumerate() {
            let at = glam::Vec2::new((pixel % 16) as f32, (pixel / 16) as f32) + 0.5;
            let direction = camera.direction(at, 12, 16);
            let passed = medium.passed_share(camera.position, direction, 1e30, 16).x;
            if passed < 1.0 {
                sum += scattered / radiance.x + passed;
                all += 1.0;
            }
        }
        let ratio: f32 = sum / all;
        assert!(all > 9.0 && (ratio - 1.0).abs() < off, "{depth}: {ratio} of {all}");
    }
}

/// A frame under a sky that is brighter on one side.
fn under_a_sky((scene, view, gbuffer): ViewedScene) -> ViewedScene {
    let texels = (0..32).map(|i| Vec3::new(0.2, 0.3, 0.5) * (i % 8) as f32).collect();
    let sky = Environment::new("a sky".as_ref(), 8, 4, texels).expect("a sky");
    let scene = Scene { environment: Some(sky.into()), ..scene.scene().clone() };
    (TracedScene::new(scene).expect("triangles"), view, gbuffer)
}

#[test]
fn a_medium_under_a_sky_is_lit_as_the_plain_version_has_it() {
    let gpu = gpu();
    let frames = foggy().into_iter().map(with_colours).map(under_a_sky);
    for frame in frames {
        prove_twin(&ScreenMethod::new(&gpu, InMedium::all(FEW)), &frame, OF_MEDIUM);
        prove_twin(&ScreenMethod::new(&gpu, InMedium::multiple(FEW)), &frame, OF_MEDIUM);
    }
}

/// Labels of the passes of a technique.
fn has_pass(gpu: &Gpu, technique: InMedium, (scene, view, gbuffer): &ViewedScene, label: &str) -> bool {
    let method = ScreenMethod::new(gpu, technique);
    let there = GpuGBuffer::upload(&gpu.device, gbuffer, method.attributes()).expect("attributes");
    let world = screen::world(gpu, scene.scene(), view).expect("room");
    let inputs = Inputs { gbuffer: &there, environment: None, world: Some(&world) };
    let passes = MethodPasses::new(&method, &inputs, view).expect("room");
    passes.steps().iter().any(|step| step.step.pass.is_of(label))
}

#[test]
fn without_a_sky_nothing_is_added_and_no_pass_is_run() {
    let (gpu, frame) = (gpu(), with_colours(foggy().remove(0)));
    for label in ["lpv.enter", "lpv.reflect"] {
        assert!(!has_pass(&gpu, InMedium::all(FEW), &frame, label), "{label}");
        assert!(has_pass(&gpu, InMedium::all(FEW), &under_a_sky(with_colours(foggy().remove(0))), label));
    }
    let (scene, view, gbuffer) = &frame;
    let inputs = PlainInputs { gbuffer, environment: None, scene: Some(scene) };
    let image = |technique: InMedium| technique.reference(&inputs, view).expect("attributes").remove(0);
    let [indirect, multiple] = [InMedium::indirect(FEW), InMedium::multiple(FEW)].map(image);
    let sum: Vec<f32> = indirect.iter().zip(multiple).map(|(a, b)| a + b).collect();
    assert_eq!(image(InMedium::all(FEW)), sum);
}
