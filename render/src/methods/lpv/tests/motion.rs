//! What moves, from frame to frame, light in a room beside truth, and light behind a wall.

use super::*;
use crate::methods::proving::view;
use crate::path::{self, Sampling, Shot};
use crate::scene::medium::Weather;
use crate::scene::{Light, Material, Mesh};
use crate::screen::PlainInputs;

/// Metres in a frame, and seconds.
const STEP: f32 = 0.02;
const SECONDS: f32 = 1.0 / 60.0;

/// What the plain version makes of a scene.
fn shaded(technique: &impl Technique, scene: Scene, camera: Camera) -> Vec<f32> {
    let scene = TracedScene::new(scene).expect("triangles");
    let view = View { camera, radius: 20.0, ..view(12, 16, 1.0) };
    let gbuffer = gbuffer::render(&scene, &camera, 12, 16, <Multiple as Technique>::ATTRIBUTES);
    let inputs = PlainInputs { gbuffer: &gbuffer, environment: None, scene: Some(&scene) };
    technique.reference(&inputs, &view).expect("attributes").remove(0)
}

fn mean(image: &[f32]) -> f32 {
    image.iter().sum::<f32>() / image.len() as f32
}

/// How far images are on average from the mean of that before and that after, over their mean.
fn flicker(images: &[Vec<f32>]) -> f32 {
    let off = |of: &[Vec<f32>]| {
        let at = |i: usize| (of[1][i] - 0.5 * (of[0][i] + of[2][i])).abs();
        (0..of[1].len()).map(at).sum::<f32>() / of[1].len() as f32
    };
    let all: Vec<f32> = images.windows(3).map(off).collect();
    mean(&all) / mean(&images.concat())
}

#[test]
fn what_moves_hardly_flickers() {
    let (traced, View { camera, .. }, _) = foggy().remove(1);
    let scene = traced.scene();
    let medium = scene.medium.clone().expect("smoke");
    let bounds = scene.bounds();
    let lamp = |frame: usize| {
        let moved = |light: &Light| match *light {
            Light::Point { position, intensity, range } => {
                Light::Point { position: position + STEP * frame as f32 * Vec3::X, intensity, range }
            }
            other => other,
        };
        Scene { lights: scene.lights.iter().map(moved).collect(), ..scene.clone() }
    };
    let screen = |frame: usize| {
        let mut meshes = scene.meshes.to_vec();
        meshes[2].positions.iter_mut().for_each(|position| position.x += STEP * frame as f32);
        Scene { meshes: meshes.into(), ..scene.clone() }
    };
    let smoke = |frame: usize| {
        let weather = Weather { wind: Vec3::X, ..Weather::smoke(2, 1.5, 0.8) };
        let grid = weather.grid(bounds, 16, SECONDS * frame as f32).expect("smoke");
        let medium =
            Medium::new(medium.absorption, medium.scattering, medium.anisotropy, Density::Grid(grid))
                .expect("smoke");
        Scene { medium: Some(medium.into()), ..scene.clone() }
    };
    let moves: [(&str, &dyn Fn(usize) -> Scene); 3] =
        [("lamp", &lamp), ("screen", &screen), ("smoke", &smoke)];
    for (name, scene) in moves {
        let images: Vec<_> = (0..8).map(|frame| shaded(&Multiple(FEW), scene(frame), camera)).collect();
        let flicker = flicker(&images);
        assert!(images[0] != images[7] && flicker < 1e-3, "{name}: {flicker}");
    }
}

/// A closed room with a lamp, and with a wall across it, as thin as a sheet, if it is `divided`.
fn room(divided: bool) -> Scene {
    let quad = |corners: [Vec3; 4]| Mesh {
        positions: corners.to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    let sides = [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|axis| [axis, -axis]);
    let side = |out: Vec3| {
        let (along, up) = (Vec3::new(out.y, out.z, out.x), Vec3::new(out.z, out.x, out.y));
        quad([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(a, b)| out + a * along + b * up))
    };
    let corner = |y: f32, z: f32| Vec3::new(0.13, y, z);
    let sheet = quad([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
    let lamp = Light::Point {
        position: Vec3::new(0.6, 0.5, 0.0),
        intensity: Vec3::splat(4.0),
        range: f32::INFINITY,
    };
    Scene {
        meshes: sides.map(side).chain(divided.then_some(sheet)).collect::<Vec<_>>().into(),
        materials: vec![Material::default()],
        lights: vec![lamp],
        ..Scene::default()
    }
}

#[test]
fn a_room_is_as_bright_as_truth_has_it() {
    let parameters = Parameters { cells: 16, iterations: 32, ..FEW };
    let camera = Camera::look_at(Vec3::new(-0.9, 0.4, 0.9), Vec3::new(0.3, -0.3, -0.5));
    let image = shaded(&parameters, room(false), camera);
    let scene = TracedScene::new(room(false)).expect("triangles");
    let shot = Shot::new(&scene, &camera, [12, 16], 20.0);
    let truth = path::render(Effect::Gi, &shot, Sampling::one(128, 1)).mean;
    let ratio = mean(&image) / mean(truth.data());
    let off = |(is, wanted): (&f32, &f32)| (is - wanted).powi(2) / (wanted * wanted + 1e-2);
    let error = mean(&image.iter().zip(truth.data()).map(off).collect::<Vec<_>>());
    assert!((ratio - 1.0).abs() < 0.1 && error < 0.1, "{ratio} {error}");
}

#[test]
fn little_light_goes_through_a_wall_thinner_than_a_cell() {
    let parameters = Parameters { cells: 16, iterations: 16, ..FEW };
    let leak = |lookup: Lookup| {
        let technique = Parameters { scheme: Scheme { lookup, ..Scheme::OURS }, ..parameters };
        let lit = Camera::look_at(Vec3::new(0.9, 0.2, 0.8), Vec3::new(0.3, -0.3, -0.8));
        let dark = Camera::look_at(Vec3::new(-0.8, 0.2, 0.8), Vec3::new(0.1, -0.3, -0.6));
        let [lit, dark] = [lit, dark].map(|camera| mean(&shaded(&technique, room(true), camera)));
        dark / lit
    };
    let [before, within] = [Lookup::Before, Lookup::Within].map(leak);
    assert!(before < 0.015 && within > 1.3 * before, "{before} {within}");
}

#[test]
fn nothing_is_left_of_another_frame() {
    let gpu = gpu();
    let (scene, view, gbuffer) = with_colours(foggy().remove(0));
    let method = MultipleScattering::new(&gpu, Multiple(FEW)).expect("valid shaders");
    let there =
        GpuGBuffer::upload(&gpu.device, &gbuffer, ScreenMethod::attributes(&method)).expect("attributes");
    let world = screen::world(&gpu, scene.scene(), &view).expect("room");
    let inputs = Inputs { gbuffer: &there, environment: None, world: Some(&world) };
    let plan = Plan::new(&method, &inputs, &view).expect("room");
    let lights = scene.scene().lights.clone();
    let brighter = |light: &Light| match *light {
        Light::Point { position, intensity, range } => {
            Light::Point { position, intensity: 30.0 * intensity, range }
        }
        other => other,
    };
    let others: Vec<Light> = lights.iter().map(brighter).collect();
    let image = |lights: &[Light]| -> Vec<f32> {
        world.gpu_lights.set(&gpu.queue, lights);
        gpu::submit(&gpu.device, &gpu.queue, "test", |encoder| plan.encode(encoder)).expect("valid passes");
        gpu::read(&gpu.device, &gpu.queue, plan.output()).expect("an image")
    };
    let first = image(&lights);
    assert!(mean(&image(&others)) > 1.2 * mean(&first));
    assert_eq!(image(&lights), first);
}
