//! `deepshade farm` as an engine calls it: shards in any order, one that always fails, one that is killed, a
//! recipe that changes; in the end the bytes of one run.

use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;

const SHARDS: usize = 4;
/// The one that fails at first.
const FAILING: usize = 2;
/// The one that is killed at first.
const KILLED: usize = 3;

struct Farm(tempfile::TempDir);

impl Farm {
    fn path(&self, name: &str) -> String {
        self.0.path().join(name).display().to_string()
    }

    fn command(&self, words: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_deepshade"));
        command.args(words).current_dir(env!("CARGO_MANIFEST_DIR"));
        command
    }

    fn deepshade(&self, words: &[&str]) -> Output {
        self.command(words).output().expect("starts")
    }

    /// Makes a shard until its first pair is there, and kills what makes it.
    fn kill(&self, words: &[&str]) {
        let journal = format!("shards/shard-{KILLED}-of-{SHARDS}/unfinished.jsonl");
        let lines = || std::fs::read_to_string(self.path(&journal)).map_or(0, |text| text.lines().count());
        // As an engine's file has it for a task of one core.
        let mut child = self.command(words).env("RAYON_NUM_THREADS", "1").stdout(Stdio::null()).spawn();
        let child = child.as_mut().expect("starts");
        while lines() < 2 && child.try_wait().expect("asked").is_none() {
            std::thread::sleep(Duration::from_millis(1));
        }
        child.kill().expect("killed");
        assert!(!child.wait().expect("ends").success(), "it was done before it could be killed");
    }

    fn done(&self, words: &[&str]) -> String {
        let output = self.deepshade(words);
        assert!(output.status.success(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).expect("text")
    }

    fn refused(&self, words: &[&str]) -> String {
        let output = self.deepshade(words);
        assert_eq!(output.status.code(), Some(1), "{words:?}");
        String::from_utf8(output.stderr).expect("text")
    }

    fn plan(&self, recipe: &str, jobs: &str) -> Vec<String> {
        let shards = SHARDS.to_string();
        let (out, jobs) = (self.path("shards"), self.path(jobs));
        let words =
            ["farm", "plan", recipe, "--out", &out, "--jobs", &jobs, "--engine", "ray", "--shards", &shards];
        words.map(str::to_owned).to_vec()
    }

    /// The figures of the status, and what is said of shards that failed.
    fn status(&self) -> (Value, String) {
        let file = self.path("status.json");
        let said = self.done(&["farm", "status", &self.path("jobs"), "--json", &file]);
        let json: Value = serde_json::from_slice(&std::fs::read(file).expect("written")).expect("JSON");
        (json["figures"].clone(), said)
    }
}

fn files(folder: &str) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for part in ["", "pairs"] {
        for entry in std::fs::read_dir(Path::new(folder).join(part)).expect("a folder").flatten() {
            if entry.path().is_file() {
                found.insert(
                    Path::new(part).join(entry.file_name()),
                    std::fs::read(entry.path()).expect("read"),
                );
            }
        }
    }
    found
}

#[test]
fn shards_of_a_farm_are_one_dataset_and_failures_are_named() {
    let farm = Farm(tempfile::tempdir().expect("a folder"));
    let recipe = farm.path("recipe.toml");
    let tiny = Path::new(env!("CARGO_MANIFEST_DIR")).join("dataset/recipes/ao-tiny.toml");
    std::fs::copy(tiny, &recipe).expect("copied");
    let plan = farm.plan(&recipe, "jobs");
    let words: Vec<&str> = plan.iter().map(String::as_str).collect();
    assert!(farm.done(&words).contains("16 pairs in 4 shards"));
    assert!(farm.refused(&words).contains("holds something"), "a plan is not written over");

    let failing = Path::new(&farm.path("shards")).join(format!("shard-{FAILING}-of-{SHARDS}"));
    std::fs::create_dir_all(&failing).expect("made");
    std::fs::write(failing.join("mine.txt"), "somebody's own").expect("written");
    let jobs = farm.path("jobs");
    let work = |shard: usize| ["farm", "work", &jobs, "--shard", &shard.to_string()].map(str::to_owned);
    for shard in (1..=SHARDS).rev() {
        let words = work(shard);
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        match shard {
            FAILING => assert!(farm.refused(&words).contains("mine.txt")),
            KILLED => farm.kill(&words),
            _ => drop(farm.done(&words)),
        }
    }
    let (figures, said) = farm.status();
    assert_eq!((&figures["shards_made"], &figures["shards_failed"]), (&2.0.into(), &1.0.into()));
    assert!(said.contains("shard 2/4: failed: ") && said.contains("mine.txt"), "{said}");
    assert!(said.contains(&format!("missing: python3 {jobs}/ray_tasks.py 2 3")), "{said}");
    let merged = farm.path("merged");
    let refused = farm.refused(&["farm", "merge", &jobs, "--out", &merged]);
    assert!(refused.contains("shards are missing: 2/4, 3/4"), "{refused}");

    std::fs::remove_dir_all(&failing).expect("deleted");
    for shard in [FAILING, KILLED] {
        farm.done(&["farm", "work", &jobs, "--shard", &shard.to_string()]);
    }
    let (figures, said) = farm.status();
    assert_eq!((&figures["shards_made"], &figures["shards_failed"]), (&4.0.into(), &0.0.into()));
    assert!(said.contains("next: deepshade farm merge"), "{said}");
    farm.done(&["farm", "merge", &jobs, "--out", &merged]);
    let whole = farm.path("whole");
    farm.done(&["dataset", "generate", &recipe, "--out", &whole]);
    assert!(files(&merged) == files(&whole), "other bytes");

    std::fs::write(&recipe, std::fs::read_to_string(&recipe).expect("read") + "\n# changed\n")
        .expect("written");
    assert!(farm.refused(&["farm", "work", &jobs, "--shard", "1"]).contains("has changed since"));
    assert!(farm.refused(&["farm", "work", &jobs, "--shard", "9"]).contains("9/4"));
}
