//! Rasterised g-buffers against those of rays, and reflective maps against closed forms.

use super::frame::{Frame, FrameStage, RasterSettings};
use crate::bvh::TracedScene;
use crate::gbuffer;
use crate::path::proving::quad;
use crate::scene::procedural::Family;
use crate::scene::{AnimatedScene, Camera, Gloss, Lens, Light, Material, Scene};
use deepshade_shaders::gpu::{self, Gpu};
use deepshade_shaders::{Attribute, GBuffer, Planes};
use glam::Vec3;
use std::f32::consts::PI;

mod limits;
mod materials;
mod pictures;
mod shadows;

const HEIGHT: usize = 96;
const WIDTH: usize = 131;

/// All stages once.
fn run(gpu: &Gpu, frame: &Frame) {
    gpu::submit(&gpu.device, &gpu.queue, "test", |encoder| {
        FrameStage::ALL.iter().for_each(|stage| frame.encode(*stage, encoder, None));
    })
    .expect("valid passes");
}

fn read(gpu: &Gpu, frame: &Frame) -> GBuffer {
    let gbuffer = frame.gbuffer();
    let attributes: Vec<Attribute> = gbuffer.attributes().collect();
    let planes = attributes.iter().flat_map(|attribute| {
        gpu::read::<f32>(&gpu.device, &gpu.queue, gbuffer.buffer(*attribute)).expect("planes")
    });
    let channels = attributes.iter().map(|attribute| attribute.width()).sum();
    let planes = Planes::from_data(channels, gbuffer.height(), gbuffer.width(), planes.collect());
    GBuffer::new(attributes, planes)
}

fn rasterised(gpu: &Gpu, scene: &Scene, camera: &Camera) -> GBuffer {
    let settings = RasterSettings {
        height: HEIGHT,
        width: WIDTH,
        attributes: Attribute::ALL.to_vec(),
        shadow_size: Some(1024),
    };
    let mut frame = Frame::new(gpu, &scene.clone().into(), &settings).expect("a frame");
    frame.set(&gpu.queue, 0.0, 0.0, camera);
    run(gpu, &frame);
    read(gpu, &frame)
}

/// A family's scene with a lamp, a spot and a sun, with materials of every kind, and with meshes on their
/// way.
fn rich(family: Family) -> Scene {
    let mut scene = family.scene(3);
    let bounds = scene.bounds();
    let power = Vec3::new(1.0, 0.8, 0.6) * bounds.diagonal() * bounds.diagonal();
    let lamp = bounds.centre() + bounds.size() * Vec3::new(0.1, 0.3, -0.15);
    let spot = bounds.centre() + bounds.size() * Vec3::new(-0.2, 0.35, 0.2);
    let sun = Vec3::new(0.4, -1.0, 0.3).normalize();
    scene.lights = vec![
        Light::Point { position: lamp, intensity: 0.3 * power, range: bounds.diagonal() },
        Light::Spot {
            position: spot,
            direction: (bounds.centre() - spot).normalize(),
            intensity: power,
            range: f32::INFINITY,
            cos_inner: 0.95,
            cos_outer: 0.8,
            slide: None,
        },
        Light::Directional { direction: sun, irradiance: Vec3::splat(2.0), pattern: None },
    ];
    for (index, material) in scene.materials.iter_mut().enumerate() {
        match index % 3 {
            0 => material.emission = Vec3::new(0.2, 3.0, 0.01) * (index + 1) as f32,
            1 => material.mean_free_path = Vec3::new(0.03, 0.02, 0.01),
            _ => (material.gloss, material.specular) = (Gloss::Phong, Some(Vec3::new(0.1, 0.2, 0.7))),
        }
    }
    for (index, mesh) in scene.meshes.iter_mut().enumerate() {
        let way = Vec3::new(0.02, 0.01, 0.03) * (index % 5) as f32;
        mesh.displacements = vec![way; mesh.positions.len()];
    }
    scene
}

fn camera_in(scene: &TracedScene) -> Camera {
    let bounds = scene.bounds();
    let eye = bounds.centre() + bounds.size() * Vec3::new(0.31, 0.2, 0.37);
    let lens = Lens::new(0.01 * scene.diagonal(), 0.3 * scene.diagonal()).expect("a lens");
    Camera { lens: Some(lens), ..Camera::look_at(eye, bounds.centre()) }
}

/// The share of pixels at which an attribute differs by more than `tolerance`, relative to the larger of
/// both, which counts as 0.01 at least.
fn share_outside(a: &GBuffer, b: &GBuffer, attribute: Attribute, tolerance: f32) -> f32 {
    let [a, b] = [a, b].map(|gbuffer| gbuffer.select(&[attribute]).expect("rendered"));
    let value = |planes: &Planes, pixel: usize| {
        let component = |c| if c < planes.channels() { planes.plane(c)[pixel] } else { 0.0 };
        Vec3::from_array(std::array::from_fn(component))
    };
    let differs = |pixel: &usize| {
        let [a, b] = [value(&a, *pixel), value(&b, *pixel)];
        let close = (a - b).length() <= tolerance * a.length().max(b.length()).max(0.01);
        !close
    };
    (0..a.pixels()).filter(differs).count() as f32 / a.pixels() as f32
}

/// How far an attribute may be off, and at which share of the pixels by more: those whose middle an edge
/// passes within what rasterisers round positions to (1/256 of a pixel).
const fn agreement(attribute: Attribute) -> (f32, f32) {
    match attribute {
        // The GPU reads textures with eight bits between texels, and words hold 16.
        Attribute::Diffuse | Attribute::Specular | Attribute::Emission => (0.01, 0.004),
        Attribute::Normal | Attribute::WorldNormal | Attribute::Glossiness | Attribute::Motion => {
            (0.01, 0.004)
        }
        // Differences to the distance in focus, and so nearly 0 close to it: 0.0065 and 0.0059 on an H100.
        Attribute::FocalDistance | Attribute::Blurriness | Attribute::CircleOfConfusion => (2e-3, 0.008),
        _ => (2e-3, 0.004),
    }
}

#[test]
fn rasterised_and_traced_gbuffers_agree_but_for_edges() {
    let gpu = Gpu::new().expect("an adapter");
    let mut told_apart = 0;
    for family in [Family::Room, Family::Grove, Family::StillLife] {
        let scene = rich(family);
        let traced = TracedScene::new(scene.clone()).expect("a scene");
        let camera = camera_in(&traced);
        let found = rasterised(&gpu, &scene, &camera);
        let expected = gbuffer::render(&traced, &camera, HEIGHT, WIDTH, &Attribute::ALL);
        let turned = Camera { vertical_fov: 1.03 * camera.vertical_fov, ..camera };
        let other = gbuffer::render(&traced, &turned, HEIGHT, WIDTH, &Attribute::ALL);
        // Light has tests of its own, since its shadows have edges.
        let is_light =
            |attribute: &Attribute| matches!(attribute, Attribute::Light | Attribute::DiffuseLight);
        for attribute in Attribute::ALL.into_iter().filter(|attribute| !is_light(attribute)) {
            let (tolerance, share) = agreement(attribute);
            let outside = share_outside(&found, &expected, attribute, tolerance);
            assert!(outside <= share, "{family:?}, {}: {outside} of the pixels differ", attribute.name());
            // What is alike all over the image another camera sees too.
            let varies = share_outside(&expected, &other, attribute, tolerance) > 2.0 * share;
            let wrong = share_outside(&found, &other, attribute, tolerance);
            assert!(
                !varies || wrong > share,
                "{family:?}, {}: {wrong} with another camera",
                attribute.name()
            );
            told_apart += usize::from(varies);
        }
        let moving = expected.select(&[Attribute::Motion]).expect("rendered");
        let moves = moving.plane(1).iter().filter(|length| **length > 0.05).count();
        assert!(moves > moving.pixels() / 10, "{family:?}: {moves} pixels move");
    }
    assert!(told_apart > 30, "{told_apart} of 48 images tell one camera from another");
}

/// A box around a lamp, seen from inside.
fn lamp_in_a_box(light: Light) -> AnimatedScene {
    let side = |a: Vec3, b: Vec3, c: Vec3| quad([c - a - b, c + a - b, c + a + b, c - a + b]);
    let (x, y, z) = (2.0 * Vec3::X, 3.0 * Vec3::Y, 2.5 * Vec3::Z);
    let meshes =
        vec![side(x, y, z), side(x, y, -z), side(y, z, x), side(y, z, -x), side(z, x, y), side(z, x, -y)];
    let materials = vec![Material { gloss: Gloss::None, ..Material::matte("", Vec3::new(0.5, 0.25, 1.0)) }];
    Scene { meshes: meshes.into(), materials, lights: vec![light], ..Scene::default() }.into()
}

/// The flux of all of a light's reflective maps, and how many texels meet a surface.
fn flux(light: Light, size: usize) -> (Vec3, usize) {
    let gpu = Gpu::new().expect("an adapter");
    let animated = lamp_in_a_box(light);
    let settings =
        RasterSettings { height: 8, width: 8, attributes: vec![Attribute::Valid], shadow_size: Some(256) };
    let mut frame = Frame::new(&gpu, &animated, &settings).expect("a frame");
    let camera = Camera::look_at(Vec3::ZERO, Vec3::X);
    frame.set(&gpu.queue, 0.0, 0.0, &camera);
    let map = frame.reflective_map(&gpu, 0, size).expect("a map");
    let (mut sum, mut met) = (Vec3::ZERO, 0);
    for view in frame.world().light_views(0, size) {
        map.set(&gpu.queue, &view);
        gpu::submit(&gpu.device, &gpu.queue, "test", |encoder| frame.encode_reflective(&map, encoder))
            .expect("valid passes");
        let texels: Vec<f32> = gpu::read(&gpu.device, &gpu.queue, &map.texels).expect("texels");
        let plane = |c: usize| &texels[c * size * size..][..size * size];
        sum += Vec3::new(plane(6).iter().sum(), plane(7).iter().sum(), plane(8).iter().sum());
        for pixel in 0..size * size {
            let normal = Vec3::new(plane(3)[pixel], plane(4)[pixel], plane(5)[pixel]);
            if normal == Vec3::ZERO {
                continue;
            }
            met += 1;
            let position = Vec3::new(plane(0)[pixel], plane(1)[pixel], plane(2)[pixel]);
            let on_wall = (position / Vec3::new(2.0, 3.0, 2.5)).abs().max_element();
            assert!((on_wall - 1.0).abs() < 1e-3, "{position} is on no wall");
            assert!(normal.dot(position) < 0.0, "the wall at {position} faces {normal}");
        }
    }
    (sum, met)
}

#[test]
fn reflective_maps_hold_all_of_a_lamp_s_power() {
    let intensity = Vec3::new(3.0, 2.0, 1.0);
    let lamp = Light::Point { position: Vec3::new(0.3, -0.2, 0.1), intensity, range: f32::INFINITY };
    let (sum, met) = flux(lamp, 128);
    // Maps of a cube's faces overlap by the texels for the filter.
    let expected = 4.0 * PI * intensity * Vec3::new(0.5, 0.25, 1.0);
    let overlap = (1.0f32 + 4.0 / 128.0).powi(2);
    assert!(met == 6 * 128 * 128);
    let share = sum / expected;
    assert!((share - share.x).abs().max_element() < 1e-3, "{share}");
    assert!(share.x > 1.0 && share.x < overlap + 0.01, "{share}");
}

#[test]
fn reflective_maps_of_a_spot_hold_its_cone() {
    let cos_outer = 0.8f32;
    let spot = Light::Spot {
        position: Vec3::ZERO,
        direction: Vec3::new(0.6, 0.8, 0.0),
        intensity: Vec3::ONE,
        range: f32::INFINITY,
        cos_inner: cos_outer + 1e-4,
        cos_outer,
        slide: None,
    };
    let (sum, _) = flux(spot, 256);
    let expected = 2.0 * PI * (1.0 - cos_outer) * Vec3::new(0.5, 0.25, 1.0);
    assert!((sum / expected - 1.0).abs().max_element() < 5e-3, "{sum} is not {expected}");
}
