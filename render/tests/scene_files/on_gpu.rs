//! Vertices posed on the GPU against files read at that moment.

use crate::build::{ONE_MESH, triangle, write};
use crate::real_data::data;
use deepshade_render::raster::geometry::POSED;
use deepshade_render::raster::{Frame, frame::FrameStage, frame::RasterSettings};
use deepshade_render::scene::{AnimatedScene, Camera, Scene, SceneSource};
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, Gpu};
use glam::{Mat4, Vec3};
use std::path::Path;

/// The largest distances, in parts of the scene's diagonal, of vertices posed on the GPU and on the CPU from
/// those of the file at the same time, of their displacements while the shutter is open and ways since the
/// time before, and of unit normals and tangents.
fn distances(gpu: &Gpu, path: &Path, times: &[f32], place: Mat4) -> [f32; 5] {
    distances_loaded_at(gpu, path, times[0], times, place)
}

/// The same of a file that is loaded at one time and posed at others.
fn distances_loaded_at(gpu: &Gpu, path: &Path, loaded: f32, times: &[f32], place: Mat4) -> [f32; 5] {
    let shutter = 0.04;
    let mut animated = AnimatedScene::load(&SceneSource::File(path.to_owned()), loaded).expect("a file");
    animated = {
        let mut hall = AnimatedScene::from(Scene { materials: vec![Default::default()], ..Scene::default() });
        hall.add(animated, place);
        hall
    };
    let settings =
        RasterSettings { height: 4, width: 4, attributes: vec![Attribute::Valid], shadow_size: Some(256) };
    let mut frame = Frame::new(gpu, &animated, &settings).expect("a frame");
    let camera = Camera::look_at(Vec3::ONE, Vec3::ZERO);
    let mut worst = [0.0f32; 5];
    let mut before: Option<Scene> = None;
    for time in times {
        frame.set(&gpu.queue, *time, shutter, &camera);
        gpu::submit(&gpu.device, &gpu.queue, "test", |encoder| frame.encode(FrameStage::Pose, encoder, None))
            .expect("valid passes");
        let posed: Vec<f32> =
            gpu::read(&gpu.device, &gpu.queue, &frame.world().geometry.posed).expect("vertices");
        let mut file = Scene::default();
        file.add(Scene::load_moving(path, *time, shutter).expect("the file"), place);
        let diagonal = file.bounds().diagonal();
        for draw in &frame.world().geometry.draws {
            let mesh = &file.meshes[draw.mesh as usize];
            for (vertex, position) in mesh.positions.iter().enumerate() {
                let at = &posed[(draw.first_vertex as usize + vertex) * POSED..][..POSED];
                let vector = |first: usize| Vec3::from_slice(&at[first..first + 3]);
                let displacement = mesh.displacements.get(vertex).copied().unwrap_or(Vec3::ZERO);
                let normal = mesh.normals.get(vertex).map_or(0.0, |normal| (vector(3) - *normal).length());
                let tangent = mesh.tangents.get(vertex).map_or(0.0, |tangent| {
                    (vector(6) - tangent.truncate()).length() + (at[9] - tangent.w).abs()
                });
                let was = before
                    .as_ref()
                    .map_or(*position, |scene| scene.meshes[draw.mesh as usize].positions[vertex]);
                let found = [
                    (vector(0) - *position).length() / diagonal,
                    (vector(10) - displacement).length() / diagonal,
                    (vector(13) - (*position - was)).length() / diagonal,
                    normal,
                    tangent,
                ];
                worst = std::array::from_fn(|i| worst[i].max(found[i]));
            }
        }
        let for_rays = animated.at(*time, shutter).expect("a pose");
        assert_eq!(for_rays.meshes.len(), file.meshes.len());
        for (mesh, expected) in for_rays.meshes.iter().zip(&file.meshes) {
            let found = [
                farthest(&mesh.positions, &expected.positions) / diagonal,
                farthest(&mesh.displacements, &expected.displacements) / diagonal,
                0.0,
                farthest(&mesh.normals, &expected.normals),
                0.0,
            ];
            worst = std::array::from_fn(|i| worst[i].max(found[i]));
            assert_eq!(mesh.triangles, expected.triangles);
            assert_eq!(mesh.material.0, 1 + expected.material.0, "the hall has a material of its own");
        }
        before = Some(file);
    }
    worst
}

fn farthest(some: &[Vec3], others: &[Vec3]) -> f32 {
    assert_eq!(some.len(), others.len());
    some.iter().zip(others).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

fn place() -> Mat4 {
    Mat4::from_scale_rotation_translation(
        Vec3::splat(0.7),
        glam::Quat::from_rotation_y(0.8),
        Vec3::new(1.0, 2.0, 3.0),
    )
}

/// A skinned and morphed triangle on a node that moves.
fn everything_at_once() -> String {
    let mut builder = triangle();
    let joints = builder.shorts("VEC4", &[0, 1, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0]);
    let weights = builder.floats("VEC4", &[0.25, 0.75, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0]);
    let target = builder.floats("VEC3", &[0.0, 0.0, 1.0, 0.5, 0.0, 0.0, 0.0, 2.0, 0.0]);
    let times = builder.floats("SCALAR", &[0.0, 1.0, 2.0]);
    let places = builder.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 2.0, 0.0, 4.0, 0.0, 1.0]);
    let shares = builder.floats("SCALAR", &[0.0, 1.0, 0.3]);
    builder.gltf(&format!(
        r#""nodes":[{{"mesh":0,"skin":0}},{{"translation":[0.5,0,0]}},{{"children":[1]}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"JOINTS_0":{joints},"WEIGHTS_0":{weights}}},
            "indices":1,"targets":[{{"POSITION":{target}}}]}}],"weights":[0.1]}}],
        "skins":[{{"joints":[1,2]}}],
        "animations":[{{"channels":[{{"sampler":0,"target":{{"node":2,"path":"translation"}}}},
            {{"sampler":1,"target":{{"node":0,"path":"weights"}}}}],
        "samplers":[{{"input":{times},"output":{places}}},{{"input":{times},"output":{shares}}}]}}]"#
    ))
}

#[test]
fn skins_and_morph_targets_are_posed_as_the_file_says() {
    let gpu = Gpu::new().expect("an adapter");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("moving.gltf");
    write(folder.path(), "moving.gltf", everything_at_once());
    let times = [-1.0, 0.0, 0.4, 1.0, 1.7, 5.0];
    let worst = distances(&gpu, &path, &times, place());
    assert!(worst.iter().all(|distance| *distance < 1e-5), "{worst:?}");
    let still = folder.path().join("still.gltf");
    write(folder.path(), "still.gltf", triangle().gltf(ONE_MESH));
    assert!(distances(&gpu, &still, &times, place()).iter().all(|distance| *distance < 1e-6));
}

#[test]
fn what_has_no_size_at_first_and_what_follows_no_joint_are_where_the_file_says() {
    let gpu = Gpu::new().expect("an adapter");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut builder = triangle();
    let places = builder.floats("VEC3", &[1.0, 2.0, 3.0, -4.0, 5.0, 0.5]);
    let times = builder.floats("SCALAR", &[0.0, 1.0]);
    let sizes = builder.floats("VEC3", &[0.0, 0.0, 0.0, 2.0, 1.0, 3.0]);
    let mesh = r#""meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}]"#;
    let grows = builder.gltf(&format!(
        r#""nodes":[{{"mesh":0,"extensions":{{"EXT_mesh_gpu_instancing":{{"attributes":{{"TRANSLATION":{places}}}}}}}}}],
        {mesh},"animations":[{{"channels":[{{"sampler":0,"target":{{"node":0,"path":"scale"}}}}],
        "samplers":[{{"input":{times},"output":{sizes}}}]}}]"#
    ));
    let path = folder.path().join("grows.gltf");
    write(folder.path(), "grows.gltf", grows);
    let worst = distances_loaded_at(&gpu, &path, 0.0, &[0.3, 1.0], place());
    assert!(worst.iter().all(|distance| *distance < 1e-5), "{worst:?}");
    for weights in [[0.0; 12], [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]] {
        let mut builder = builder.clone();
        let joints = builder.shorts("VEC4", &[0; 12]);
        let weights = builder.floats("VEC4", &weights);
        let limp = builder.gltf(&format!(
            r#""nodes":[{{"mesh":0,"skin":0}},{{}}],"skins":[{{"joints":[1]}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"JOINTS_0":{joints},"WEIGHTS_0":{weights}}},
            "indices":1}}]}}],"animations":[{{"channels":[{{"sampler":0,"target":{{"node":1,"path":"translation"}}}}],
            "samplers":[{{"input":{times},"output":{places}}}]}}]"#
        ));
        let path = folder.path().join("limp.gltf");
        write(folder.path(), "limp.gltf", limp);
        let worst = distances(&gpu, &path, &[0.0, 0.6], place());
        assert!(worst.iter().all(|distance| *distance < 1e-5), "{worst:?}");
    }
}

#[test]
fn real_characters_are_posed_as_their_files_say() {
    let Some(data) = data() else { return };
    let gpu = Gpu::new().expect("an adapter");
    for name in [
        "gltf/Fox/Fox.gltf",
        "gltf/CesiumMan/CesiumMan.gltf",
        "gltf_conformance/SimpleSkin.gltf",
        "gltf_conformance/SimpleMorph.gltf",
        "gltf_conformance/RecursiveSkeletons.glb",
        "gltf_conformance/InterpolationTest.glb",
    ] {
        let worst = distances(&gpu, &data.join(name), &[0.0, 0.31, 1.13, 9.0], place());
        assert!(worst.iter().all(|distance| *distance < 2e-4), "{name}: {worst:?}");
    }
}
