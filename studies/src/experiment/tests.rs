//! Studies as small as they go, end to end.

use super::size::Size;
use super::*;
use deepshade_dataset::recipe::Tiles;
use std::collections::{BTreeMap, BTreeSet};
use std::time::SystemTime;

const TINY: Size = Size {
    name: "tiny",
    edge: 32,
    scenes: 1,
    views: 1,
    image_cost: 1,
    test_scenes: 1,
    test_views: 1,
    tiles: Tiles { samples: 16, one_in: 2, whole_frames: 1 },
    crop: 32,
    steps: 4,
    scene_counts: &[1, 2],
    perceptron_steps: 4,
    forest_examples: 40,
};

/// The files below a folder that are dear to make: pairs, truth and networks, and when they were written.
fn costly(folder: &Path) -> BTreeMap<PathBuf, SystemTime> {
    let mut files = BTreeMap::new();
    for entry in std::fs::read_dir(folder).expect("listed") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            files.extend(costly(&path));
        } else if path.extension().is_some_and(|kind| kind == "exr" || kind == "safetensors") {
            let time = path.metadata().and_then(|metadata| metadata.modified()).expect("a time");
            files.insert(path, time);
        }
    }
    files
}

/// The table of a study, after asserting what holds for every one.
fn table(study: Study, folder: &Path) -> Table {
    let workspace = Workspace::open(folder, TINY).expect("a lab");
    let table = study.run(&workspace).expect("runs");
    let figures: BTreeSet<&str> = table.rows.iter().map(|row| row.figure.as_str()).collect();
    assert_eq!(figures.len(), table.rows.len(), "every row has a figure of its own");
    for row in &table.rows {
        let ssim = row.values[0];
        assert!((-1.0..1.0).contains(&ssim), "{}: {ssim}", row.figure);
        assert!(row.values[1] <= ssim && ssim <= row.values[2], "{}: its interval holds it", row.figure);
        assert!(row.values.len() <= table.columns.len(), "{}", row.figure);
    }
    write(folder, &table, &workspace, 1.0).expect("written");
    table
}

#[test]
fn a_study_finds_again_what_it_made_and_gives_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let names = |table: &Table| -> Vec<String> { table.rows.iter().map(|row| row.figure.clone()).collect() };
    let similarities = |table: &Table| -> Vec<f64> { table.rows.iter().map(|row| row.values[0]).collect() };
    let first = table(Study::Scenes, folder.path());
    assert_eq!(names(&first), ["ssim_scenes1", "ssim_scenes2", "ssim_trivial"]);
    assert_ne!(similarities(&first)[0], similarities(&first)[1], "two networks");
    let made = costly(folder.path());
    assert_eq!(made.len(), 20 + 15 + 5 + 2, "pairs, truth of tiles and of a frame, networks");
    // As if the program had been killed after the first network.
    std::fs::remove_dir_all(folder.path().join("runs/scenes-2")).expect("removed");
    let again = table(Study::Scenes, folder.path());
    assert_eq!(similarities(&again), similarities(&first));
    let kept = costly(folder.path()).into_iter().filter(|(path, time)| made.get(path) == Some(time)).count();
    assert_eq!(kept, made.len() - 1, "only the network that was missing is made");
    for (file, holds) in [
        ("table.md", "- size `tiny`"),
        ("table.md", "network `scenes-2`: 4 steps"),
        ("table.csv", "ssim_scenes1,1,"),
        ("plot.svg", "scenes trained on"),
        ("curves.svg", "scenes-1"),
    ] {
        let text = std::fs::read_to_string(folder.path().join(file)).expect("written");
        assert!(text.contains(holds), "{file}: {text}");
    }
}

#[test]
fn regressors_are_compared_with_the_network() {
    let folder = tempfile::tempdir().expect("a folder");
    let table = table(Study::Regressors, folder.path());
    let names: Vec<&str> = table.rows.iter().map(|row| row.figure.as_str()).collect();
    assert_eq!(names[..3], ["ssim_unet", "ssim_mlp11", "ssim_mlp21"]);
    assert_eq!(names[3..], ["ssim_forest1", "ssim_forest5", "ssim_forest10", "ssim_trivial"]);
}

#[test]
fn every_kind_of_kernel_is_trained_and_timed() {
    let folder = tempfile::tempdir().expect("a folder");
    let table = table(Study::Kernels, folder.path());
    let names: Vec<&str> = table.rows.iter().map(|row| row.figure.as_str()).collect();
    assert_eq!(names[..3], ["ssim_kernel3_u4", "ssim_kernel3_u8", "ssim_kernel3_u16"]);
    assert_eq!(names[3..], ["ssim_kernel5_u4", "ssim_kernel5_u8", "ssim_kernel5_u16", "ssim_trivial"]);
    let column = |name: &str| table.columns.iter().position(|column| column.0 == name).expect("a column");
    let of = |row: usize, name: &str| table.rows[row].values[column(name)];
    assert_eq!(of(1, "weights"), 71_089.0, "the paper's");
    assert!((0..6).all(|row| of(row, "ms at 256x256") > 0.0));
}
