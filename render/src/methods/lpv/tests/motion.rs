//! What moves, from frame to frame.

use super::room::{mean, shaded};
use super::*;
use crate::scene::Light;
use crate::scene::medium::Weather;

/// Metres in a frame, and seconds.
const STEP: f32 = 0.02;
const SECONDS: f32 = 1.0 / 60.0;

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
        let images: Vec<_> =
            (0..8).map(|frame| shaded(&InMedium::multiple(FEW), scene(frame), camera)).collect();
        let flicker = flicker(&images);
        assert!(images[0] != images[7] && flicker < 1e-3, "{name}: {flicker}");
    }
}

#[test]
fn nothing_is_left_of_another_frame() {
    let gpu = gpu();
    let (scene, view, gbuffer) = with_colours(foggy().remove(0));
    let method = ScreenMethod::new(&gpu, InMedium::multiple(FEW));
    let there = GpuGBuffer::upload(&gpu.device, &gbuffer, method.attributes()).expect("attributes");
    let world = screen::world(&gpu, scene.scene(), &view).expect("room");
    let inputs = Inputs { gbuffer: &there, environment: None, world: Some(&world) };
    let passes = MethodPasses::new(&method, &inputs, &view).expect("room");
    let lights = scene.scene().lights.clone();
    let brighter = |light: &Light| match *light {
        Light::Point { position, intensity, range } => {
            Light::Point { position, intensity: 30.0 * intensity, range }
        }
        other => other,
    };
    let others: Vec<Light> = lights.iter().map(brighter).collect();
    let image = |lights: &[Light]| -> Vec<f32> {
        world.gpu_lights.set(&gpu.queue, lights, &[true; 3]);
        gpu::submit(&gpu.device, &gpu.queue, "test", |encoder| passes.encode(encoder)).expect("valid passes");
        gpu::read(&gpu.device, &gpu.queue, passes.output()).expect("an image")
    };
    let first = image(&lights);
    assert!(mean(&image(&others)) > 1.2 * mean(&first));
    assert_eq!(image(&lights), first);
}
