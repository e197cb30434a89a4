//! `deepshade compare`: from where, with what in the scene, and into which folder.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn compare(folder: &Path, line: &str) -> Output {
    let common = "compare --scene room:1 --height 32 --width 48 --spp 8 --json figures.json --out report";
    Command::new(env!("CARGO_BIN_EXE_deepshade"))
        .args(common.split(' ').chain(line.split(' ')))
        .current_dir(folder)
        .output()
        .expect("starts")
}

/// Runs it, which must succeed, and gives its figures, the facts of its frame, and what it said on stderr.
fn compared(folder: &Path, line: &str) -> (Value, Value, String) {
    let output = compare(folder, line);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{line}: {said}");
    let json: Value =
        serde_json::from_slice(&std::fs::read(folder.join("figures.json")).expect("read")).expect("JSON");
    assert_eq!(json["details"]["frames"].as_array().map(Vec::len), Some(1), "{line}: one view");
    (json["figures"].clone(), json["details"]["frames"][0]["facts"].clone(), said)
}

#[test]
fn methods_are_compared_from_a_view_of_ones_choice_with_scenes_put_in() {
    let folder = tempfile::tempdir().expect("a folder");
    let view = "--effect ao --methods hbao --quality low --eye 1,1.5,1 --look-at 3,0.5,3";
    let (_, plain, said) = compared(folder.path(), view);
    assert_eq!(plain["camera"], "at (1.00, 1.50, 1.00)");
    assert!(said.contains("radius: ") && said.contains(" % of the diagonal, the default"), "{said}");
    let (_, more, said) =
        compared(folder.path(), &format!("{view} --radius 0.5 --put still-life:1@2,0,2,0.2,30"));
    assert_eq!(
        more["radius"].as_str().and_then(|text| text.split_once(',')).map(|(r, _)| r),
        Some("0.500 m")
    );
    assert!(!said.contains("radius"), "it was stated: {said}");
    let triangles = |facts: &Value| facts["triangles"].as_str().and_then(|text| text.parse::<u32>().ok());
    assert!(triangles(&more) > triangles(&plain), "{more}, {plain}");
    let (_, other, _) = compared(folder.path(), "--effect ao --methods hbao --quality low --view 3");
    assert_ne!(other["camera"], plain["camera"]);
    for (line, named) in [
        ("--eye 1,1,1", "--look-at"),
        ("--eye 1,1,1 --look-at 2,2,2 --views 2", "--views"),
        ("--eye 1,1,1 --look-at 2,2,2 --view 2", "--view"),
        ("--eye 1,1,1 --look-at 1,1,1", "the same point"),
        ("--put sofa.gltf@0,0,0", "sofa.gltf"),
        ("--mean-free-path 0.1", "--mean-free-path means nothing to the effect ao"),
    ] {
        let output = compare(folder.path(), &format!("--effect ao --methods truth {line}"));
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && said.contains(named), "{line}: {said}");
    }
}

#[test]
fn a_mean_free_path_that_is_stated_scatters_farther() {
    let folder = tempfile::tempdir().expect("a folder");
    let blurred = |metres: &str| {
        let line = format!("--effect sss --methods separable --quality low --mean-free-path {metres}");
        compared(folder.path(), &line).0["ssim_light"].as_f64().expect("a number")
    };
    assert_ne!(blurred("0.001"), blurred("0.3"), "truth is another");
}

#[test]
fn a_folder_of_something_else_is_refused_before_any_work() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::create_dir(folder.path().join("report")).expect("made");
    std::fs::write(folder.path().join("report/holiday.png"), "a picture").expect("written");
    let output = compare(folder.path(), "--effect ao --methods truth");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && said.contains("holds `holiday.png` and no report"), "{said}");
    assert!(!folder.path().join("figures.json").exists());
}
