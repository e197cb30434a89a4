//! Statements one by one.

use super::*;
use std::path::Path;

const CORNERS: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\n";

/// What a text holds, and what is said of it.
fn read(text: &str) -> (Obj, Vec<String>) {
    let mut warnings = Warnings::default();
    let obj = parse(text, 9, &mut warnings).expect("a sound file");
    (obj, warnings.about(Path::new("a")))
}

fn refusal(text: &str, most: usize) -> String {
    parse(text, most, &mut Warnings::default()).expect_err("refused")
}

#[test]
fn faces_in_range_pass() {
    for face in ["f 1 2 3", "f -3 -2 -1", "f 1//1 2//1 3//-1", "f\t1/ 2/ 3/", "f 1 2 4\nv 2 2 2", "fo 1 2 3"]
    {
        let (obj, warnings) = read(&format!("{CORNERS}{face}"));
        assert_eq!((obj.runs[0].sides.as_slice(), warnings.len()), (&[3][..], 0), "{face}");
    }
    assert!(read(&format!("{CORNERS}# f 9 9 9")).0.runs.is_empty());
}

#[test]
fn faces_out_of_range_are_named_with_their_line() {
    for word in ["0", "4", "-4", "1//1/1", "/1", "x", "1/x", "6148914691236517206", "-9223372036854775808"] {
        let error = refusal(&format!("{CORNERS}f 1 2 {word}"), 9);
        assert_eq!(error, format!("line 5: there is no vertex `{word}`"));
    }
}

#[test]
fn coordinates_and_normals_that_are_not_there_are_none() {
    for word in ["1/0/0", "1/1", "1//2", "1//-2", "1/-1/1", "1//6148914691236517206"] {
        let (obj, warnings) = read(&format!("{CORNERS}f 1/ 2 {word}\n"));
        let corner = obj.runs[0].corners[2];
        let normal = if word.ends_with("/1") && word != "1/1" { 0 } else { NONE };
        assert_eq!(corner, Corner { position: 0, uv: NONE, normal }, "{word}");
        let what = "a texture coordinate or a normal that is not there is left out of a face";
        assert_eq!(warnings, [format!("a: line 5: {what}")], "{word}");
    }
}

#[test]
fn comments_need_no_space_before_them() {
    let (obj, warnings) = read("v 0 0 0# a\nv 1 0 0 #b\nv 0 1 0#\nvt 1 0#c\nf 1 2 3#front \\\nf 1 2 3\n");
    assert_eq!((obj.positions.len(), obj.runs[0].sides.as_slice()), (3, &[3, 3][..]));
    assert!(warnings.is_empty(), "{warnings:?}");
}

#[test]
fn names_keep_what_may_be_a_comment() {
    let (obj, _) =
        read(&format!("mtllib a #1.mtl\n{CORNERS}usemtl m #1\no box #2\nf 1 2 3\nusemtl # none\n"));
    assert_eq!((obj.libraries[0].name.as_str(), obj.runs[0].name.as_str()), ("a #1.mtl", "box #2"));
    assert_eq!(obj.materials, [Named { name: "m #1".to_owned(), line: 6 }]);
    let (obj, warnings) = read(&format!("{CORNERS}usemtl # none\nf 1 2 3\n"));
    assert_eq!((obj.materials[0].name.as_str(), warnings.len()), ("", 0), "the libraries' only one");
}

#[test]
fn reading_stops_where_memory_holds_no_more_triangles() {
    let text = format!("{CORNERS}f 1 2 3\nl 1 2 3 1\nf 1 2 3 1 2\n");
    assert_eq!(parse(&text, 4, &mut Warnings::default()).expect("four").runs[0].sides, [3, 5]);
    assert_eq!(refusal(&text, 3), "line 7: there are more triangles than the 3 that memory holds");
}

#[test]
fn lines_and_points_are_no_faces() {
    let (obj, warnings) = read(&format!("{CORNERS}l 1 2 3\nl 1 2 3 1 2\np 1\nf 1 2 3\n"));
    assert_eq!((obj.runs.len(), obj.runs[0].sides.as_slice()), (1, &[3][..]));
    assert_eq!(warnings, ["a: line 5 and 2 others: lines and points have no surface and are left out"]);
}

#[test]
fn colours_stay_with_their_vertices() {
    let text = "v 0 0 0\nv 1 0 0 0.5 0 0\nv 0 1 0 2\nv 1 1 0 0 1 0 0.25\nv 2 2 2\n";
    let (obj, warnings) = read(text);
    let has: Vec<bool> = obj.colours.iter().map(|colour| !colour.is_nan()).collect();
    assert_eq!(has, [false, true, false, true, false]);
    assert_eq!(
        [obj.colours[1], obj.colours[3]],
        [Vec4::new(0.5, 0.0, 0.0, 1.0), Vec4::new(0.0, 1.0, 0.0, 0.25)]
    );
    assert!(warnings.is_empty() && read(CORNERS).0.colours.is_empty());
}

#[test]
fn a_vertex_without_a_position_is_refused_and_what_is_odd_behind_it_is_said() {
    assert_eq!(refusal("v 0 0 0\nv 1 x 0\n", 9), "line 2: `v 1 x 0` is no position of three numbers");
    let (obj, warnings) = read("v 1 2 3 4 5\nv 1 2 3 red\nv 1 2 3 1 1 1 1 1\n");
    assert_eq!((obj.positions.len(), warnings.len()), (3, 1));
    assert!(warnings[0].starts_with("a: line 1 and 2 others: "), "{warnings:?}");
}

#[test]
fn coordinates_may_be_of_one_number_and_what_is_none_is_zero() {
    let (obj, warnings) = read("vt 0.5\nvt 0.25 0.75 3\n");
    assert_eq!((obj.uvs, warnings.len()), (vec![Vec2::new(0.5, 0.0), Vec2::new(0.25, 0.75)], 0));
    let (obj, warnings) = read("vt\nvt x 1\nvn 0 1\nvn nan 0 1\n");
    assert_eq!(obj.uvs, [Vec2::ZERO, Vec2::Y]);
    assert_eq!(obj.normals, [Vec3::Y, Vec3::Z]);
    assert_eq!(warnings.len(), 2, "{warnings:?}");
}

#[test]
fn materials_and_objects_begin_runs() {
    let faces = "usemtl a\no first\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl\nf 1 2 3\ng second\nf 1 2 3\n";
    let (obj, warnings) = read(&format!("mtllib x.mtl y.mtl\n{CORNERS}{faces}"));
    let runs: Vec<_> =
        obj.runs.iter().map(|run| (run.name.as_str(), run.material, run.sides.len())).collect();
    assert_eq!(runs, [("first", Some(0), 1), ("first", Some(1), 3), ("second", Some(1), 1)]);
    assert_eq!(obj.materials[1], Named { name: "b".to_owned(), line: 9 });
    assert_eq!(obj.libraries, [Named { name: "x.mtl y.mtl".to_owned(), line: 1 }]);
    assert_eq!(warnings, ["a: line 13: `usemtl` without a name is passed over"]);
}

#[test]
fn strange_lines_are_passed_over() {
    let (obj, warnings) =
        read(&format!("{CORNERS}s off\nhello world\nhello\nf 1 2\nf 1 2 3\ncurv 0 1 1 2\n"));
    assert_eq!(obj.runs[0].sides, [3]);
    assert_eq!(warnings.len(), 3, "{warnings:?}");
    assert_eq!(warnings[0], "a: line 6 and another: `hello` is passed over");
}
