//! `deepshade-studies farm`: training pairs an hour by one, two and more workers on this machine, and whether
//! what they make is what one run makes, byte for byte.
//!
//! A worker is a process of one thread that makes shard after shard, as an engine's tasks do (`deepshade farm
//! work`), so that starting, reading scenes again and putting shards together count. With more workers than
//! cores there is nothing to gain, and the figures say so. Beside each stands what the simulation of
//! `deepshade farm cost` says of it, from a few pairs that were timed alone.

use anyhow::{Context, Result, ensure};
use deepshade::shared::farm::{Farm, Outcome, Parts, measured, program};
use deepshade::shared::figures::Figures;
use deepshade_dataset::Recipe;
use serde_json::json;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Instant;

/// Training pairs an hour by several workers on this machine, and whether their bytes are those of one run.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade-studies farm --workers 1,2,4 --json farm.json")]
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
    #[arg(long, value_parser = deepshade::shared::arguments::written_file)]
    json: Option<PathBuf>,
}

/// Measures and prints.
///
/// # Errors
/// If the recipe is at fault or a worker fails, or what they made differs from what one run makes.
pub fn run(args: &Args) -> Result<()> {
    let own = crate::program::deepshade()?;
    let folder = tempfile::tempdir().context("a temporary folder")?;
    let place = |name: &str| folder.path().join(name);
    let start = Instant::now();
    program(&own, &["dataset", "generate"], &[&args.recipe, Path::new("--out"), &place("whole")])?;
    let alone = start.elapsed().as_secs_f64();
    let whole = contents(&place("whole"))?;
    let pairs = whole.keys().filter(|name| name.starts_with("pairs")).count() as f64;
    let mut figures = Figures::new("farm");
    figures.set("pairs", pairs);
    figures.set("pairs_per_hour_one_run", 3600.0 * pairs / alone);
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let parts = measured(&own, &args.recipe, &Recipe::load(&args.recipe)?)?;
    let mut equal = true;
    let mut lines = Vec::new();
    for workers in &args.workers {
        let Farmed { seconds, merge, merged } = farmed(&own, args, *workers, folder.path())?;
        equal &= contents(&merged)? == whole;
        let farm = Farm {
            workers: *workers as usize,
            cores: cores as f64,
            shards: args.shards as usize,
            pairs: pairs as usize,
        };
        let said = Outcome::of(&farm, &Parts { merge: merge / pairs, ..parts }).seconds;
        let [rate, simulated] = [seconds, said].map(|seconds| 3600.0 * pairs / seconds);
        figures.set(&format!("pairs_per_hour_{workers}"), rate);
        figures.set(&format!("simulated_pairs_per_hour_{workers}"), simulated);
        let beside = rate * alone / (3600.0 * pairs);
        lines.push(format!("{workers:>7}  {rate:>8.0}  {beside:>6.2}  {simulated:>9.0}"));
    }
    figures.set("bytes_equal", if equal { 1.0 } else { 0.0 });
    figures.set("bytes", whole.values().map(Vec::len).sum::<usize>() as f64);
    figures.detail("cores", json!(cores));
    figures.detail("shards", json!(args.shards));
    figures.detail("recipe", json!(args.recipe));
    figures.write(args.json.as_deref())?;
    say!("workers of one thread on {cores} cores, {} shards; beside one run of one thread", args.shards)?;
    say!("workers   pairs/h  beside  simulated")?;
    lines.iter().try_for_each(|line| say!("{line}"))?;
    ensure!(equal, "the bytes are not those of one run");
    say!("the bytes are those of one run")
}

/// A dataset that a farm made.
struct Farmed {
    /// What it took, putting its shards together included.
    seconds: f64,
    /// What that took.
    merge: f64,
    merged: PathBuf,
}

/// Makes the dataset by so many workers.
fn farmed(own: &Path, args: &Args, workers: u32, folder: &Path) -> Result<Farmed> {
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
    program(own, &["farm", "plan"], &options)?;
    let start = Instant::now();
    let next = AtomicU32::new(1);
    let work = || -> Result<()> {
        loop {
            let shard = next.fetch_add(1, Ordering::Relaxed);
            if shard > args.shards {
                return Ok(());
            }
            program(own, &["farm", "work"], &[&jobs, "--shard".as_ref(), shard.to_string().as_ref()])?;
        }
    };
    std::thread::scope(|scope| {
        let hands: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        hands
            .into_iter()
            .try_for_each(|hand| hand.join().unwrap_or_else(|_| anyhow::bail!("a worker's thread")))
    })?;
    let made = start.elapsed().as_secs_f64();
    program(own, &["farm", "merge"], &[&jobs, "--out".as_ref(), &merged])?;
    let seconds = start.elapsed().as_secs_f64();
    Ok(Farmed { seconds, merge: seconds - made, merged })
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
