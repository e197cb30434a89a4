//! Light on the GPU in files whose lights and objects move, against rays in the file at that moment.

use crate::build::{Builder, write};
use deepshade_render::bvh::TracedScene;
use deepshade_render::gbuffer;
use deepshade_render::raster::{Frame, frame::FrameStage, frame::RasterSettings};
use deepshade_render::scene::{AnimatedScene, Camera, Scene, SceneSource};
use deepshade_shaders::gpu::{self, Gpu};
use deepshade_shaders::{Attribute, Planes};
use glam::{Quat, Vec3};
use std::path::Path;

const SIZE: usize = 64;

/// A floor, a plate that rises from just above it to 4 m, and a light whose node turns from straight down to
/// aside and goes from one end of the floor to the other.
fn stage(light: &str) -> String {
    let mut builder = Builder::default();
    let square = |half: f32| [-half, 0.0, half, half, 0.0, half, half, 0.0, -half, -half, 0.0, -half];
    let floor = builder.floats("VEC3", &square(3.0));
    let plate = builder.floats("VEC3", &square(0.7));
    let indices = builder.shorts("SCALAR", &[0, 1, 2, 0, 2, 3]);
    let times = builder.floats("SCALAR", &[0.0, 1.0]);
    let rises = builder.floats("VEC3", &[0.0, 0.05, 0.0, 0.3, 4.0, 0.2]);
    let walks = builder.floats("VEC3", &[-2.0, 6.0, 0.0, 2.0, 6.5, 0.5]);
    let turned = |degrees: f32| Quat::from_rotation_x(degrees.to_radians()).to_array();
    let turns = builder.floats("VEC4", &[turned(-90.0), turned(-80.0)].concat());
    builder.gltf(&format!(
        r#""extensionsUsed":["KHR_lights_punctual"],
        "extensions":{{"KHR_lights_punctual":{{"lights":[{light}]}}}},
        "nodes":[{{"mesh":0}},{{"mesh":1}},{{"extensions":{{"KHR_lights_punctual":{{"light":0}}}}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":{floor}}},"indices":{indices},"material":0}}]}},
            {{"primitives":[{{"attributes":{{"POSITION":{plate}}},"indices":{indices},"material":0}}]}}],
        "materials":[{{"pbrMetallicRoughness":{{"metallicFactor":0}}}}],
        "animations":[{{"channels":[{{"sampler":0,"target":{{"node":1,"path":"translation"}}}},
            {{"sampler":1,"target":{{"node":2,"path":"translation"}}}},
            {{"sampler":2,"target":{{"node":2,"path":"rotation"}}}}],
        "samplers":[{{"input":{times},"output":{rises}}},{{"input":{times},"output":{walks}}},
            {{"input":{times},"output":{turns}}}]}}]"#
    ))
}

/// From below the plate, so that its shadow is in sight.
fn camera() -> Camera {
    Camera::look_at(Vec3::new(0.5, 2.5, 5.0), Vec3::ZERO)
}

fn traced(path: &Path, time: f32) -> Planes {
    let scene = TracedScene::new(Scene::load(path, time).expect("the file")).expect("a scene");
    gbuffer::render(&scene, &camera(), SIZE, SIZE, &[Attribute::DiffuseLight])
        .select(&[Attribute::DiffuseLight])
        .expect("light")
}

/// The share of pixels whose red light differs by more than a twentieth.
fn off(a: &Planes, b: &Planes) -> f32 {
    let differs = |(a, b): &(&f32, &f32)| (*a - *b).abs() > 0.05 * a.max(**b).max(1e-3);
    a.plane(0).iter().zip(b.plane(0)).filter(differs).count() as f32 / (SIZE * SIZE) as f32
}

#[test]
fn lights_and_what_throws_shadows_move_with_their_nodes() {
    let gpu = Gpu::new().expect("an adapter");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("stage.gltf");
    for light in [
        r#"{"type":"directional","intensity":3}"#,
        r#"{"type":"point","intensity":40}"#,
        r#"{"type":"spot","intensity":60,"spot":{"innerConeAngle":0.3,"outerConeAngle":0.8}}"#,
    ] {
        write(folder.path(), "stage.gltf", stage(light));
        let animated = AnimatedScene::load(&SceneSource::File(path.clone()), 0.0).expect("a file");
        let attributes = vec![Attribute::Light, Attribute::DiffuseLight];
        let settings = RasterSettings { height: SIZE, width: SIZE, attributes, shadow_size: Some(1024) };
        let mut frame = Frame::new(&gpu, &animated, &settings).expect("a frame");
        for time in [0.0, 0.5, 1.0] {
            frame.set(&gpu.queue, time, 0.0, &camera());
            gpu::submit(&gpu.device, &gpu.queue, "test", |encoder| {
                FrameStage::ALL.iter().for_each(|stage| frame.encode(*stage, encoder, None));
            })
            .expect("valid passes");
            let found = frame.gbuffer().buffer(Attribute::DiffuseLight);
            let found = gpu::read(&gpu.device, &gpu.queue, found).expect("light");
            let found = Planes::from_data(3, SIZE, SIZE, found);
            let (right, wrong) = (
                off(&found, &traced(&path, time)),
                off(&found, &traced(&path, if time < 0.5 { 1.0 } else { 0.0 })),
            );
            assert!(right < 0.02, "{light} at {time} s: {right}");
            assert!(wrong > 0.025, "{light} at {time} s: {wrong} at another time");
        }
    }
}
