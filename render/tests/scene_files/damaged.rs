//! Damaged and hostile glTF files: every one gives an error that names what is wrong, within seconds.

use crate::build::{Builder, ONE_MESH, base64, load, load_bytes, png, triangle, write};
use deepshade_render::scene::{Scene, SceneError};
use std::time::{Duration, Instant};

/// Longest time that a small file may take.
const PATIENCE: Duration = Duration::from_secs(5);

fn assert_named(case: &str, result: Result<Scene, SceneError>, expected: &str) {
    let error = result.expect_err(case).to_string();
    assert!(error.contains("test.gl") && error.contains(expected), "{case}: {error}");
}

/// JSON of a scene with one mesh of the given primitive.
fn primitive(json: &str) -> String {
    format!(r#""nodes":[{{"mesh":0}}],"meshes":[{{"name":"corner","primitives":[{{{json}}}]}}]"#)
}

#[test]
fn json_that_lies_is_named() {
    let good = triangle().gltf(ONE_MESH);
    assert!(load(&good, 0.0).is_ok());
    let cases = [
        ("webp", r#""asset":"#, r#""extensionsRequired":["EXT_texture_webp"],"asset":"#, "EXT_texture_webp"),
        ("version", r#""2.0""#, r#""1.0""#, "is glTF 1.0"),
        ("newer version", r#""2.0""#, r#""2.1","minVersion":"2.1""#, "needs 2.1"),
        ("no mesh", r#""mesh":0"#, r#""mesh":7"#, "nodes[0].mesh: Index out of bounds"),
        ("no position accessor", r#""POSITION":0"#, r#""POSITION":7"#, "mesh 0: there is no accessor 7"),
        ("no index accessor", r#""indices":1"#, r#""indices":7"#, "indices: Index out of bounds"),
        (
            "float indices",
            r#""componentType":5123,"count":3"#,
            r#""componentType":5126,"count":1"#,
            "indices of mesh `corner`: accessor 1",
        ),
        (
            "unknown component",
            r#""componentType":5126"#,
            r#""componentType":1"#,
            "accessors[0].componentType",
        ),
        ("wrong kind", r#""VEC3""#, r#""VEC2""#, "POSITION of mesh `corner`: accessor 0 has 2 components"),
        (
            "longer than its view",
            r#""count":3,"type":"VEC3""#,
            r#""count":4,"type":"VEC3""#,
            "accessor 0 reaches past the end of buffer view 0",
        ),
        (
            "absurdly long",
            r#""count":3,"type":"VEC3""#,
            r#""count":18446744073709551615,"type":"VEC3""#,
            "accessor 0 reaches past the end of buffer view 0",
        ),
        (
            "offset that overflows",
            r#""count":3,"type":"VEC3""#,
            r#""byteOffset":18446744073709551610,"count":3,"type":"VEC3""#,
            "accessor 0",
        ),
        (
            "view outside its buffer",
            r#""byteOffset":0,"byteLength":36"#,
            r#""byteOffset":32,"byteLength":36"#,
            "bufferViews[0]: 36 bytes from 32 on",
        ),
        (
            "view that overflows",
            r#""byteOffset":0,"byteLength":36"#,
            r#""byteOffset":18446744073709551615,"byteLength":36"#,
            "bufferViews[0]: 36 bytes from 18446744073709551615 on",
        ),
        (
            "truncated buffer",
            r#""byteLength":44"#,
            r#""byteLength":45"#,
            "buffer 0 is truncated: 44 bytes where 45",
        ),
        (
            "absurd buffer",
            r#""byteLength":44"#,
            r#""byteLength":1152921504606846976"#,
            "buffer 0 is truncated",
        ),
        ("damaged data URI", ";base64,", ";base64,*", "data URI"),
        ("no JSON", "{", "", "is not glTF 2.0"),
        (
            "its own child",
            r#"{"mesh":0}"#,
            r#"{"mesh":0,"name":"ring","children":[0]}"#,
            "node 0 `ring` is its own ancestor",
        ),
        (
            "a ring",
            r#"{"mesh":0}"#,
            r#"{"mesh":0},{"children":[2]},{"children":[1]}"#,
            "node 1 is its own ancestor",
        ),
        (
            "two parents",
            r#"{"mesh":0}"#,
            r#"{"mesh":0},{"children":[0]},{"children":[0]}"#,
            "node 0 has two parents",
        ),
        (
            "infinite place",
            r#"{"mesh":0}"#,
            r#"{"mesh":0,"translation":[1e39,0,0]}"#,
            "mesh `corner`: vertex 0 is not finite",
        ),
    ];
    for (case, from, to, expected) in cases {
        assert!(good.contains(from), "{case}");
        assert_named(case, load(&good.replacen(from, to, 1), 0.0), expected);
    }
}

#[test]
fn numbers_that_lie_are_named() {
    let corner = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    for bad in [f32::NAN, f32::INFINITY] {
        let mut builder = Builder::default();
        let mut positions = corner;
        positions[4] = bad;
        builder.floats("VEC3", &positions);
        let result = load(&builder.gltf(&primitive(r#""attributes":{"POSITION":0}"#)), 0.0);
        assert_named(
            "a vertex",
            result,
            "POSITION of mesh `corner`: accessor 0 holds a value that is not finite",
        );
    }
    let mut builder = Builder::default();
    builder.floats("VEC3", &corner);
    builder.shorts("SCALAR", &[0, 1, 3]);
    let result = load(&builder.gltf(ONE_MESH), 0.0);
    assert_named("an index", result, "mesh `corner`: index 3 is out of range of 3 vertices");
    builder.floats("VEC3", &[0.0, 0.0, 1.0]);
    let result = load(&builder.gltf(&primitive(r#""attributes":{"POSITION":0,"NORMAL":2}"#)), 0.0);
    assert_named("normals", result, "NORMAL of mesh `corner`: 1 values for 3 vertices");
}

#[test]
fn nothing_to_see_is_empty() {
    let mut flat = Builder::default();
    flat.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 2.0, 0.0, 0.0]);
    let lines = triangle().gltf(&primitive(r#""attributes":{"POSITION":0},"mode":1"#));
    let none = triangle().gltf(r#""nodes":[]"#);
    let flat = flat.gltf(&primitive(r#""attributes":{"POSITION":0}"#));
    for text in [lines, none, flat] {
        assert!(matches!(load(&text, 0.0), Err(SceneError::Empty { name }) if name == "test"));
    }
    assert_named("time", load(&triangle().gltf(ONE_MESH), f32::NAN), "NaN seconds");
}

#[test]
fn animations_and_skins_that_lie_are_named() {
    let mut builder = triangle();
    let falling = builder.floats("SCALAR", &[1.0, 0.0]);
    let values = builder.floats("VEC3", &[0.0; 6]);
    let joints = builder.shorts("VEC4", &[9; 12]);
    let weights = builder.floats("VEC4", &[0.25; 12]);
    let animated = |node: usize, path: &str, input: usize| {
        builder.gltf(&format!(
            r#"{ONE_MESH},"animations":[{{"channels":[{{"sampler":0,"target":{{"node":{node},"path":"{path}"}}}}],
            "samplers":[{{"input":{input},"output":{values}}}]}}]"#
        ))
    };
    let skinned = |attributes: &str| {
        builder.gltf(&format!(
            r#""nodes":[{{"mesh":0,"skin":0}}],"skins":[{{"joints":[0]}}],
            "meshes":[{{"name":"corner","primitives":[{{"attributes":{{"POSITION":0,"JOINTS_0":{joints}{attributes}}}}}]}}]"#
        ))
    };
    assert_named(
        "times",
        load(&animated(0, "translation", falling), 0.0),
        "animation 0, channel 0: its times do not increase",
    );
    assert_named("values", load(&animated(0, "rotation", falling), 0.0), "animation 0, channel 0: accessor");
    assert_named("node", load(&animated(5, "translation", falling), 0.0), "animation 0: channel 0");
    assert_named("path", load(&animated(0, "colour", falling), 0.0), "animation 0: channel 0");
    assert_named(
        "joint",
        load(&skinned(&format!(r#","WEIGHTS_0":{weights}"#)), 0.0),
        "mesh `corner` follows joint 9 of a skin with 1",
    );
    assert_named("weights", load(&skinned(""), 0.0), "JOINTS_0 of mesh `corner`: joints without weights");
}

#[test]
fn materials_and_lights_that_lie_are_named() {
    let image = base64(&png(1, 1, &[[1, 2, 3]]));
    let textured = |slot: &str| {
        triangle().gltf(&format!(
            r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"material":0}}]}}],
            "materials":[{{"name":"bark",{slot}}}],"textures":[{{"source":0}}],
            "images":[{{"uri":"data:image/png;base64,{image}"}}]"#
        ))
    };
    let moved = |by: &str| format!(r#"{{"index":0,"extensions":{{"KHR_texture_transform":{{{by}}}}}}}"#);
    let expected = "material `bark`: KHR_texture_transform holds a value that is not finite";
    for by in [r#""offset":[1e39,0]"#, r#""rotation":-1e39"#, r#""scale":[1,1e39]"#] {
        for map in ["normalTexture", "emissiveTexture"] {
            assert_named(by, load(&textured(&format!(r#""{map}":{}"#, moved(by))), 0.0), expected);
        }
    }
    assert!(load(&textured(&format!(r#""normalTexture":{}"#, moved(r#""rotation":1"#))), 0.0).is_ok());

    let lit = |range: &str| {
        triangle().gltf(&format!(
            r#""extensions":{{"KHR_lights_punctual":{{"lights":[{{"type":"point","range":{range}}}]}}}},
            "nodes":[{{"mesh":0,"name":"lamp","extensions":{{"KHR_lights_punctual":{{"light":0}}}}}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}]"#
        ))
    };
    for range in ["0", "-2"] {
        assert_named("a range", load(&lit(range), 0.0), "`lamp`: its range");
    }
    assert!(load(&lit("2"), 0.0).is_ok());
}

#[test]
fn a_few_bytes_do_not_become_gigabytes() {
    let mut builder = triangle();
    let sparse = builder.raw_accessor(
        r#"{"componentType":5126,"count":4000000000,"type":"VEC3","sparse":{"count":1,
        "indices":{"bufferView":1,"componentType":5123},"values":{"bufferView":0}}}"#,
    );
    let text = builder.gltf(&primitive(&format!(r#""attributes":{{"POSITION":{sparse}}}"#)));
    let begin = Instant::now();
    assert_named("zeros", load(&text, 0.0), "mesh `corner`");
    let text = builder.gltf(&primitive(r#""attributes":{"POSITION":0}"#)).replace("4000000000", "2000000");
    let text = text.replacen(r#""mesh":0"#, &format!(r#""mesh":0,"extensions":{{"EXT_mesh_gpu_instancing":{{"attributes":{{"TRANSLATION":{sparse}}}}}}}"#), 1);
    assert_named("instances", load(&text, 0.0), "instances of node 0");
    assert!(begin.elapsed() < PATIENCE);
}

#[test]
fn truncated_files_are_named() {
    let whole = triangle().glb(ONE_MESH);
    assert!(load_bytes("test.glb", &whole, 0.0).is_ok());
    for length in 0..whole.len() {
        assert_named("truncated", load_bytes("test.glb", &whole[..length], 0.0), "");
    }
    let mut short = whole;
    short[8..12].copy_from_slice(&5u32.to_le_bytes());
    assert_named("header", load_bytes("test.glb", &short, 0.0), "header");
}

#[test]
fn what_a_file_refers_to_is_named() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("test.gltf");
    let try_with = |text: &str| {
        write(folder.path(), "test.gltf", text);
        Scene::load(&path, 0.0).expect_err(text).to_string()
    };
    let embedded = triangle().gltf(ONE_MESH);
    let begin = embedded.find("data:").expect("a data URI");
    let end = begin + embedded[begin..].find('"').expect("its end");
    let with_buffer = |uri: &str| [&embedded[..begin], uri, &embedded[end..]].concat();
    assert!(try_with(&with_buffer("gone%20away.bin")).contains("gone away.bin"));
    for elsewhere in ["../a.bin", "%2e%2e/a.bin", "/etc/hostname"] {
        assert!(try_with(&with_buffer(elsewhere)).contains("leads out of the folder"), "{elsewhere}");
    }
    assert!(try_with(&with_buffer("https://example.org/a.bin")).contains("example.org"));
    #[cfg(unix)]
    {
        // A link in the folder stands for what it leads to, which must be a file.
        std::os::unix::fs::symlink("/dev/zero", folder.path().join("zero")).expect("a link");
        assert!(try_with(&with_buffer("zero")).contains("zero: is not a plain file"));
    }
    write(folder.path(), "short.bin", [0; 10]);
    assert!(try_with(&with_buffer("short.bin")).contains("buffer 0 is truncated: 10 bytes"));

    let textured = |uri: &str| {
        triangle().gltf(&format!(
            r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"material":0}}]}}],
            "materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}}}}],
            "textures":[{{"source":0}}],"images":[{{"uri":"{uri}","name":"bark"}}]"#
        ))
    };
    let image = png(8, 8, &[[1, 2, 3]; 64]);
    write(folder.path(), "whole.png", &image);
    write(folder.path(), "test.gltf", textured("whole.png"));
    assert!(Scene::load(&path, 0.0).is_ok());
    assert!(try_with(&textured("gone.png")).contains("gone.png"));
    write(folder.path(), "half.png", &image[..image.len() / 2]);
    assert!(try_with(&textured("half.png")).contains("image 0 `half.png` is a damaged image"));
    write(folder.path(), "text.png", "not an image");
    assert!(try_with(&textured("text.png")).contains("`text.png` is no PNG, JPEG, BMP, TGA or KTX2"));
    let embedded = format!("data:image/png;base64,{}", base64(&image[..40]));
    assert!(try_with(&textured(&embedded)).contains("image 0 `bark` is a damaged image"));
    // A signature and a header that asks for 2^31 by 2^31 texels.
    let mut absurd = image.clone();
    absurd[16..24].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff]);
    write(folder.path(), "absurd.png", &absurd);
    assert!(try_with(&textured("absurd.png")).contains("absurd.png"));
}

/// Faults that the validator of the crate `gltf` does not know, each in a file that is sound without it.
#[test]
fn faults_of_what_is_not_shown_are_named() {
    let sound = |more: &str, views: &str, extra: &str| {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"uri":"data:application/octet-stream;base64,{}","byteLength":36}}],
            "bufferViews":[{{"buffer":0,"byteLength":36}}{views}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
            "nodes":[{{"mesh":0}},{{"children":[2]}},{{"name":"hand"}}{extra}],"scenes":[{{"nodes":[0]}}]{more}}}"#,
            base64(&[0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].map(f32::to_le_bytes).concat())
        )
    };
    load(&sound("", "", ""), 0.0).expect("sound");
    load(&sound(r#","skins":[{"joints":[2],"skeleton":1}]"#, "", ""), 0.0).expect("sound");
    for (more, views, extra, expected) in [
        (
            "",
            r#",{"buffer":0,"byteOffset":4,"byteLength":33}"#,
            "",
            "bufferViews[1]: 33 bytes from 4 on, in the 36",
        ),
        (
            "",
            r#",{"buffer":0,"byteLength":4,"byteStride":256}"#,
            "",
            "bufferViews[1].byteStride: Invalid value",
        ),
        (
            "",
            r#",{"buffer":0,"byteLength":4,"byteStride":8}"#,
            "",
            "bufferViews[1].byteStride: 8 in a view of 4 bytes",
        ),
        (r#","images":[{}]"#, "", "", "images[0]: neither"),
        (
            r#","images":[{"bufferView":1,"mimeType":"image/png"}]"#,
            r#",{"buffer":0,"byteLength":36,"byteStride":12}"#,
            "",
            "images[0]: buffer view 1 has a stride",
        ),
        (r#","extensionsUsed":["A","B","A"]"#, "", "", "extensionsUsed: A is listed twice"),
        (
            r#","cameras":[{"type":"orthographic","orthographic":{"xmag":0,"ymag":1,"znear":0,"zfar":1}}]"#,
            "",
            "",
            "cameras[0]: a magnification of 0 by 1",
        ),
        ("", "", r#",{"mesh":0,"weights":[1]}"#, "nodes[3].weights: 1 for 0"),
        (
            r#","skins":[{"joints":[2],"inverseBindMatrices":0}]"#,
            "",
            "",
            "skins[0]: accessor 0 holds no matrices",
        ),
        (
            r#","skins":[{"joints":[2,1],"skeleton":2}]"#,
            "",
            "",
            "skins[0].skeleton: node 2 is not above joint 1",
        ),
    ] {
        let error = load(&sound(more, views, extra), 0.0).expect_err(expected).to_string();
        assert!(error.contains(expected), "{error}: not {expected}");
    }
}
