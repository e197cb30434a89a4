//! Everything that others may have written, read from the corpus that `cargo xtask fuzz` begins with, as it
//! is and changed at random: nothing panics, hangs or asks for the whole memory. What libFuzzer has found
//! lies in the corpus, too.
//!
//! An input that takes too long is told by a thread that watches, which ends the program; one that asks for
//! more memory than there is here ends it at once. Either way the inputs that were being read lie in the
//! folder for temporary files.

#[path = "../fuzz/src/readers.rs"]
mod readers;

use cap::Cap;
use readers::{MOST_BYTES, READERS, Reader};
use std::alloc::System;
use std::collections::BTreeMap;
use std::io::Write;
use std::num::NonZero;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Each of what is read at once may take what it may where libFuzzer runs.
#[global_allocator]
static MEMORY: Cap<System> = Cap::new(System, usize::MAX);

/// Since when each reader reads which input.
static UNDER_WAY: Mutex<BTreeMap<&str, (Instant, String)>> = Mutex::new(BTreeMap::new());

/// Changed inputs of each reader.
const CHANGED: usize = 3000;
/// The longest that one input may take, on a busy machine.
const PATIENCE: Duration = Duration::from_secs(20);
/// The largest changed input, bytes.
const LARGEST: usize = 16_384;

/// Numbers that are at the ends of what they are stored in, or of what makes sense.
const NUMBERS: [&str; 12] = [
    "0",
    "-1",
    "1",
    "255",
    "65536",
    "4294967295",
    "9223372036854775807",
    "18446744073709551616",
    "1e39",
    "-1e308",
    "nan",
    "0.5",
];

#[test]
fn nothing_that_others_may_have_written_breaks_a_reader() {
    let at_once = std::thread::available_parallelism().map_or(1, NonZero::get).min(READERS.len());
    MEMORY.set_limit(at_once * MOST_BYTES).expect("nothing has been read yet");
    std::thread::spawn(watch);
    // Not rayon's threads, which readers use themselves: one that waits for another would meanwhile read
    // other inputs, and the first would seem to take as long.
    let next = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        for _ in 0..at_once {
            scope.spawn(|| {
                while let Some(reader) = READERS.get(next.fetch_add(1, Ordering::Relaxed)) {
                    corpus_and_changed(reader);
                }
            });
        }
    });
}

/// Reads a reader's corpus, of which something is accepted, and changed inputs, of which some are refused.
fn corpus_and_changed(reader: &Reader) {
    let corpus = corpus(reader);
    let folder = tempfile::tempdir().expect("a folder");
    let read = |data: &[u8], what: &str| read(reader, folder.path(), data, what);
    let accepted = corpus.iter().filter(|(name, data)| read(data, name)).count();
    assert!(accepted > 0, "{}: no input of the corpus is accepted", reader.name);
    let mut random = Random(7);
    let mut refused = 0;
    for index in 0..CHANGED {
        let data = changed(&corpus, &mut random);
        refused += usize::from(!read(&data, &format!("changed input {index}")));
    }
    println!(
        "{}: {accepted} of {} accepted, {refused} of {CHANGED} changed ones refused",
        reader.name,
        corpus.len()
    );
    assert!(refused > CHANGED / 20, "{}: {refused} changed inputs were refused", reader.name);
}

/// Reads an input, which must come to an end of its own, soon; whether it was accepted.
fn read(reader: &Reader, folder: &Path, data: &[u8], what: &str) -> bool {
    let place = place(reader.name);
    std::fs::write(&place, data).expect("a folder for temporary files");
    under_way().insert(reader.name, (Instant::now(), what.to_owned()));
    let outcome = catch_unwind(AssertUnwindSafe(|| reader.read(folder, data)));
    under_way().remove(reader.name);
    assert!(outcome.is_ok(), "{}, {what}: panics; {}", reader.name, place.display());
    std::fs::remove_file(&place).expect("as it was left");
    outcome.expect("it did not panic")
}

/// Ends the program where an input takes too long. Nothing else can end what does not end by itself.
fn watch() {
    loop {
        std::thread::sleep(Duration::from_millis(200));
        let under_way = under_way();
        let stuck = under_way.iter().find(|(_, (begin, _))| begin.elapsed() > PATIENCE);
        if let Some((name, (_, what))) = stuck {
            let said = format!("{name}, {what}: takes too long; {}\n", place(name).display());
            // Not as tests print, which is kept until the test has come to its end.
            let _ = std::io::stderr().write_all(said.as_bytes());
            std::process::abort();
        }
    }
}

fn under_way() -> MutexGuard<'static, BTreeMap<&'static str, (Instant, String)>> {
    UNDER_WAY.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Where the input is that a reader reads.
fn place(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("deepshade-{name}-input-{}", std::process::id()))
}

/// The inputs that are kept, by name.
fn corpus(reader: &Reader) -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(reader.name);
    let entries = std::fs::read_dir(&folder).expect("the reader's folder of inputs");
    let mut inputs: Vec<_> = entries
        .map(|entry| {
            let entry = entry.expect("an entry");
            (entry.file_name().to_string_lossy().into_owned(), std::fs::read(entry.path()).expect("read"))
        })
        .collect();
    inputs.sort();
    inputs
}

/// An input of the corpus, changed in one to four places.
fn changed(corpus: &[(String, Vec<u8>)], random: &mut Random) -> Vec<u8> {
    let mut data = corpus[random.below(corpus.len())].1.clone();
    for _ in 0..=random.below(4) {
        let at = random.below(data.len() + 1);
        let end = (at + random.below(32)).min(data.len());
        match random.below(7) {
            0 if at < data.len() => data[at] ^= 1 << random.below(8),
            1 if at < data.len() => data[at] = [0, 1, 0x7f, 0x80, 0xff][random.below(5)],
            2 => data.truncate(at),
            3 => drop(data.drain(at..end)),
            4 => {
                let copied = data[at..end].to_vec();
                let place = random.below(data.len() + 1);
                data.splice(place..place, copied);
            }
            5 => {
                let (_, other) = &corpus[random.below(corpus.len())];
                let from = random.below(other.len() + 1);
                data.truncate(at);
                data.extend_from_slice(&other[from..]);
            }
            _ => replace_number(&mut data, at, random),
        }
    }
    data.truncate(LARGEST);
    data
}

/// Replaces the first number from a place on, where there is one, by another.
fn replace_number(data: &mut Vec<u8>, at: usize, random: &mut Random) {
    let Some(begin) = data[at..].iter().position(u8::is_ascii_digit).map(|found| at + found) else { return };
    let length = data[begin..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    data.splice(begin..begin + length, NUMBERS[random.below(NUMBERS.len())].bytes());
}

/// Random numbers (splitmix64).
struct Random(u64);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((bits ^ (bits >> 31)) % bound as u64) as usize
    }
}
