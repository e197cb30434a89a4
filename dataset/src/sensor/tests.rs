//! A small synthetic capture, from its recipe to its pairs and test frames.

use super::*;
use crate::{Dataset, Recipe, TestSet, generate, verify};
use deepshade_shaders::Attribute;
use deepshade_shaders::colour::{LINEAR_OF_SRGB, srgb_byte};
use std::path::Path;

/// A recipe of two frames, with some text replaced.
fn recipe(folder: &Path, split: &str, old: &str, new: &str) -> Result<Recipe, crate::DatasetError> {
    let (family, rest) = match split {
        "train" => ("tabletop", ""),
        _ => ("workbench", "tiles = { samples = 8, one_in = 1, whole_frames = 0 }\n"),
    };
    let text = format!(
        "effect = \"real\"\nsplit = \"{split}\"\nseed = 1\nresolution = {{ height = 48, width = 64 }}\nsamples = 4\n\
         radius = {{ metres = 0.2 }}\nviews_per_scene = 1\n{rest}\
         camera = {{ position = [0.0, 0.75, 0.95], target = [0.0, 0.06, 0.0] }}\n\
         vary = {{ sensor = \"structured-light\" }}\n\
         families = [{{ name = \"{family}\", scenes = 2 }}]\n"
    );
    let path = folder.join(format!("{split}.toml"));
    std::fs::write(&path, text.replace(old, new)).expect("written");
    Recipe::load(&path)
}

/// The share of an image's values that a photograph can have.
fn share_of_bytes(image: &Planes) -> f32 {
    let is_byte = |value: &&f32| {
        // Half floats round by 1/2048.
        (**value - LINEAR_OF_SRGB[srgb_byte(**value) as usize]).abs() <= **value / 1024.0
    };
    image.data().iter().filter(is_byte).count() as f32 / image.data().len() as f32
}

#[test]
fn pairs_are_photographs_with_measured_surfaces_of_one_camera() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    generate(&recipe(folder.path(), "train", "", "").expect("a recipe"), &out).expect("generated");
    assert_eq!(verify(&out).expect("verified").faults, []);
    let dataset = Dataset::open(&out).expect("a dataset");
    let cameras = [0, 1].map(|index| dataset.record(index).camera);
    assert_eq!(cameras[0], cameras[1]);
    let pairs = [0, 1].map(|index| dataset.pair(index).expect("a pair"));
    assert_ne!(pairs[0].gbuffer, pairs[1].gbuffer);
    for pair in &pairs {
        assert_eq!(pair.gbuffer.attributes(), capture::surface::ATTRIBUTES);
        assert!(share_of_bytes(&pair.target) > 0.999);
        let seen = pair.gbuffer.seen().expect("a mask");
        let holes = seen.iter().filter(|seen| !**seen).count() as f32 / seen.len() as f32;
        assert!((0.005..0.4).contains(&holes), "{holes} of the pixels are holes");
        // What the table and the wall are turned to in camera space is most of what is seen.
        let planes = pair.gbuffer.select(&[Attribute::Normal]).expect("normals");
        let axes = cameras[0].rotation.transpose();
        let along = |axis: glam::Vec3| {
            let near = |pixel: usize| {
                let normal = glam::Vec3::from_array(std::array::from_fn(|c| planes.plane(c)[pixel]));
                normal.dot(axis) > 0.97
            };
            (0..planes.pixels()).filter(|pixel| near(*pixel)).count() as f32 / planes.pixels() as f32
        };
        assert!(along(axes * glam::Vec3::Y) > 0.2 && along(axes * glam::Vec3::Z) > 0.1);
        assert!(along(axes * glam::Vec3::NEG_Y) < 0.02);
    }
}

#[test]
fn test_frames_are_measured_too_and_their_truth_is_no_photograph() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    let recipe = recipe(folder.path(), "test", "", "").expect("a recipe");
    let set = TestSet::generate(&recipe, &out).expect("generated");
    let pair = set.pair(0, &set.props().expect("none")).expect("a frame");
    assert!(pair.gbuffer.seen().expect("a mask").iter().any(|seen| !seen));
    assert!(share_of_bytes(&pair.target) < 0.6, "{} are bytes", share_of_bytes(&pair.target));
    let again = set.pair(0, &set.props().expect("none")).expect("a frame");
    assert_eq!(pair, again, "a frame that is rendered again is measured again");
}

#[test]
fn recipes_of_captures_are_checked() {
    let folder = tempfile::tempdir().expect("a folder");
    let refusal =
        |old: &str, new: &str| recipe(folder.path(), "train", old, new).expect_err("refused").to_string();
    assert!(refusal("sensor = \"structured-light\"", "").contains("needs the key `vary.sensor`"));
    assert!(refusal("structured-light", "radar").contains("unknown variant `radar`"));
    assert!(refusal("samples = 4", "samples = 4\nerror = 0.1").contains("`error` is for truth"));
    assert!(refusal("[0.0, 0.75, 0.95]", "[0.0, 0.06, 0.0]").contains("`camera` must be two places"));
    assert!(refusal("[0.0, 0.75, 0.95]", "[nan, 0.75, 0.95]").contains("`camera` must be two places"));
    assert!(refusal("tabletop", "workbench").contains("mixes training and testing"));
}
