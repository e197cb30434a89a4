//! `deepshade bench farm`: training pairs an hour by one, two and more workers on this machine, and whether what they make
//! is what one run makes, byte for byte.
//!
//! A worker is a process of one thread that makes shard after shard, as an engine's tasks do (`deepshade farm work`), so
//! that starting, reading scenes again and putting shards together count. With more workers than cores there is nothing
//! to gain, and the figures say so.

use crate::figures::Figures;
use anyhow::{Context, Result, ensure};
use serde_json::json;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Instant;

/// Training pairs an hour by several workers on this machine, and whether their bytes are those of one run.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade bench farm --workers 1,2,4 --json farm.json")]
pub struct Args {
    /// The recipe, a TOML file.
    #[arg(long, default_value = "dataset/recipes/ao-tiny.toml")]
    recipe: PathBuf,
    /// Processes at a time.
    #[arg(long, value_delimiter = ',', default_value = "1,2,4", value_parser = clap::value_parser!(u32).range(1..=64))]
    workers: Vec<u32>,
    /// Into how many shards the dataset is cut.
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=1000))]
    shards: u32,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
}

/// Measures and prints.
///
/// # Errors
/// If the recipe is at fault or a worker fails, or what they made differs from what one run makes.
pub fn run(args: &Args) -> Result<()> {
    let folder = tempfile::tempdir().context("a temporary folder")?;
    let place = |name: &str| folder.path().join(name);
    let start = Instant::now();
    program(&["dataset", "generate"], &[&args.recipe, Path::new("--out"), &place("whole")])?;
    let alone = start.elapsed().as_secs_f64();
    let whole = contents(&place("whole"))?;
    let pairs = whole.keys().filter(|name| name.starts_with("pairs")).count() as f64;
    let mut figures = Figures::new("bench farm");
    figures.set("pairs", pairs);
    figures.set("pairs_per_hour_one_run", 3600.0 * pairs / alone);
    let mut equal = true;
    let mut lines = Vec::new();
    for workers in &args.workers {
        let (seconds, merged) = farmed(args, *workers, folder.path())?;
        equal &= contents(&merged)? == whole;
        let rate = 3600.0 * pairs / seconds;
        figures.set(&format!("pairs_per_hour_{workers}"), rate);
        lines.push(format!("{workers:>7}  {rate:>8.0}  {:>6.2}", rate * alone / (3600.0 * pairs)));
    }
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    figures.set("bytes_equal", if equal { 1.0 } else { 0.0 });
    figures.set("bytes", whole.values().map(Vec::len).sum::<usize>() as f64);
    figures.detail("cores", json!(cores));
    figures.detail("shards", json!(args.shards));
    figures.detail("recipe", json!(args.recipe));
    figures.write(args.json.as_deref())?;
    say!("workers of one thread on {cores} cores, {} shards; beside one run of one thread", args.shards)?;
    say!("workers   pairs/h    beside")?;
    lines.iter().try_for_each(|line| say!("{line}"))?;
    ensure!(equal, "the bytes are not those of one run");
    say!("the bytes are those of one run")
}

/// Seconds that so many workers took for all shards, put together, and the folder of the dataset.
fn farmed(args: &Args, workers: u32, folder: &Path) -> Result<(f64, PathBuf)> {
    let place = |name: &str| folder.join(format!("{name}-{workers}"));
    let (jobs, made, merged) = (place("jobs"), place("shards"), place("merged"));
    let shards = args.shards.to_string();
    let options: [&Path; 9] = [
        &args.recipe,
        "--out".as_ref(),
        &made,
        "--jobs".as_ref(),
        &jobs,
        "--engine".as_ref(),
        "ray".as_ref(),
        "--shards".as_ref(),
        shards.as_ref(),
    ];
    program(&["farm", "plan"], &options)?;
    let start = Instant::now();
    let next = AtomicU32::new(1);
    let work = || -> Result<()> {
        loop {
            let shard = next.fetch_add(1, Ordering::Relaxed);
            if shard > args.shards {
                return Ok(());
            }
            program(&["farm", "work"], &[&jobs, "--shard".as_ref(), shard.to_string().as_ref()])?;
        }
    };
    std::thread::scope(|scope| {
        let hands: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        hands
            .into_iter()
            .try_for_each(|hand| hand.join().unwrap_or_else(|_| anyhow::bail!("a worker's thread")))
    })?;
    program(&["farm", "merge"], &[&jobs, "--out".as_ref(), &merged])?;
    Ok((start.elapsed().as_secs_f64(), merged))
}

/// Runs this program with one thread.
fn program(verb: &[&str], args: &[&Path]) -> Result<()> {
    let own = std::env::current_exe().context("where this program is")?;
    let mut command = Command::new(own);
    command.args(verb).args(args).env("RAYON_NUM_THREADS", "1").stdin(Stdio::null());
    let output = command.output().with_context(|| verb.join(" "))?;
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    ensure!(output.status.success(), "deepshade {} failed: {said}", verb.join(" "));
    Ok(())
}

/// All files of a dataset.
fn contents(folder: &Path) -> Result<BTreeMap<PathBuf, Vec<u8>>> {
    let mut found = BTreeMap::new();
    for part in ["", "pairs"] {
        let entries = std::fs::read_dir(folder.join(part)).with_context(|| folder.display().to_string())?;
        for path in entries.flatten().map(|entry| entry.path()).filter(|path| path.is_file()) {
            let bytes = std::fs::read(&path).with_context(|| path.display().to_string())?;
            found.insert(path.strip_prefix(folder).unwrap_or(&path).to_owned(), bytes);
        }
    }
    Ok(found)
}
