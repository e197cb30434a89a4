//! The long jobs that are disturbed: each a command line that makes one folder, and what that holds in the end.

use crate::command::command;
use crate::program::{Program, contents};
use anyhow::{Context, Result, ensure};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

/// A job.
pub struct Job {
    /// What it is called in figures.
    pub name: &'static str,
    /// The arguments; `OUT` stands for the folder.
    line: String,
    /// What it makes.
    makes: Makes,
    /// Kilobytes of a disk that are enough for a part of that, where it is all that is in the folder.
    pub few_kilobytes: Option<u32>,
    /// What it makes undisturbed.
    pub calm: Files,
    /// How long that takes.
    pub takes: Duration,
}

/// What a job makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Makes {
    /// Pairs, rendered one after the other.
    Pairs,
    /// The few pairs of one shard of a farm, as a task of an engine makes it: [`PLAN`], [`SHARD`].
    Shard,
    /// Copies of pairs, in milliseconds.
    Copies,
    /// A run. Its files state times; what it has learned is seen in the model that it gives.
    Run,
    /// A model, in milliseconds.
    Model,
}

/// Files by name.
pub type Files = BTreeMap<PathBuf, Vec<u8>>;

/// What a dataset has until it is whole.
pub const JOURNAL: &str = "unfinished.jsonl";
const OUT: &str = "OUT";
/// What makes a dataset, of the smallest recipe that has every part of one.
const DATASET: &str = "dataset generate dataset/recipes/ao-tiny.toml --out OUT";
/// What plans the farm, once for each folder.
const PLAN: &str =
    "farm plan dataset/recipes/ao-tiny.toml --shards 3 --engine slurm --out OUT/shards --jobs OUT/jobs";
/// What says how the farm is doing, and what it says of one shard of it.
const STATUS: (&str, &str) = ("farm status OUT/jobs", "1 of 3 shards made");
/// Where its shard is.
const SHARD: &str = "shards/shard-2-of-3";

impl Job {
    /// The job in a folder, after words that run it.
    pub fn command(&self, program: &Program, out: &Path, before: &[&str]) -> Command {
        let mut words: Vec<String> = before.iter().map(|word| (*word).to_owned()).collect();
        words.push(program.path().display().to_string());
        words.extend(filled(&self.line, out));
        let mut job = command(&words[0], &words[1..]);
        if self.makes == Makes::Shard {
            // As an engine's file has it for a task of one core.
            job.env("RAYON_NUM_THREADS", "1");
        }
        job
    }

    /// Runs it to its end.
    ///
    /// # Errors
    /// If it fails, with what it says.
    pub fn run(&self, program: &Program, out: &Path) -> Result<()> {
        let output = self.command(program, out, &[]).output()?;
        ensure!(output.status.success(), "{}: {}", output.status, crate::program::message(&output));
        Ok(())
    }

    /// What comes before the first run in a folder.
    ///
    /// # Errors
    /// If it fails.
    pub fn prepare(&self, program: &Program, out: &Path) -> Result<()> {
        if self.makes == Makes::Shard { program.run(&filled(PLAN, out)) } else { Ok(()) }
    }

    /// Where what it makes is.
    pub fn made(&self, out: &Path) -> PathBuf {
        if self.makes == Makes::Shard { out.join(SHARD) } else { out.to_owned() }
    }

    /// Whether it is done so soon that it must be slowed down to be met at work.
    pub fn is_quick(&self) -> bool {
        matches!(self.makes, Makes::Shard | Makes::Copies | Makes::Model)
    }

    /// Whether it has come so far that it has something to lose.
    pub fn begun(&self, out: &Path) -> bool {
        let made = self.made(out);
        match self.makes {
            Makes::Pairs | Makes::Shard => {
                let journal = std::fs::read(made.join(JOURNAL)).unwrap_or_default();
                journal.iter().filter(|byte| **byte == b'\n').count() >= 3
            }
            Makes::Run => made.join("checkpoint.safetensors").exists(),
            // Be it a file under way.
            Makes::Copies | Makes::Model => {
                std::fs::read_dir(&made).is_ok_and(|mut entries| entries.next().is_some())
            }
        }
    }

    /// The files of a job under way, all with their final names; none of a run, whose files change until its end.
    ///
    /// # Errors
    /// If one cannot be read.
    pub fn so_far(&self, out: &Path) -> Result<Files> {
        if self.makes == Makes::Run {
            return Ok(Files::new());
        }
        let mut found = contents(&self.made(out))?;
        found.remove(Path::new(JOURNAL));
        Ok(found)
    }

    /// What a job that is done has made.
    ///
    /// # Errors
    /// If a file cannot be read, or a farm does not know what it has.
    fn result(&self, program: &Program, out: &Path) -> Result<Files> {
        match self.makes {
            Makes::Run => {
                let model = out.with_extension("model");
                let word = Path::new;
                program.run(&[word("export"), word("--run"), out, word("--out"), &model])?;
                let found = contents(&model);
                std::fs::remove_dir_all(&model).with_context(|| model.display().to_string())?;
                found
            }
            Makes::Shard => {
                let (line, said) = STATUS;
                let status = program.output(&filled(line, out))?;
                let text = String::from_utf8_lossy(&status.stdout).into_owned();
                ensure!(text.contains(said), "the farm does not say `{said}`: {text}");
                contents(&self.made(out))
            }
            Makes::Pairs | Makes::Copies | Makes::Model => contents(out),
        }
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
        let left = std::fs::read_dir(self.made(out))?
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

/// The words of a line for a folder.
fn filled(line: &str, out: &Path) -> Vec<String> {
    let word = |word: &str| match word.strip_prefix(OUT) {
        Some(below) => format!("{}{below}", out.display()),
        None => word.to_owned(),
    };
    line.split(' ').map(word).collect()
}

/// All jobs, done once undisturbed below a folder: pairs, a shard of a farm, a merge, a training, an export.
///
/// # Errors
/// If one fails.
pub fn all(program: &Program, folder: &Path) -> Result<Vec<Job>> {
    let path = |name: &str| folder.join(name).display().to_string();
    let made = |name: &'static str, line: String, makes: Makes, few_kilobytes: Option<u32>| {
        let out = folder.join(format!("calm-{name}"));
        let calm = Files::new();
        let mut job = Job { name, line, makes, few_kilobytes, calm, takes: Duration::ZERO };
        let undisturbed = || format!("{name}, undisturbed");
        job.prepare(program, &out).with_context(undisturbed)?;
        let start = Instant::now();
        job.run(program, &out).with_context(undisturbed)?;
        job.takes = start.elapsed();
        job.calm = job.result(program, &out)?;
        ensure!(!job.calm.is_empty(), "{name} makes nothing");
        Ok(job)
    };
    let dataset = made("dataset", DATASET.to_owned(), Makes::Pairs, Some(150))?;
    let farm = made("farm", "farm work OUT/jobs --shard 2".to_owned(), Makes::Shard, None)?;
    let shards = [1, 2, 3].map(|shard| {
        let out = path(&format!("shard-{shard}"));
        let line = format!("{DATASET} --shard {shard}/3");
        program.run(&filled(&line, Path::new(&out))).map(|()| out)
    });
    let shards = shards.into_iter().collect::<Result<Vec<_>>>()?.join(" ");
    let merge = made("merge", format!("dataset merge {shards} --out OUT"), Makes::Copies, Some(150))?;
    let data = path("calm-dataset");
    let train =
        format!("train --dataset {data} --out OUT --steps 600 --crop 32 --batch 2 --validate-every 50");
    // A checkpoint, and no second one beside it.
    let train = made("train", train, Makes::Run, Some(1400))?;
    let export = format!("export --run {} --out OUT", path("calm-train"));
    let export = made("export", export, Makes::Model, Some(400))?;
    Ok(vec![dataset, farm, merge, train, export])
}
