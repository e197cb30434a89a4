use super::*;
use crate::journal::JOURNAL;
use crate::recipe::file_hash;
use crate::shipped::{contents, shrunk};
use crate::{Dataset, contact_sheet, data_version, verify};
use deepshade_render::exr_file;
use deepshade_render::gbuffer;
use deepshade_render::method::{Clock, Frame, Method, MethodError, Repeats, Shaded};
use deepshade_render::path::{Sampling, Shot, render};
use deepshade_render::scene::procedural::{Family, Split};
use deepshade_shaders::{Attribute, Effect, Planes};

/// A recipe of two scenes with two views each.
pub(crate) fn recipe(folder: &Path, seed: u32) -> Recipe {
    let train = Family::ALL.into_iter().find(|family| family.split() == Split::Train).expect("a family");
    let path = folder.join(format!("recipe-{seed}.toml"));
    let text = format!(
        "effect = \"ao\"\nsplit = \"train\"\nseed = {seed}\nresolution = {{ height = 32, width = 40 }}\nsamples = 4\n\
         radius = {{ diagonal = 0.05 }}\nviews_per_scene = 2\nvalidation_share = 0.5\n\
         [[families]]\nname = \"{}\"\nscenes = 2\n",
        train.name()
    );
    std::fs::write(&path, text).expect("written");
    Recipe::load(&path).expect("a sound recipe")
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let folder = tempfile::tempdir().expect("a folder");
    let recipe = recipe(folder.path(), 1);
    let generated = |threads: usize| {
        let out = folder.path().join(threads.to_string());
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        let summary = pool.install(|| generate(&recipe, &out)).expect("generated");
        assert_eq!((summary.pairs, summary.rendered), (4, 4));
        contents(&out)
    };
    let one = generated(1);
    assert_eq!(one.len(), 5, "four pairs and a manifest, nothing else");
    assert!(one == generated(2));
    assert!(one == generated(4));
}

#[test]
fn pairs_with_an_error_take_the_samples_that_it_needs_and_come_with_their_variance() {
    let folder = tempfile::tempdir().expect("a folder");
    let recipe = Recipe { samples: 4096, error: Some(0.02), ..recipe(folder.path(), 1) };
    let out = folder.path().join("out");
    generate(&recipe, &out).expect("generated");
    let manifest = Manifest::load(&out).expect("a manifest");
    let taken: Vec<u32> = manifest
        .pairs
        .iter()
        .map(|pair| {
            let image = exr_file::read(&out.join(&pair.file)).expect("read");
            let variance = image.image("variance", 1).expect("variance");
            let mean = image.image("target.ao", 1).expect("a target");
            let samples = image.metadata()["samples"].parse().expect("a number");
            let estimate = Estimate { mean, variance: Some(variance), samples };
            // Half floats round the mean.
            assert!(estimate.noise_relmse(1.0).expect("variance").sqrt() < 0.0201, "{}", pair.file);
            samples
        })
        .collect();
    assert!(taken.iter().all(|samples| (128..4096).contains(samples)), "{taken:?}");
}

#[test]
fn pairs_of_several_scramblings_come_with_a_variance_that_is_how_far_they_are_off() {
    let folder = tempfile::tempdir().expect("a folder");
    let split = Recipe { samples: 16, scramblings: 2, ..recipe(folder.path(), 1) };
    let one = Recipe { scramblings: 1, ..split.clone() };
    let fine = Recipe { samples: 4096, ..one.clone() };
    let pairs = |recipe: &Recipe, name: &str| {
        let out = folder.path().join(name);
        generate(recipe, &out).expect("generated");
        let dataset = Dataset::open(&out).expect("opens");
        (0..dataset.len()).map(|pair| dataset.pair(pair).expect("reads")).collect::<Vec<_>>()
    };
    let [split, one, fine] =
        [(&split, "split"), (&one, "one"), (&fine, "fine")].map(|(r, name)| pairs(r, name));
    assert!(one.iter().all(|pair| pair.variance.is_none()), "one sequence does not know its noise");
    let (mut off, mut variance) = (0.0, 0.0);
    for (split, fine) in split.iter().zip(&fine) {
        let squares = split.target.data().iter().zip(fine.target.data()).map(|(a, b)| (a - b).powi(2));
        off += squares.sum::<f32>();
        variance += split.variance.as_ref().expect("a variance").data().iter().sum::<f32>();
    }
    let ratio = variance / off;
    assert!((0.85..1.15).contains(&ratio), "the variance is {ratio} of the squared error");
}

/// The composed frame reads more of a surface than pairs hold, and its estimate is of the pair's own frame.
#[test]
fn pairs_of_all_light_come_with_the_composed_frame() {
    let folder = tempfile::tempdir().expect("a folder");
    let plain = recipe(folder.path(), 1);
    let estimates = vec!["composed:low".to_owned()];
    let recipe = Recipe { effect: Effect::Path, samples: 64, estimates, ..plain };
    let out = folder.path().join("out");
    generate(&recipe, &out).expect("generated");
    let dataset = Dataset::open(&out).expect("opens");
    let brightness = |planes: &Planes| planes.data().iter().map(|value| value.ln_1p()).sum::<f32>();
    let difference = |[a, b]: [&Planes; 2]| {
        a.data().iter().zip(b.data()).map(|(a, b)| (a.ln_1p() - b.ln_1p()).abs()).sum::<f32>()
    };
    let pairs: Vec<_> = (0..dataset.len()).map(|index| dataset.pair(index).expect("reads")).collect();
    let estimates: Vec<_> =
        pairs.iter().map(|pair| pair.gbuffer.select(&[Attribute::Estimate]).expect("an estimate")).collect();
    for (index, pair) in pairs.iter().enumerate() {
        let whole = brightness(&pair.target);
        let own = difference([&estimates[index], &pair.target]);
        let other = difference([&estimates[(index + 1) % pairs.len()], &pair.target]);
        assert!(whole > 0.0 && own < 0.5 * whole && own < other, "{index}: {own}, {other} of {whole}");
    }
}

/// The first line of a journal.
fn head(origin: &Origin) -> String {
    serde_json::to_string(origin).expect("JSON")
}

#[test]
fn a_killed_run_ends_with_the_bytes_of_an_undisturbed_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let recipe = recipe(folder.path(), 2);
    let out = folder.path().join("out");
    generate(&recipe, &out).expect("generated");
    let undisturbed = contents(&out);
    let manifest = Manifest::load(&out).expect("a manifest");
    let [first, second, third, fourth] = manifest.pairs.as_slice() else { unreachable!("four pairs") };

    // Killed while the third line was written: one pair is journalled and whole, one journalled and damaged,
    // one without its line, one not there, and a temporary file is left over in each folder.
    std::fs::remove_file(out.join(MANIFEST)).expect("removed");
    let json = |record: &PairRecord| serde_json::to_string(record).expect("JSON");
    let cut_off = &json(third)[..40];
    let journal = format!("{}\n{}\n{}\n{cut_off}", head(&manifest.origin), json(first), json(second));
    std::fs::write(out.join(JOURNAL), journal).expect("written");
    std::fs::write(out.join(&second.file), &undisturbed[Path::new(&second.file)][..500]).expect("truncated");
    std::fs::remove_file(out.join(&fourth.file)).expect("removed");
    std::fs::write(out.join(".deepshade-x1"), b"half").expect("left over");
    std::fs::write(out.join("pairs/.deepshade-x2"), b"half").expect("left over");
    assert_eq!(generate(&recipe, &out).expect("resumed").rendered, 3);
    assert!(contents(&out) == undisturbed);

    // Killed while the first line was written.
    std::fs::remove_file(out.join(MANIFEST)).expect("removed");
    std::fs::write(out.join(JOURNAL), "\"deepsh").expect("written");
    assert_eq!(generate(&recipe, &out).expect("resumed").rendered, 4);
    assert!(contents(&out) == undisturbed);

    // Damaged after it was whole.
    std::fs::write(out.join(&first.file), b"noise").expect("damaged");
    assert_eq!(generate(&recipe, &out).expect("mended").rendered, 1);
    assert!(contents(&out) == undisturbed);
    assert_eq!(generate(&recipe, &out).expect("nothing to do").rendered, 0);
    assert!(contents(&out) == undisturbed);
}

#[test]
fn a_folder_in_use_or_with_other_data_is_left_alone() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    generate(&recipe(folder.path(), 3), &out).expect("generated");
    let before = contents(&out);
    let other = recipe(folder.path(), 4);
    let refused = generate(&other, &out).expect_err("another recipe");
    let refused = refused.to_string();
    assert!(refused.contains("holds other data: `seed` is 3 there and 4 here; choose"), "{refused}");
    assert!(contents(&out) == before);
    let busy = folder.path().join("busy");
    let mut origin = Manifest::load(&out).expect("a manifest").origin;
    origin.recipe.resolution.width = 48;
    (origin.recipe_hash, origin.recipe.seed) = ("another".to_owned(), 4);
    let (journal, _) = Journal::open::<PairRecord>(&busy, &[PAIRS], MANIFEST, &origin).expect("opened");
    let refused = generate(&other, &busy).expect_err("in use");
    assert!(
        matches!(&refused, DatasetError::Busy { holder, .. } if holder.starts_with("process ")),
        "{refused}"
    );
    drop(journal);
    let refused = generate(&other, &busy).expect_err("another job's journal");
    assert!(refused.to_string().contains("`resolution.width` is 48 there and 40 here"), "{refused}");
    std::fs::write(busy.join(JOURNAL), "\"an older version's head\"\n").expect("written");
    let refused = generate(&other, &busy).expect_err("another version's journal").to_string();
    assert!(refused.contains(JOURNAL) && refused.contains("another version"), "{refused}");
    let report = folder.path().join("report");
    std::fs::create_dir(&report).expect("made");
    std::fs::write(report.join("index.html"), "a page").expect("written");
    let refused = generate(&other, &report).expect_err("no folder of data").to_string();
    assert!(refused.contains("holds `index.html`"), "{refused}");
    assert_eq!(std::fs::read_dir(&report).expect("listed").count(), 1, "nothing is left there");
}

#[test]
fn data_of_another_version_and_absurd_manifests_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let recipe = recipe(folder.path(), 6);
    let out = folder.path().join("out");
    generate(&recipe, &out).expect("generated");
    let path = out.join(MANIFEST);
    let sound = std::fs::read_to_string(&path).expect("read");
    let refused = |old: &str, new: &str| {
        assert!(sound.contains(old), "{old}");
        std::fs::write(&path, sound.replacen(old, new, 1)).expect("written");
        Dataset::open(&out).expect_err("refused").to_string()
    };
    let version = format!("\"data_version\": {}", data_version(recipe.effect));
    let error = refused(&version, "\"data_version\": 999");
    assert!(error.contains("manifest.json: data of version 999"), "{error}");
    let error = generate(&recipe, &out).expect_err("another version").to_string();
    assert!(error.contains("data of version 999"), "{error}");
    assert!(refused(&format!("{version},"), "").contains("data of version 0"));
    let error = refused("\"height\": 32", "\"height\": 1000000000");
    assert!(error.contains("manifest.json: `resolution.height` must be 16"), "{error}");
}

#[test]
fn a_test_set_is_not_generated_as_a_dataset() {
    let folder = tempfile::tempdir().expect("a folder");
    let tiles = Some(crate::recipe::Tiles { samples: 4, one_in: 2, whole_frames: 1 });
    let sound = recipe(folder.path(), 7);
    for (recipe, what) in [
        (Recipe { tiles, ..sound.clone() }, "`tiles` is for test sets"),
        (Recipe { split: Split::Test, ..sound }, "`split` says testing"),
    ] {
        let error = generate(&recipe, &folder.path().join("out")).expect_err(what).to_string();
        for part in ["recipe-7.toml", what, "`deepshade dataset testset`"] {
            assert!(error.contains(part), "{error}");
        }
    }
}

/// A recipe of one scene file that refers to another file.
fn recipe_of_a_file(folder: &Path) -> Recipe {
    std::fs::create_dir_all(folder.join("scenes")).expect("made");
    std::fs::write(folder.join("scenes/slabs.gltf"), SLABS).expect("written");
    write_slabs(folder, 1.0);
    let text = "effect = \"ao\"\nsplit = \"test\"\nseed = 1\nresolution = { height = 16, width = 16 }\n\
                samples = 1\nradius = { diagonal = 0.05 }\nviews_per_scene = 2\nfiles = [\"scenes/slabs.gltf\"]\n";
    std::fs::write(folder.join("files.toml"), text).expect("written");
    Recipe::load(&folder.join("files.toml")).expect("a sound recipe")
}

/// Twelve triangles whose corners are in `slabs.bin`.
const SLABS: &str = r#"{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "buffers": [{"uri": "slabs.bin", "byteLength": 432}], "bufferViews": [{"buffer": 0, "byteLength": 432}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 36, "type": "VEC3",
        "min": [-2, -2, -2], "max": [2, 2, 2]}]}"#;

/// Writes corners of slanted triangles around a room, some metres long.
fn write_slabs(folder: &Path, height: f32) {
    let corner = |triangle: usize, corner: usize| {
        let angle = triangle as f32 * 2.1 + corner as f32 * 1.9;
        [2.0 * angle.cos(), height * (angle * 1.7).sin(), 2.0 * (angle * 1.3).sin()]
    };
    let corners = (0..12).flat_map(|i| [0, 1, 2].map(|c| corner(i, c)));
    let bytes: Vec<u8> = corners.flatten().flat_map(f32::to_le_bytes).collect();
    std::fs::write(folder.join("scenes/slabs.bin"), bytes).expect("written");
}

#[test]
fn scene_files_are_found_again_from_the_data_and_a_change_of_any_is_noticed() {
    let folder = tempfile::tempdir().expect("a folder");
    let recipe = recipe_of_a_file(folder.path());
    let plan = recipe.plan().expect("a plan");
    let scene = &plan[0].scene;
    let out = folder.path().join("data/out");
    let origin = Origin::new(&recipe, &plan, &out).expect("an origin");
    assert_eq!(origin.scenes.as_deref(), Some(Path::new("../..")), "no path of this machine");
    Manifest { origin: origin.clone(), pairs: Vec::new() }.save(&out).expect("saved");
    // Made for another place, they do not say where the files are, and are told as the same data.
    let away = folder.path().join("away");
    let unsaid = Origin::new(&recipe, &plan, Out { folder: &away, stays: false }).expect("an origin");
    assert_eq!(unsaid, Origin { scenes: None, ..origin.clone() });
    std::fs::create_dir(&away).expect("made");
    Manifest { origin: unsaid, pairs: Vec::new() }.save(&away).expect("saved");
    let hashes = [&out, &away].map(|folder| Manifest::file_hash(folder).expect("a hash"));
    assert_eq!(hashes[0], hashes[1]);
    assert_eq!(hashes[1], file_hash(&away.join(MANIFEST)).expect("a hash"), "of the file as it is");

    // Both move to another place, and the recipe's own file is gone.
    let moved = folder.path().join("moved");
    std::fs::create_dir(&moved).expect("made");
    for name in ["scenes", "data"] {
        std::fs::rename(folder.path().join(name), moved.join(name)).expect("moved");
    }
    let dataset = Dataset::open(&moved.join("data/out")).expect("opened");
    scene.load(&dataset.recipe().folder).expect("found from the data's folder");
    let elsewhere = |scenes: &Path| scene.load(&dataset.clone().with_scenes(scenes).recipe().folder);
    assert!(elsewhere(&moved).is_ok() && elsewhere(&out).is_err());
    assert!(scene.load(&recipe.folder).is_err(), "no longer there");

    // The scene file stays the same, what it refers to does not.
    write_slabs(&moved, 1.5);
    let error = scene.load(&dataset.recipe().folder).expect_err("another scene").to_string();
    assert!(error.contains("slabs.gltf") && error.contains("not what the data were made from"), "{error}");
    let changed = Recipe { folder: moved, ..recipe };
    let plan = changed.plan().expect("a plan");
    let changed = Origin::new(&changed, &plan, &out).expect("an origin");
    let error = changed.check_same(&origin, &out).expect_err("other contents").to_string();
    assert!(error.contains("the scene files have other contents"), "{error}");
}

#[test]
fn scenes_of_a_batch_keep_the_plans_order() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut recipe = recipe(folder.path(), 8);
    recipe.families[0].scenes = 7;
    let plan = recipe.plan().expect("a plan");
    let records = by_scene(&plan, |index, scene| Ok(vec![(index, scene.views[0].name.clone()); 2]));
    let expected = |i: usize| (i / 2, plan[i / 2].views[0].name.clone());
    assert_eq!(records.expect("records"), (0..14).map(expected).collect::<Vec<_>>());
}

#[test]
fn what_is_generated_is_read_and_verified() {
    let folder = tempfile::tempdir().expect("a folder");
    let recipe = recipe(folder.path(), 5);
    let out = folder.path().join("out");
    assert!(Dataset::open(&out).is_err(), "unfinished");
    generate(&recipe, &out).expect("generated");
    let dataset = Dataset::open(&out).expect("a dataset");
    assert_eq!((dataset.training(), dataset.validation()), (vec![0, 1], vec![2, 3]));

    let record = dataset.record(3);
    let scene = record.scene.load(&recipe.folder).expect("a scene");
    let shot = Shot::new(&scene, &record.camera, [32, 40], record.radius);
    let pair = dataset.pair(3).expect("a pair");
    // Quarters are exact in half floats.
    assert_eq!(pair.target, render(recipe.effect, &shot, Sampling::one(4, record.seed)).mean);
    assert_eq!(pair.radius, 0.05 * scene.diagonal());
    let rendered = gbuffer::render(&scene, &record.camera, 32, 40, pair.gbuffer.attributes());
    let close = |(a, b): (&f32, &f32)| (a - b).abs() <= b.abs() / 2048.0 + 1e-6;
    assert!(pair.gbuffer.planes().data().iter().zip(rendered.planes().data()).all(close));
    assert_ne!(dataset.pair(2).expect("a pair").target, pair.target);

    assert_eq!(verify(&out).expect("verified").faults, []);
    let sheet = folder.path().join("sheet.png");
    contact_sheet(&dataset, &[0, 3], &sheet).expect("drawn");
    let drawn = image::load_from_memory(&std::fs::read(sheet).expect("read")).expect("a PNG").into_rgb8();
    // Eight columns of at least 40 pixels, two rows of 32 and their text; ink, black and white are all there.
    assert!(drawn.width() > 320 && drawn.height() > 64);
    assert!([0, 32, 255].into_iter().all(|grey| drawn.pixels().any(|pixel| pixel.0 == [grey; 3])));
    let file = |index: usize| out.join(&dataset.record(index).file);
    let mut bytes = std::fs::read(file(1)).expect("read");
    *bytes.last_mut().expect("a byte") ^= 1;
    std::fs::write(file(1), bytes).expect("damaged");
    std::fs::remove_file(file(2)).expect("removed");
    std::fs::write(out.join("pairs/stranger.exr"), b"").expect("added");
    let faults: Vec<String> =
        verify(&out).expect("verified").faults.into_iter().map(|fault| fault.file).collect();
    let damaged = [1, 2].map(|index: usize| dataset.record(index).file.clone());
    assert_eq!(faults, ["pairs/stranger.exr".to_owned(), damaged[0].clone(), damaged[1].clone()]);
}

#[test]
fn varied_data_are_resumed_to_the_same_bytes() {
    let folder = tempfile::tempdir().expect("a folder");
    let recipe = shrunk("dof.toml");
    let out = folder.path().join("out");
    generate(&recipe, &out).expect("generated");
    let undisturbed = contents(&out);
    let manifest = Manifest::load(&out).expect("a manifest");
    // Killed after the first pair.
    std::fs::remove_file(out.join(MANIFEST)).expect("removed");
    std::fs::remove_file(out.join(&manifest.pairs[1].file)).expect("removed");
    let first = serde_json::to_string(&manifest.pairs[0]).expect("JSON");
    std::fs::write(out.join(JOURNAL), format!("{}\n{first}\n", head(&manifest.origin))).expect("written");
    assert_eq!(generate(&recipe, &out).expect("resumed").rendered, 1);
    assert!(contents(&out) == undisturbed);
}

/// A method whose images are the g-buffer's depth in all channels.
struct Depths(Effect);

impl Method for Depths {
    fn name(&self) -> &'static str {
        "depths"
    }

    fn effect(&self) -> Effect {
        self.0
    }

    fn shade(&self, frame: &Frame<'_>, _repeats: Repeats) -> Result<Shaded, MethodError> {
        let position = frame.gbuffer.select(&[Attribute::Position]).expect("a position");
        let (height, width) = (position.height(), position.width());
        let image = Planes::from_fn(self.0.channels(), height, width, |_, y, x| -position.at(2, y, x));
        Ok(Shaded { image, milliseconds: 0.0, clock: Clock::Cpu, device: String::new() })
    }
}

#[test]
fn a_method_can_be_what_pairs_aim_at() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("out");
    let recipe = Recipe { target: Some("depths".to_owned()), ..recipe(folder.path(), 3) };
    let method = Depths(recipe.effect);
    generate_by(&recipe, &out, Some(&method)).expect("generated");
    let dataset = Dataset::open(&out).expect("a dataset");
    let pair = dataset.pair(0).expect("a pair");
    let position = pair.gbuffer.select(&[Attribute::Position]).expect("a position");
    for (target, z) in pair.target.data().iter().zip(position.plane(2)) {
        // Both went through half floats.
        assert!((target + z).abs() <= 1e-3 * z.abs(), "{target} is not {z}");
    }
    assert!(pair.target.data().iter().any(|depth| *depth > 0.1));

    let refused = |recipe: &Recipe, method: Option<TargetMethod<'_>>| {
        generate_by(recipe, &folder.path().join("other"), method).expect_err("refused").to_string()
    };
    assert!(refused(&recipe, None).contains("`target` is `depths`, and truth"));
    let truth = Recipe { target: None, ..recipe.clone() };
    assert!(refused(&truth, Some(&method)).contains("`target` is truth, and `depths`"));
    assert!(refused(&recipe, Some(&Depths(Effect::Dof))).contains("computes dof, not ao"));
}

#[test]
fn of_each_effect_there_is_a_version_of_its_own() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut recipe = shrunk("subsurface.toml");
    recipe.views_per_scene = 1;
    let out = folder.path().join("subsurface");
    generate(&recipe, &out).expect("generated");
    let path = out.join(MANIFEST);
    let text = std::fs::read_to_string(&path).expect("read");
    let stated = |effect: Effect| format!("\"data_version\": {}", data_version(effect));
    assert_ne!(stated(Effect::Subsurface), stated(Effect::Ao));
    let older = text.replace(&stated(Effect::Subsurface), &stated(Effect::Ao));
    std::fs::write(&path, older).expect("written");
    let error = Dataset::open(&out).expect_err("refused").to_string();
    let [theirs, ours] = [Effect::Ao, Effect::Subsurface].map(data_version);
    assert!(
        error.contains(&format!("data of version {theirs}")) && error.contains(&ours.to_string()),
        "{error}"
    );
}
