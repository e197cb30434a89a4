//! The recipes that come with the project, made small: each must give data.

use crate::generate::generate_by;
use crate::recipe::{Recipe, Resolution};
use crate::target::QUALITY;
use crate::testset::TestSet;
use crate::{Dataset, StagedScene, TargetMethod, contact_sheet, test_sheet, verify};
use deepshade_render::methods::disks::Disks;
use deepshade_render::methods::{ssgi, surfel};
use deepshade_render::scene::procedural::Split;
use deepshade_render::screen::ScreenMethod;
use deepshade_shaders::gpu::Gpu;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A shipped recipe by the name of its file, with two tiny images of one of its scenes and few samples.
pub fn shrunk(name: &str) -> Recipe {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("recipes").join(name);
    let mut recipe = Recipe::load(&path).expect("a sound recipe");
    let words: usize = name.bytes().map(usize::from).sum();
    // Another family or file for each recipe.
    if !recipe.families.is_empty() {
        let chosen = words % recipe.families.len();
        recipe.families = vec![recipe.families[chosen].clone()];
        recipe.families[0].scenes = 1;
    }
    if !recipe.files.is_empty() {
        let chosen = words % recipe.files.len();
        recipe.files = vec![recipe.files[chosen].clone()];
    }
    recipe.resolution = Resolution { height: 32, width: 32 };
    recipe.smallest.iter_mut().for_each(|size| *size = Resolution { height: 16, width: 24 });
    recipe.samples = 4;
    recipe.views_per_scene = 2;
    recipe.sequence.iter_mut().for_each(|sequence| sequence.frames = 2);
    if recipe.split == Split::Train {
        recipe.validation_share = 0.5;
    }
    if let Some(tiles) = &mut recipe.tiles {
        (tiles.samples, tiles.one_in, tiles.whole_frames) = (16, 2, 1);
    }
    recipe
}

/// The shipped recipes of a split.
fn all(split: Split) -> Vec<Recipe> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("recipes");
    let entries = std::fs::read_dir(folder).expect("recipes");
    let mut names: Vec<_> = entries.map(|entry| entry.expect("a recipe").file_name()).collect();
    names.sort();
    let recipes = names.iter().map(|name| shrunk(name.to_str().expect("a name")));
    let recipes: Vec<Recipe> =
        recipes.filter(|recipe| recipe.split == split).filter_map(with_files).collect();
    assert!(recipes.len() >= 14, "one for each effect at least, not {}", recipes.len());
    recipes
}

/// A recipe whose scene files are there: in the folder that `DEEPSHADE_DATA` names, else beside the
/// workspace.
fn with_files(recipe: Recipe) -> Option<Recipe> {
    if recipe.files.is_empty() {
        return Some(recipe);
    }
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/open");
    let folder = std::env::var_os("DEEPSHADE_DATA").map_or(beside, PathBuf::from).join("scenes");
    let recipe = Recipe { folder, ..recipe };
    let missing = recipe.files.iter().find(|file| !recipe.folder.join(file).is_file());
    if let Some(file) = missing {
        eprintln!("{} is not tested: no {}", recipe.path.display(), recipe.folder.join(file).display());
    }
    missing.is_none().then_some(recipe)
}

/// Contents of all files in a folder and the folders in it, by name.
pub fn contents(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = BTreeMap::new();
    for entry in std::fs::read_dir(folder).expect("listed") {
        let path = entry.expect("an entry").path();
        let name = |path: &Path| path.strip_prefix(folder).expect("inside").to_owned();
        if path.is_dir() {
            files.extend(contents(&path).into_iter().map(|(inner, bytes)| (name(&path).join(inner), bytes)));
        } else {
            files.insert(name(&path), std::fs::read(&path).expect("read"));
        }
    }
    files
}

/// What a recipe gives, after asserting that it is the same by any number of threads.
fn made(recipe: &Recipe, folder: &Path, make: impl Fn(&Path) + Sync) -> PathBuf {
    let name = recipe.path.file_stem().expect("a name").to_str().expect("a name");
    let [one, three] = [1, 3].map(|threads: usize| {
        let out = folder.join(format!("{name}-{threads}"));
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| make(&out));
        out
    });
    assert!(contents(&one) == contents(&three), "{name}");
    one
}

/// The methods that shipped recipes aim at.
struct Targets {
    ssgi: ScreenMethod,
    surfel: ScreenMethod,
}

impl Targets {
    fn new() -> Self {
        let gpu = Gpu::new().expect("an adapter; lavapipe will do");
        Self {
            ssgi: ScreenMethod::new(&gpu, ssgi::SsgiParameters::of(QUALITY)),
            surfel: ScreenMethod::new(
                &gpu,
                Disks::new(surfel::SurfelParameters::of(QUALITY), surfel::occlusion::OCCLUSION),
            ),
        }
    }

    /// What a recipe aims at, where that is not truth.
    fn of(&self, recipe: &Recipe) -> Option<TargetMethod<'_>> {
        let methods: [TargetMethod<'_>; 2] = [&self.ssgi, &self.surfel];
        let name = recipe.target.as_ref()?;
        let method =
            methods.into_iter().find(|method| method.name() == name && method.effect() == recipe.effect);
        Some(method.expect("one of these"))
    }
}

/// A picture of some columns of images.
fn assert_is_picture(path: &Path) {
    let picture = image::load_from_memory(&std::fs::read(path).expect("read")).expect("a PNG").into_rgb8();
    assert!(picture.width() > 4 * 32 && picture.height() > 2 * 32);
    assert!(picture.pixels().any(|pixel| pixel.0 == [255; 3]));
}

#[test]
fn every_training_recipe_gives_data_that_are_sound_and_shown() {
    let (folder, targets) = (tempfile::tempdir().expect("a folder"), Targets::new());
    for recipe in all(Split::Train) {
        let effect = recipe.effect;
        let out = made(&recipe, folder.path(), |out| {
            generate_by(&recipe, out, targets.of(&recipe)).expect("generated");
        });
        assert_eq!(verify(&out).expect("verified").faults, [], "{effect}");
        let dataset = Dataset::open(&out).expect("a dataset");
        let pairs = [0, 1].map(|index| dataset.pair(index).expect("a pair"));
        assert_ne!(pairs[0], pairs[1], "{effect}");
        let values = pairs[0].target.data();
        assert!(values.iter().any(|value| *value != values[0]), "{effect}: a target of one value");
        let sheet = folder.path().join("sheet.png");
        contact_sheet(&dataset, &[0, 1], &sheet).expect("drawn");
        assert_is_picture(&sheet);

        // The frame can be made again from what the manifest says.
        let props = dataset.props().expect("props");
        let record = dataset.record(1);
        let staged = StagedScene::load(&record.scene, dataset.recipe(), &props).expect("a scene");
        let scene = staged.shown(&record.camera, record.variation.as_ref()).expect("shown");
        let again = staged.gbuffer(&scene, &record.camera, record.seed);
        let close = |(a, b): (&f32, &f32)| (a - b).abs() <= b.abs() / 1024.0 + 1e-6;
        let pair = &pairs[1].gbuffer;
        assert!(pair.planes().data().iter().zip(again.planes().data()).all(close), "{effect}");
    }
}

#[test]
fn every_recipe_for_testing_gives_a_test_set_that_is_read_and_shown() {
    let (folder, targets) = (tempfile::tempdir().expect("a folder"), Targets::new());
    for recipe in all(Split::Test) {
        let effect = recipe.effect;
        let out = made(&recipe, folder.path(), |out| {
            TestSet::generate_by(&recipe, out, targets.of(&recipe)).expect("generated");
        });
        let set = TestSet::open(&out).expect("a test set");
        let props = set.props().expect("props");
        let pairs = [0, 1].map(|index| set.pair(index, &props).expect("a frame"));
        assert_ne!(pairs[0].gbuffer, pairs[1].gbuffer, "{effect}");
        for (index, pair) in pairs.iter().enumerate() {
            let frame = set.frame(index).expect("a frame");
            let values = frame.truth.data();
            assert!(values.iter().any(|value| *value != values[0]), "{effect}: truth of one value");
            assert!(values.iter().all(|value| *value >= 0.0 && value.is_finite()), "{effect}");
            assert_eq!(pair.gbuffer.attributes(), recipe.attributes());
        }
        let sheet = folder.path().join("sheet.png");
        test_sheet(&set, &[0, 1], &sheet).expect("drawn");
        assert_is_picture(&sheet);
    }
}
