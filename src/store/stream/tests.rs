//! Streams over a store in memory.

use super::*;
use deepshade_dataset::{Recipe, generate};
use object_store::memory::InMemory;
use std::path::Path;
use std::sync::Arc;

/// A dataset of eight small pairs, and a store with it.
fn stored(folder: &Path) -> (Dataset, Commit, Arc<InMemory>) {
    let recipe = Path::new(env!("CARGO_MANIFEST_DIR")).join("dataset/recipes/ao-tiny.toml");
    let text = std::fs::read_to_string(recipe).expect("a recipe").replace("= 64", "= 16");
    std::fs::write(folder.join("recipe.toml"), text).expect("written");
    let whole = folder.join("whole");
    let recipe = Recipe::load(&folder.join("recipe.toml")).expect("a recipe");
    generate(&recipe, &whole).expect("a dataset");
    let (list, store) = (Commit::of(&whole).expect("listed"), Arc::new(InMemory::new()));
    crate::store::transfer::put(&remote(&store), &list, &whole).expect("stored");
    (Dataset::open(&whole).expect("a dataset"), list, store)
}

fn remote(store: &Arc<InMemory>) -> Remote {
    let address = match "s3://bucket/data".parse() {
        Ok(crate::place::Place::Store(address)) => address,
        _ => unreachable!("an address"),
    };
    Remote::on(Arc::clone(store) as _, &address).expect("a remote")
}

/// Bytes of pairs in a folder.
fn bytes(folder: &Path) -> u64 {
    let pairs = std::fs::read_dir(folder.join("pairs")).into_iter().flatten().flatten();
    pairs.map(|entry| entry.metadata().expect("a file").len()).sum()
}

#[test]
fn pairs_are_those_of_the_dataset_whatever_the_room() {
    let folder = tempfile::tempdir().expect("a folder");
    let (dataset, list, store) = stored(folder.path());
    let largest = list.files.iter().map(|file| file.bytes).max().expect("files");
    for room in [0, 3 * largest, u64::MAX] {
        let place = folder.path().join(format!("stream-{room}"));
        let stream = Stream::new(remote(&store), list.clone(), Folder::of(&place), room).expect("a stream");
        assert_eq!(stream.hash(), dataset.hash());
        assert_eq!((stream.training(), stream.validation()), (dataset.training(), dataset.validation()));
        std::thread::scope(|scope| {
            for thread in 0..4 {
                let (stream, dataset) = (&stream, &dataset);
                scope.spawn(move || {
                    for step in 0..3 * dataset.len() {
                        let index = (step * (thread + 3)) % dataset.len();
                        assert!(stream.read(index) == dataset.pair(index).map_err(|e| e.to_string()));
                    }
                });
            }
        });
        assert!(bytes(&place) <= room, "{} bytes in a room of {room}", bytes(&place));
        assert!(room < u64::MAX || bytes(&place) > 7 * (largest / 2), "all are kept where there is room");
    }
}

#[test]
fn damage_is_named_and_not_trained_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let (dataset, list, store) = stored(folder.path());
    let place = folder.path().join("stream");
    let stream =
        || Stream::new(remote(&store), list.clone(), Folder::of(&place), u64::MAX).expect("a stream");
    let first = dataset.pair(0).expect("a pair");
    assert!(stream().read(0) == Ok(first.clone()));
    // Here: it is fetched again.
    let name = &dataset.record(0).file;
    std::fs::write(place.join(name), "cut off").expect("written");
    assert!(stream().read(0) == Ok(first));
    // There.
    let object = list.files.iter().find(|file| file.name == *name).expect("listed").object();
    remote(&store).put(&object, b"other".to_vec()).expect("put");
    std::fs::remove_file(place.join(name)).expect("deleted");
    let error = stream().read(0).expect_err("damaged");
    assert!(error.contains(&object) && error.contains("is damaged"), "{error}");
}
