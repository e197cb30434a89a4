//! Broken files of other projects, each with what its table says is wrong with it: Khronos' validator's own
//! cases, and images that once broke decoders.

use crate::{
    build::{triangle, write},
    data::files,
    real_data::data,
};
use deepshade_render::scene::{Scene, SceneError};
use std::path::Path;
use std::time::{Duration, Instant};

/// Longest time that a small file may take.
const PATIENCE: Duration = Duration::from_secs(5);

/// Said of a file that shows nothing, where nothing else is wrong with it here.
const NOTHING_SHOWN: &str = "has no triangle with an area";

/// Each file, the validator's code for what we say is wrong with it, and our words for that. Without a code
/// we say something else than the validator: what is wrong is in extensions that are not read, or in bytes
/// that the files lack. The latter faults have tests of their own beside this one: numbers that are not
/// finite, times that do not increase, joints that are not there.
const SCENES: [(&str, &str, &str); 40] = [
    ("EXT_texture_webp__texture__invalid_image_mime_type.gltf", "", NOTHING_SHOWN),
    ("EXT_texture_webp__texture__undeclared_extension.gltf", "", NOTHING_SHOWN),
    (
        "KHR_animation_pointer__animation__channel__target__invalid_channel_target_path.gltf",
        "",
        "missing field `node`",
    ),
    (
        "KHR_animation_pointer__animation__channel__target__invalid_pointer_syntax.gltf",
        "",
        "missing field `node`",
    ),
    ("KHR_materials_clearcoat__material__no_tangent_space.gltf", "", NOTHING_SHOWN),
    ("KHR_materials_variants__primitive__non_unique.gltf", "", NOTHING_SHOWN),
    ("KHR_mesh_quantization__primitive__non_required.gltf", "", NOTHING_SHOWN),
    ("KHR_mesh_quantization__primitive__unexpected_extension.gltf", "", NOTHING_SHOWN),
    ("accessor__alignment.gltf", "ACCESSOR_TOO_LONG", "accessor 2 reaches past the end of buffer view 0"),
    (
        "accessor__invalid_sparse_count_and_stride.gltf",
        "ACCESSOR_SPARSE_COUNT_OUT_OF_RANGE",
        "accessors[0].sparse: 2 for 1 elements",
    ),
    ("accessor_data__invalid_elements_float.gltf", "", "invalid_elements_float.bin: "),
    ("accessor_data__out_of_range_elements_uint8.gltf", "", "out_of_range_elements_uint8.bin: "),
    ("animation__sampler_output_count_invalid.gltf", "", "missing field `node`"),
    (
        "animation__sampler_output_format_invalid.gltf",
        "ANIMATION_SAMPLER_OUTPUT_ACCESSOR_INVALID_FORMAT",
        "animation 0, channel 0: accessor 1 has 4 components an element where 3 are expected",
    ),
    ("animation_data__invalid_input_values.gltf", "", "invalid_input_values.bin: "),
    ("animation_data__quaternion_non_unit_values.gltf", "", "quaternion_non_unit_values.bin: "),
    (
        "asset__min_version_invalid.gltf",
        "ASSET_MIN_VERSION_GREATER_THAN_VERSION",
        "is glTF 2.0 and needs 2.1",
    ),
    ("buffer__invalid_uri_data.glb", "INVALID_URI", "a data URI is damaged"),
    (
        "buffer__no_bin_chunk.glb",
        "BUFFER_MISSING_GLB_DATA",
        "buffer 0 has no URI, and there is no binary chunk",
    ),
    (
        "buffer__wrong_bytelength.glb",
        "BUFFER_BYTE_LENGTH_MISMATCH",
        "buffer 0 is truncated: 16 bytes where 17 are declared",
    ),
    (
        "buffer_view__invalid_stride_too_big.gltf",
        "BUFFER_VIEW_TOO_BIG_BYTE_STRIDE",
        "bufferViews[0].byteStride: 4 in a view of 1 bytes",
    ),
    ("camera__orthographic_xy.gltf", "CAMERA_XMAG_YMAG_ZERO", "cameras[0]: a magnification of 1 by 0"),
    ("glb__truncated_chunk_header.glb", "GLB_UNEXPECTED_END_OF_CHUNK_HEADER", "failed to fill whole buffer"),
    ("glb__two_empty_bin_chunks.glb", "GLB_UNEXPECTED_FIRST_CHUNK", "was not expecting BIN"),
    ("glb__unaligned_chunk.glb", "GLB_CHUNK_LENGTH_UNALIGNED", "a chunk of 27 bytes, no multiple of 4"),
    ("glb__zero_chunk_header.glb", "GLB_UNKNOWN_CHUNK_TYPE", "unknown chunk type"),
    (
        "image__buffer_view_bytestride.gltf",
        "IMAGE_BUFFER_VIEW_WITH_BYTESTRIDE",
        "images[0]: buffer view 0 has a stride",
    ),
    ("image__empty_object.gltf", "ONE_OF_MISMATCH", "images[0]: neither a URI nor a buffer view"),
    (
        "mesh__indices_bytestride.gltf",
        "MESH_PRIMITIVE_INDICES_ACCESSOR_WITH_BYTESTRIDE",
        "meshes[0].primitives[0].indices: buffer view 0 has a stride",
    ),
    (
        "mesh__invalid_indexed_attribute.gltf",
        "MESH_PRIMITIVE_INVALID_ATTRIBUTE",
        "meshes[0].primitives[0].attributes",
    ),
    (
        "mesh_data__joints_no_weights.gltf",
        "BUFFER_VIEW_TOO_LONG",
        "bufferViews[0]: 32 bytes from 0 on, in the 16 of buffer 0",
    ),
    ("mesh_data__joints_weights_complex.gltf", "", "joints_weights_complex.bin: "),
    ("node__node_loop_scene.gltf", "NODE_PARENT_OVERRIDE", "node 4 has two parents"),
    ("node__node_weights_invalid.gltf", "NODE_WEIGHTS_INVALID", "nodes[0].weights: 2 for 1 morph targets"),
    ("node__unresolved_skin.gltf", "UNRESOLVED_REFERENCE", "nodes[0].skin: Index out of bounds"),
    ("root__duplicate_extension_entry.gltf", "DUPLICATE_ELEMENTS", "KHR_materials_unlit is listed twice"),
    ("root__undefined_used_extensions.gltf", "", "requires the extension KHR_extension"),
    (
        "skin__ibm_invalid_format.gltf",
        "SKIN_IBM_INVALID_FORMAT",
        "skins[0]: accessor 0 holds no matrices of floats",
    ),
    (
        "skin__skeleton_invalid.gltf",
        "SKIN_SKELETON_INVALID",
        "skins[0].skeleton: node 2 is not above joint 0",
    ),
    ("skin__unresolved_joint.gltf", "UNRESOLVED_REFERENCE", "skins[0].joints[0]: Index out of bounds"),
];

/// What is said of images that are PNG files, by words of the data's table, and of others that are none.
const IMAGES: [(&str, &str); 8] = [
    ("PngSuite colour type 1", "Invalid color type 1"),
    ("PngSuite colour type 9", "Invalid color type 9"),
    ("PngSuite incorrect IDAT checksum", "CRC error"),
    ("PngSuite bit depth 0", "Invalid bit depth 0"),
    ("PngSuite missing IDAT", "IDAT or fdAT chunk is missing"),
    ("PngSuite incorrect IHDR checksum", "CRC error"),
    ("fuzz regression, MIT/Apache", "is a damaged image"),
    ("", "is no PNG, JPEG, BMP, TGA or KTX2 image"),
];

/// Columns of a table of the data's, by the file that they are of.
fn table(path: &Path) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(path).expect("the data's table");
    text.lines().skip(1).map(|line| line.split('\t').map(str::to_owned).collect()).collect()
}

#[test]
fn scenes_are_refused_for_what_is_wrong() {
    let Some(folder) = data() else { return };
    let folder = folder.join("malformed/gltf");
    let table = table(&folder.join("expected.tsv"));
    assert_eq!([files(&folder, &["gltf", "glb"]).len(), table.len()], [SCENES.len(); 2]);
    for (name, code, expected) in SCENES {
        let row = table.iter().find(|row| row[0] == name).expect(name);
        assert!(
            code.is_empty() || row[3].split(',').any(|known| known == code),
            "{name}: {code}, {}",
            row[3]
        );
        let said = refused(&folder.join(name));
        assert!(said.contains(expected), "{name}: {said}");
    }
}

/// The bytes of one of those files that lack them, made up.
#[test]
fn times_that_do_not_increase_are_named_where_they_are_there() {
    let Some(data) = data() else { return };
    let name = "animation_data__invalid_input_values.gltf";
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join(name);
    std::fs::copy(data.join("malformed/gltf").join(name), &path).expect("a writable temporary folder");
    write(folder.path(), "invalid_input_values.bin", [0; 16]);
    let said = refused(&path);
    assert!(said.contains("animation 0, channel 0: its times do not increase"), "{said}");
}

#[test]
fn images_are_refused_for_what_is_wrong() {
    let Some(folder) = data() else { return };
    let folder = folder.join("malformed/images");
    let table = table(&folder.join("index.tsv"));
    let images = files(&folder, &["bmp", "exr", "hdr", "png", "tga"]);
    assert_eq!([images.len(), table.len()], [28; 2]);
    let scene = tempfile::tempdir().expect("a temporary folder");
    for image in images {
        let name = image.file_name().expect("a file").to_string_lossy().into_owned();
        let row = table.iter().find(|row| row[0] == name).expect("a row of the table");
        let is_png = name.ends_with(".png");
        let of_row = IMAGES.iter().find(|(what, _)| row[2] == *what && is_png || what.is_empty());
        let (_, expected) = of_row.expect("the last one is of all others");
        assert_eq!(is_png, *expected != IMAGES[7].1, "{name}: {}", row[2]);
        std::fs::copy(&image, scene.path().join(&name)).expect("a writable temporary folder");
        let text = triangle().gltf(&format!(
            r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"material":0}}]}}],
            "materials":[{{"normalTexture":{{"index":0}}}}],
            "textures":[{{"source":0}}],"images":[{{"uri":"{name}"}}]"#
        ));
        write(scene.path(), "test.gltf", text);
        let said = refused(&scene.path().join("test.gltf"));
        let is_damaged = !is_png && said.contains("is a damaged image");
        let names_it = said.contains(&format!("image 0 `{name}` "));
        assert!(names_it && (is_damaged || said.contains(expected)), "{name}: {said}");
    }
}

/// Why a file is refused, which must not take long, and must name it.
fn refused(path: &Path) -> String {
    let begin = Instant::now();
    let error = Scene::load(path, 0.0).expect_err("refused");
    assert!(begin.elapsed() < PATIENCE, "{}", path.display());
    let text = error.to_string();
    println!("{}: {text}", path.display());
    match error {
        SceneError::Empty { ref name } => {
            assert_eq!(name.as_str(), path.file_stem().expect("a name"), "{}", path.display());
        }
        _ => {
            let folder = path.parent().expect("a folder").to_string_lossy();
            assert!(text.starts_with(&*folder), "{text}");
        }
    }
    text
}
