use super::*;
use crate::location::Location;
use object_store::memory::InMemory;
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

    fn begin(&self, machine: &str) -> Result<WorkingCopy> {
        WorkingCopy::on(self.remote(), &self.folder.path().join(machine), &address())
    }

    /// What a machine finds, and then lets go of.
    fn found(&self, machine: &str) -> String {
        let folder = self.begin(machine).expect("begun").folder();
        assert_eq!(fs::read_dir(&folder).expect("listed").count(), 1);
        fs::read_to_string(folder.join("file")).expect("a text")
    }

    /// A machine writes a file and puts it there.
    fn made(&self, machine: &str, text: &str) -> Result<()> {
        let copy = self.begin(machine)?;
        write(&copy, text);
        copy.finish()
    }
}

fn address() -> Address {
    match "s3://bucket/data".parse() {
        Ok(Location::Store(address)) => address,
        _ => unreachable!("an address"),
    }
}

fn write(copy: &WorkingCopy, text: &str) {
    fs::write(copy.folder().join("file"), text).expect("written");
}

#[test]
fn what_one_machine_makes_another_goes_on_with() {
    let bench = Bench::new();
    bench.made("one", "first").expect("made");
    assert_eq!(bench.found("two"), "first");
    bench.made("two", "second").expect("made");
    assert_eq!(bench.found("one"), "second");
    let copies = bench.folder.path().join("one/outputs");
    bench.made("one", "third").expect("made");
    let entry = fs::read_dir(copies).expect("listed").flatten().next().expect("an entry");
    assert!(!entry.path().join("files").exists(), "what is in the store is not kept here");
}

#[test]
fn a_folder_is_one_programs_and_unfinished_work_stays() {
    let bench = Bench::new();
    bench.made("one", "first").expect("made");
    let copy = bench.begin("one").expect("begun");
    let error = bench.begin("one").err().expect("taken").to_string();
    assert!(error.starts_with("s3://bucket/data: process") && error.contains("is at work on it"), "{error}");
    write(&copy, "unfinished");
    // As where it is killed.
    drop(copy);
    assert_eq!((bench.found("one"), bench.found("two")), ("unfinished".to_owned(), "first".to_owned()));
    // And if nothing is in the store any more.
    let empty = Bench { store: Arc::new(InMemory::new()), folder: bench.folder };
    empty.begin("one").expect("begun").finish().expect("put");
    assert_eq!(empty.found("three"), "unfinished");
}

#[test]
fn the_second_of_two_that_write_different_things_is_told_and_loses_nothing() {
    let bench = Bench::new();
    let begin = |text: [&str; 2]| {
        let (one, two) = (bench.begin("one").expect("begun"), bench.begin("two").expect("begun"));
        write(&one, text[0]);
        write(&two, text[1]);
        two.finish().expect("the first");
        one
    };
    let one = begin(["mine", "theirs"]);
    let unfinished = one.folder();
    let error = format!("{:#}", one.finish().expect_err("the second"));
    assert!(error.contains("somebody else has put something else there"), "{error}");
    assert_eq!(bench.found("two"), "theirs");
    let error = format!("{:#}", bench.begin("one").err().expect("unfinished work"));
    assert!(error.contains(&unfinished.display().to_string()), "{error}");
    fs::remove_dir_all(&unfinished).expect("deleted");
    assert_eq!(bench.found("one"), "theirs");
    // Where both make the same there is no other.
    begin(["the same", "the same"]).finish().expect("the second");
    // One that was killed after it had put its own there goes on with that.
    let copy = bench.begin("one").expect("begun");
    write(&copy, "done");
    copy.publish().expect("put");
    drop(copy);
    assert_eq!(bench.found("one"), "done");
}

#[test]
fn a_copy_that_is_not_whole_is_fetched_again() {
    let bench = Bench::new();
    bench.made("one", "first").expect("made");
    let object = Commit::at(&bench.remote()).expect("read").expect("a list").0.files[0].object();
    bench.remote().put(&object, b"other".to_vec()).expect("put");
    let error = format!("{:#}", bench.begin("two").err().expect("broken"));
    assert!(error.contains("is damaged"), "{error}");
    let entry = bench.folder.path().join("two/outputs").join(hash(b"s3://bucket/data"));
    fs::create_dir_all(entry.join("files")).expect("made");
    fs::write(entry.join("files/stranger"), "of another list").expect("written");
    bench.remote().put(&object, b"first".to_vec()).expect("put");
    assert_eq!(bench.found("two"), "first");
}
