//! Geometry: nodes, primitive modes, sparse and quantised accessors, and where winding turns.

use crate::build::{Builder, ONE_MESH, load, load_bytes, triangle, write};
use deepshade_render::scene::{Mesh, Scene};
use glam::Vec3;

/// The geometric normal of each triangle.
fn facing(mesh: &Mesh) -> Vec<Vec3> {
    let normal = |index| {
        let [a, b, c] = mesh.corners(index);
        (b - a).cross(c - a).normalize()
    };
    (0..mesh.triangles.len()).map(normal).collect()
}

/// A triangle that faces +z, with normals and tangents, at a node with a transform.
fn transformed(transform: &str) -> Mesh {
    let mut builder = triangle();
    let normals = builder.floats("VEC3", &[0.6, 0.0, 0.8].repeat(3));
    let tangents = builder.floats("VEC4", &[0.8, 0.0, -0.6, 1.0].repeat(3));
    let text = builder.gltf(&format!(
        r#""nodes":[{{"mesh":0,{transform}}}],"meshes":[{{"primitives":[{{"indices":1,
        "attributes":{{"POSITION":0,"NORMAL":{normals},"TANGENT":{tangents}}}}}]}}]"#
    ));
    load(&text, 0.0).expect("a node").meshes.remove(0)
}

#[test]
fn mirroring_keeps_fronts_in_front() {
    for (transform, mirrored) in [
        (r#""scale":[-1,1,1]"#, true),
        (r#""scale":[-1,-1,1]"#, false),
        (r#""matrix":[0,1,0,0, 1,0,0,0, 0,0,1,0, 0,0,0,1]"#, true),
    ] {
        let mesh = transformed(transform);
        assert_eq!(facing(&mesh), [Vec3::Z], "{transform}");
        assert_eq!(mesh.triangles[0] == [0, 2, 1], mirrored, "{transform}");
        assert_eq!(mesh.tangents[0].w, if mirrored { -1.0 } else { 1.0 }, "{transform}");
    }
    // The bitangent, mapped as a direction, is what the mapped frame gives.
    let mesh = transformed(r#""scale":[-1,1,1]"#);
    let bitangent = mesh.normals[0].cross(mesh.tangents[0].truncate()) * mesh.tangents[0].w;
    assert!((bitangent - Vec3::Y).length() < 1e-6, "{bitangent}");
}

#[test]
fn normals_stay_perpendicular_under_uneven_scale() {
    let mesh = transformed(r#""scale":[2,1,0.5]"#);
    let (normal, tangent) = (mesh.normals[0], mesh.tangents[0].truncate());
    assert!(normal.dot(tangent).abs() < 1e-6);
    assert!((normal - Vec3::new(0.3, 0.0, 1.6).normalize()).length() < 1e-6, "{normal}");
}

#[test]
fn children_stand_where_their_parents_put_them() {
    let text = triangle().gltf(
        r#""nodes":[{"children":[1],"translation":[1,2,3],"rotation":[0,0,0.70710678,0.70710678]},
            {"mesh":0,"translation":[1,0,0],"scale":[2,2,2]},{"mesh":0}],
        "scenes":[{"nodes":[2]},{"nodes":[0]}],"scene":1,
        "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}]"#,
    );
    let scene = load(&text, 0.0).expect("two nodes");
    assert_eq!(scene.meshes.len(), 1, "only the default scene is shown");
    for (found, expected) in
        scene.meshes[0].positions.iter().zip([[1.0, 3.0, 3.0], [1.0, 5.0, 3.0], [-1.0, 3.0, 3.0]])
    {
        assert!((*found - Vec3::from(expected)).length() < 1e-5, "{found}");
    }
}

#[test]
fn strips_and_fans_face_one_way() {
    let zigzag =
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 2.0, 0.0]].concat();
    let rim = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]].concat();
    for (mode, positions, triangles) in [(5, zigzag, 3), (6, rim, 2)] {
        let mut builder = Builder::default();
        builder.floats("VEC3", &positions);
        let text = builder.gltf(&format!(
            r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"mode":{mode}}}]}}]"#
        ));
        assert_eq!(
            facing(&load(&text, 0.0).expect("triangles").meshes[0]),
            vec![Vec3::Z; triangles],
            "mode {mode}"
        );
    }
}

#[test]
fn sparse_values_replace_zeros() {
    let mut builder = Builder::default();
    let indices = builder.view(&[1, 2, 0, 0]);
    let values: Vec<u8> =
        [1.0f32, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|value| value.to_le_bytes()).collect();
    let values = builder.view(&values);
    builder.raw_accessor(&format!(
        r#"{{"componentType":5126,"count":3,"type":"VEC3","sparse":{{"count":2,
        "indices":{{"bufferView":{indices},"componentType":5121}},"values":{{"bufferView":{values}}}}}}}"#
    ));
    let rest = r#""nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]"#;
    let scene = load(&builder.gltf(rest), 0.0).expect("a sparse accessor");
    assert_eq!(scene.meshes[0].positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
}

#[test]
fn quantised_positions_are_scaled_by_their_node() {
    let mut builder = Builder::default();
    let bytes = [0i8, 0, 0, 0, 127, 0, 0, 0, 0, -128, 0, 0].map(i8::cast_unsigned);
    let view = builder.view(&bytes);
    builder.raw_accessor(&format!(
        r#"{{"bufferView":{view},"componentType":5120,"normalized":true,"count":3,"type":"VEC3"}}"#
    ));
    let text = builder.gltf(
        r#""extensionsRequired":["KHR_mesh_quantization"],"nodes":[{"mesh":0,"scale":[10,10,10]}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]"#,
    );
    // Elements are four bytes apart.
    let text = text.replace(r#""byteLength":12}"#, r#""byteLength":12,"byteStride":4}"#);
    let scene = load(&text, 0.0).expect("quantised positions");
    assert_eq!(scene.meshes[0].positions, [Vec3::ZERO, Vec3::X * 10.0, Vec3::Y * -10.0]);
}

#[test]
fn the_same_scene_in_every_packing() {
    let builder = triangle();
    let embedded = load(&builder.gltf(ONE_MESH), 0.0).expect("a data URI");
    let packed = load_bytes("test.glb", &builder.glb(ONE_MESH), 0.0).expect("a binary chunk");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let uri = format!("data:application/octet-stream;base64,{}", crate::build::base64(&bytes_of(&builder)));
    let text = builder.gltf(ONE_MESH).replace(&uri, "a%20buffer.bin");
    write(folder.path(), "a buffer.bin", bytes_of(&builder));
    write(folder.path(), "test.gltf", text);
    let beside = Scene::load(&folder.path().join("test.gltf"), 0.0).expect("a file beside");
    for scene in [&embedded, &packed, &beside] {
        assert_eq!(scene.name, "test");
        assert_eq!(scene.meshes[0].name, "corner");
        assert_eq!(scene.meshes[0].positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
        assert_eq!(scene.meshes[0].triangles, [[0, 1, 2]]);
    }
}

/// The binary chunk of a builder's file.
fn bytes_of(builder: &Builder) -> Vec<u8> {
    let glb = builder.glb("\"nodes\":[]");
    let json = u32::from_le_bytes([glb[12], glb[13], glb[14], glb[15]]) as usize;
    glb[12 + 8 + json + 8..].to_vec()
}
