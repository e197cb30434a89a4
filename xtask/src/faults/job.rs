//! The long jobs that are disturbed: each a command line that makes one folder, and what that holds in the end.

use crate::program::{Program, contents};
use anyhow::{Context, Result, ensure};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The smallest recipe that has every part of a dataset, from the workspace's root.
pub const RECIPE: &str = "dataset/recipes/ao-tiny.toml";

/// A job.
pub struct Job {
    /// What it is called in figures.
    pub name: &'static str,
    /// The arguments; `OUT` stands for the folder.
    words: Vec<String>,
    /// Whether a run is what it makes. Its files state times; what it has learned is seen in the model that it gives.
    is_run: bool,
    /// What it makes undisturbed.
    pub calm: Files,
    /// How long that takes.
    pub takes: Duration,
}

/// Files by name.
pub type Files = BTreeMap<PathBuf, Vec<u8>>;

/// What a dataset has until it is whole.
pub const JOURNAL: &str = "unfinished.jsonl";
const OUT: &str = "OUT";

impl Job {
    /// The command line for a folder.
    pub fn words(&self, out: &Path) -> Vec<String> {
        let word = |word: &String| if word == OUT { out.display().to_string() } else { word.clone() };
        self.words.iter().map(word).collect()
    }

    /// The files of a job under way, all with their final names; none of a run, whose files change until its end.
    ///
    /// # Errors
    /// If one cannot be read.
    pub fn so_far(&self, out: &Path) -> Result<Files> {
        if self.is_run {
            return Ok(Files::new());
        }
        let mut found = contents(out)?;
        found.remove(Path::new(JOURNAL));
        Ok(found)
    }

    /// What a job that is done has made.
    ///
    /// # Errors
    /// If a file cannot be read.
    pub fn result(&self, program: &Program, out: &Path) -> Result<Files> {
        if !self.is_run {
            return contents(out);
        }
        let model = out.with_extension("model");
        let word = Path::new;
        program.run(&[word("export"), word("--run"), out, word("--out"), &model])?;
        let found = contents(&model);
        std::fs::remove_dir_all(&model).with_context(|| model.display().to_string())?;
        found
    }

    /// Holds what a job that is done has made against what it makes undisturbed; gives the bytes that were compared.
    ///
    /// # Errors
    /// If a file is missing, left over or has other bytes.
    pub fn check_done(&self, program: &Program, out: &Path) -> Result<u64> {
        let found = self.result(program, out)?;
        let bytes = self.check_so_far(&found)?;
        let missing = self.calm.keys().find(|path| !found.contains_key(*path));
        ensure!(
            missing.is_none(),
            "{} is missing",
            missing.map_or_else(String::new, |path| path.display().to_string())
        );
        let left = std::fs::read_dir(out)?
            .flatten()
            .find(|entry| entry.file_name().to_string_lossy().starts_with('.'));
        ensure!(left.is_none(), "{:?} is left over", left.map(|entry| entry.file_name()));
        Ok(bytes)
    }

    /// Holds the files of a job under way, all with their final names, against what it makes undisturbed.
    ///
    /// # Errors
    /// If one is not of the job or has other bytes.
    pub fn check_so_far(&self, found: &Files) -> Result<u64> {
        for (path, bytes) in found {
            let calm = self.calm.get(path);
            ensure!(calm.is_some(), "{} is left over", path.display());
            ensure!(calm == Some(bytes), "{} has other bytes", path.display());
        }
        Ok(found.values().map(|bytes| bytes.len() as u64).sum())
    }
}

/// All jobs, done once undisturbed below a folder.
///
/// # Errors
/// If one fails.
pub fn all(program: &Program, folder: &Path) -> Result<Vec<Job>> {
    let path = |name: &str| folder.join(name).display().to_string();
    let words = |line: &str| -> Vec<String> { line.split(' ').map(str::to_owned).collect() };
    let made = |name: &'static str, line: String, is_run: bool| {
        let out = folder.join(format!("calm-{name}"));
        let mut job = Job { name, words: words(&line), is_run, calm: Files::new(), takes: Duration::ZERO };
        let start = Instant::now();
        program.run(&job.words(&out)).with_context(|| format!("{name}, undisturbed"))?;
        job.takes = start.elapsed();
        job.calm = job.result(program, &out)?;
        ensure!(!job.calm.is_empty(), "{name} makes nothing");
        Ok(job)
    };
    let dataset = made("dataset", format!("dataset generate {RECIPE} --out {OUT}"), false)?;
    for shard in 1..=3 {
        let out = path(&format!("shard-{shard}"));
        program.run(&words(&format!("dataset generate {RECIPE} --shard {shard}/3 --out {out}")))?;
    }
    let shards = [1, 2, 3].map(|shard| path(&format!("shard-{shard}"))).join(" ");
    let merge = made("merge", format!("dataset merge {shards} --out {OUT}"), false)?;
    let data = path("calm-dataset");
    let train =
        format!("train --dataset {data} --out {OUT} --steps 600 --crop 32 --batch 2 --validate-every 50");
    let train = made("train", train, true)?;
    let export = made("export", format!("export --run {} --out {OUT}", path("calm-train")), false)?;
    Ok(vec![dataset, merge, train, export])
}
