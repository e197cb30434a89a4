//! What devices cannot do: an error that names it, or a way around that is stated.

use super::*;
use crate::scene::{Encoding, Mesh, Texture, TextureId, TextureSlot, Wrap};
use glam::{Affine2, Vec2};
use std::time::{Duration, Instant};

/// A device of the fastest adapter with nothing but WebGPU's guaranteed limits.
fn least() -> Gpu {
    let gpu = Gpu::new().expect("an adapter");
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()));
    let descriptor =
        wgpu::DeviceDescriptor { required_limits: wgpu::Limits::default(), ..Default::default() };
    let device = pollster::block_on(adapter.expect("an adapter").request_device(&descriptor));
    let (device, queue) = device.expect("the limits that all adapters have");
    Gpu { device, queue, info: gpu.info }
}

fn settings(height: usize, width: usize) -> RasterSettings {
    RasterSettings {
        height,
        width,
        attributes: vec![Attribute::Light, Attribute::Diffuse, Attribute::Valid],
        shadow_size: Some(512),
    }
}

/// A floor with a lamp above.
fn floor() -> Scene {
    let mesh = Mesh {
        uvs: [vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y], Vec::new()],
        ..quad([(-2., 2.), (2., 2.), (2., -2.), (-2., -2.)].map(|(x, z)| Vec3::new(x, 0.0, z)))
    };
    let lamp = Light::Point { position: Vec3::Y, intensity: Vec3::ONE, range: f32::INFINITY };
    let materials = vec![Material { gloss: Gloss::None, ..Material::matte("", Vec3::splat(0.5)) }];
    Scene { meshes: vec![mesh].into(), materials, lights: vec![lamp], ..Scene::default() }
}

fn above() -> Camera {
    Camera::look_at(Vec3::new(0.3, 3.0, 0.2), Vec3::ZERO)
}

#[test]
fn where_no_light_is_asked_for_nothing_is_said_of_shadows() {
    let gpu = Gpu::new().expect("an adapter");
    let settings = RasterSettings { attributes: vec![Attribute::Valid], ..settings(8, 8) };
    let frame = Frame::new(&gpu, &floor().into(), &settings).expect("a frame");
    assert!(frame.world().notes.is_empty(), "{:?}", frame.world().notes);
}

/// The mean of red direct light.
fn brightness(gpu: &Gpu, scene: Scene) -> (f32, Vec<String>) {
    let mut frame = Frame::new(gpu, &scene.into(), &settings(33, 47)).expect("a frame");
    frame.set(&gpu.queue, 0.0, 0.0, &above());
    run(gpu, &frame);
    let light = read(gpu, &frame).select(&[Attribute::Light]).expect("light");
    (light.plane(0).iter().sum::<f32>() / light.pixels() as f32, frame.world().notes.clone())
}

#[test]
fn the_limits_that_every_device_has_are_enough() {
    let (least, most) = (least(), Gpu::new().expect("an adapter"));
    let [a, b] = [&least, &most].map(|gpu| brightness(gpu, floor()).0);
    assert!(a > 0.01 && a == b, "{a} and {b}");
}

#[test]
fn hundreds_of_lights_light_and_it_is_said_which_cast_no_shadow() {
    let gpu = Gpu::new().expect("an adapter");
    let (one, notes) = brightness(&gpu, floor());
    assert!(notes.is_empty(), "{notes:?}");
    let mut scene = floor();
    let lamp = Light::Point { position: Vec3::Y, intensity: Vec3::splat(0.005), range: f32::INFINITY };
    scene.lights = vec![lamp; 200];
    let (many, notes) = brightness(&gpu, scene);
    assert!((many / one - 1.0).abs() < 1e-3, "{many} of {one}");
    assert!(
        notes.iter().any(|note| note.starts_with("158 of the fainter lights cast no shadow")),
        "{notes:?}"
    );
}

#[test]
fn textures_beyond_the_limit_are_halved_and_it_is_said() {
    let gpu = Gpu::new().expect("an adapter");
    let mut scene = floor();
    let texels = (0..20_000).map(|i| if i % 2 == 0 { [0, 0, 0, 255] } else { [255; 4] }).collect();
    scene.textures = vec![Texture::new(20_000, 1, texels, Encoding::Linear, [Wrap::Repeat; 2]).into()];
    let slot = TextureSlot { texture: TextureId(0), uv_set: 0, transform: Affine2::IDENTITY };
    scene.materials[0].base_colour_texture = Some(slot);
    let (halved, notes) = brightness(&gpu, scene);
    let (plain, _) = brightness(&gpu, floor());
    assert!((halved / plain - 0.5).abs() < 0.01, "{halved} of {plain}");
    assert_eq!(notes, ["1 textures are larger than the device allows and were halved"]);
}

#[test]
fn sizes_that_cannot_be_are_errors() {
    let gpu = Gpu::new().expect("an adapter");
    for (height, width) in [(0, 16), (16, 0), (16, 100_000)] {
        let error = Frame::new(&gpu, &floor().into(), &settings(height, width)).expect_err("no such image");
        assert!(error.to_string().contains("deepshade.frame."), "{height} x {width}: {error}");
    }
    for (height, width) in [(1, 1), (7, 1), (17, 3)] {
        let mut frame = Frame::new(&gpu, &floor().into(), &settings(height, width)).expect("a frame");
        frame.set(&gpu.queue, 0.0, 0.0, &above());
        run(&gpu, &frame);
        let valid = read(&gpu, &frame).select(&[Attribute::Valid]).expect("a mask");
        assert!(valid.data().iter().all(|valid| *valid == 1.0), "{height} x {width}");
    }
}

#[test]
fn more_triangles_than_a_buffer_holds_are_an_error_that_names_it() {
    let gpu = least();
    // 6 million vertices of 64 bytes are more than the 256 MiB that every device has.
    let mut scene = floor();
    let vertices = 6_000_000;
    scene.meshes[0].positions.resize(vertices, Vec3::ONE);
    let error = Frame::new(&gpu, &scene.into(), &settings(8, 8)).expect_err("too large").to_string();
    assert!(error.contains("deepshade.frame.posed") && error.contains("384000000 bytes"), "{error}");
}

#[test]
fn more_corners_than_a_buffer_holds_are_an_error_that_names_it() {
    let mut scene = floor();
    scene.meshes[0].triangles.resize(23_000_000, [0, 1, 2]);
    let error = Frame::new(&least(), &scene.into(), &settings(8, 8)).expect_err("too large").to_string();
    assert!(error.contains("deepshade.frame.indices") && error.contains("276000000 bytes"), "{error}");
}

#[test]
fn what_is_bound_in_parts_may_be_larger_than_a_binding() {
    let device = least().device;
    // A binding holds 128 MiB, a buffer 256.
    let bytes = vec![0u8; 136 << 20];
    let usage = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::STORAGE;
    assert!(gpu::filled(&device, "test", &bytes, usage).is_ok());
    let whole = gpu::storage(&device, "test", &bytes).expect_err("too large").to_string();
    assert!(whole.contains("deepshade.test"), "{whole}");
}

#[test]
fn the_same_frame_has_the_same_bits() {
    let gpu = Gpu::new().expect("an adapter");
    let scene = rich(Family::StillLife);
    let camera = camera_in(&TracedScene::new(scene.clone()).expect("a scene"));
    let [a, b] = [(); 2].map(|()| rasterised(&gpu, &scene, &camera));
    let [a, b] = [&a, &b].map(|gbuffer| gbuffer.select(&Attribute::ALL).expect("all"));
    let bits = |planes: &Planes| planes.data().iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    assert!(bits(&a) == bits(&b), "two frames of the same moment differ");
    assert!(a.data().iter().any(|value| *value != 0.0));
}

/// A device with a frame to draw on it, of so many pixels an edge.
fn drawn(edge: usize) -> (Gpu, Frame) {
    let gpu = least();
    let mut frame = Frame::new(&gpu, &floor().into(), &settings(edge, edge)).expect("a frame");
    frame.set(&gpu.queue, 0.0, 0.0, &above());
    (gpu, frame)
}

/// Draws a frame and waits for it; `midway` is done when all of it is encoded, and `submitted` when the
/// device has it.
fn shown(
    gpu: &Gpu,
    frame: &Frame,
    midway: impl FnOnce(),
    submitted: impl FnOnce(),
) -> Result<Vec<f32>, gpu::GpuError> {
    gpu::submit(&gpu.device, &gpu.queue, "test", |encoder| {
        FrameStage::ALL.iter().for_each(|stage| frame.encode(*stage, encoder, None));
        midway();
    })?;
    submitted();
    gpu::read(&gpu.device, &gpu.queue, frame.gbuffer().buffer(Attribute::Valid))
}

/// An adapter cannot be taken away from outside of the program.
#[test]
fn a_device_that_is_lost_in_mid_frame_is_an_error_and_no_panic() {
    let (gpu, frame) = drawn(64);
    let whole = shown(&gpu, &frame, || (), || ()).expect("an image");
    assert!(whole.contains(&1.0), "nothing is seen");
    shown(&gpu, &frame, || gpu.device.destroy(), || ()).expect_err("lost with a frame that is encoded");
    assert!(Frame::new(&gpu, &floor().into(), &settings(8, 8)).is_err(), "it is gone for good");
    let (gpu, frame) = drawn(64);
    shown(&gpu, &frame, || (), || gpu.device.destroy()).expect_err("lost with a frame that is submitted");
}

#[test]
fn a_device_that_is_lost_while_frames_are_awaited_is_an_error_and_no_panic() {
    const PATIENCE: Duration = Duration::from_mins(1);
    for moment in [1, 5, 17, 50, 120].map(Duration::from_millis) {
        // So large that nearly all of the time is spent waiting for frames.
        let (gpu, frame) = drawn(384);
        let device = gpu.device.clone();
        let begin = Instant::now();
        let loss = std::thread::spawn(move || {
            std::thread::sleep(moment);
            device.destroy();
        });
        while shown(&gpu, &frame, || (), || ()).is_ok() {
            assert!(begin.elapsed() < PATIENCE, "frames come from a device that is lost");
        }
        assert!(begin.elapsed() >= moment, "an error before there was a reason");
        loss.join().expect("no panic there either");
    }
}
