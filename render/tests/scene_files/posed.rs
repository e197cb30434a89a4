//! Animation, skins and morph targets against values worked out by hand.

use crate::build::{Builder, load, triangle};
use deepshade_render::scene::Scene;
use glam::Vec3;
use std::f32::consts::FRAC_1_SQRT_2;

fn near(found: Vec3, expected: [f32; 3]) {
    assert!((found - Vec3::from(expected)).length() < 1e-5, "{found} is not {expected:?}");
}

/// The first vertex, which rests at the origin, of a triangle whose node has one animated property.
fn animated(path: &str, interpolation: &str, times: &[f32], kind: &str, values: &[f32], time: f32) -> Scene {
    let mut builder = triangle();
    let input = builder.floats("SCALAR", times);
    let output = builder.floats(kind, values);
    let text = builder.gltf(&format!(
        r#""nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
        "animations":[{{
            "channels":[{{"sampler":0,"target":{{"node":0,"path":"{path}"}}}}],
            "samplers":[{{"input":{input},"output":{output},"interpolation":"{interpolation}"}}]
        }}]"#
    ));
    load(&text, time).expect("an animation")
}

#[test]
fn steps_lines_and_their_ends() {
    let at = |interpolation, time| {
        let values = [1.0, 0.0, 0.0, 3.0, 4.0, 0.0];
        animated("translation", interpolation, &[1.0, 3.0], "VEC3", &values, time).meshes[0].positions[0]
    };
    near(at("LINEAR", 1.5), [1.5, 1.0, 0.0]);
    near(at("STEP", 2.9), [1.0, 0.0, 0.0]);
    near(at("STEP", 3.0), [3.0, 4.0, 0.0]);
    for interpolation in ["LINEAR", "STEP"] {
        near(at(interpolation, -5.0), [1.0, 0.0, 0.0]);
        near(at(interpolation, 99.0), [3.0, 4.0, 0.0]);
    }
}

#[test]
fn a_cubic_spline_goes_through_its_keys_with_its_tangents() {
    let values = [
        [9.0, 9.0, 9.0], // tangent into the first key, which nothing reads
        [0.0, 1.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 0.0, 8.0], // tangent into the second
        [3.0, 1.0, 0.0],
        [9.0, 9.0, 9.0],
    ]
    .concat();
    let at = |time| {
        animated("translation", "CUBICSPLINE", &[0.0, 2.0], "VEC3", &values, time).meshes[0].positions[0]
    };
    // At a quarter the Hermite weights are 27/32 and 5/32 for the keys, 9/64 and -3/64 for tangents times 2
    // seconds.
    near(at(0.5), [0.75, 1.0, -0.75]);
    near(at(0.0), [0.0, 1.0, 0.0]);
    near(at(2.0), [3.0, 1.0, 0.0]);
    near(at(7.0), [3.0, 1.0, 0.0]);
}

#[test]
fn rotations_turn_evenly_on_the_short_way() {
    let quarter_turn = [0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2];
    for sign in [1.0, -1.0] {
        let values = [[0.0, 0.0, 0.0, 1.0], quarter_turn.map(|value| sign * value)].concat();
        let scene = animated("rotation", "LINEAR", &[0.0, 3.0], "VEC4", &values, 1.0);
        let angle = 30f32.to_radians();
        near(scene.meshes[0].positions[1], [angle.cos(), angle.sin(), 0.0]);
    }
}

#[test]
fn normalised_integers_are_rotations_too() {
    let mut builder = triangle();
    let input = builder.floats("SCALAR", &[0.0]);
    let half: [i16; 4] = [0, 0, 23_170, 23_170];
    let bytes: Vec<u8> = half.iter().flat_map(|value| value.to_le_bytes()).collect();
    let output = builder.accessor("VEC4", 5122, 1, &bytes, r#","normalized":true"#);
    let text = builder.gltf(&format!(
        r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
        "animations":[{{"channels":[{{"sampler":0,"target":{{"node":0,"path":"rotation"}}}}],
        "samplers":[{{"input":{input},"output":{output}}}]}}]"#
    ));
    near(load(&text, 0.0).expect("a rotation").meshes[0].positions[1], [0.0, 1.0, 0.0]);
}

#[test]
fn morph_targets_add_up_by_their_weights_at_the_time() {
    let mut builder = triangle();
    let normals = builder.floats("VEC3", &[0.0, 0.0, 1.0].repeat(3));
    let rise = builder.floats("VEC3", &[0.0, 0.0, 2.0].repeat(3));
    let shift = builder.floats("VEC3", &[4.0, 0.0, 0.0].repeat(3));
    let lean = builder.floats("VEC3", &[2.0, 0.0, 0.0].repeat(3));
    let input = builder.floats("SCALAR", &[1.0, 3.0]);
    let output = builder.floats("SCALAR", &[0.0, 1.0, 1.0, 0.5]);
    let rest = format!(
        r#""nodes":[{{"mesh":0}}],"meshes":[{{"weights":[0.25,0.0],"primitives":[{{
            "attributes":{{"POSITION":0,"NORMAL":{normals}}},
            "targets":[{{"POSITION":{rise}}},{{"POSITION":{shift},"NORMAL":{lean}}}]}}]}}]"#
    );
    let still = load(&builder.gltf(&rest), 0.0).expect("weights of the mesh");
    near(still.meshes[0].positions[1], [1.0, 0.0, 0.5]);
    let moving = builder.gltf(&format!(
        r#"{rest},"animations":[{{"channels":[{{"sampler":0,"target":{{"node":0,"path":"weights"}}}}],
        "samplers":[{{"input":{input},"output":{output}}}]}}]"#
    ));
    let at = |time| load(&moving, time).expect("animated weights").meshes.remove(0);
    near(at(0.0).positions[1], [5.0, 0.0, 0.0]);
    near(at(2.0).positions[1], [1.0 + 4.0 * 0.75, 0.0, 2.0 * 0.5]);
    near(at(9.0).positions[1], [3.0, 0.0, 2.0]);
    near(at(9.0).normals[0], [FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2]);
}

/// A strip of three vertices above each other and one beside the second. Joint 0 stays at the origin, joint 1
/// stands at (0, 1, 0) and has turned by 90 degrees about z. The mesh's node is far away, which must not
/// matter.
fn bent() -> Scene {
    let mut builder = Builder::default();
    let positions = builder
        .floats("VEC3", &[[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 2.0, 0.0], [1.0, 1.0, 0.0]].concat());
    let normals = builder.floats("VEC3", &[1.0, 0.0, 0.0].repeat(4));
    let indices = builder.shorts("SCALAR", &[0, 3, 1, 1, 3, 2]);
    let joints = builder.shorts("VEC4", &[[0, 1, 0, 0], [0, 1, 0, 0], [0, 1, 0, 0], [0, 1, 0, 0]].concat());
    let weights =
        [[1.0, 0.0, 0.0, 0.0], [0.5, 0.5, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.25, 0.25, 0.0, 0.0]].concat();
    let weights = builder.floats("VEC4", &weights);
    let columns = |y: f32| [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, y, 0.0, 1.0];
    let inverse = builder.floats("MAT4", &[columns(0.0), columns(-1.0)].concat());
    let text = builder.gltf(&format!(
        r#""nodes":[{{"mesh":0,"skin":0,"translation":[5,5,5],"scale":[-3,1,1]}},{{"children":[2]}},
            {{"translation":[0,1,0],"rotation":[0,0,{FRAC_1_SQRT_2},{FRAC_1_SQRT_2}]}}],
        "skins":[{{"joints":[1,2],"inverseBindMatrices":{inverse}}}],
        "scenes":[{{"nodes":[0,1]}}],
        "meshes":[{{"name":"strip","primitives":[{{"indices":{indices},"attributes":{{
            "POSITION":{positions},"NORMAL":{normals},"JOINTS_0":{joints},"WEIGHTS_0":{weights}}}}}]}}]"#
    ));
    load(&text, 0.0).expect("a skin")
}

#[test]
fn a_skin_bends_at_its_joint() {
    let strip = &bent().meshes[0];
    near(strip.positions[0], [0.0, 0.0, 0.0]);
    near(strip.positions[1], [0.0, 1.0, 0.0]);
    near(strip.positions[2], [-1.0, 1.0, 0.0]);
    // Half at (1, 1, 0), half turned to (0, 2, 0); its weights add up to a half and count as one.
    near(strip.positions[3], [0.5, 1.5, 0.0]);
    near(strip.normals[0], [1.0, 0.0, 0.0]);
    near(strip.normals[1], [FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0]);
    near(strip.normals[2], [0.0, 1.0, 0.0]);
    assert_eq!(strip.triangles, [[0, 3, 1], [1, 3, 2]]);
}
