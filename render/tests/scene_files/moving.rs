//! Files at two times: how far vertices move while the shutter is open.

use crate::build::{Builder, ONE_MESH, triangle, write};
use crate::real_data::data;
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::{Scene, SceneError};
use glam::Vec3;

fn load(text: &str, time: f32, shutter: f32) -> Result<Scene, SceneError> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    write(folder.path(), "test.gltf", text);
    Scene::load_moving(&folder.path().join("test.gltf"), time, shutter)
}

/// Everything of a scene.
fn bytes(scene: &Scene) -> String {
    format!("{scene:?}")
}

/// A triangle whose node moves evenly from the origin at 1 s to (2, 4, 0) at 3 s, beside another that stays.
fn sliding() -> String {
    let mut builder = triangle();
    let input = builder.floats("SCALAR", &[1.0, 3.0]);
    let output = builder.floats("VEC3", &[0.0, 0.0, 0.0, 2.0, 4.0, 0.0]);
    builder.gltf(&format!(
        r#""nodes":[{{"mesh":0}},{{"mesh":0,"translation":[9,0,0]}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
        "animations":[{{"channels":[{{"sampler":0,"target":{{"node":0,"path":"translation"}}}}],
        "samplers":[{{"input":{input},"output":{output}}}]}}]"#
    ))
}

#[test]
fn vertices_move_at_their_velocity() {
    let scene = load(&sliding(), 2.0, 0.5).expect("an animation");
    let still = load(&sliding(), 2.0, 0.0).expect("an animation");
    // (1, 2, 0) metres a second for half a second.
    assert_eq!(scene.meshes[0].displacements, vec![Vec3::new(0.5, 1.0, 0.0); 3]);
    assert!(scene.meshes[1].displacements.is_empty(), "the other one stays");
    assert_eq!(scene.meshes[0].positions, still.meshes[0].positions);
    assert_eq!(still.meshes[0].positions[0], Vec3::new(1.0, 2.0, 0.0));
}

#[test]
fn an_animation_says_when_it_begins_and_ends() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let span = |name: &str, text: &str| {
        write(folder.path(), name, text);
        Scene::animation_span(&folder.path().join(name)).expect("a file")
    };
    assert_eq!(span("moving.gltf", &sliding()), Some([1.0, 3.0]));
    assert_eq!(span("still.gltf", &triangle().gltf(ONE_MESH)), None);
    assert_eq!(span("still.obj", "v 0 0 0\n"), None, "a format without animations");
}

#[test]
fn the_shutter_may_open_before_the_animation() {
    // At 1 s, where it starts, half of the exposure is before.
    let scene = load(&sliding(), 1.0, 0.5).expect("an animation");
    assert_eq!(scene.meshes[0].displacements[0], Vec3::new(0.25, 0.5, 0.0));
}

#[test]
fn morphs_move_vertex_by_vertex() {
    let mut builder = triangle();
    let rise = builder.floats("VEC3", &[0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 4.0]);
    let input = builder.floats("SCALAR", &[0.0, 2.0]);
    let output = builder.floats("SCALAR", &[0.0, 1.0]);
    let text = builder.gltf(&format!(
        r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{
            "attributes":{{"POSITION":0}},"indices":1,"targets":[{{"POSITION":{rise}}}]}}]}}],
        "animations":[{{"channels":[{{"sampler":0,"target":{{"node":0,"path":"weights"}}}}],
        "samplers":[{{"input":{input},"output":{output}}}]}}]"#
    ));
    let scene = load(&text, 1.0, 1.0).expect("a morph");
    let expected = [0.0, 1.0, 2.0].map(|z| Vec3::new(0.0, 0.0, z));
    assert_eq!(scene.meshes[0].displacements, expected);
}

#[test]
fn skins_move_with_their_joints() {
    let mut builder = Builder::default();
    let positions = builder.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    let joints = builder.shorts("VEC4", &[0, 1, 0, 0].repeat(3));
    let weights = builder.floats("VEC4", &[1.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    let input = builder.floats("SCALAR", &[0.0, 1.0]);
    let output = builder.floats("VEC3", &[0.0, 0.0, 0.0, 0.0, 0.0, 8.0]);
    let text = builder.gltf(&format!(
        r#""nodes":[{{"mesh":0,"skin":0}},{{}},{{}}],"skins":[{{"joints":[1,2]}}],
        "meshes":[{{"primitives":[{{"attributes":{{
            "POSITION":{positions},"JOINTS_0":{joints},"WEIGHTS_0":{weights}}}}}]}}],
        "animations":[{{"channels":[{{"sampler":0,"target":{{"node":2,"path":"translation"}}}}],
        "samplers":[{{"input":{input},"output":{output}}}]}}]"#
    ));
    let scene = load(&text, 0.5, 0.5).expect("a skin");
    let expected = [0.0, 2.0, 4.0].map(|z| Vec3::new(0.0, 0.0, z));
    assert_eq!(scene.meshes[0].displacements, expected);
}

#[test]
fn what_stays_is_the_same_to_the_byte() {
    let still = triangle().gltf(ONE_MESH);
    assert_eq!(
        bytes(&load(&still, 1.0, 0.5).expect("a triangle")),
        bytes(&load(&still, 1.0, 0.0).expect("a triangle"))
    );
    // After the animation's end nothing moves either.
    let after = |shutter| load(&sliding(), 9.0, shutter).expect("an animation");
    assert_eq!(bytes(&after(0.5)), bytes(&after(0.0)));
    assert_ne!(
        bytes(&load(&sliding(), 2.0, 0.5).expect("moving")),
        bytes(&load(&sliding(), 2.0, 0.0).expect("still"))
    );
}

#[test]
fn a_shutter_that_is_no_time_is_refused() {
    for shutter in [-0.5, f32::NAN, f32::INFINITY] {
        let error = load(&sliding(), 2.0, shutter).expect_err("no time").to_string();
        assert!(error.ends_with(&format!("cannot be exposed for {shutter} seconds")), "{error}");
    }
}

#[test]
fn a_walking_man_is_where_his_file_says_at_both_ends() {
    let Some(folder) = data() else { return };
    let path = folder.join("gltf/CesiumMan/CesiumMan.gltf");
    let scene = Scene::load_moving(&path, 0.7, 0.1).expect("a man");
    let ends = [0.65, 0.75].map(|time| Scene::load(&path, time).expect("a man"));
    let mut farthest = 0.0f32;
    for (mesh, (before, after)) in scene.meshes.iter().zip(ends[0].meshes.iter().zip(&ends[1].meshes)) {
        for (vertex, displacement) in mesh.displacements.iter().enumerate() {
            let expected = after.positions[vertex] - before.positions[vertex];
            assert!((*displacement - expected).length() < 1e-6);
            farthest = farthest.max(displacement.length());
        }
    }
    assert!((0.02..0.5).contains(&farthest), "{farthest} m in a tenth of a second");
    let traced = TracedScene::new(scene).expect("a man");
    let middle = traced.bounds().centre() + Vec3::Z * 3.0;
    let distance = |time: f32| traced.at(time).hit(middle, Vec3::NEG_Z, 9.0).map(|hit| hit.distance);
    assert!(distance(-0.5).is_some() && distance(-0.5) != distance(0.5));
}
