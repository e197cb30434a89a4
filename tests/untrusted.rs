//! Everything that others may have written, read from the corpus that `cargo xtask fuzz` begins with, as it is and changed
//! at random: nothing panics, hangs or asks for the whole memory. What libFuzzer has found lies in the corpus, too.

#[path = "../fuzz/src/readers.rs"]
mod readers;

use rayon::prelude::*;
use readers::{READERS, Reader};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::{Duration, Instant};

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
    READERS.par_iter().for_each(|reader| {
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
    });
}

/// Reads an input, which must come to an end of its own, soon; whether it was accepted.
fn read(reader: &Reader, folder: &Path, data: &[u8], what: &str) -> bool {
    let begin = Instant::now();
    let outcome = catch_unwind(AssertUnwindSafe(|| reader.read(folder, data)));
    let place = || {
        let place = std::env::temp_dir().join(format!("deepshade-{}-input", reader.name));
        std::fs::write(&place, data).map_or_else(|error| error.to_string(), |()| place.display().to_string())
    };
    assert!(begin.elapsed() < PATIENCE, "{}, {what}: takes too long; {}", reader.name, place());
    assert!(outcome.is_ok(), "{}, {what}: panics; {}", reader.name, place());
    outcome.expect("it did not panic")
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
