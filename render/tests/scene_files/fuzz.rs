//! Random damage: no file makes the loader panic, and what loads is sound.

use crate::build::{Builder, base64, load, load_bytes, png};
use proptest::{collection::vec, prelude::*};

/// JSON and numbers of everything that a file can have: nodes, a skin, morph targets, an animation, a
/// texture, sparse accessors, instances, lights and cameras.
fn everything() -> (Builder, String) {
    let mut builder = Builder::default();
    let positions = builder.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0]);
    let normals = builder.floats("VEC3", &[0.0, 0.0, 1.0].repeat(4));
    let tangents = builder.floats("VEC4", &[1.0, 0.0, 0.0, 1.0].repeat(4));
    let uvs = builder.floats("VEC2", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
    let colours = builder.floats("VEC4", &[0.5; 16]);
    let indices = builder.shorts("SCALAR", &[0, 1, 2, 3]);
    let joints = builder.shorts("VEC4", &[0, 1, 0, 0].repeat(4));
    let weights = builder.floats("VEC4", &[0.5, 0.5, 0.0, 0.0].repeat(4));
    let identity = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let inverse = builder.floats("MAT4", &identity.repeat(2));
    let times = builder.floats("SCALAR", &[0.0, 1.0]);
    let turns = builder.floats("VEC4", &[0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0]);
    let splines = builder.floats("SCALAR", &[0.0, 0.1, 0.2, 0.3, 0.4, 0.5]);
    let (sparse_indices, sparse_values) = (builder.view(&[1, 0, 3, 0]), builder.view(&[0; 24]));
    let target = builder.raw_accessor(&format!(
        r#"{{"componentType":5126,"count":4,"type":"VEC3","sparse":{{"count":2,
        "indices":{{"bufferView":{sparse_indices},"componentType":5123}},"values":{{"bufferView":{sparse_values}}}}}}}"#
    ));
    let image = builder.view(&png(2, 2, &[[9, 8, 7]; 4]));
    let other = base64(&png(1, 2, &[[1, 2, 3]; 2]));
    let json = format!(
        r#""scene":0,"scenes":[{{"nodes":[0,1,3]}}],
        "nodes":[{{"mesh":0,"skin":0}},{{"children":[2],"camera":0}},{{"translation":[0,1,0],
            "extensions":{{"KHR_lights_punctual":{{"light":0}}}}}},
            {{"mesh":1,"extensions":{{"EXT_mesh_gpu_instancing":{{"attributes":{{"TRANSLATION":{positions}}}}}}}}}],
        "extensions":{{"KHR_lights_punctual":{{"lights":[{{"type":"spot","spot":{{"outerConeAngle":1}}}}]}}}},
        "cameras":[{{"type":"perspective","perspective":{{"yfov":1,"znear":0.1}}}}],
        "skins":[{{"joints":[1,2],"inverseBindMatrices":{inverse}}}],
        "meshes":[{{"weights":[0.5],"primitives":[{{"mode":5,"indices":{indices},"material":0,
            "targets":[{{"POSITION":{target}}}],
            "attributes":{{"POSITION":{positions},"NORMAL":{normals},"TANGENT":{tangents},"TEXCOORD_0":{uvs},
                "COLOR_0":{colours},"JOINTS_0":{joints},"WEIGHTS_0":{weights}}}}}]}},
            {{"primitives":[{{"attributes":{{"POSITION":{positions}}},"mode":6}}]}}],
        "materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}},
            "normalTexture":{{"index":1,"extensions":{{"KHR_texture_transform":{{"rotation":1,"texCoord":0}}}}}}}}],
        "textures":[{{"source":0,"sampler":0}},{{"source":1}}],"samplers":[{{"wrapS":33071}}],
        "images":[{{"bufferView":{image},"mimeType":"image/png"}},{{"uri":"data:image/png;base64,{other}"}}],
        "animations":[{{"channels":[{{"sampler":0,"target":{{"node":2,"path":"rotation"}}}},
            {{"sampler":1,"target":{{"node":0,"path":"weights"}}}}],
            "samplers":[{{"input":{times},"output":{turns}}},
                {{"input":{times},"output":{splines},"interpolation":"CUBICSPLINE"}}]}}]"#
    );
    (builder, json)
}

#[test]
fn the_undamaged_file_loads() {
    let (builder, json) = everything();
    let scene = load(&builder.gltf(&json), 0.5).expect("an undamaged file");
    assert_eq!((scene.meshes.len(), scene.triangle_count()), (5, 2 + 4 * 2));
    assert_eq!((scene.textures.len(), scene.lights.len(), scene.cameras.len()), (2, 1, 1));
}

#[test]
fn every_number_of_the_json_may_be_wrong() {
    let (builder, json) = everything();
    let text = builder.gltf(&json);
    let wrong = [
        "0",
        "1",
        "7",
        "255",
        "65536",
        "4294967295",
        "9223372036854775807",
        "18446744073709551615",
        "-1",
        "1e39",
        "0.5",
    ];
    let mut loaded = 0;
    let mut tried = 0;
    for (begin, end) in numbers(&text) {
        for number in wrong {
            let damaged = [&text[..begin], number, &text[end..]].concat();
            loaded += usize::from(load(&damaged, 0.5).is_ok());
            tried += 1;
        }
    }
    assert!(tried > 1000 && loaded > 0 && loaded < tried, "{loaded} of {tried}");
}

/// Where the numbers of a JSON text are that stand outside of strings.
fn numbers(text: &str) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    let (mut in_string, mut begin) = (false, None);
    for (at, byte) in text.bytes().enumerate() {
        in_string ^= byte == b'"';
        match (byte.is_ascii_digit() && !in_string, begin) {
            (true, None) => begin = Some(at),
            (false, Some(first)) => {
                found.push((first, at));
                begin = None;
            }
            _ => {}
        }
    }
    found
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn flipped_and_missing_bytes_do_not_panic(
        flips in vec((any::<prop::sample::Index>(), any::<u8>()), 0..6),
        kept in 0.0..1.5f64,
        time in -1.0..2.0f32,
    ) {
        let (builder, json) = everything();
        let mut bytes = builder.glb(&json);
        for (at, value) in flips {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        bytes.truncate((bytes.len() as f64 * kept) as usize);
        if let Ok(scene) = load_bytes("test.glb", &bytes, time) {
            for mesh in &scene.meshes {
                prop_assert!(mesh.positions.iter().all(|position| position.is_finite()));
                prop_assert!(mesh.triangles.iter().flatten().all(|vertex| (*vertex as usize) < mesh.positions.len()));
            }
        }
    }
}
