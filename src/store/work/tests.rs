use super::*;
use crate::place::Place;
use object_store::memory::InMemory;
use std::path::Path;
use std::sync::Arc;

/// A store and the caches of machines that use it.
struct Bench {
    store: Arc<InMemory>,
    folder: tempfile::TempDir,
}

impl Bench {
    fn new() -> Self {
        Self { store: Arc::new(InMemory::new()), folder: tempfile::tempdir().expect("a folder") }
    }

    fn remote(&self) -> Remote {
        Remote::on(Arc::clone(&self.store) as _, &address()).expect("a remote")
    }

    fn cache(&self, machine: &str, bound: u64) -> Cache {
        Cache::at(self.folder.path().join(machine), bound)
    }

    fn begin(&self, machine: &str) -> Result<Work> {
        Work::on(self.remote(), self.cache(machine, 1000), &address())
    }

    /// What a machine finds, and then lets go of.
    fn found(&self, machine: &str) -> Vec<(String, String)> {
        contents(&self.begin(machine).expect("begun").folder())
    }

    /// A machine writes a file and puts it there.
    fn made(&self, machine: &str, text: &str) -> Result<()> {
        let work = self.begin(machine)?;
        write(&work, "file", text);
        work.finish()
    }
}

fn address() -> Address {
    match "s3://bucket/data".parse() {
        Ok(Place::Store(address)) => address,
        _ => unreachable!("an address"),
    }
}

fn write(work: &Work, name: &str, text: &str) {
    std::fs::write(work.folder().join(name), text).expect("written");
}

fn contents(folder: &Path) -> Vec<(String, String)> {
    let entries = std::fs::read_dir(folder).expect("listed").flatten();
    let read = |path: PathBuf| std::fs::read_to_string(path).expect("a text");
    let mut all: Vec<_> =
        entries.map(|entry| (entry.file_name().to_string_lossy().into_owned(), read(entry.path()))).collect();
    all.sort();
    all
}

fn file(text: &str) -> Vec<(String, String)> {
    vec![("file".to_owned(), text.to_owned())]
}

#[test]
fn what_one_machine_makes_another_goes_on_with() {
    let bench = Bench::new();
    bench.made("one", "first").expect("made");
    assert_eq!(bench.found("two"), file("first"));
    bench.made("two", "second").expect("made");
    assert_eq!(bench.found("one"), file("second"), "nothing of its own is lost");
    assert!(!bench.begin("one").expect("begun").entry.note("aside-1").exists());
}

#[test]
fn a_folder_is_one_programs_and_unfinished_work_stays() {
    let bench = Bench::new();
    bench.made("one", "first").expect("made");
    let work = bench.begin("one").expect("begun");
    let error = bench.begin("one").err().expect("taken").to_string();
    assert!(error.starts_with("s3://bucket/data: process") && error.contains("is at work on it"), "{error}");
    write(&work, "file", "unfinished");
    // As where it is killed.
    drop(work);
    assert_eq!(bench.found("one"), file("unfinished"));
    assert_eq!(bench.found("two"), file("first"));
}

#[test]
fn the_second_of_two_that_write_different_things_is_told_and_loses_nothing() {
    let bench = Bench::new();
    for (mine, theirs) in [("mine", "theirs"), ("mine again", "theirs again")] {
        let (one, two) = (bench.begin("one").expect("begun"), bench.begin("two").expect("begun"));
        write(&one, "file", mine);
        write(&two, "file", theirs);
        two.finish().expect("the first");
        let error = one.finish().expect_err("the second").to_string();
        assert!(error.contains("somebody else has put something else there"), "{error}");
        assert_eq!(bench.found("two"), file(theirs));
        // Given again, it goes on with what is there, and keeps what it had made.
        let work = bench.begin("one").expect("begun");
        assert_eq!(contents(&work.folder()), file(theirs));
        let aside = if mine == "mine" { "aside-1" } else { "aside-2" };
        assert_eq!(contents(&work.entry.note(aside)), file(mine));
    }
    // Where both make the same there is no other.
    let (one, two) = (bench.begin("one").expect("begun"), bench.begin("two").expect("begun"));
    write(&one, "file", "the same");
    write(&two, "file", "the same");
    two.finish().expect("the first");
    one.finish().expect("the second");
    // One that was killed before it noted that it was done has made what is there.
    let work = bench.begin("one").expect("begun");
    write(&work, "file", "done");
    let list = work.publish().expect("put");
    work.note(&Note::Work(Some("an earlier list".to_owned()))).expect("noted");
    drop(work);
    assert_eq!(bench.found("one"), file("done"));
    assert_eq!(Commit::at(&bench.remote()).expect("read").expect("a list").0, list);
    assert!(!bench.begin("one").expect("begun").entry.note("aside-3").exists());
}

#[test]
fn what_was_fetched_before_a_break_is_not_fetched_again() {
    let bench = Bench::new();
    bench.made("one", "first").expect("made");
    let object = Commit::at(&bench.remote()).expect("read").expect("a list").0.files[0].object();
    bench.remote().put(&object, b"other".to_vec()).expect("put");
    let error = bench.begin("two").err().expect("broken");
    assert!(format!("{error:#}").contains("is damaged"), "{error:#}");
    // Something that is cleared away where the folder is.
    let entry = bench.cache("two", 1000).output(&hash(b"s3://bucket/data")).expect("an output").0;
    std::fs::write(entry.files().join("fetched before"), "").expect("written");
    bench.remote().put(&object, b"first".to_vec()).expect("put");
    assert_eq!(bench.found("two").len(), 2);
    // Of another list nothing stays.
    drop(bench.begin("three").expect("begun"));
    bench.remote().put(&object, b"other".to_vec()).expect("put");
    assert!(bench.begin("four").is_err());
    let entry = bench.cache("four", 1000).output(&hash(b"s3://bucket/data")).expect("an output").0;
    std::fs::write(entry.files().join("fetched before"), "").expect("written");
    bench.made("three", "second").expect("made");
    assert_eq!(bench.found("four"), file("second"));
}

#[test]
fn what_the_cache_has_no_room_for_is_fetched_again() {
    let bench = Bench::new();
    let begin = |bound| Work::on(bench.remote(), bench.cache("one", bound), &address()).expect("begun");
    let work = begin(1000);
    write(&work, "file", "first");
    work.finish().expect("made");
    let work = begin(3);
    assert_eq!(contents(&work.folder()), file("first"));
    write(&work, "file", "second");
    let entry = work.entry.clone();
    work.finish().expect("made");
    assert!(!entry.files().exists());
    assert_eq!(bench.found("one"), file("second"));
    // What is delivered is not kept, whatever the room.
    let work = begin(1000);
    write(&work, "file", "third");
    work.deliver().expect("made");
    assert!(!entry.files().exists());
    assert_eq!(bench.found("two"), file("third"));
}

#[test]
fn what_was_deleted_from_the_store_is_put_there_again() {
    let bench = Bench::new();
    bench.made("one", "first").expect("made");
    let empty = Bench { store: Arc::new(InMemory::new()), folder: bench.folder };
    let work = empty.begin("one").expect("begun");
    assert_eq!(contents(&work.folder()), file("first"));
    work.finish().expect("put");
    assert_eq!(empty.found("two"), file("first"));
}
