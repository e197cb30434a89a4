//! Compressed files give what they were made from, as far as the compression keeps it. Streams that are cut
//! are refused, and changed ones do not make the loader panic.

mod files;

use crate::build::{base64, load};
use crate::real_data::data;
use deepshade_render::scene::{Mesh, Scene};
use files::{DRACO, MESHOPT, View, bytes, draco, meshopt, views};
use glam::{Quat, Vec2, Vec3, Vec4};
use std::collections::BTreeSet;
use std::f32::consts::FRAC_PI_3;

/// Vertices along an edge of the grid that all streams are of. Vertex `i` has x and y of `i % 4` and `i / 4`
/// and lies on z = x y / 4; coordinates run from 0 to 1, and the colour is (u, v, 1, 1).
const EDGE: u32 = 4;

/// That a mesh is the grid, within the steps of positions, coordinates and colours, and of normals.
fn assert_is_grid(mesh: &Mesh, step: f32, step_of_normals: f32) {
    let place = |vertex: u32| mesh.positions[vertex as usize].round().as_uvec3();
    let found = mesh.triangles.iter().map(|corners| {
        let mut corners = corners.map(|corner| place(corner).x + EDGE * place(corner).y);
        let least = (0..3).min_by_key(|corner| corners[*corner]).expect("three");
        corners.rotate_left(least);
        corners
    });
    let cells = (0..EDGE - 1).flat_map(|y| (0..EDGE - 1).map(move |x| x + EDGE * y));
    let expected = cells.flat_map(|a| [[a, a + 1, a + EDGE], [a + 1, a + 1 + EDGE, a + EDGE]]);
    assert_eq!(found.collect::<BTreeSet<_>>(), expected.collect());
    for (vertex, position) in mesh.positions.iter().enumerate() {
        let (x, y) = (position.x.round(), position.y.round());
        assert!(position.distance(Vec3::new(x, y, 0.25 * x * y)) < step, "{position}");
        let normal = Vec3::new(-0.25 * y, -0.25 * x, 1.0).normalize();
        assert!(
            mesh.normals[vertex].distance(normal) < step_of_normals,
            "{} for {normal}",
            mesh.normals[vertex]
        );
        let uv = Vec2::new(x, y) / 3.0;
        assert!(mesh.uvs[0][vertex].distance(uv) < step, "{} for {uv}", mesh.uvs[0][vertex]);
        let colour = mesh.colours[vertex];
        assert!(colour.distance(Vec4::new(uv.x, uv.y, 1.0, 1.0)) < 4.0 * step, "{colour} for {uv}");
    }
}

#[test]
fn views_by_meshopt_are_what_they_were_made_from() {
    for (extension, streams) in &MESHOPT {
        let tagged = format!(r#","extensions":{{"{extension}":{{"fallback":true}}}}"#);
        for fallback in ["", &tagged, r#","uri":"gone.bin""#] {
            let scene = load(&meshopt(extension, &views(streams), fallback), 0.0).expect(extension);
            assert_eq!(scene.warnings, [""; 0]);
            assert_eq!(scene.meshes.len(), 3);
            let [strip, grid, turned] = [0, 1, 2].map(|index| &scene.meshes[index]);
            assert_is_grid(grid, 0.002, 0.02);
            let turn = Quat::from_rotation_y(FRAC_PI_3);
            for (vertex, position) in turned.positions.iter().enumerate() {
                assert!(position.distance(turn * grid.positions[vertex]) < 0.005, "{position}");
            }
            assert_eq!(strip.triangles.len(), 6);
        }
    }
}

#[test]
fn primitives_by_draco_are_what_they_were_made_from() {
    for stream in DRACO {
        let scene = load(&draco(&bytes(stream)), 0.0).expect("a grid");
        assert_eq!(scene.meshes.len(), 1);
        assert_is_grid(&scene.meshes[0], 0.002, 0.02);
    }
}

#[test]
fn a_box_by_draco_is_the_box() {
    let Some(folder) = data() else { return };
    let load = |name: &str| Scene::load(&folder.join("gltf_conformance").join(name), 0.0).expect(name);
    let (packed, plain) = (load("Box-Draco/Box.gltf"), load("Box/Box.gltf"));
    let near = |a: Vec3, b: Vec3| a.abs_diff_eq(b, 0.001);
    assert!(near(packed.bounds().min, plain.bounds().min) && near(packed.bounds().max, plain.bounds().max));
    let [packed, plain] = [&packed.meshes[0], &plain.meshes[0]];
    let corners = |mesh: &Mesh| {
        let corners = mesh.triangles.iter().flatten().map(|corner| *corner as usize);
        corners.map(|corner| (mesh.positions[corner], mesh.normals[corner])).collect::<Vec<_>>()
    };
    let (packed, mut plain) = (corners(packed), corners(plain));
    assert_eq!(packed.len(), 36);
    for (position, normal) in packed {
        let same = plain.iter().position(|plain| near(plain.0, position) && normal.distance(plain.1) < 0.02);
        plain.swap_remove(same.expect("each corner of the box, once"));
    }
    assert!(plain.is_empty());
}

/// Makes a file with a stream in one of its places.
type With = Box<dyn Fn(&[u8]) -> String>;

/// Each stream, and how to make a file of another one in its place.
fn all_files() -> Vec<(Vec<u8>, With)> {
    let mut files: Vec<(Vec<u8>, With)> = Vec::new();
    for (extension, streams) in &MESHOPT {
        let all = views(streams);
        for (index, View { stream, .. }) in all.iter().enumerate() {
            let all = all.clone();
            let with = move |stream: &[u8]| {
                let mut all = all.clone();
                all[index].stream = stream.to_vec();
                meshopt(extension, &all, "")
            };
            files.push((stream.clone(), Box::new(with)));
        }
    }
    files.extend(DRACO.map(|stream| (bytes(stream), Box::new(draco) as With)));
    files
}

#[test]
fn cut_streams_are_refused() {
    for (stream, with) in all_files() {
        assert!(load(&with(&stream), 0.0).is_ok());
        for length in 0..stream.len() {
            let error = load(&with(&stream[..length]), 0.0).expect_err("a cut stream").to_string();
            assert!(error.contains("test.gltf"), "{length} of {}: {error}", stream.len());
        }
    }
}

#[test]
fn changed_streams_do_not_panic() {
    let mut read = 0;
    for (stream, with) in all_files() {
        for at in 0..stream.len() {
            for value in [0, 0xff, stream[at] ^ 1] {
                let mut changed = stream.clone();
                changed[at] = value;
                read += usize::from(load(&with(&changed), 0.0).is_ok());
            }
        }
    }
    assert!(read > 0);
}

#[test]
fn extensions_that_lie_are_named() {
    let (extension, streams) = &MESHOPT[0];
    let packed = meshopt(extension, &views(streams), "");
    let length = format!(r#""byteLength":{},"#, streams[0].len() / 2);
    for (from, to, expected) in [
        (r#""buffer":0,"#, r#""buffer":9,"#, "bufferViews[0], compressed: there is no buffer 9"),
        (r#""buffer":0,"#, "", "bufferViews[0]: EXT_meshopt_compression: missing field `buffer`"),
        (r#""count":16,"mode""#, r#""count":17,"mode""#, "17 elements of 12 bytes in a view of 192"),
        (r#""count":16,"mode""#, r#""count":18446744073709551615,"mode""#, "elements of 12 bytes in a view"),
        ("ATTRIBUTES", "VERTICES", "unknown variant `VERTICES`"),
        ("EXPONENTIAL", "LINEAR", "unknown variant `LINEAR`"),
        (
            r#""TRIANGLES","filter":"NONE""#,
            r#""TRIANGLES","filter":"COLOR""#,
            "the filter Color for Triangles",
        ),
        (&length, r#""byteLength":9999,"#, "bufferViews[0], compressed: 9999 bytes from 0 on, in the"),
    ] {
        assert_refused(&packed, from, to, expected);
    }
    let packed = draco(&bytes(DRACO[0]));
    let at = "meshes[0].primitives[0]: KHR_draco_mesh_compression: ";
    for (from, to, expected) in [
        (r#"{"bufferView":0,"#, r#"{"bufferView":1,"#, "there is no buffer view 1"),
        (r#"{"bufferView":0,"#, "{", "missing field `bufferView`"),
        (
            r#""NORMAL":1,"TEXCOORD_0":2,"COLOR_0":3}}}"#,
            r#""NORMAL":7}}}"#,
            "NORMAL: the stream has no attribute 7",
        ),
        (
            r#""NORMAL":1,"TEXCOORD_0":2,"COLOR_0":3}}}"#,
            r#""NORMAL":2}}}"#,
            "NORMAL: the stream has 2 components an element, the accessor 3",
        ),
    ] {
        assert_refused(&packed, from, to, &format!("{at}{expected}"));
    }
}

fn assert_refused(good: &str, from: &str, to: &str, expected: &str) {
    assert!(good.contains(from), "{from}");
    let error = load(&good.replacen(from, to, 1), 0.0).expect_err(expected).to_string();
    assert!(error.contains("test.gltf") && error.contains(expected), "{error}: not {expected}");
}

#[test]
fn kilobytes_do_not_become_gigabytes() {
    // 16 MiB of zeros: for each 256 elements of four bytes a byte that says that none changes.
    let stream = [&[0xa1][..], &[0xaa; 16_384], &[0; 24]].concat();
    let view = format!(
        r#"{{"buffer":1,"byteLength":16777216,"extensions":{{"KHR_meshopt_compression":{{"buffer":0,
        "byteLength":{},"byteStride":4,"count":4194304,"mode":"ATTRIBUTES"}}}}}}"#,
        stream.len()
    );
    let with = |views: usize| {
        let text = format!(
            r#"{{"asset":{{"version":"2.0"}},"bufferViews":[{}],"buffers":[{{"byteLength":{},
            "uri":"data:application/octet-stream;base64,{}"}},{{"byteLength":16777216}}]}}"#,
            vec![view.as_str(); views].join(","),
            stream.len(),
            base64(&stream),
        );
        load(&text, 0.0).expect_err("nothing to show").to_string()
    };
    assert!(with(2).contains("no triangle"), "{}", with(2));
    let refused = "bufferViews[2], compressed: decodes to more than a file of this size may";
    assert!(with(3).contains(refused), "{}", with(3));
}
