//! `deepshade farm` as an engine calls it: shards in any order, one that always fails, one that is killed, a recipe that
//! changes; in the end the bytes of one run. Real engines are for `cargo xtask farm`.

use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const SHARDS: usize = 4;
/// The one that fails at first.
const FAILING: usize = 2;

struct Farm(tempfile::TempDir);

impl Farm {
    fn path(&self, name: &str) -> String {
        self.0.path().join(name).display().to_string()
    }

    fn deepshade(&self, words: &[&str]) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_deepshade"));
        command.args(words).current_dir(env!("CARGO_MANIFEST_DIR")).output().expect("starts")
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
        let said = self.done(&["farm", "status", &self.path("jobs"), "--price", "0.5", "--json", &file]);
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
            _ => drop(farm.done(&words)),
        }
    }
    let (figures, said) = farm.status();
    assert_eq!((&figures["shards_made"], &figures["shards_failed"]), (&3.0.into(), &1.0.into()));
    assert_eq!((&figures["pairs_made"], &figures["tries"]), (&12.0.into(), &4.0.into()));
    assert!(figures["cost"].as_f64().is_some_and(|cost| cost > 0.0), "{figures}");
    assert!(said.contains("shard 2/4: failed: ") && said.contains("mine.txt"), "{said}");
    let merged = farm.path("merged");
    assert!(farm.refused(&["farm", "merge", &jobs, "--out", &merged]).contains("shard-2-of-4"));

    std::fs::remove_dir_all(&failing).expect("deleted");
    let refused = farm.refused(&["farm", "merge", &jobs, "--out", &merged]);
    assert!(refused.contains("shards are missing: 2/4"), "{refused}");
    farm.done(&["farm", "work", &jobs, "--shard", "2"]);
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
