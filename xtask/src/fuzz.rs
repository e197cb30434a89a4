//! `cargo xtask fuzz`: the readers of everything that others may have written, by libFuzzer, which counts
//! what of the code each input reaches and changes those that reach something new.
//!
//! The targets are in `fuzz/`, in the form that cargo-fuzz has. They are built here by cargo alone, with the
//! flags that `cargo fuzz build --sanitizer none` gives: these are those of a stable compiler. A target runs
//! in turns; what it has done is noted after each, so that a run that was ended goes on.

use crate::command::{self, cargo, command, root, target};
use crate::figures::{self, write_text};
use anyhow::{Context, Result, bail, ensure};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::process::Stdio;

/// Executions of a turn.
const TURN: u64 = 250_000;
/// The longest that one input may take, seconds.
const PATIENCE: u32 = 20;
/// Largest input, bytes.
const LARGEST: u32 = 16_384;

/// Counters at every edge of the control flow, a table of their places, and the values that are compared.
const FLAGS: &str = "-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
    -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
    -Cllvm-args=-sanitizer-coverage-trace-compares -Cllvm-args=-simplifycfg-branch-fold-threshold=0 --cfg fuzzing";

/// What is run.
#[derive(clap::Args)]
pub struct Args {
    /// Executions of each target, which take hours.
    #[arg(long, default_value_t = 10_000_000)]
    executions: u64,
    /// Only the target of that name; can be given more than once.
    #[arg(long)]
    only: Vec<String>,
    /// Writes the figures here as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
}

/// Runs every target until it has done its executions, and says what was found.
///
/// # Errors
/// If the targets do not build, or something was found.
pub fn run(args: &Args) -> Result<()> {
    let Args { executions, only, json } = args;
    let all = names()?;
    if let Some(name) = only.iter().find(|name| !all.contains(name)) {
        bail!("there is no target `{name}`; there are {}", all.join(", "));
    }
    let work = target().join("fuzz");
    let programs = build(&work)?;
    let targets: Vec<Target> = all
        .into_iter()
        .filter(|name| only.is_empty() || only.contains(name))
        .map(|name| Target::new(&work, &programs, name))
        .collect::<Result<_>>()?;
    // In turns, so that whenever it is ended all have come about as far.
    while let Some(next) = targets
        .iter()
        .filter(|target| target.done() < *executions && target.found() == 0)
        .min_by_key(|target| target.done())
    {
        next.turn(executions - next.done())?;
    }
    let mut figures: Vec<(String, f64)> =
        targets.iter().map(|target| (format!("executions_{}", target.name), target.done() as f64)).collect();
    let crashes: usize = targets.iter().map(Target::found).sum();
    figures.push(("crashes".to_owned(), crashes as f64));
    figures::write(json.as_deref(), "fuzz", &figures, json!({}))?;
    figures.iter().for_each(|(name, value)| println!("{name}: {value}"));
    ensure!(crashes == 0, "{crashes} inputs break a reader: {}", work.join("found").display());
    Ok(())
}

/// The targets' names, which their files have.
fn names() -> Result<Vec<String>> {
    let folder = root().join("fuzz/fuzz_targets");
    let files = std::fs::read_dir(&folder).with_context(|| folder.display().to_string())?;
    let stem = |path: PathBuf| Some(path.file_stem()?.to_string_lossy().into_owned());
    let mut names: Vec<String> = files.flatten().filter_map(|entry| stem(entry.path())).collect();
    names.sort();
    Ok(names)
}

/// Builds the targets; gives the folder that they are in.
fn build(work: &Path) -> Result<PathBuf> {
    let version = command("rustc", &["-vV"]).output().context("rustc")?;
    let version = String::from_utf8_lossy(&version.stdout).into_owned();
    let host = version.lines().find_map(|line| line.strip_prefix("host: ")).context("rustc names no host")?;
    let folder = work.join("target").display().to_string();
    // With a target named, the flags are not those of build scripts and macros.
    let place = ["--manifest-path", "fuzz/Cargo.toml", "--target", host, "--target-dir", &folder];
    let mut build = cargo(&[&["build", "--release", "--locked", "--bins"][..], &place].concat());
    command::run(build.env("RUSTFLAGS", FLAGS))?;
    Ok(work.join("target").join(host).join("release"))
}

/// A target with what it has come to.
struct Target {
    name: String,
    program: PathBuf,
    /// What it has found out and done, below the target folder.
    work: PathBuf,
}

impl Target {
    fn new(work: &Path, programs: &Path, name: String) -> Result<Self> {
        let program = programs.join(format!("{name}{}", std::env::consts::EXE_SUFFIX));
        let target = Self { program, work: work.to_owned(), name };
        for folder in [target.corpus(), target.artifacts()] {
            std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
        }
        Ok(target)
    }

    /// Inputs that reach what no other does.
    fn corpus(&self) -> PathBuf {
        self.work.join("corpus").join(&self.name)
    }

    /// Inputs that break it.
    fn artifacts(&self) -> PathBuf {
        self.work.join("found").join(&self.name)
    }

    fn note(&self) -> PathBuf {
        self.work.join(format!("{}.executions", self.name))
    }

    /// Executions so far.
    fn done(&self) -> u64 {
        std::fs::read_to_string(self.note()).ok().and_then(|text| text.trim().parse().ok()).unwrap_or(0)
    }

    /// How many inputs break it.
    fn found(&self) -> usize {
        std::fs::read_dir(self.artifacts()).map_or(0, |found| found.flatten().count())
    }

    /// Some executions more, at most so many.
    fn turn(&self, most: u64) -> Result<()> {
        let executions = most.min(TURN);
        let kept = root().join("fuzz/corpus").join(&self.name);
        let words = root().join(format!("fuzz/dictionaries/{}.dict", self.name));
        let inputs = Files(inputs_folder(&self.name)?);
        let mut run = command(&self.program.display().to_string(), &[self.corpus(), kept]);
        run.args([
            format!("-runs={executions}"),
            format!("-timeout={PATIENCE}"),
            // What is slower than usual and yet in time may be a machine that had other work.
            format!("-report_slow_units={PATIENCE}"),
            format!("-max_len={LARGEST}"),
        ])
        .args(["-rss_limit_mb=3000", "-print_final_stats=0"])
        .arg(format!("-artifact_prefix={}/", self.artifacts().display()))
        .env("TMPDIR", &inputs.0)
        .stdout(Stdio::null())
        .stderr(Stdio::null());
        if words.exists() {
            run.arg(format!("-dict={}", words.display()));
        }
        let status = run.status().with_context(|| self.program.display().to_string())?;
        // What breaks a reader is left among the artifacts.
        ensure!(
            status.success() || self.found() > 0,
            "{} ended with {status} without an input that breaks it",
            self.name
        );
        if status.success() {
            write_text(&self.note(), &(self.done() + executions).to_string())?;
        }
        println!("{}: {} executions, {} findings", self.name, self.done(), self.found());
        Ok(())
    }
}

/// A folder that goes with this.
struct Files(PathBuf);

impl Drop for Files {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A folder for the files of inputs: in memory where the system has a place for that.
fn inputs_folder(name: &str) -> Result<PathBuf> {
    let shared = Path::new("/dev/shm");
    let place = if shared.is_dir() { shared.to_owned() } else { std::env::temp_dir() };
    let folder = place.join(format!("deepshade-fuzz-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    Ok(folder)
}
