//! How far surfaces move in the image from frame to frame, against projections.

use crate::build::{Builder, write};
use deepshade_render::raster::since::Since;
use deepshade_render::raster::{Frame, frame::FrameStage, frame::RasterSettings};
use deepshade_render::scene::{AnimatedScene, Camera, SceneSource};
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, Gpu};
use glam::{Vec2, Vec3};

const HEIGHT: usize = 60;
const WIDTH: usize = 84;

/// A plate at z = 0 that comes nearer and aside, in front of a wall at z = -3.
fn plate_and_wall() -> String {
    let mut builder = Builder::default();
    let square = |half: f32, z: f32| [-half, -half, z, half, -half, z, half, half, z, -half, half, z];
    let (plate, wall) =
        (builder.floats("VEC3", &square(0.8, 0.0)), builder.floats("VEC3", &square(9.0, -3.0)));
    let indices = builder.shorts("SCALAR", &[0, 1, 2, 0, 2, 3]);
    let times = builder.floats("SCALAR", &[0.0, 1.0]);
    let ways = builder.floats("VEC3", &[[0.0; 3], WAY].concat());
    builder.gltf(&format!(
        r#""nodes":[{{"mesh":0}},{{"mesh":1}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":{plate}}},"indices":{indices}}}]}},
            {{"primitives":[{{"attributes":{{"POSITION":{wall}}},"indices":{indices}}}]}}],
        "animations":[{{"channels":[{{"sampler":0,"target":{{"node":0,"path":"translation"}}}}],
        "samplers":[{{"input":{times},"output":{ways}}}]}}]"#
    ))
}

const WAY: [f32; 3] = [0.4, -0.2, 1.1];

/// Where a point is in the image, pixels, y up, and its depth.
fn projected(camera: &Camera, point: Vec3) -> (Vec2, f32) {
    let at = camera.rotation.transpose() * (point - camera.position);
    (Vec2::new(at.x, at.y) * (camera.focal_length(HEIGHT) / -at.z), -at.z)
}

#[test]
fn surfaces_moved_as_projections_of_both_frames_say() {
    let gpu = Gpu::new().expect("an adapter");
    let folder = tempfile::tempdir().expect("a temporary folder");
    write(folder.path(), "plate.gltf", plate_and_wall());
    let source = SceneSource::File(folder.path().join("plate.gltf"));
    let animated = AnimatedScene::load(&source, 0.0).expect("a file");
    let first = Camera::look_at(Vec3::new(0.4, 0.3, 5.0), Vec3::ZERO);
    let second = Camera::look_at(Vec3::new(-0.1, 0.5, 4.6), Vec3::new(0.2, 0.1, 0.0));
    for camera in [first, second] {
        let attributes = vec![Attribute::Valid];
        let settings = RasterSettings { height: HEIGHT, width: WIDTH, attributes, shadow_size: Some(256) };
        let mut frame = Frame::new(&gpu, &animated, &settings).expect("a frame");
        let since = Since::new(&gpu.device, &frame).expect("a pass");
        for (time, camera) in [(0.0, first), (1.0, camera)] {
            frame.set(&gpu.queue, time, 0.0, &camera);
            gpu::submit(&gpu.device, &gpu.queue, "test", |encoder| {
                FrameStage::ALL.iter().for_each(|stage| frame.encode(*stage, encoder, None));
                since.encode(encoder, None);
            })
            .expect("valid passes");
        }
        let planes: Vec<f32> = gpu::read(&gpu.device, &gpu.queue, since.planes()).expect("planes");
        let mut seen = [0, 0];
        for pixel in 0..HEIGHT * WIDTH {
            let [x, y, depth, depth_then] =
                std::array::from_fn(|plane| planes[plane * HEIGHT * WIDTH + pixel]);
            let at = Vec2::new((pixel % WIDTH) as f32 + 0.5, (pixel / WIDTH) as f32 + 0.5);
            let along = camera.direction(at, HEIGHT, WIDTH);
            let point = camera.position + along * (depth / -camera.direction_to_camera(along).z);
            let on_plate = point.z > -1.0;
            assert!((point.z - if on_plate { WAY[2] } else { -3.0 }).abs() < 1e-3, "{point}");
            let way = if on_plate { Vec3::from(WAY) } else { Vec3::ZERO };
            let (now, _) = projected(&camera, point);
            let (was, wanted) = projected(&first, point - way);
            // Ways are known to a 256th: here 4 mm, which are a tenth of a pixel.
            let off = (now - was - Vec2::new(x, y)).length();
            assert!(off < if on_plate { 0.1 } else { 0.01 }, "{point}: {off} pixels");
            assert!((depth_then / wanted - 1.0).abs() < 2e-3, "{point}: {depth_then} m, not {wanted}");
            seen[usize::from(on_plate)] += 1;
        }
        assert!(seen.iter().all(|pixels| *pixels > 200), "{seen:?}");
    }
}
