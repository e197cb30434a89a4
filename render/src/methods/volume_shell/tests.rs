//! What the passes make against the plain version, and where geometry or the medium degenerates.

mod direct;
mod improvements;
mod limits;
mod truth;
mod twins;
mod work;

use super::*;
use crate::bvh::TracedScene;
use crate::gbuffer;
use crate::method::{Frame, Method, Repeats};
use crate::methods::proving::beyond::corner;
use crate::scene::medium::Weather;
use crate::scene::{Bounds, Density, Medium, Scene};
use crate::screen::ScreenMethod;
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{GBuffer, Planes};
use glam::Vec3;

/// A scene, from where it is seen, and its g-buffer.
type ViewedScene = (TracedScene, View, GBuffer);

/// The box of media in the corner.
const BOX: Bounds = Bounds { min: Vec3::new(-4.0, 0.0, -4.0), max: Vec3::new(1.0, 2.0, 4.0) };

fn gpu() -> Gpu {
    Gpu::new().expect("an adapter; lavapipe will do")
}

/// Smoke that takes more of blue than of red.
fn smoke() -> Medium {
    let grid = Weather::smoke(2, 1.5, 0.8).grid(BOX, 16, 0.0).expect("smoke");
    let (absorption, scattering) = (Vec3::new(0.02, 0.05, 0.4), Vec3::new(0.3, 0.2, 0.25));
    Medium::new(absorption, scattering, 0.4, Density::Grid(grid)).expect("a medium")
}

/// Grey fog.
fn fog(extinction: f32) -> Medium {
    let scattering = Vec3::splat(0.8 * extinction);
    Medium::new(Vec3::splat(0.2 * extinction), scattering, 0.3, Density::Within(BOX)).expect("a medium")
}

/// A scene in a medium, as a camera sees it.
fn seen_in(scene: Scene, medium: Option<Medium>, view: View) -> ViewedScene {
    let scene = Scene { medium: medium.map(Into::into), ..scene };
    let scene = TracedScene::new(scene).expect("a scene");
    let gbuffer = gbuffer::render(&scene, &view.camera, view.height, view.width, &Attribute::ALL);
    (scene, view, gbuffer)
}

/// The lit corner, seen through a medium.
fn filled(medium: Medium) -> ViewedScene {
    filled_at(medium, 36, 48)
}

fn filled_at(medium: Medium, height: usize, width: usize) -> ViewedScene {
    let (scene, view, _) = corner();
    seen_in(scene.scene().clone(), Some(medium), View { radius: 1.0, height, width, ..view })
}

/// VolumeShellParameters of which tests take little time.
fn coarse() -> VolumeShellParameters {
    VolumeShellParameters {
        surfels: surfels::SurfelDensity { scale: 0.1, near: 0.25 },
        levels: 3,
        steps: 64,
        ..VolumeShellParameters::of(Quality::High)
    }
}

fn without(improvement: Improvement) -> VolumeShellParameters {
    VolumeShellParameters { improvements: Improvements::ALL.without(improvement), ..coarse() }
}

fn shaded(method: &ScreenMethod, (scene, view, gbuffer): &ViewedScene) -> Planes {
    let frame = Frame { scene, camera: &view.camera, gbuffer, radius: view.radius, seed: view.seed };
    Method::shade(method, &frame, Repeats::ONCE).expect("an image").image
}

fn image(gpu: &Gpu, parameters: VolumeShellParameters, seen: &ViewedScene) -> Planes {
    shaded(&ScreenMethod::new(gpu, parameters), seen)
}

fn mean(image: &Planes) -> f32 {
    image.data().iter().sum::<f32>() / image.data().len() as f32
}

fn is_sound(image: &Planes) -> bool {
    image.data().iter().all(|value| value.is_finite() && *value >= 0.0)
}

fn is_black(image: &Planes) -> bool {
    image.data().iter().all(|value| *value == 0.0)
}
