//! A program of its own, since it watches its memory: scenes with millions of triangles have images, or are
//! refused in words.
#![cfg(target_os = "linux")]

use deepshade_render::methods::disks::Disks;
use deepshade_render::methods::{Quality, aov, surfel};
use deepshade_render::raster::World;
use deepshade_render::scene::{Camera, Material, Mesh, Scene};
use deepshade_render::screen::{GpuGBuffer, Inputs, MethodPasses, ScreenMethod, View};
use deepshade_shaders::gpu::{self, Gpu, GpuError};
use deepshade_shaders::{Attribute, GBuffer, Planes};
use glam::{Mat3, Vec2, Vec3};
use std::time::Instant;

const ATTRIBUTES: [Attribute; 3] = [Attribute::Position, Attribute::Normal, Attribute::Valid];
const HEIGHT: usize = 24;
const WIDTH: usize = 32;

/// Most memory that this program had at once, megabytes.
fn most_memory() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("Linux tells");
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).expect("resident memory");
    line.trim().trim_end_matches("kB").trim().parse::<f64>().expect("a number") / 1024.0
}

/// A ceiling of 2 `n`^2 triangles that faces down, 40 m to a side, half a metre below the camera.
fn ceiling(n: u32) -> Scene {
    let at = |i: u32| 40.0 * (i as f32 / n as f32 - 0.5);
    let row = n + 1;
    let positions = (0..row * row).map(|i| Vec3::new(at(i % row), -0.5, at(i / row))).collect();
    let square = |i: u32| {
        let a = i / n * row + i % n;
        [[a, a + 1, a + row + 1], [a, a + row + 1, a + row]]
    };
    let triangles = (0..n * n).flat_map(square).collect();
    let mesh = Mesh { positions, triangles, ..Mesh::default() };
    Scene { meshes: vec![mesh].into(), materials: vec![Material::default()], ..Scene::default() }
}

fn view() -> View {
    let camera = Camera {
        position: Vec3::ZERO,
        rotation: Mat3::IDENTITY,
        vertical_fov: 50f32.to_radians(),
        lens: None,
    };
    View { height: HEIGHT, width: WIDTH, camera, radius: 1.0, seed: 1 }
}

/// A floor one metre below the camera, up to twelve metres away.
fn floor() -> GBuffer {
    let at = |x: usize, y: usize| {
        let ray = view().camera.direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5), HEIGHT, WIDTH);
        let place = ray / -ray.y;
        if ray.y < 0.0 && place.z > -12.0 { [place.x, -1.0, place.z, 0.0, 1.0, 0.0, 1.0] } else { [0.0; 7] }
    };
    GBuffer::new(ATTRIBUTES.to_vec(), Planes::from_fn(7, HEIGHT, WIDTH, |c, y, x| at(x, y)[c]))
}

/// What of the floor is open, where it is seen.
fn image(gpu: &Gpu, world: &World, method: &ScreenMethod) -> Result<Vec<f32>, GpuError> {
    let gbuffer = floor();
    let there = GpuGBuffer::upload(&gpu.device, &gbuffer, &ATTRIBUTES).expect("attributes");
    let inputs = Inputs { gbuffer: &there, environment: None, world: Some(world) };
    let passes = MethodPasses::new(method, &inputs, &view())?;
    gpu::submit(&gpu.device, &gpu.queue, "test", |encoder| passes.encode(encoder))?;
    let image: Vec<f32> = gpu::read(&gpu.device, &gpu.queue, passes.output())?;
    let valid = gbuffer.select(&[Attribute::Valid]).expect("a mask");
    Ok(image.into_iter().zip(valid.data()).filter(|(_, valid)| **valid > 0.5).map(|(open, _)| open).collect())
}

/// Half a metre below a ceiling three quarters of what is within a metre are hidden.
const HIDDEN: f32 = 0.75;

fn mean_openness(gpu: &Gpu, world: &World, method: &ScreenMethod) -> Result<f32, GpuError> {
    let image = image(gpu, world, method)?;
    assert!(image.len() > 200, "{} pixels", image.len());
    Ok(image.iter().sum::<f32>() / image.len() as f32)
}

#[test]
fn five_million_triangles_occlude_as_few_do() {
    let gpu = Gpu::new().expect("an adapter");
    let surfels = ScreenMethod::new(
        &gpu,
        Disks::new(surfel::SurfelParameters::of(Quality::Ultra), surfel::occlusion::OCCLUSION),
    );
    let volumes = ScreenMethod::new(&gpu, aov::Volumes);
    let few = World::new(&gpu, &ceiling(40).into(), None).expect("room");
    let of_few = mean_openness(&gpu, &few, &surfels).expect("an image");
    // A pixel that noise takes below 0 is black: the mean is a little above what is right.
    assert!((of_few - (1.0 - HIDDEN)).abs() < 0.04, "{of_few}");
    let scene = ceiling(1582);
    assert!(scene.triangle_count() > 5_000_000);
    let start = Instant::now();
    let many = World::new(&gpu, &scene.into(), None).expect("room");
    let of_many = mean_openness(&gpu, &many, &surfels).expect("an image");
    assert!((of_many - of_few).abs() < 0.02, "{of_many} of many, {of_few} of few");
    println!("surfels of 5 million triangles: {:?}, {} MB at most", start.elapsed(), most_memory());
    let offered = gpu.device.limits().max_storage_buffer_binding_size;
    match mean_openness(&gpu, &many, &volumes) {
        Ok(open) => assert!((open - aov::reference::compensated(HIDDEN)).abs() < 0.01, "{open}"),
        Err(error) => {
            let needed = 40 * 5_005_448;
            let named =
                format!("buffer `deepshade.aov.facets` of {needed} bytes; the device allows {offered}");
            assert_eq!(error.to_string(), named);
        }
    }
    assert!(most_memory() < 4000.0, "{} MB", most_memory());
}
