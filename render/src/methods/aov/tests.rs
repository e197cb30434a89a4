//! Closed forms, what hides what, odd scenes, and the passes against the plain version.

use super::Volumes;
use super::bounced::AovBouncedZParameters;
use super::reference::{Facet, MOST_HIDDEN, compensated, distance, facets, lifted, occluded};
use crate::method::{Frame, Method, Repeats};
use crate::methods::bounced_z::reference::place_on_disk;
use crate::methods::bounced_z::{Matte, Reflector};
use crate::methods::proving::beyond::{disk_mesh, prove_twin, scene_of, seen, sphere_mesh};
use crate::methods::proving::{Tolerance, camera, gbuffer_of, mean_difference, plane, view};
use crate::methods::{Quality, blur};
use crate::path::{self, Sampling, Shot};
use crate::raster::World;
use crate::scene::procedural::Family;
use crate::scene::{AlphaMode, Material, MaterialId, Mesh, Scene};
use crate::screen::{GpuGBuffer, Inputs, MethodPasses, ScreenMethod};
use deepshade_shaders::gpu::{self, Gpu};
use deepshade_shaders::{Attribute, Effect, GBuffer, Planes};
use glam::{UVec2, Vec3, Vec4};

/// What a scene hides from above a horizontal surface at the origin: by volumes, and by rays into the
/// directions of many pixels.
fn hidden(scene: &Scene, reach: f32) -> [f32; 2] {
    let facets = facets(scene, &camera());
    let at = lifted(Vec3::ZERO, Vec3::Y, reach);
    let is_met = |direction| {
        facets.iter().any(|facet| distance(facet.corners, at, direction).is_some_and(|far| far < reach))
    };
    let directions =
        (0..64 * 64).map(|i| Matte(Vec3::Y).direction(place_on_disk(UVec2::new(i % 64, i / 64), 0, [1, 5])));
    let met = directions.filter(|direction| is_met(*direction)).count();
    [occluded(&facets, at, Vec3::Y, reach), met as f32 / 4096.0]
}

#[test]
fn a_disk_hides_what_a_closed_form_says() {
    // A disk of radius r at height h hides r^2 / (r^2 + h^2); of an endless one 1 - (h / reach)^2 is within
    // reach.
    for (radius, height, reach) in [(0.5f32, 1.0f32, 9.0f32), (0.3, 0.2, 1.0), (40.0, 0.5, 1.0)] {
        let whole = radius * radius / (radius * radius + height * height);
        let right = whole.min(1.0 - (height / reach).powi(2));
        let [sum, rays] = hidden(&scene_of(vec![disk_mesh(Vec3::Y * height, radius)]), reach);
        assert!((sum - right).abs() < 2e-3, "{radius} at {height}: {sum}, not {right}");
        assert!((rays - right).abs() < 1e-2, "{radius} at {height}: {rays} of the rays, not {right}");
    }
}

#[test]
fn sheets_behind_one_another_add_up_but_for_rays() {
    let sheet = |i: u8| disk_mesh(Vec3::Y * (0.5 + 1e-3 * f32::from(i)), 0.4);
    let [[one, by_rays], [three, three_by_rays]] =
        [1, 3].map(|count| hidden(&scene_of((0..count).map(sheet).collect()), 9.0));
    assert!((three / (3.0 * one) - 1.0).abs() < 0.01, "{three} of three, {one} of one");
    assert!((three_by_rays - by_rays).abs() < 2e-3, "{three_by_rays} of three, {by_rays} of one");
}

#[test]
fn a_closed_surface_hides_its_solid_angle_once() {
    // A sphere straight above hides (r / d)^2; with a hole at its top, its far half is seen from inside and
    // hides as much again.
    let mut sphere = sphere_mesh(Vec3::Y * 2.0, 0.5);
    let [sum, rays] = hidden(&scene_of(vec![sphere.clone()]), 9.0).map(|share| 16.0 * share);
    assert!((sum - 1.0).abs() < 0.01 && (rays - 1.0).abs() < 0.1, "{sum} and {rays} of what a sphere hides");
    sphere.triangles.remove(0);
    let [sum, rays] = hidden(&scene_of(vec![sphere]), 9.0).map(|share| 16.0 * share);
    assert!((sum - 2.0).abs() < 0.02 && (rays - 1.0).abs() < 0.1, "{sum} and {rays} with a hole");
}

#[test]
fn a_sheet_hides_as_much_seen_from_its_back() {
    let mut disk = disk_mesh(Vec3::Y, 0.7);
    let [front, _] = hidden(&scene_of(vec![disk.clone()]), 9.0);
    disk.triangles.iter_mut().for_each(|triangle| triangle.swap(0, 1));
    let [back, _] = hidden(&scene_of(vec![disk]), 9.0);
    assert!(front > 0.3 && (front - back).abs() < 1e-6, "{front} and {back}");
}

#[test]
fn compensation_leaves_little_alone_and_much_below_its_bound() {
    assert_eq!(compensated(0.0), 1.0);
    assert!((compensated(1e-2) - 0.99).abs() < 1e-4, "one of its own");
    let falls = (0..50).all(|i| compensated(0.1 * i as f32) > compensated(0.1 * (i + 1) as f32));
    assert!(falls && (compensated(1e3) - (1.0 - MOST_HIDDEN)).abs() < 1e-6);
}

#[test]
fn what_is_half_there_hides_half() {
    let whole = facets(&scene_of(vec![disk_mesh(Vec3::Y, 1.0)]), &camera());
    let half: Vec<Facet> = whole.iter().map(|facet| Facet { coverage: 0.5, ..*facet }).collect();
    let [whole, half] = [whole, half].map(|facets| occluded(&facets, Vec3::ZERO, Vec3::Y, 9.0));
    assert!(whole > 0.49 && (half / whole - 0.5).abs() < 1e-6, "{half} of {whole}");
}

/// A floor one metre below the camera.
fn floor() -> GBuffer {
    gbuffer_of(24, 32, |ray| plane(ray, -Vec3::Y, Vec3::Y).filter(|(at, _)| at.z > -12.0))
}

/// A scene's image above [`floor`].
fn above_floor(method: &ScreenMethod, scene: &Scene, radius: f32) -> Vec<f32> {
    let (gpu, gbuffer) = (method.gpu(), floor());
    let world = World::new(gpu, &scene.clone().into(), None).expect("a scene");
    let there = GpuGBuffer::upload(&gpu.device, &gbuffer, method.attributes()).expect("attributes");
    let inputs = Inputs { gbuffer: &there, environment: None, world: Some(&world) };
    let passes = MethodPasses::new(method, &inputs, &view(24, 32, radius)).expect("room");
    gpu::submit(&gpu.device, &gpu.queue, "test", |encoder| passes.encode(encoder)).expect("valid passes");
    gpu::read(&gpu.device, &gpu.queue, passes.output()).expect("an image")
}

fn volumes() -> ScreenMethod {
    ScreenMethod::new(&Gpu::new().expect("an adapter; lavapipe will do"), Volumes)
}

fn rays(quality: Quality) -> ScreenMethod {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    ScreenMethod::new(&gpu, AovBouncedZParameters::of(quality))
}

fn seen_on_floor(image: &[f32]) -> impl Iterator<Item = f32> {
    let valid = floor().select(&[Attribute::Valid]).expect("a mask");
    let all: Vec<(f32, f32)> = image.iter().copied().zip(valid.data().iter().copied()).collect();
    assert!(all.iter().filter(|(_, valid)| *valid < 0.5).all(|(value, _)| *value == 1.0), "background");
    all.into_iter().filter(|(_, valid)| *valid > 0.5).map(|(value, _)| value)
}

/// A triangle as large as the world, facing down.
fn huge_triangle(height: f32) -> Scene {
    let corners = [(-900.0, -900.0), (900.0, -900.0), (0.0, 1800.0)].map(|(x, z)| Vec3::new(x, height, z));
    let mesh = Mesh { positions: corners.to_vec(), triangles: vec![[0, 1, 2]], ..Mesh::default() };
    scene_of(vec![mesh])
}

/// A ceiling of 2 `n`^2 triangles, facing down.
fn fine_ceiling(n: u32, height: f32) -> Scene {
    let at = |i: u32| 40.0 * (i as f32 / n as f32 - 0.5);
    let positions =
        (0..(n + 1) * (n + 1)).map(|i| Vec3::new(at(i % (n + 1)), height, at(i / (n + 1)))).collect();
    let square = |i: u32| {
        let a = i / n * (n + 1) + i % n;
        [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]
    };
    scene_of(vec![Mesh { positions, triangles: (0..n * n).flat_map(square).collect(), ..Mesh::default() }])
}

#[test]
fn of_odd_scenes_images_are_defined() {
    let (volumes, rays) = (volumes(), rays(Quality::High));
    let nothing = Scene { materials: vec![Material::default()], ..Scene::default() };
    for (name, scene, radius) in [
        ("no triangle", nothing, 1.0),
        ("an effect that reaches nowhere", huge_triangle(-0.5), 0.0),
        ("nothing within reach", huge_triangle(30.0), 1.0),
        ("what is below the floor", huge_triangle(-1.5), 1.0),
    ] {
        for image in [above_floor(&volumes, &scene, radius), above_floor(&rays, &scene, radius)] {
            assert!(seen_on_floor(&image).all(|open| (open - 1.0).abs() < 1e-6), "{name}");
        }
    }
    // Half a metre above the floor everything is hidden but for that share of the hemisphere, squared. Of the
    // second one a pixel has twenty thousand triangles within reach.
    for (scene, radius) in [(huge_triangle(-0.5), 1.0), (fine_ceiling(400, -0.5), 6.0)] {
        let (sum, rays) = (above_floor(&volumes, &scene, radius), above_floor(&rays, &scene, radius));
        let open = (0.5 / radius).powi(2);
        let summed = compensated(1.0 - open);
        assert!(seen_on_floor(&sum).all(|found| (found - summed).abs() < 2e-3), "{summed}: {sum:?}");
        assert!(seen_on_floor(&rays).all(|found| (found - open).abs() < 0.1), "{open}: {rays:?}");
    }
}

/// Panes of a glass that hides nothing, one above the other, and an opaque ceiling over them.
fn panes_below_a_ceiling(count: u32) -> Scene {
    let glass = Material {
        base_colour: Vec4::new(1.0, 1.0, 1.0, 0.0),
        alpha: AlphaMode::Blend,
        ..Material::default()
    };
    let pane =
        |height: f32| [(-90.0, -90.0), (90.0, -90.0), (0.0, 180.0)].map(|(x, z)| Vec3::new(x, height, z));
    let positions = (0..count).flat_map(|i| pane(-0.9 + 0.3 * i as f32 / count as f32)).collect();
    let triangles = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let panes = Mesh { positions, triangles, material: MaterialId(1), ..Mesh::default() };
    let mut scene = huge_triangle(-0.5);
    scene.meshes = scene.meshes.iter().cloned().chain([panes]).collect();
    scene.materials.push(glass);
    scene
}

#[test]
fn rays_go_on_past_more_facets_than_loops_have_turns() {
    let open = above_floor(&rays(Quality::Low), &panes_below_a_ceiling(80_000), 1.0);
    assert!(seen_on_floor(&open).all(|found| (found - 0.25).abs() < 0.2), "{open:?}");
}

#[test]
fn the_passes_make_what_the_plain_version_does() {
    let method = volumes();
    for (family, [height, width]) in
        [(Family::StillLife, [21, 30]), (Family::Room, [24, 32]), (Family::Grove, [19, 27])]
    {
        prove_twin(&method, &seen(family, height, width), Tolerance { usual: 1e-3, worst: 0.05 });
    }
}

#[test]
fn the_rays_meet_what_those_of_the_plain_version_do() {
    let mut method = rays(Quality::High);
    let filter = blur::BlurParameters { radius: 2, sharpness: 512.0 };
    for (family, [height, width], directions) in
        [(Family::StillLife, [27, 35], 3), (Family::Room, [24, 32], 16), (Family::Grove, [21, 43], 1)]
    {
        method = method.with(AovBouncedZParameters { directions, filter });
        // A ray that just meets a triangle in one may just miss it in the other.
        prove_twin(&method, &seen(family, height, width), Tolerance { usual: 2e-3, worst: 0.1 });
    }
}

#[test]
fn rays_come_nearer_to_truth_than_sums() {
    let (scene, view, gbuffer) = seen(Family::Shelves, 48, 64);
    let frame =
        Frame { scene: &scene, camera: &view.camera, gbuffer: &gbuffer, radius: view.radius, seed: 3 };
    let shot = Shot::new(&scene, &view.camera, [48, 64], view.radius);
    let truth = path::render(Effect::Ao, &shot, Sampling { samples: 128, scramblings: 1, seed: 1 }).mean;
    let off = |image: &Planes| mean_difference(image, &truth);
    let white = Planes::filled(1, 48, 64, 1.0);
    let [sum, rays] = [&volumes() as &ScreenMethod, &rays(Quality::Ultra)]
        .map(|method| off(&Method::shade(method, &frame, Repeats::ONCE).expect("an image").image));
    assert!(rays < sum && sum < off(&white), "{rays} by rays, {sum} by sums, {} by nothing", off(&white));
}
