//! `deepshade-studies kills`: long jobs killed at random moments, and what they then make. All that bears a
//! final name must be what an undisturbed job makes, byte for byte, right after a kill and in the end.

use anyhow::{Context, Result, bail, ensure};
use deepshade::shared::figures::Figures;
use deepshade_shaders::atomic_file::TEMPORARY_PREFIX;
use serde_json::json;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Long jobs killed at random moments: whether they make, byte for byte, what they make undisturbed.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade-studies kills --kills 1000 --json kills.json")]
pub struct Args {
    /// How many kills.
    #[arg(long, default_value_t = 60)]
    kills: usize,
    /// Chooses the moments.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// The recipe, a TOML file.
    #[arg(long, default_value = "dataset/recipes/ao-tiny.toml")]
    recipe: PathBuf,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = deepshade::shared::arguments::written_file)]
    json: Option<PathBuf>,
}

/// Files by name.
type Files = BTreeMap<PathBuf, Vec<u8>>;

/// A command that makes a folder, and what it makes undisturbed.
struct Job {
    name: &'static str,
    /// The command line, without the folder, which its last option names.
    line: String,
    /// Whether it makes a training run. Its files state times; what it has learned is seen in its model.
    is_run: bool,
    calm: Files,
    takes: Duration,
}

/// What a dataset has until it is whole.
const JOURNAL: &str = "unfinished.jsonl";
/// A job is killed so often before it is left alone.
const IN_A_ROW: usize = 4;

/// Kills, compares and prints.
///
/// # Errors
/// If a job fails of itself, or has made something else than undisturbed.
pub fn run(args: &Args) -> Result<()> {
    let folder = tempfile::tempdir().context("a temporary folder")?;
    let jobs = jobs(&args.recipe, folder.path())?;
    let mut moments = (0..).map(|turn: u64| share(args.seed, turn));
    let mut by_job = BTreeMap::<&str, usize>::new();
    let (mut kills, mut bytes) = (0, 0);
    for job in jobs.iter().cycle() {
        if kills >= args.kills {
            break;
        }
        let out = folder.path().join("killed");
        let mut met = 0;
        for moment in moments.by_ref().take(IN_A_ROW.min(args.kills - kills)) {
            if !killed(job, &out, job.takes.mul_f64(moment))? {
                break;
            }
            met += 1;
            let found = if job.is_run { Files::new() } else { files(&out)? };
            bytes += compared(job, &found).with_context(|| format!("{}, right after a kill", job.name))?;
        }
        started(&job.line, &out)?;
        let found = made(job, &out)?;
        bytes += compared(job, &found).with_context(|| format!("{}, in the end", job.name))?;
        ensure!(found.len() == job.calm.len(), "{}: something is missing", job.name);
        std::fs::remove_dir_all(&out).with_context(|| out.display().to_string())?;
        kills += met;
        *by_job.entry(job.name).or_default() += met;
    }
    let mut figures = Figures::new("kills");
    figures.set("kills", kills as f64);
    figures.set("bytes", bytes as f64);
    figures.detail("by_job", json!(by_job));
    figures.write(args.json.as_deref())?;
    by_job.iter().try_for_each(|(name, kills)| say!("{name}: {kills} kills"))?;
    say!("{bytes} bytes are those of undisturbed jobs")
}

/// All jobs, done once undisturbed: pairs, a shard, a merge, a training, an export.
fn jobs(recipe: &Path, folder: &Path) -> Result<Vec<Job>> {
    let path = |name: &str| folder.join(name).display().to_string();
    let generate = format!("dataset generate {}", recipe.display());
    let shards = [1, 2, 3].map(|shard| path(&format!("shard-{shard}")));
    for (shard, out) in (1..).zip(&shards) {
        started(&format!("{generate} --shard {shard}/3 --out"), Path::new(out))?;
    }
    let merge = format!("dataset merge {} --out", shards.join(" "));
    let settings = "--steps 600 --crop 32 --batch 2 --validate-every 50";
    let train = format!("train --dataset {} {settings} --out", path("dataset"));
    let lines = [
        ("dataset", format!("{generate} --out")),
        ("shard", format!("{generate} --shard 2/3 --out")),
        ("merge", merge),
        ("train", train),
        ("export", format!("export --run {} --out", path("train"))),
    ];
    let calm = lines.into_iter().map(|(name, line)| {
        let out = folder.join(name);
        let start = Instant::now();
        started(&line, &out)?;
        let takes = start.elapsed();
        let mut job = Job { name, line, is_run: name == "train", calm: Files::new(), takes };
        job.calm = made(&job, &out)?;
        ensure!(!job.calm.is_empty(), "{name} makes nothing");
        Ok(job)
    });
    calm.collect()
}

fn command(line: &str, out: &Path) -> Result<Command> {
    let mut command = Command::new(crate::program::deepshade()?);
    command.args(line.split(' ')).arg(out).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
    Ok(command)
}

/// Runs a job to its end.
fn started(line: &str, out: &Path) -> Result<()> {
    let output = command(line, out)?.output()?;
    let said = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "deepshade {line}: {}: {}", output.status, said.trim());
    Ok(())
}

/// Kills a job after a time; `false` if it was done before.
fn killed(job: &Job, out: &Path, moment: Duration) -> Result<bool> {
    let mut child = command(&job.line, out)?.stderr(Stdio::null()).spawn()?;
    let start = Instant::now();
    while start.elapsed() < moment && child.try_wait()?.is_none() {
        std::thread::sleep(Duration::from_micros(200));
    }
    // One that has ended meanwhile has nothing to be killed.
    let _ = child.kill();
    let status = child.wait()?;
    if status.code().is_some_and(|code| code != 0) {
        bail!("{} failed before it was killed: {status}", job.name);
    }
    Ok(!status.success())
}

/// From 0 to 1, by a seed and a turn.
fn share(seed: u64, turn: u64) -> f64 {
    let hash = blake3::hash(&[seed.to_le_bytes(), turn.to_le_bytes()].concat());
    let bytes: [u8; 4] = std::array::from_fn(|index| hash.as_bytes()[index]);
    f64::from(u32::from_le_bytes(bytes)) / f64::from(u32::MAX)
}

/// What a job that is done has made.
fn made(job: &Job, out: &Path) -> Result<Files> {
    if !job.is_run {
        return files(out);
    }
    let model = tempfile::tempdir().context("a temporary folder")?;
    let place = model.path().join("model");
    started(&format!("export --run {} --out", out.display()), &place)?;
    files(&place)
}

/// Holds files against those of the undisturbed job; gives how many bytes they have.
fn compared(job: &Job, found: &Files) -> Result<usize> {
    for (name, bytes) in found {
        ensure!(job.calm.get(name) == Some(bytes), "{} is left over or has other bytes", name.display());
    }
    Ok(found.values().map(Vec::len).sum())
}

/// All files with final names below a folder, if it is there.
fn files(folder: &Path) -> Result<Files> {
    let mut found = Files::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(place) = folders.pop() {
        for entry in std::fs::read_dir(&place).into_iter().flatten().flatten() {
            let (path, name) = (entry.path(), entry.file_name().to_string_lossy().into_owned());
            if path.is_dir() {
                folders.push(path);
            } else if name != JOURNAL && !name.starts_with(TEMPORARY_PREFIX) {
                let bytes = std::fs::read(&path).with_context(|| path.display().to_string())?;
                found.insert(path.strip_prefix(folder)?.to_owned(), bytes);
            }
        }
    }
    Ok(found)
}
