//! Datasets of a capture of a few small frames.

use crate::{Dataset, Recipe, contact_sheet, generate, verify};
use deepshade_shaders::Attribute;
use deepshade_shaders::colour::LINEAR_OF_SRGB;
use image::{ImageBuffer, Luma, Rgb};
use std::fs;
use std::path::Path;

/// Writes a capture of five frames of 40 x 32 pixels in Open3D's layout: a wall, nearer from frame to frame,
/// with a hole.
fn write_capture(folder: &Path) {
    for name in ["color", "depth"] {
        fs::create_dir_all(folder.join(name)).expect("made");
    }
    for frame in 0..5u16 {
        let depth = ImageBuffer::from_fn(40, 32, |x, _| Luma([if x < 12 { 0 } else { 2000 - 100 * frame }]));
        depth.save(folder.join(format!("depth/{frame}.png"))).expect("written");
        let colour = ImageBuffer::from_pixel(40, 32, Rgb([50 * frame as u8, 128, 255]));
        colour.save(folder.join(format!("color/{frame}.png"))).expect("written");
    }
    let camera = "{\"width\": 40, \"height\": 32, \"intrinsic_matrix\": [40, 0, 0, 0, 40, 0, 19.5, 15.5, 1]}";
    fs::write(folder.join("camera_intrinsic.json"), camera).expect("written");
}

/// A recipe of three frames of the capture beside it, with some text replaced.
fn recipe(folder: &Path, old: &str, new: &str) -> Result<Recipe, crate::DatasetError> {
    let text = "effect = \"real\"\nsplit = \"train\"\nseed = 1\nresolution = { height = 16, width = 16 }\nsamples = 1\n\
                radius = { metres = 0.2 }\nviews_per_scene = 3\nvalidation_share = 0.3\ncaptures = [\"desk\"]\n";
    let path = folder.join("real.toml");
    fs::write(&path, text.replace(old, new)).expect("written");
    Recipe::load(&path)
}

#[test]
fn frames_of_a_capture_become_pairs() {
    let folder = tempfile::tempdir().expect("a folder");
    write_capture(&folder.path().join("desk"));
    let recipe = recipe(folder.path(), "", "").expect("a recipe");
    let out = folder.path().join("out");
    assert_eq!(generate(&recipe, &out).expect("generated").rendered, 3);
    assert_eq!(verify(&out).expect("verified").faults, []);
    let dataset = Dataset::open(&out).expect("a dataset");
    assert_eq!((dataset.training().len(), dataset.validation().len()), (2, 1));
    assert_eq!(dataset.record(0).scene.to_string(), "capture:desk");
    // Of five frames the first, the second and the fourth; every second pixel of the middle 32 columns.
    for (index, frame) in [(0, 0u8), (1, 1), (2, 3)] {
        let pair = dataset.pair(index).expect("a pair");
        assert!((pair.target.at(0, 3, 3) - LINEAR_OF_SRGB[50 * frame as usize]).abs() < 1e-3);
        assert!((pair.target.at(2, 9, 9) - 1.0).abs() < 1e-6);
        let seen = pair.gbuffer.seen().expect("a mask");
        assert!((0..16).all(|x| seen[16 * 8 + x] == (x >= 4)), "the hole is the left quarter");
        let position = pair.gbuffer.select(&[Attribute::Position]).expect("positions");
        assert!((position.at(2, 8, 8) + 2.0 - 0.1 * f32::from(frame)).abs() < 2e-3);
        let normal = pair.gbuffer.select(&[Attribute::Normal]).expect("normals");
        assert!(normal.at(2, 8, 8) > 0.999);
    }
    let sheet = folder.path().join("sheet.png");
    contact_sheet(&dataset, &[0, 1, 2], &sheet).expect("drawn");

    // What was made stays what it is; another capture in its place is other data.
    assert_eq!(generate(&recipe, &out).expect("whole").rendered, 0);
    let file = folder.path().join("desk/color/0.png");
    ImageBuffer::from_pixel(40, 32, Rgb([1u8, 2, 3])).save(&file).expect("written");
    let error = generate(&recipe, &out).expect_err("other data").to_string();
    assert!(error.contains("the scene files have other contents"), "{error}");
}

#[test]
fn what_captures_cannot_give_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    write_capture(&folder.path().join("desk"));
    let refusal = |old: &str, new: &str| {
        let made =
            recipe(folder.path(), old, new).and_then(|recipe| generate(&recipe, &folder.path().join("no")));
        made.expect_err("refused").to_string()
    };
    assert!(refusal("\"real\"", "\"path\"").contains("for effect `real`, not for `path`"));
    assert!(refusal("\"train\"", "\"test\"").contains("`captures` are for training"));
    assert!(refusal("metres", "diagonal").contains("`radius.diagonal` is for scenes"));
    assert!(refusal("seed = 1", "seed = 1\nvary = { light = true }").contains("`vary` is for scenes"));
    let families = "seed = 1\nfamilies = [{ name = \"tabletop\", scenes = 1 }]";
    assert!(refusal("seed = 1", families).contains("`families` is for scenes"));
    assert!(refusal("scene = 3", "scene = 6").contains("has 5 frames where `views_per_scene` is 6"));
    assert!(refusal("width = 16", "width = 64").contains("has 40 x 32 pixels where 64 x 16 are wanted"));
    assert!(refusal("desk", "attic").contains("attic: holds neither"));
    assert!(!folder.path().join("no/manifest.json").exists());
}
