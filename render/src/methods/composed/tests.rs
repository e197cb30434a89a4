//! The passes against their plain version, and the whole beside all light.

use super::*;
use crate::bvh::TracedScene;
use crate::gbuffer;
use crate::method::{Frame, Repeats};
use crate::methods::proving::Tolerance;
use crate::methods::proving::beyond::{corner, foggy, prove_twin};
use crate::path::{self, Sampling, Shot};
use crate::scene::{Gloss, Light, Material, MaterialId, Medium, Mesh};
use crate::screen::ScreenMethod;
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{GBuffer, Planes};

fn few() -> ComposedParameters {
    let mut few = ComposedParameters::of(Quality::Low);
    few.volume = LpvParameters { cells: 10, iterations: 8, steps: 8, ..few.volume };
    few.surfaces.levels = 3;
    few
}

type ViewedScene = (TracedScene, View, GBuffer);

fn seen((scene, view, _): ViewedScene, changed: impl FnOnce(&mut Scene)) -> ViewedScene {
    let mut scene = scene.scene().clone();
    changed(&mut scene);
    let scene = TracedScene::new(scene).expect("triangles");
    let attributes = few().about().attributes;
    let gbuffer = gbuffer::render(&scene, &view.camera, view.height, view.width, attributes);
    (scene, view, gbuffer)
}

fn under_a_sky(scene: &mut Scene) {
    scene.environment = Some(Environment::uniform(Vec3::new(0.3, 0.4, 0.6)).into());
}

/// The floor glows, and no lamp shines.
fn by_its_floor(scene: &mut Scene) {
    scene.lights.clear();
    scene.materials.push(Material { emission: Vec3::new(2.0, 1.0, 0.5), ..scene.materials[0].clone() });
    scene.meshes.iter_mut().take(1).for_each(|floor| floor.material = MaterialId(1));
}

/// A metal, and a surface of Phong's model.
fn of_other_materials(scene: &mut Scene) {
    let first = scene.materials[0].clone();
    scene.materials.push(Material { metallic: 1.0, roughness: 0.5, ..first.clone() });
    scene.materials.push(Material { gloss: Gloss::Phong, roughness: 0.6, ..first });
    let all = scene.meshes.iter_mut().zip([1, 2].into_iter().cycle());
    all.for_each(|(mesh, material)| mesh.material = MaterialId(material));
}

#[test]
fn the_passes_make_what_the_plain_version_does() {
    let method = ScreenMethod::new(&Gpu::new().expect("an adapter; lavapipe will do"), few());
    let frames = [
        seen(corner(), under_a_sky),
        seen(corner(), by_its_floor),
        seen(foggy().remove(0), |_| ()),
        seen(foggy().remove(1), |_| ()),
        seen(foggy().remove(0), by_its_floor),
        seen(foggy().remove(1), under_a_sky),
        seen(corner(), of_other_materials),
    ];
    // Shadow maps end within a texel of where shadows do.
    let tolerance = Tolerance { usual: 1e-3, worst: 0.05 };
    frames.iter().for_each(|frame| prove_twin(&method, frame, tolerance));
}

#[test]
fn each_part_that_a_scene_has_takes_its_own_time() {
    let method = ScreenMethod::new(&Gpu::new().expect("an adapter; lavapipe will do"), few());
    let parts = |(scene, view, gbuffer): ViewedScene| {
        let View { camera, radius, seed, .. } = view;
        let frame = Frame { scene: &scene, camera: &camera, gbuffer: &gbuffer, radius, seed };
        let times = method.pass_times(&frame, Repeats { warm_up: 0, timed: 2 }).expect("it runs");
        assert!(times.iter().all(|time| time.milliseconds > 0.0));
        let mut parts: Vec<String> =
            times.iter().filter_map(|time| Some(time.key.split_once('/')?.0.to_owned())).collect();
        parts.dedup();
        parts
    };
    assert_eq!(parts(seen(corner(), |_| ())), ["lamps", "surfaces"]);
    assert_eq!(parts(seen(corner(), under_a_sky)), ["lamps", "surfaces", "sky"]);
    assert_eq!(parts(seen(corner(), by_its_floor)), ["surfaces", "emission"]);
    assert_eq!(parts(seen(foggy().remove(0), |_| ())), ["lamps", "surfaces", "shafts", "volume"]);
}

fn plain(scene: &TracedScene, view: &View, gbuffer: &GBuffer) -> Planes {
    let environment = scene.scene().environment.as_deref();
    let inputs = PlainInputs { gbuffer, environment, scene: Some(scene) };
    let image = few().reference(&inputs, view).expect("attributes").remove(0);
    Planes::from_data(3, view.height, view.width, image)
}

#[test]
fn all_parts_together_are_about_as_bright_as_truth() {
    // Light of lamps that surfaces reflect twice is missing.
    let frames = [
        (seen(corner(), |_| ()), 0.9),
        (seen(corner(), under_a_sky), 0.9),
        (seen(foggy().remove(0), |_| ()), 0.9),
        (seen(foggy().remove(1), under_a_sky), 0.85),
    ];
    for ((scene, view, gbuffer), least) in frames {
        let shot = Shot::new(&scene, &view.camera, [view.height, view.width], view.radius);
        let truth = path::render(Effect::Path, &shot, Sampling::one(64, 1)).mean.mean();
        let ratio = plain(&scene, &view, &gbuffer).mean() / truth;
        assert!((least..1.1).contains(&ratio), "{ratio}");
    }
}

#[test]
fn a_glossy_floor_seen_from_low_down_reflects_a_lamp_as_truth_does() {
    let corners = [(-9.0, 9.0), (9.0, 9.0), (9.0, -9.0), (-9.0, -9.0)].map(|(x, z)| Vec3::new(x, 0.0, z));
    let floor =
        Mesh { positions: corners.to_vec(), triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() };
    let lamp = Light::Point {
        position: Vec3::new(0.5, 2.0, -3.0),
        intensity: Vec3::splat(9.0),
        range: f32::INFINITY,
    };
    let material = Material { roughness: 0.7, ..Material::matte("floor", Vec3::splat(0.6)) };
    let glossy = Material { gloss: Gloss::Microfacets, ..material };
    let scene =
        Scene { meshes: vec![floor].into(), materials: vec![glossy], lights: vec![lamp], ..Scene::default() };
    let scene = TracedScene::new(scene).expect("triangles");
    let camera = Camera::look_at(Vec3::new(0.0, 0.4, 3.0), Vec3::new(0.0, 0.0, -1.0));
    let (height, width) = (24, 32);
    let view = View { height, width, camera, radius: 0.1, seed: 1 };
    let gbuffer = gbuffer::render(&scene, &camera, height, width, few().about().attributes);
    let shot = Shot::new(&scene, &camera, [height, width], view.radius);
    let truth = path::render(Effect::Path, &shot, Sampling::one(64, 1)).mean.mean();
    let ratio = plain(&scene, &view, &gbuffer).mean() / truth;
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
    // Phong's model is another.
    let by_phong = gbuffer.select(&[Attribute::Light]).expect("light").mean() / truth;
    assert!(by_phong > 1.1, "{by_phong}");
}

#[test]
fn what_emits_lights_what_is_beside_it() {
    let (scene, view, gbuffer) = seen(corner(), by_its_floor);
    let shot = Shot::new(&scene, &view.camera, [view.height, view.width], view.radius);
    let truth = path::render(Effect::Path, &shot, Sampling::one(64, 1)).mean;
    let image = plain(&scene, &view, &gbuffer);
    let glows = gbuffer.select(&[Attribute::Emission]).expect("emission");
    let wall = |image: &Planes| {
        let lit = image.plane(0).iter().zip(glows.plane(0)).filter(|(_, emission)| **emission == 0.0);
        lit.map(|(light, _)| f64::from(*light)).sum::<f64>()
    };
    let ratio = wall(&image) / wall(&truth);
    assert!((0.85..1.1).contains(&ratio), "{ratio}");
}

#[test]
fn a_medium_that_does_nothing_changes_nothing_and_one_that_absorbs_all_is_black() {
    let (scene, view, gbuffer) = &seen(corner(), |_| ());
    let filled = |absorption: f32| {
        let bounds = scene.scene().bounds();
        let density = crate::scene::Density::Within(bounds);
        let medium = Medium::new(Vec3::splat(absorption), Vec3::ZERO, 0.0, density).expect("a medium");
        seen(corner(), |scene| scene.medium = Some(medium.into()))
    };
    let clear = plain(scene, view, gbuffer);
    let image = |(scene, view, gbuffer): ViewedScene| plain(&scene, &view, &gbuffer);
    let nothing = image(filled(0.0));
    let off = clear.data().iter().zip(nothing.data()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(off < 1e-5, "{off}");
    assert!(image(filled(1e3)).mean() < 1e-3 * clear.mean());
}
