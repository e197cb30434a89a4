use super::merge::merge;
use super::*;
use crate::generate::tests::recipe;
use crate::journal::JOURNAL;
use crate::manifest::Manifest;
use crate::shipped::contents;
use crate::{Recipe, generate, generate_shard, verify};
use proptest::prelude::*;
use std::path::PathBuf;

fn shard(text: &str) -> Shard {
    text.parse().expect("a shard")
}

/// Makes all shards of a recipe, the last one first, in folders of their own.
fn shards(recipe: &Recipe, folder: &Path, count: usize) -> Vec<PathBuf> {
    let make = |number: usize| {
        let out = folder.join(format!("{count}-{number}"));
        generate_shard(recipe, &out, None, shard(&format!("{number}/{count}"))).expect("a shard");
        out
    };
    (1..=count).rev().map(make).collect()
}

#[test]
fn shards_put_together_are_the_bytes_of_one_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let recipe = recipe(folder.path(), 5);
    let whole = folder.path().join("whole");
    generate(&recipe, &whole).expect("generated");
    // Four pairs: more shards than that are empty.
    for count in [1, 3, 5] {
        let parts = shards(&recipe, folder.path(), count);
        let merged = folder.path().join(format!("merged-{count}"));
        assert_eq!(merge(&parts, &merged).expect("merged"), 4);
        assert!(contents(&merged) == contents(&whole), "{count} shards");
        assert!(verify(&merged).expect("a dataset").faults.is_empty());
        assert_eq!(merge(&parts, &merged).expect("nothing to do"), 4);
    }
}

#[test]
fn no_shards_way_to_scene_files_is_taken_for_the_wholes() {
    let folder = tempfile::tempdir().expect("a folder");
    let parts = shards(&recipe(folder.path(), 11), folder.path(), 2);
    for (part, name) in parts.iter().zip(["shard-2-of-2.json", "shard-1-of-2.json"]) {
        relist(part, name, |list| list.origin.scenes = Some("../nowhere".into()));
    }
    let merged = folder.path().join("merged");
    merge(&parts, &merged).expect("merged");
    assert_eq!(Manifest::load(&merged).expect("a manifest").origin.scenes, None);
}

#[test]
fn what_is_no_whole_set_of_shards_is_refused_and_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let ours = recipe(folder.path(), 6);
    let parts = shards(&ours, folder.path(), 3);
    let other = shards(&recipe(folder.path(), 7), &folder.path().join("other"), 3);
    let halves = shards(&ours, folder.path(), 2);
    let whole = folder.path().join("whole");
    let refused = |parts: &[&PathBuf]| {
        let parts: Vec<PathBuf> = parts.iter().map(|part| (*part).clone()).collect();
        merge(&parts, &folder.path().join("merged")).expect_err("refused").to_string()
    };
    assert!(refused(&[&parts[0], &parts[2]]).contains("shards are missing: 2/3"));
    assert!(refused(&[&parts[0], &parts[1], &parts[2], &parts[1]]).contains("it is shard 2/3, as is"));
    assert!(refused(&[&parts[0], &parts[1], &halves[0]]).contains("where others are of"));
    assert!(refused(&[&parts[0], &parts[1], &other[2]]).contains("`seed` is"));
    generate(&ours, &whole).expect("generated");
    assert!(refused(&[&whole]).contains("no list of a shard"));
    assert!(refused(&[]).contains("no shard is given"));

    // Damaged, mended by making the shard again, and then sound.
    let list = Manifest::load_list(&parts[0], &shard("3/3").file_name()).expect("a list");
    let error = Manifest::load(&parts[0]).expect_err("refused").to_string();
    assert!(error.contains("it is shard 3/3: merge it"), "{error}");
    let faults = || verify(&parts[0]).expect("a shard").faults;
    assert_eq!(faults(), []);
    let damaged = parts[0].join(&list.pairs[0].file);
    std::fs::write(&damaged, b"noise").expect("damaged");
    assert!(faults().iter().any(|fault| fault.file == list.pairs[0].file), "{:?}", faults());
    let all: Vec<&PathBuf> = parts.iter().collect();
    assert!(refused(&all).contains("generate that shard again"));
    assert_eq!(generate_shard(&ours, &parts[0], None, shard("3/3")).expect("mended").rendered, 1);
    let merged = folder.path().join("merged");
    assert_eq!(merge(&parts, &merged).expect("merged"), 4);
    assert!(contents(&merged) == contents(&whole));
}

/// Rewrites the list of a shard.
fn relist(folder: &Path, name: &str, change: impl FnOnce(&mut Manifest)) {
    let mut list = Manifest::load_list(folder, name).expect("a list");
    change(&mut list);
    list.save_list(folder, name).expect("written");
}

#[test]
fn a_list_names_what_its_recipe_plans_and_nothing_else() {
    let folder = tempfile::tempdir().expect("a folder");
    let parts = shards(&recipe(folder.path(), 9), folder.path(), 2);
    let merged = folder.path().join("merged");
    let name = shard("2/2").file_name();
    let sound = std::fs::read(parts[0].join(&name)).expect("a list");
    let refused = |change: fn(&mut Manifest)| {
        relist(&parts[0], &name, change);
        let error = merge(&parts, &merged).expect_err("refused").to_string();
        let faults = verify(&parts[0]).map_or(1, |report| report.faults.len());
        assert_ne!(faults, 0, "{error}");
        std::fs::write(parts[0].join(&name), &sound).expect("restored");
        assert!(!merged.exists(), "nothing is written");
        error
    };
    assert!(refused(|list| list.pairs[0].file = "../outside.exr".into()).contains("lists `../outside.exr`"));
    assert!(refused(|list| list.pairs[1] = list.pairs[0].clone()).contains("where its recipe has `pairs/"));
    assert!(refused(|list| list.pairs.truncate(1)).contains("lists 1 pairs"));
    assert_eq!(merge(&parts, &merged).expect("merged"), 4);
}

#[test]
fn a_pair_that_was_made_anew_replaces_the_older_copy() {
    let folder = tempfile::tempdir().expect("a folder");
    let parts = shards(&recipe(folder.path(), 10), folder.path(), 2);
    let merged = folder.path().join("merged");
    merge(&parts, &merged).expect("merged");
    // As another machine would, whose rays round in another way.
    let name = shard("2/2").file_name();
    let file = Manifest::load_list(&parts[0], &name).expect("a list").pairs[0].file.clone();
    std::fs::write(parts[0].join(&file), b"other bytes").expect("written");
    relist(&parts[0], &name, |list| list.pairs[0].blake3 = blake3::hash(b"other bytes").to_hex().to_string());
    merge(&parts, &merged).expect("merged again");
    assert_eq!(std::fs::read(merged.join(&file)).expect("a pair"), b"other bytes");
}

#[test]
fn a_folder_holds_one_shard() {
    let folder = tempfile::tempdir().expect("a folder");
    let recipe = recipe(folder.path(), 8);
    let out = folder.path().join("out");
    generate_shard(&recipe, &out, None, shard("1/2")).expect("a shard");
    let before = contents(&out);
    let refused = generate_shard(&recipe, &out, None, shard("2/2")).expect_err("another shard").to_string();
    assert!(refused.contains("shard-1-of-2.json"), "{refused}");
    assert!(generate(&recipe, &out).is_err(), "nor the whole");
    assert!(contents(&out) == before);
    // One that was killed is taken up by itself alone.
    let list = out.join("shard-1-of-2.json");
    let manifest = Manifest::load_list(&out, "shard-1-of-2.json").expect("a list");
    std::fs::remove_file(list).expect("removed");
    let head = serde_json::to_string(&manifest.origin).expect("JSON");
    std::fs::write(out.join(JOURNAL), format!("{head}\n")).expect("written");
    let refused = generate_shard(&recipe, &out, None, shard("2/2")).expect_err("another shard").to_string();
    assert!(refused.contains("`shard`"), "{refused}");
    generate_shard(&recipe, &out, None, shard("1/2")).expect("taken up");
    assert!(contents(&out) == before);
}

#[test]
fn shards_are_written_like_fractions() {
    for text in ["0/3", "4/3", "1", "a/b", "1/0", "-1/3", "1/1000001", ""] {
        assert!(text.parse::<Shard>().expect_err("no shard").contains("2/5"), "{text}");
    }
    assert_eq!(Shard::by_file(&shard("2/5").file_name()), Some(shard("2/5")));
    assert_eq!(Shard::by_file("manifest.json"), None);
}

proptest! {
    #[test]
    fn every_view_is_in_one_shard(views in proptest::collection::vec(0usize..5, 1..8), count in 1usize..12) {
        let plan = || -> Vec<PlannedScene> { views.iter().enumerate().map(|(key, views)| planned(key, *views)).collect() };
        let names = |plan: Vec<PlannedScene>| -> Vec<String> {
            plan.into_iter().flat_map(|scene| scene.views).map(|view| view.name).collect()
        };
        let parts = (1..=count).map(|number| shard(&format!("{number}/{count}")).of(plan()));
        let sizes: Vec<usize> = parts.clone().map(|part| names(part).len()).collect();
        prop_assert!(sizes.iter().max().unwrap_or(&0) - sizes.iter().min().unwrap_or(&0) <= 1);
        prop_assert_eq!(parts.flat_map(names).collect::<Vec<_>>(), names(plan()));
    }
}

fn planned(key: usize, views: usize) -> PlannedScene {
    use crate::plan::PlannedView;
    let source = "room:1".parse().expect("a scene");
    let scene = crate::SceneRecord { source: crate::SceneOrCapture::Scene(source), blake3: None };
    let view = |index| PlannedView { index, name: format!("{key}-{index}"), seed: 0, held_apart: false };
    PlannedScene { scene, key: key as u64, views: (0..views).map(view).collect() }
}
