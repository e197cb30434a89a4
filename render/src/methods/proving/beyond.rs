//! Scenes for methods that look beyond the screen, and the comparison of what their passes make of one with
//! their plain version.

use super::{Tolerance, agree, prove_comparator, view};
use crate::bvh::TracedScene;
use crate::gbuffer;
use crate::method::{Frame, Repeats};
use crate::methods::lobe;
use crate::scene::medium::Weather;
use crate::scene::procedural::Family;
use crate::scene::{Bounds, Camera, Density, Light, Material, Medium, Mesh, Scene};
use crate::screen::{self, GpuGBuffer, Inputs, MethodPasses, PlainInputs, ScreenMethod, View};
use crate::surfels::Surfel;
use crate::surfels::reference::Disk;
use deepshade_shaders::gpu::{self, Gpu};
use deepshade_shaders::{Attribute, GBuffer, Planes};
use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// A regular polygon with many corners around a point, facing down.
pub fn disk_mesh(middle: Vec3, radius: f32) -> Mesh {
    let corners = 128u32;
    let corner = |i: u32| {
        let (sin, cos) = (i as f32 / corners as f32 * TAU).sin_cos();
        middle + radius * Vec3::new(cos, 0.0, sin)
    };
    let positions = [middle].into_iter().chain((0..corners).map(corner)).collect();
    Mesh {
        positions,
        triangles: (0..corners).map(|i| [0, 1 + i, 1 + (i + 1) % corners]).collect(),
        ..Mesh::default()
    }
}

/// A sphere, facing outwards.
pub fn sphere_mesh(middle: Vec3, radius: f32) -> Mesh {
    let (rings, segments) = (48u32, 96u32);
    let at = |ring: u32, segment: u32| {
        let (sin, cos) = (ring as f32 / rings as f32 * PI).sin_cos();
        // All corners of a pole are one place.
        let sin = if ring == rings { 0.0 } else { sin };
        let (s, c) = (segment as f32 / segments as f32 * TAU).sin_cos();
        middle + radius * Vec3::new(sin * c, cos, sin * s)
    };
    let positions =
        (0..=rings).flat_map(|ring| (0..segments).map(move |segment| at(ring, segment))).collect();
    let quad = |i: u32| {
        let (ring, segment) = (i / segments, i % segments);
        let [a, b] = [segment, (segment + 1) % segments].map(|segment| ring * segments + segment);
        [[a, b, a + segments], [b, b + segments, a + segments]]
    };
    let mut mesh =
        Mesh { positions, triangles: (0..rings * segments).flat_map(quad).collect(), ..Mesh::default() };
    mesh.drop_degenerate_triangles();
    mesh
}

pub fn scene_of(meshes: Vec<Mesh>) -> Scene {
    Scene { meshes: meshes.into(), materials: vec![Material::default()], ..Scene::default() }
}

/// A white floor and a white wall at x = 1 that faces it, lit from the left, seen from above.
pub fn corner() -> (TracedScene, View, GBuffer) {
    let square = |corners: [[f32; 3]; 4]| Mesh {
        positions: corners.map(Vec3::from_array).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    let floor = square([[-4., 0., 4.], [1., 0., 4.], [1., 0., -4.], [-4., 0., -4.]]);
    let wall = square([[1., 0., 4.], [1., 2., 4.], [1., 2., -4.], [1., 0., -4.]]);
    let light =
        Light::Directional { direction: Vec3::X, irradiance: Vec3::new(2.0, 1.0, 0.5) * PI, pattern: None };
    let scene = Scene { lights: vec![light], ..scene_of(vec![floor, wall]) };
    let scene = TracedScene::new(scene).expect("two squares");
    let camera = Camera::look_at(Vec3::new(-1.0, 2.5, 1.5), Vec3::new(0.0, 0.0, 0.0));
    let view = View { camera, radius: 20.0, ..view(48, 64, 1.0) };
    let gbuffer = gbuffer::render(&scene, &camera, 48, 64, ATTRIBUTES);
    (scene, view, gbuffer)
}

/// The lit corner with a wall of half its height in the light, in coloured fog and in smoke, with a sun, a
/// lamp and a spot.
pub fn foggy() -> Vec<(TracedScene, View, GBuffer)> {
    let (corner, view, _) = corner();
    let bounds = Bounds { min: Vec3::new(-4.0, 0.0, -4.0), max: Vec3::new(1.0, 2.0, 4.0) };
    let (absorption, scattering) = (Vec3::new(0.02, 0.05, 0.1), Vec3::new(0.3, 0.2, 0.25));
    let grid = Weather::smoke(2, 1.5, 0.8).grid(bounds, 16, 0.0).expect("smoke");
    let lamp = Light::Point {
        position: Vec3::new(-1.2, 1.1, -0.5),
        intensity: Vec3::new(0.3, 0.6, 0.2),
        range: 6.0,
    };
    let spot = Light::Spot {
        position: Vec3::new(-2.5, 1.9, 0.7),
        direction: Vec3::new(1.0, -0.9, -0.2).normalize(),
        intensity: Vec3::new(3.0, 2.0, 4.0),
        range: f32::INFINITY,
        cos_inner: 0.97,
        cos_outer: 0.9,
        slide: None,
    };
    let screen = [[-2., 0., 2.], [-2., 1., 2.], [-2., 1., -1.], [-2., 0., -1.]].map(Vec3::from_array);
    let screen =
        Mesh { positions: screen.to_vec(), triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() };
    let filled = |density: Density| {
        let medium = Medium::new(absorption, scattering, 0.4, density).expect("a medium");
        let mut scene = Scene { medium: Some(medium.into()), ..corner.scene().clone() };
        scene.lights.extend([lamp, spot]);
        scene.meshes = scene.meshes.iter().cloned().chain([screen.clone()]).collect::<Vec<_>>().into();
        let scene = TracedScene::new(scene).expect("triangles");
        let gbuffer = gbuffer::render(&scene, &view.camera, view.height, view.width, ATTRIBUTES);
        (scene, view, gbuffer)
    };
    [Density::Within(bounds), Density::Grid(grid)].map(filled).into()
}

/// A procedural scene, from where it is seen, and its g-buffer.
pub fn seen(family: Family, height: usize, width: usize) -> (TracedScene, View, GBuffer) {
    let scene = TracedScene::new(family.scene(4)).expect("a scene");
    let bounds = scene.scene().bounds();
    let eye = bounds.centre() + 0.3 * bounds.size();
    let camera = Camera::look_at(eye, bounds.centre());
    let gbuffer = gbuffer::render(&scene, &camera, height, width, ATTRIBUTES);
    let view = View { camera, radius: 0.1 * bounds.diagonal(), ..view(height, width, 1.0) };
    (scene, view, gbuffer)
}

/// What methods that look beyond the screen read of a g-buffer, glossy receivers all of it.
pub const ATTRIBUTES: &[Attribute] = lobe::ATTRIBUTES;

/// A method's image, the same for the same frame twice, and the surfels that its passes have laid out for it.
/// What the plain version of shading makes of these it makes on every device, however that rounds where it
/// lays them out.
pub fn shaded_by_surfels(
    method: &ScreenMethod,
    (scene, view, gbuffer): &(TracedScene, View, GBuffer),
) -> (Planes, Vec<Disk>) {
    let Gpu { device, queue, .. } = method.gpu();
    let there = GpuGBuffer::upload(device, gbuffer, method.attributes()).expect("attributes");
    let world = screen::world(method.gpu(), scene.scene(), view).expect("room");
    let inputs = Inputs { gbuffer: &there, environment: None, world: Some(&world) };
    let passes = MethodPasses::new(method, &inputs, view).expect("room");
    let shaded = || -> Vec<f32> {
        gpu::submit(device, queue, "test", |encoder| passes.encode(encoder)).expect("valid passes");
        gpu::read(device, queue, passes.output()).expect("an image")
    };
    let image = shaded();
    assert_eq!(image, shaded(), "the same frame twice");
    let written = |label: &str| {
        let step = passes.steps().iter().find(|step| step.step.pass.is_of(label)).expect("a pass");
        step.writes.last().expect("a buffer")
    };
    let totals: Vec<u32> = gpu::read(device, queue, written("surfels.total")).expect("totals");
    let surfels: Vec<Surfel> = gpu::read(device, queue, written("surfels.place")).expect("surfels");
    let image = Planes::from_data(method.effect().channels(), view.height, view.width, image);
    (image, surfels.into_iter().take(totals[0] as usize).map(Disk::from).collect())
}

/// Proves that a method's passes make what its plain version does, and the same of the same frame twice.
pub fn prove_twin(
    method: &ScreenMethod,
    (scene, view, gbuffer): &(TracedScene, View, GBuffer),
    tolerance: Tolerance,
) {
    let frame = Frame { scene, camera: &view.camera, gbuffer, radius: view.radius, seed: view.seed };
    let [image, again] =
        [0, 1].map(|_| method.shade_in_passes(&frame, Repeats::ONCE).expect("an image").image);
    assert_eq!(image.data(), again.data(), "the same frame twice");
    let inputs =
        PlainInputs { gbuffer, environment: scene.scene().environment.as_deref(), scene: Some(scene) };
    let right = method.reference(&inputs, view).expect("attributes").pop().expect("an image");
    let right = Planes::from_data(image.channels(), view.height, view.width, right);
    assert_eq!(agree(&image, &right, tolerance), Ok(()));
    prove_comparator(&right, tolerance);
}
