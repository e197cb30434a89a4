//! `deepshade farm cost`: what datasets take on so many workers, before anybody pays for them. A few pairs of
//! each recipe are made here, put together and timed; what a scheduler and a store take is said, or assumed,
//! and which of them is printed; a simulation ([`super::model`]) puts it together.

use super::model::{Farm, Limit, NO_STORE, Outcome, Parts, Store};
use super::words;
use crate::arguments::positive;
use crate::figures::Figures;
use crate::table;
use anyhow::{Context, Result, bail, ensure};
use deepshade_dataset::Recipe;
use deepshade_dataset::shard::merge::rehearse;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

/// Says what datasets would take on many machines: hours, cores, bytes, and what holds them up.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  deepshade farm cost dataset/recipes/ao.toml\n  \
    deepshade farm cost dataset/recipes/*[a-z].toml --pairs 61000 --workers 1,100,1000,10000 --price 0.05\n\n\
    Pairs of each recipe are made here to time them, on one core, which takes seconds to minutes. \
    `deepshade-studies farm` holds the same simulation against farms that run, `deepshade-studies store` \
    measures a store, `cargo xtask farm` Slurm.")]
pub struct Args {
    /// The recipes, TOML files.
    #[arg(required = true)]
    recipes: Vec<PathBuf>,
    /// Pairs of each dataset; by default what its recipe has.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    pairs: Option<u32>,
    /// Workers of one core each.
    #[arg(long, value_delimiter = ',', default_value = "1,100,1000,10000", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    workers: Vec<u32>,
    /// Tasks for each worker.
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=100))]
    tasks: u32,
    /// Seconds that the scheduler is busy with the start of a task [assumed where it is not said: 0.05].
    #[arg(long, value_parser = positive)]
    launch: Option<f32>,
    /// Megabytes a second that the store takes of all workers together [assumed where it is not said: 1000].
    #[arg(long, value_parser = positive)]
    store_megabytes: Option<f32>,
    /// Requests a second that it takes [assumed where it is not said: 3500, what S3 promises for one prefix].
    #[arg(long, value_parser = positive)]
    store_requests: Option<f32>,
    /// What an hour of one core costs.
    #[arg(long, value_parser = positive)]
    price: Option<f32>,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
}

/// What a parameter is called, its unit, its value where nobody says it, and how people measure theirs.
type Assumed = (&'static str, &'static str, f32, &'static str);
const LAUNCH: Assumed =
    ("launch", "s a task", 0.05, "`cargo xtask farm` measures Slurm's where no task waits for a node");
const STORE_MEGABYTES: Assumed =
    ("store", "MB/s", 1000.0, "`deepshade-studies store` measures what one machine gets");
const STORE_REQUESTS: Assumed =
    ("store", "requests/s", 3500.0, "`deepshade-studies store` measures what one machine gets");

/// Pairs of shards that are made to be timed: the difference between the two tells a pair from a start.
const PROBES: [usize; 2] = [1, 3];
/// At so many places of a recipe, since its scenes do not take the same time.
const SPOTS: usize = 3;

/// Times, simulates and prints.
///
/// # Errors
/// If a recipe is at fault or its pairs cannot be made.
pub fn run(args: &Args) -> Result<()> {
    let own = std::env::current_exe().context("where this program is")?;
    let mut figures = Figures::new("farm cost");
    let mut lines = Vec::new();
    let mut stated = |said: Option<f32>, (name, unit, assumed, how): Assumed| {
        let from = if said.is_some() { "as said".to_owned() } else { format!("assumed; {how}") };
        let value = said.unwrap_or(assumed);
        lines.push(format!("{name}: {value} {unit}, {from}"));
        f64::from(value)
    };
    let launch = stated(args.launch, LAUNCH);
    let store = Store {
        bytes: 1e6 * stated(args.store_megabytes, STORE_MEGABYTES),
        requests: stated(args.store_requests, STORE_REQUESTS),
    };
    figures.detail("parameters", json!(lines));
    let mut rows =
        vec![["recipe", "pairs", "s/pair", "s/start", "ms/merge", "MB/pair"].map(str::to_owned).to_vec()];
    let mut all: Vec<(usize, Parts)> = Vec::new();
    for path in &args.recipes {
        let recipe = Recipe::load(path)?;
        let pairs = args.pairs.map_or(recipe.scene_count() * recipe.views_per_scene, |pairs| pairs as usize);
        note!("{}: a few pairs are timed", path.display());
        let parts = Parts { launch, store, ..measured(&own, path, &recipe)? };
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        figures.set(&format!("seconds_a_pair_{name}"), parts.pair);
        figures.set(&format!("merge_seconds_a_pair_{name}"), parts.merge);
        rows.push(vec![
            name,
            pairs.to_string(),
            format!("{:.2}", parts.pair),
            format!("{:.2}", parts.start),
            format!("{:.2}", 1e3 * parts.merge),
            format!("{:.2}", 1e-6 * parts.bytes),
        ]);
        all.push((pairs, parts));
    }
    let timed = rows;
    let mut rows = vec![["workers", "time", "time of cores", "held up by"].map(str::to_owned).to_vec()];
    rows[0].extend(args.price.map(|_| "costs".to_owned()));
    for workers in &args.workers {
        let (hours, core_hours, limit) = together(&all, *workers as usize, args.tasks as usize);
        figures.set(&format!("hours_{workers}"), hours);
        figures.set(&format!("core_hours_{workers}"), core_hours);
        figures.detail(&format!("limit_{workers}"), json!(limit.name()));
        let mut row =
            vec![workers.to_string(), words::time(hours), words::time(core_hours), limit.name().to_owned()];
        row.extend(args.price.map(|price| format!("{:.2}", core_hours * f64::from(price))));
        rows.push(row);
    }
    let bytes: f64 = all.iter().map(|(pairs, parts)| *pairs as f64 * parts.bytes).sum();
    figures.set("bytes", bytes);
    figures.write(args.json.as_deref())?;
    say!("{}", table::aligned(&timed))?;
    lines.iter().try_for_each(|line| say!("{line}"))?;
    say!("{}", table::aligned(&rows))?;
    say!("{}", words::size(bytes))
}

/// Hours, core hours, and what holds the longest dataset up, of datasets made one after the other.
fn together(all: &[(usize, Parts)], workers: usize, tasks: usize) -> (f64, f64, Limit) {
    let outcomes: Vec<Outcome> = all
        .iter()
        .map(|(pairs, parts)| {
            let shards = (workers * tasks).clamp(1, *pairs);
            Outcome::of(&Farm { workers, cores: f64::INFINITY, shards, pairs: *pairs }, parts)
        })
        .collect();
    let longest = outcomes.iter().max_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let sum = |of: fn(&Outcome) -> f64| outcomes.iter().map(of).sum::<f64>() / 3600.0;
    (sum(|one| one.seconds), sum(|one| one.worked), longest.map_or(Limit::Workers, |one| one.limit))
}

/// What a recipe's pairs take on one core of this machine, made by a program `deepshade` in a folder of it,
/// and what putting them together takes.
///
/// # Errors
/// If the recipe has too few pairs, or they cannot be made.
pub fn measured(own: &Path, path: &Path, recipe: &Recipe) -> Result<Parts> {
    let all = recipe.scene_count() * recipe.views_per_scene;
    ensure!(all >= PROBES[1], "{}: {all} pairs are too few to be timed", path.display());
    let folder = tempfile::tempdir().context("a temporary folder")?;
    let mut shards = Vec::new();
    let mut probe = |pairs: usize, spot: usize| -> Result<Probe> {
        let count = all.div_ceil(pairs);
        let number = 1 + spot * (count - 1) / (SPOTS - 1);
        let shard = format!("{number}/{count}");
        let out = folder.path().join(format!("{pairs}-{spot}"));
        let start = Instant::now();
        let json = out.with_extension("json");
        let arguments: [&Path; 6] =
            [path, "--out".as_ref(), &out, "--shard".as_ref(), shard.as_ref(), "--json".as_ref()];
        program(own, &["dataset", "generate"], &[&arguments[..], &[&json]].concat())?;
        let seconds = start.elapsed().as_secs_f64();
        // Where there are few, the same shard is at several spots, and is put together once.
        if pairs == PROBES[1] && shards.iter().all(|(known, _)| *known != number) {
            shards.push((number, out));
        }
        Probe::read(seconds, &json)
    };
    let mut sums = [Probe::default(); 2];
    for spot in 0..SPOTS {
        for (sum, pairs) in sums.iter_mut().zip(PROBES) {
            *sum = sum.with(probe(pairs, spot)?);
        }
    }
    let [few, more] = sums;
    ensure!(more.pairs > few.pairs, "{}: its shards cannot be told apart", path.display());
    let pair = ((more.seconds - few.seconds) / (more.pairs - few.pairs)).max(1e-6);
    let start = ((few.seconds - few.pairs * pair) / SPOTS as f64).max(0.0);
    let shards: Vec<PathBuf> = shards.into_iter().map(|(_, out)| out).collect();
    let begin = Instant::now();
    let merged = rehearse(&shards, &folder.path().join("merged"))?;
    let merge = begin.elapsed().as_secs_f64() / merged as f64;
    Ok(Parts { launch: 0.0, start, pair, bytes: more.bytes / more.pairs, merge, store: NO_STORE })
}

/// What was made, and in what time.
#[derive(Clone, Copy, Debug, Default)]
struct Probe {
    seconds: f64,
    pairs: f64,
    bytes: f64,
}

impl Probe {
    /// By the figures of `dataset generate`.
    fn read(seconds: f64, path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
        let figures: serde_json::Value = serde_json::from_str(&text).context("figures of a dataset")?;
        let number =
            |name: &str| figures["figures"][name].as_f64().with_context(|| format!("no figure {name}"));
        Ok(Self { seconds, pairs: number("pairs")?, bytes: number("bytes")? })
    }

    /// Both together.
    fn with(self, other: Self) -> Self {
        Self {
            seconds: self.seconds + other.seconds,
            pairs: self.pairs + other.pairs,
            bytes: self.bytes + other.bytes,
        }
    }
}

/// Runs a program `deepshade` with one thread.
///
/// # Errors
/// If it fails, with what it said.
pub fn program(own: &Path, verb: &[&str], args: &[&Path]) -> Result<()> {
    let mut command = Command::new(own);
    command.args(verb).args(args).env("RAYON_NUM_THREADS", "1").stdin(Stdio::null());
    let output = command.output().with_context(|| verb.join(" "))?;
    if !output.status.success() {
        bail!("deepshade {} failed: {}", verb.join(" "), String::from_utf8_lossy(&output.stderr).trim());
    }
    Ok(())
}
