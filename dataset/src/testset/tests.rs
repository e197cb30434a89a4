use super::*;
use crate::{StagedScene, data_version};
use deepshade_render::metrics::ssim;
use deepshade_render::path::{Sampling, Shot, render};
use deepshade_render::scene::procedural::{Family, Split};

fn recipe(folder: &Path, tiles: &str) -> Recipe {
    let test = Family::ALL.into_iter().find(|family| family.split() == Split::Test).expect("a family");
    let path = folder.join("test.toml");
    let text = format!(
        "effect = \"ao\"\nsplit = \"test\"\nseed = 7\nresolution = {{ height = 44, width = 64 }}\nsamples = 8\n\
         radius = {{ diagonal = 0.05 }}\nviews_per_scene = 2\n{tiles}\n[[families]]\nname = \"{}\"\nscenes = 2\n",
        test.name()
    );
    std::fs::write(&path, text).expect("written");
    Recipe::load(&path).expect("a sound recipe")
}

fn mean_squared_difference(a: &Planes, b: &Planes) -> f64 {
    let squares = a.data().iter().zip(b.data()).map(|(a, b)| f64::from(a - b).powi(2));
    squares.sum::<f64>() / a.data().len() as f64
}

const TILES: &str = "tiles = { samples = 64, one_in = 4, whole_frames = 1 }";

#[test]
fn tiles_are_a_share_of_the_whole_ones_and_stay_what_they_are() {
    let tiles = tile_indices(3, 44, 64, 4);
    assert_eq!(tiles.len(), 10, "a quarter of 5 x 8");
    assert!(tiles.is_sorted() && tiles.iter().all(|tile| *tile < 40));
    assert_eq!(tile_indices(3, 44, 64, 1), (0..40).collect::<Vec<_>>());
    // Kept test sets rest on this choice: a change of it makes them worthless.
    assert_eq!(tile_indices(1, 64, 64, 8), PINNED);
    // Each tile is chosen in about its share of the frames: four standard deviations are 55.
    let chosen =
        |tile: usize| (0..4_000).filter(|seed| tile_indices(*seed, 44, 64, 4).contains(&tile)).count();
    assert!([0, 17, 39].into_iter().all(|tile| chosen(tile).abs_diff(1_000) < 110));
}

const PINNED: [usize; 8] = [8, 12, 28, 29, 30, 31, 36, 51];

#[test]
fn gathered_tiles_are_windows_of_the_image() {
    let image = Planes::from_fn(2, 44, 64, |c, y, x| (c * 10_000 + y * 100 + x) as f32);
    let strip = gather(&image, &[1, 9, 39]);
    assert_eq!((strip.channels(), strip.height(), strip.width()), (2, 8, 24));
    assert_eq!(strip.window(0, 8, 8, 8), image.window(8, 8, 8, 8));
    assert_eq!(strip.window(0, 16, 8, 8), image.window(32, 56, 8, 8));
}

#[test]
fn a_test_set_is_resumed_to_the_same_bytes_and_holds_the_truth() {
    let folder = tempfile::tempdir().expect("a folder");
    let recipe = recipe(folder.path(), TILES);
    let out = folder.path().join("out");
    let set = TestSet::generate(&recipe, &out).expect("generated");
    let list = || std::fs::read(out.join(LIST)).expect("read");
    let undisturbed = list();
    std::fs::write(out.join(&set.frames()[1].tiles.file), b"noise").expect("damaged");
    TestSet::generate(&recipe, &out).expect("mended");
    assert!(list() == undisturbed);

    let set = TestSet::open(&out).expect("opened");
    let wholes = set.frames().iter().filter(|frame| frame.whole.is_some()).count();
    assert_eq!((set.frames().len(), wholes), (4, 1));
    for index in 0..4 {
        let record = &set.frames()[index];
        let frame = set.frame(index).expect("a frame");
        let scene = record.scene.load(&recipe.folder).expect("a scene");
        let shot = Shot::new(&scene, &record.camera, [44, 64], record.radius);
        let image = render(recipe.effect, &shot, Sampling::one(512, 99)).mean;
        let better = gather(&image, &frame.tiles);
        // 512 samples in one sequence are hardly away from what is true, so truth is away from them by its
        // noise.
        let distance = mean_squared_difference(&better, &frame.truth);
        assert!((0.5..2.0).contains(&(distance / record.ceiling.variance)), "{distance}");
        assert!(ssim(&better, &frame.truth) > record.ceiling.ssim && record.ceiling.ssim < 1.0);
        // Tiles of another frame's choice are something else.
        let shifted: Vec<usize> = frame.tiles.iter().map(|tile| (tile + 1) % 40).collect();
        let wrong = gather(&image, &shifted);
        assert!(mean_squared_difference(&wrong, &frame.truth) > 4.0 * record.ceiling.variance);
    }
}

#[test]
fn a_changed_image_and_an_absurd_list_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    let set = TestSet::generate(&recipe(folder.path(), TILES), &out).expect("generated");
    // A sound image of another frame in the place of this one.
    let [first, second] = [0, 1].map(|index: usize| out.join(&set.frames()[index].tiles.file));
    std::fs::copy(&second, &first).expect("replaced");
    let error = set.frame(0).expect_err("another image").to_string();
    assert!(error.contains("its hash is"), "{error}");
    assert!(set.frame(1).is_ok());

    let path = out.join(LIST);
    let sound = std::fs::read_to_string(&path).expect("read");
    let version = format!("\"data_version\": {}", data_version(deepshade_shaders::Effect::Ao));
    for (old, new, what) in [
        ("\"one_in\": 4", "\"one_in\": 0", "`tiles.one_in` must be 1 to 64"),
        ("\"width\": 64", "\"width\": 99999999999", "`resolution.width` must be"),
        (version.as_str(), "\"data_version\": 99", "data of version 99"),
    ] {
        assert!(sound.contains(old), "{old}");
        std::fs::write(&path, sound.replacen(old, new, 1)).expect("written");
        let error = TestSet::open(&out).expect_err("absurd").to_string();
        assert!(error.contains("testset.json") && error.contains(what), "{error}");
    }
}

#[test]
fn pixels_beyond_the_last_whole_tile_are_in_none() {
    let (height, width) = (20, 29);
    let all: Vec<usize> = (0..6).collect();
    let wanted = in_tiles(&all, width);
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let inside: Vec<(usize, usize)> = pixels.filter(|(x, y)| wanted(*x, *y)).collect();
    assert_eq!(inside.len(), 6 * TILE * TILE);
    assert!(inside.iter().all(|(x, y)| *x < 24 && *y < 16));
    assert!(in_tiles(&[4], width)(8, 8) && !in_tiles(&[3], width)(24, 0));
}

#[test]
fn a_recipe_without_tiles_is_refused_and_an_estimate_needs_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let without = recipe(folder.path(), "");
    let error = TestSet::generate(&without, &folder.path().join("out")).expect_err("no tiles").to_string();
    assert!(error.contains("needs the table `tiles`"), "{error}");
    assert!(TestSet::estimate(&without).is_err());
    let train = Recipe { split: Split::Train, ..recipe(folder.path(), TILES) };
    let error = TestSet::generate(&train, &folder.path().join("out")).expect_err("training").to_string();
    assert!(error.contains("test.toml: `split` says training"), "{error}");
    assert!(TestSet::estimate(&train).is_err());
    let estimate =
        |tiles: &str| TestSet::estimate(&recipe(folder.path(), tiles)).expect("an estimate").as_secs_f64();
    assert!(estimate(&TILES.replace("64", "65536")) > estimate(TILES));
}

#[test]
fn test_sets_of_other_effects_hold_what_their_frames_were_given() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("dof.toml");
    let text = "effect = \"dof\"\nsplit = \"test\"\nseed = 7\nresolution = { height = 24, width = 32 }\nsamples = 4\n\
                radius = { diagonal = 0.05 }\nviews_per_scene = 2\n\
                tiles = { samples = 256, one_in = 4, whole_frames = 1 }\n\
                vary = { materials = true, light = true, lens = [1.0, 3.0] }\n\
                families = [{ name = \"drapery\", scenes = 1 }]\n";
    std::fs::write(&path, text).expect("written");
    let recipe = Recipe::load(&path).expect("a sound recipe");
    let set = TestSet::generate(&recipe, &folder.path().join("out")).expect("generated");
    let props = set.props().expect("nothing to load");
    for (index, record) in set.frames().iter().enumerate() {
        let frame = set.frame(index).expect("a frame");
        let variation = record.variation.as_ref().expect("a lamp");
        assert!(variation.lamp.is_some() && record.camera.lens.is_some());
        let staged = StagedScene::load(&record.scene, set.recipe(), &props).expect("a scene");
        let distance = |camera: &Camera, variation: &Variation| {
            let scene = staged.shown(camera, Some(variation)).expect("shown");
            let shot = Shot::new(&scene, camera, [24, 32], record.radius);
            let image = gather(&render(recipe.effect, &shot, Sampling::one(64, 99)).mean, &frame.tiles);
            // The lamp's reflection in a glossy surface is not to outshine all else.
            let compressed = |value: &f32| value / (1.0 + value);
            let pairs = image.data().iter().zip(frame.truth.data());
            pairs.map(|(a, b)| (compressed(a) - compressed(b)).abs()).sum::<f32>()
        };
        let own = distance(&record.camera, variation);
        let lamp = set.frames()[1 - index].variation.expect("a lamp").lamp;
        let sharp = Camera { lens: None, ..record.camera };
        let others = [
            ("materials", distance(&record.camera, &Variation { seed: 1, ..*variation })),
            ("lamp", distance(&record.camera, &Variation { lamp, ..*variation })),
            ("lens", distance(&sharp, variation)),
        ];
        for (what, other) in others {
            assert!(other > 1.5 * own, "another {what}: {other}, where the noise is {own}");
        }
    }
}
