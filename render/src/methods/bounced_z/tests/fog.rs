//! Light of surfels in a medium: the passes against the plain version, truth in a closed room, and what hides
//! what.

use super::super::fog::FogRaysParameters;
use super::*;
use crate::gbuffer;
use crate::methods::proving::beyond::ATTRIBUTES;
use crate::methods::volume_shell::VolumeShellParameters;
use crate::scene::medium::Weather;
use crate::scene::{Bounds, Density, Light, Material, Medium, Mesh};
use crate::screen::Technique;
use deepshade_shaders::{GBuffer, Planes};

type ViewedScene = (TracedScene, View, GBuffer);

fn gpu() -> Gpu {
    Gpu::new().expect("an adapter; lavapipe will do")
}

/// Of which tests take little time.
fn coarse() -> FogRaysParameters {
    let surfels = surfels::SurfelDensity { scale: 0.08, near: 0.25 };
    FogRaysParameters { surfels, directions: 3, radius: 6, ..FogRaysParameters::of(Quality::Low) }
}

/// A room from -1 to 1 with a lamp on its right; `divider` is a wall across it, nearer to the left.
fn room(medium: Medium, divider: bool) -> Scene {
    let quad = |corners: [Vec3; 4]| Mesh {
        positions: corners.to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    let square = |out: Vec3| {
        let (along, up) = (Vec3::new(out.y, out.z, out.x), Vec3::new(out.z, out.x, out.y));
        let [along, up] = [along, up].map(|way| way.normalize());
        quad([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(a, b)| out + a * along + b * up))
    };
    let sides = Vec3::AXES.into_iter().flat_map(|axis| [axis, -axis]).map(square);
    let position = Vec3::new(0.6, 0.4, 0.2);
    let lamp = Light::Point { position, intensity: Vec3::new(9.0, 6.0, 3.0), range: f32::INFINITY };
    Scene {
        meshes: sides.chain(divider.then(|| square(-0.4 * Vec3::X))).collect::<Vec<_>>().into(),
        materials: vec![Material::matte("grey", Vec3::splat(0.6))],
        lights: vec![lamp],
        medium: Some(medium.into()),
        ..Scene::default()
    }
}

fn seen_from(scene: Scene, eye: Vec3, target: Vec3) -> ViewedScene {
    let (scene, camera) = (TracedScene::new(scene).expect("triangles"), Camera::look_at(eye, target));
    let gbuffer = gbuffer::render(&scene, &camera, 30, 40, ATTRIBUTES);
    (scene, View { camera, ..view(30, 40, 1.0) }, gbuffer)
}

const ROOM: Bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };

fn fog(anisotropy: f32, density: Density) -> Medium {
    let (absorption, scattering) = (Vec3::new(0.05, 0.1, 0.2), Vec3::new(0.6, 0.4, 0.3));
    Medium::new(absorption, scattering, anisotropy, density).expect("fog")
}

fn smoke() -> Density {
    Density::Grid(Weather::smoke(2, 0.6, 0.8).grid(ROOM, 16, 0.0).expect("smoke"))
}

fn image(technique: impl Technique + 'static, (scene, view, gbuffer): &ViewedScene) -> Planes {
    let frame = Frame { scene, camera: &view.camera, gbuffer, radius: view.radius, seed: view.seed };
    ScreenMethod::new(&gpu(), technique).shade(&frame, Repeats::ONCE).expect("an image").image
}

fn mean(image: &Planes) -> f32 {
    image.data().iter().sum::<f32>() / image.data().len() as f32
}

#[test]
fn the_passes_scatter_as_the_plain_version_does() {
    let method = ScreenMethod::new(&gpu(), coarse());
    let (eye, target) = (Vec3::new(-0.9, 0.4, 0.9), Vec3::new(0.3, -0.3, -0.5));
    for (anisotropy, density) in [(0.3, Density::Within(ROOM)), (-0.4, Density::Everywhere), (0.3, smoke())] {
        let seen = seen_from(room(fog(anisotropy, density), false), eye, target);
        // Radiance has nine bits, and a ray that just meets a disk in one may just miss it in the other.
        prove_twin(&method, &seen, Tolerance { usual: 1.5e-3, worst: 0.2 });
    }
}

#[test]
fn a_closed_room_is_as_bright_as_truth_has_it() {
    let (eye, target) = (Vec3::new(-0.9, 0.4, 0.9), Vec3::new(0.3, -0.3, -0.5));
    for (anisotropy, density) in [(0.0, Density::Within(ROOM)), (0.6, Density::Within(ROOM)), (0.0, smoke())]
    {
        let seen = seen_from(room(fog(anisotropy, density), false), eye, target);
        let (scene, view, _) = &seen;
        let shot = Shot::new(scene, &view.camera, [view.height, view.width], view.radius);
        let truth = path::render(Effect::FogIndirect, &shot, Sampling::one(1024, 1)).mean;
        for quality in [Quality::Low, Quality::High] {
            let image = image(FogRaysParameters::of(quality), &seen);
            let colours = [0, 1, 2].map(|c| {
                let sum = |image: &Planes| image.plane(c).iter().sum::<f32>();
                sum(&image) / sum(&truth)
            });
            assert!(colours.iter().all(|ratio| (ratio - 1.0).abs() < 0.1), "{quality:?}: {colours:?}");
            let off = mean_difference(&image, &truth) / mean(&truth);
            assert!(off < 0.2, "{quality:?}: {off}");
        }
    }
}

/// Behind a wall without light nothing is scattered; by volume shells it is.
#[test]
fn a_wall_keeps_light_out() {
    let (eye, target) = (Vec3::new(-0.95, 0.5, 0.9), Vec3::new(-0.6, -0.3, -0.9));
    let hidden = seen_from(room(fog(0.0, Density::Within(ROOM)), true), eye, target);
    let open = seen_from(room(fog(0.0, Density::Within(ROOM)), false), eye, target);
    let shares = |image: &dyn Fn(&ViewedScene) -> Planes| mean(&image(&hidden)) / mean(&image(&open));
    let by_rays = shares(&|seen| image(FogRaysParameters::of(Quality::Medium), seen));
    let by_shells = shares(&|seen| image(VolumeShellParameters::of(Quality::Low), seen));
    assert!(by_rays < 0.03 && by_shells > 0.3, "{by_rays} by rays, {by_shells} by shells");
}

#[test]
fn without_a_medium_or_light_it_is_black() {
    let (eye, target) = (Vec3::new(-0.9, 0.4, 0.9), Vec3::new(0.3, -0.3, -0.5));
    let clear = Scene { medium: None, ..room(fog(0.0, Density::Everywhere), false) };
    let dark = Scene { lights: vec![], ..room(fog(0.0, Density::Everywhere), false) };
    let absorbs = Medium { scattering: Vec3::ZERO, ..fog(0.0, Density::Everywhere) };
    let nothing = Medium { absorption: Vec3::ZERO, ..absorbs.clone() };
    for scene in [clear, dark, room(absorbs, false), room(nothing, false)] {
        let image = image(coarse(), &seen_from(scene, eye, target));
        assert!(image.data().iter().all(|value| *value == 0.0));
    }
}
