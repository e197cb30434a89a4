//! `deepshade dataset generate`, killed again and again, ends with the bytes of an undisturbed run, and no
//! half file ever bears a final name.

use std::collections::BTreeMap;
use std::hash::{BuildHasher, RandomState};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Pairs of the recipe.
const PAIRS: usize = 16;
const JOURNAL: &str = "unfinished.jsonl";
const MANIFEST: &str = "manifest.json";

/// When a run is killed.
#[derive(Debug)]
enum KillTime {
    /// Once the journal has so many pairs.
    Pairs(usize),
    /// After a time.
    After(Duration),
}

fn start(out: &Path) -> Child {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut command = Command::new(env!("CARGO_BIN_EXE_deepshade"));
    command.args(["dataset", "generate", "dataset/recipes/ao-tiny.toml", "--out"]).arg(out);
    command.current_dir(root).stdout(Stdio::null()).spawn().expect("starts")
}

fn finish(out: &Path) {
    assert!(start(out).wait().expect("ends").success(), "{}", out.display());
}

/// Contents of all files of a dataset by name; none where there is no folder yet.
fn files(out: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for folder in ["", "pairs"] {
        for entry in std::fs::read_dir(out.join(folder)).into_iter().flatten().flatten() {
            if entry.path().is_file() {
                let name = Path::new(folder).join(entry.file_name()).display().to_string();
                found.insert(name, std::fs::read(entry.path()).expect("read"));
            }
        }
    }
    found
}

/// Pairs in the journal: its whole lines but for the first, which says what is made.
fn journalled(out: &Path) -> usize {
    let bytes = std::fs::read(out.join(JOURNAL)).unwrap_or_default();
    bytes.iter().filter(|byte| **byte == b'\n').count().saturating_sub(1)
}

/// Starts a run and kills it, or waits for its end where that comes first.
fn disturb(out: &Path, moment: &KillTime) {
    let mut child = start(out);
    let begin = Instant::now();
    let now = || match moment {
        KillTime::Pairs(pairs) => journalled(out) >= *pairs,
        KillTime::After(time) => begin.elapsed() >= *time,
    };
    while !now() && child.try_wait().expect("asked").is_none() {
        std::thread::sleep(Duration::from_millis(1));
    }
    // SIGKILL; a run that has ended already has nothing to be killed.
    let _ = child.kill();
    child.wait().expect("ends");
}

/// All files that bear a final name are those of an undisturbed run.
fn assert_whole(out: &Path, undisturbed: &BTreeMap<String, Vec<u8>>, moment: &KillTime) {
    for (name, bytes) in files(out) {
        let unfinished = name == JOURNAL || name.contains(".deepshade-");
        assert!(unfinished || undisturbed.get(&name) == Some(&bytes), "{name} after {moment:?}");
    }
}

#[test]
fn a_run_killed_at_any_moment_ends_with_the_bytes_of_an_undisturbed_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let (calm, out) = (folder.path().join("calm"), folder.path().join("killed"));
    let begin = Instant::now();
    finish(&calm);
    let whole = begin.elapsed();
    let undisturbed = files(&calm);
    assert_eq!(undisturbed.len(), PAIRS + 1, "the pairs and the manifest");
    assert!(undisturbed.contains_key(MANIFEST));

    let random = RandomState::new();
    let after = |index: u64| {
        let share = random.hash_one(index) as f64 / u64::MAX as f64;
        KillTime::After(whole.mul_f64(0.4 * share))
    };
    let moments =
        [after(0), KillTime::Pairs(1), after(1), KillTime::Pairs(7), after(2), KillTime::Pairs(12), after(3)];
    let mut reached = Vec::new();
    for moment in &moments {
        disturb(&out, moment);
        assert_whole(&out, &undisturbed, moment);
        if !out.join(MANIFEST).exists() {
            reached.push(journalled(&out));
        }
    }
    assert!(
        reached.iter().any(|pairs| (1..PAIRS).contains(pairs)),
        "no kill fell in the middle: {reached:?}"
    );
    assert!(reached.is_sorted(), "a killed run lost pairs: {reached:?}");
    finish(&out);
    assert!(files(&out) == undisturbed, "other bytes, or something is left over");
}

/// Sends a signal, named as kill(1) has it.
#[cfg(unix)]
fn send(signal: &str, child: &Child) {
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).status();
    assert!(sent.is_ok_and(|status| status.success()), "{signal}");
}

#[cfg(all(unix, feature = "train"))]
#[test]
fn a_training_that_is_interrupted_says_which_step_it_keeps_and_goes_on_from_there() {
    let folder = tempfile::tempdir().expect("a folder");
    let (data, run) = (folder.path().join("data"), folder.path().join("run"));
    finish(&data);
    let train = |more: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_deepshade"));
        command.args([
            "train",
            "--steps",
            "1000000",
            "--batch",
            "2",
            "--crop",
            "64",
            "--validation-pairs",
            "2",
        ]);
        command.args(more).arg("--dataset").arg(&data).arg("--out").arg(&run);
        command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("starts")
    };
    let lines = || std::fs::read_to_string(run.join("metrics.jsonl")).map_or(0, |text| text.lines().count());
    let first = train(&[]);
    while lines() < 1 {
        std::thread::sleep(Duration::from_millis(10));
    }
    send("-INT", &first);
    let ended = first.wait_with_output().expect("ends");
    let said = String::from_utf8_lossy(&ended.stderr).into_owned();
    assert_eq!(ended.status.code(), Some(130), "{said}");
    assert!(said.starts_with("training a network for ao on "), "the first line comes at once: {said}");
    let number = |text: &str, before: &str| -> usize {
        let (_, rest) = text.rsplit_once(before).expect(text);
        rest.split(|letter: char| !letter.is_ascii_digit()).next().unwrap_or_default().parse().expect(text)
    };
    let kept = number(&said, "interrupted at step ");
    assert!(said.contains("of 1000000, which is kept; the same command goes on"), "{said}");
    // A line of the log is written each twenty steps, and checkpoints are rarer.
    assert!((20..250).contains(&kept), "{said}");
    let second = train(&["--minutes", "0.0001"]).wait_with_output().expect("ends");
    let said = String::from_utf8_lossy(&second.stdout).into_owned();
    assert!(second.status.success() && number(&said, "step ") >= kept, "{said}");
    let bar = String::from_utf8_lossy(&second.stderr).into_owned();
    assert!(bar.contains(&format!("training 0:00 of 0:00, 0s left, step {kept} of 1000000")), "{bar}");
}

#[cfg(unix)]
#[test]
fn ctrl_c_has_its_code_and_whoever_comes_second_is_told_who_has_the_folder() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let begin = || {
        let mut command = Command::new(env!("CARGO_BIN_EXE_deepshade"));
        command.args(["dataset", "generate", "dataset/recipes/ao-tiny.toml", "--out"]).arg(&out);
        command.current_dir(root).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("starts")
    };
    let first = begin();
    while journalled(&out) < 2 {
        std::thread::sleep(Duration::from_millis(1));
    }
    send("-STOP", &first);
    assert!(!out.join(MANIFEST).exists(), "stopped too late");
    let second = begin().wait_with_output().expect("ends");
    let message = String::from_utf8_lossy(&second.stderr).into_owned();
    assert_eq!(second.status.code(), Some(1), "{message}");
    assert!(message.contains(&format!("process {} ", first.id())), "{message}");
    send("-INT", &first);
    send("-CONT", &first);
    let interrupted = first.wait_with_output().expect("ends");
    let message = String::from_utf8_lossy(&interrupted.stderr).into_owned();
    assert_eq!(interrupted.status.code(), Some(130), "{message}");
    assert!(message.contains("the same command goes on"), "{message}");
    finish(&out);
    assert_eq!(files(&out).len(), PAIRS + 1, "the pairs and the manifest, and nothing left over");
}
