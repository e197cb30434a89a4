//! Closed forms, and the passes against the plain version.

use super::*;
use crate::bvh::TracedScene;
use crate::gbuffer;
use crate::method::{Frame, Method, Repeats};
use crate::methods::proving::beyond::{corner, prove_twin};
use crate::methods::proving::{Tolerance, mean_difference};
use crate::path::{self, Sampling, Shot};
use crate::scene::medium::Weather;
use crate::scene::{Bounds, Density, Medium};
use deepshade_shaders::GBuffer;
use deepshade_shaders::gpu::Gpu;
use glam::Vec3;

/// The lit corner, seen through a medium.
fn filled(medium: Medium) -> (TracedScene, View, GBuffer) {
    let (scene, view, _) = corner();
    let scene = crate::scene::Scene { medium: Some(medium.into()), ..scene.scene().clone() };
    let scene = TracedScene::new(scene).expect("a scene");
    let gbuffer = gbuffer::render(&scene, &view.camera, view.height, view.width, &Attribute::ALL);
    (scene, View { radius: 1.0, ..view }, gbuffer)
}

const BOX: Bounds = Bounds { min: Vec3::new(-4.0, 0.0, -4.0), max: Vec3::new(1.0, 2.0, 4.0) };

fn smoke() -> Medium {
    let grid = Weather::smoke(2, 1.5, 0.8).grid(BOX, 16, 0.0).expect("smoke");
    let (absorption, scattering) = (Vec3::new(0.02, 0.05, 0.1), Vec3::new(0.3, 0.2, 0.25));
    Medium::new(absorption, scattering, 0.4, Density::Grid(grid)).expect("a medium")
}

fn fog(extinction: f32) -> Medium {
    let scattering = Vec3::splat(0.8 * extinction);
    Medium::new(Vec3::splat(0.2 * extinction), scattering, 0.3, Density::Within(BOX)).expect("a medium")
}

fn coarse() -> Parameters {
    Parameters {
        surfels: surfels::Parameters { scale: 0.05, near: 0.25 },
        levels: 3,
        ..Parameters::default()
    }
}

#[test]
fn the_passes_make_what_the_plain_version_does() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    // Radiance has nine bits, and shadow maps end within a texel of where shadows do.
    for medium in [fog(0.3), smoke()] {
        let method = VolumeShell::new(&gpu, coarse()).expect("valid shaders");
        prove_twin(&method, &filled(medium), Tolerance { usual: 1e-4, worst: 2e-3 });
    }
}

#[test]
fn it_is_nearer_to_truth_than_no_light() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let (scene, view, gbuffer) = filled(fog(0.3));
    let shot = Shot::new(&scene, &view.camera, [view.height, view.width], view.radius);
    let truth = path::render(Effect::FogIndirect, &shot, Sampling::one(512, 1)).mean;
    let method = VolumeShell::new(&gpu, Parameters::of(Quality::High)).expect("valid shaders");
    let frame =
        Frame { scene: &scene, camera: &view.camera, gbuffer: &gbuffer, radius: view.radius, seed: 1 };
    let image = Method::shade(&method, &frame, Repeats::ONCE).expect("an image").image;
    let mean =
        |image: &deepshade_shaders::Planes| image.data().iter().sum::<f32>() / image.data().len() as f32;
    let off = mean_difference(&image, &truth);
    println!("{} {} {off}", mean(&image), mean(&truth));
    assert!((mean(&image) / mean(&truth) - 1.0).abs() < 0.1, "{} and {}", mean(&image), mean(&truth));
}
