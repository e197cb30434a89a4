use super::*;
use std::cell::Cell;

/// A list of one file with so many bytes, which are in a folder of that name.
fn listed(folder: &Path, name: &str, bytes: usize) -> (Commit, PathBuf) {
    let folder = folder.join(name);
    std::fs::create_dir_all(&folder).expect("made");
    std::fs::write(folder.join(name), vec![0; bytes]).expect("written");
    (Commit::of(&folder).expect("listed"), folder)
}

/// Has a copy of what `listed` made.
fn had(cache: &Cache, (commit, from): &(Commit, PathBuf)) -> Result<Folder> {
    let name = &commit.files[0].name;
    cache.source(commit, name, |folder| {
        std::fs::copy(from.join(name), folder.join(name)).expect("copied");
        Ok(())
    })
}

#[test]
fn a_copy_is_fetched_once_and_again_where_it_was_cut_off() {
    let folder = tempfile::tempdir().expect("a folder");
    let cache = Cache::at(folder.path().join("cache"), 100);
    let (commit, from) = listed(folder.path(), "a", 10);
    let fetched = Cell::new(0);
    let had = || {
        cache.source(&commit, "hash", |folder| {
            fetched.set(fetched.get() + 1);
            std::fs::copy(from.join("a"), folder.join("a")).expect("copied");
            Ok(())
        })
    };
    let (one, other) = (had().expect("a copy"), had().expect("a copy"));
    assert_eq!((&*one, fetched.get()), (&*other, 1));
    let path = one.join("a");
    drop((one, other));
    std::fs::write(&path, b"cut off").expect("written");
    had().expect("a copy");
    assert_eq!(fetched.get(), 2);
    assert!(cache.source(&commit, "other", |_| bail!("broken")).is_err());
    let error = cache.source(&commit, "empty", |_| Ok(())).expect_err("never there").to_string();
    assert!(error.contains("sizes of its list"), "{error}");
}

#[test]
fn what_is_in_use_stays_and_the_rest_goes_the_oldest_first() {
    let folder = tempfile::tempdir().expect("a folder");
    let cache = Cache::at(folder.path().join("cache"), 25);
    let [a, b, c] = ["a", "b", "c"].map(|name| listed(folder.path(), name, 10));
    let (first, second) = (had(&cache, &a).expect("room"), had(&cache, &b).expect("room"));
    let error = had(&cache, &c).expect_err("no room").to_string();
    assert!(error.contains("beside what is in use") && error.contains(BOUND), "{error}");
    let (kept, gone) = (first.join("a"), second.join("b"));
    drop(second);
    let third = had(&cache, &c).expect("room");
    assert!(kept.exists() && !gone.exists() && third.join("c").exists());
    // Asked for again later, the first is younger than the third.
    drop((first, third));
    std::thread::sleep(std::time::Duration::from_millis(20));
    drop(had(&cache, &a).expect("there"));
    let second = had(&cache, &b).expect("room");
    assert!(kept.exists() && !cache.entry("sources", "c").files().exists());
    drop(second);
    let all = listed(folder.path(), "all", 25);
    drop(had(&cache, &all).expect("room"));
    assert!(!kept.exists() && had(&cache, &listed(folder.path(), "more", 26)).is_err());
    assert!(cache.entry("sources", "all").files().join("all").exists(), "nothing goes in vain");
}

#[cfg(feature = "train")]
#[test]
fn streams_and_outputs_count_too() {
    let folder = tempfile::tempdir().expect("a folder");
    let cache = Cache::at(folder.path().join("cache"), 40);
    let (stream, room) = cache.stream("list", 1000).expect("a stream");
    assert_eq!(room, 20);
    let (second, less) = cache.stream("list", 1000).expect("a stream");
    assert_ne!(&*stream, &*second);
    assert_eq!(less, 10);
    let few = cache.stream("few", 3).expect("a stream");
    assert_eq!(few.1, 3);
    std::fs::write(stream.join("pair"), vec![0; 20]).expect("written");
    let wanted = listed(folder.path(), "a", 15);
    assert!(had(&cache, &wanted).is_err(), "33 are in use");
    let pair = stream.join("pair");
    drop(stream);
    let source = had(&cache, &wanted).expect("room");
    assert!(!pair.exists());
    drop((source, second, few));

    // What was put into a store goes for others, what is worked on does not.
    let (output, lock) = cache.output("made").expect("an output");
    assert!(lock.is_some() && cache.output("made").expect("an output").1.is_none());
    std::fs::write(output.files().join("work"), vec![0; 30]).expect("written");
    let most = listed(folder.path(), "b", 40);
    drop(had(&cache, &most).expect("room"));
    drop(lock);
    drop(had(&cache, &listed(folder.path(), "c", 40)).expect("room"));
    assert!(output.files().join("work").exists());
    let (_, lock) = cache.output("made").expect("an output");
    assert!(cache.claim(&output, 30).expect("claimed"));
    drop(lock);
    drop(had(&cache, &most).expect("room"));
    assert!(!output.files().exists());
}
