//! `deepshade farm cost`: what datasets take on so many workers, before anybody pays for them. A few pairs of each recipe are made
//! here and timed; what a scheduler and a store take is said, by default as they were measured; a simulation ([`super::model`])
//! puts it together.

use super::model::{Farm, Limit, NO_STORE, Outcome, Parts, Store};
use crate::arguments::positive;
use crate::figures::Figures;
use crate::table;
use anyhow::{Context, Result, bail, ensure};
use deepshade_dataset::Recipe;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

/// Says what datasets would take on many machines: hours, cores, bytes, and what holds them up.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  deepshade farm cost dataset/recipes/ao.toml\n  \
    deepshade farm cost dataset/recipes/*[a-z].toml --pairs 61000 --workers 1,100,1000,10000 --price 0.05\n\n\
    Pairs of each recipe are made here to time them, on one core, which takes seconds to minutes. `deepshade bench farm` \
    holds the same simulation against farms that run.")]
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
    /// Seconds that the scheduler is busy with the start of a task.
    #[arg(long, default_value_t = 0.05, value_parser = positive)]
    launch: f32,
    /// Megabytes a second that the store takes of all workers together.
    #[arg(long, default_value_t = 1000.0, value_parser = positive)]
    store_megabytes: f32,
    /// Requests a second that it takes.
    #[arg(long, default_value_t = 3500.0, value_parser = positive)]
    store_requests: f32,
    /// What an hour of one core costs.
    #[arg(long, value_parser = positive)]
    price: Option<f32>,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
}

/// Pairs that are made to be timed, of which the first few tell what a start takes.
const PROBES: [usize; 2] = [1, 6];

/// Times, simulates and prints.
///
/// # Errors
/// If a recipe is at fault or its pairs cannot be made.
pub fn run(args: &Args) -> Result<()> {
    let store = Store { bytes: 1e6 * f64::from(args.store_megabytes), requests: args.store_requests.into() };
    let mut figures = Figures::new("farm cost");
    let mut rows = vec![["recipe", "pairs", "s/pair", "MB/pair"].map(str::to_owned).to_vec()];
    let mut all: Vec<(usize, Parts)> = Vec::new();
    for path in &args.recipes {
        let recipe = Recipe::load(path)?;
        let pairs = args.pairs.map_or(recipe.scene_count() * recipe.views_per_scene, |pairs| pairs as usize);
        note!("{}: a few pairs are timed", path.display());
        let parts = Parts { launch: args.launch.into(), store, ..measured(path, &recipe)? };
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        figures.set(&format!("seconds_a_pair_{name}"), parts.pair);
        rows.push(vec![
            name,
            pairs.to_string(),
            format!("{:.2}", parts.pair),
            format!("{:.2}", 1e-6 * parts.bytes),
        ]);
        all.push((pairs, parts));
    }
    say!("{}", table::aligned(&rows))?;
    let mut rows = vec![["workers", "hours", "core hours", "held up by"].map(str::to_owned).to_vec()];
    rows[0].extend(args.price.map(|_| "costs".to_owned()));
    for workers in &args.workers {
        let (hours, core_hours, limit) = together(&all, *workers as usize, args.tasks as usize);
        figures.set(&format!("hours_{workers}"), hours);
        figures.set(&format!("core_hours_{workers}"), core_hours);
        figures.detail(&format!("limit_{workers}"), json!(limit.name()));
        let mut row = vec![
            workers.to_string(),
            format!("{hours:.2}"),
            format!("{core_hours:.1}"),
            limit.name().to_owned(),
        ];
        row.extend(args.price.map(|price| format!("{:.2}", core_hours * f64::from(price))));
        rows.push(row);
    }
    let bytes: f64 = all.iter().map(|(pairs, parts)| *pairs as f64 * parts.bytes).sum();
    figures.set("bytes", bytes);
    figures.write(args.json.as_deref())?;
    say!("{}", table::aligned(&rows))?;
    say!("{:.1} GB", 1e-9 * bytes)
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

/// What a recipe's pairs take on one core of this machine, in a folder of it.
///
/// # Errors
/// If the recipe has too few pairs, or they cannot be made.
pub fn measured(path: &Path, recipe: &Recipe) -> Result<Parts> {
    let all = recipe.scene_count() * recipe.views_per_scene;
    ensure!(all >= PROBES[1], "{}: {all} pairs are too few to be timed", path.display());
    let folder = tempfile::tempdir().context("a temporary folder")?;
    let probe = |pairs: usize| -> Result<(f64, Made)> {
        let shard = format!("1/{}", all.div_ceil(pairs));
        let out = folder.path().join(pairs.to_string());
        let start = Instant::now();
        let json = out.with_extension("json");
        let arguments: [&Path; 6] =
            [path, "--out".as_ref(), &out, "--shard".as_ref(), shard.as_ref(), "--json".as_ref()];
        program(&["dataset", "generate"], &[&arguments[..], &[&json]].concat())?;
        let seconds = start.elapsed().as_secs_f64();
        Ok((seconds, Made::read(&json)?))
    };
    let [(first, few), (second, more)] = [probe(PROBES[0])?, probe(PROBES[1])?];
    ensure!(more.pairs > few.pairs, "{}: its shards cannot be told apart", path.display());
    let pair = ((second - first) / (more.pairs - few.pairs)).max(1e-6);
    let start = (first - few.pairs * pair).max(0.0);
    Ok(Parts { launch: 0.0, start, pair, bytes: more.bytes / more.pairs, merge: 0.0, store: NO_STORE })
}

/// What was made.
struct Made {
    pairs: f64,
    bytes: f64,
}

impl Made {
    /// By the figures of `dataset generate`.
    fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
        let figures: serde_json::Value = serde_json::from_str(&text).context("figures of a dataset")?;
        let number =
            |name: &str| figures["figures"][name].as_f64().with_context(|| format!("no figure {name}"));
        Ok(Self { pairs: number("pairs")?, bytes: number("bytes")? })
    }
}

/// Runs this program with one thread.
///
/// # Errors
/// If it fails, with what it said.
pub fn program(verb: &[&str], args: &[&Path]) -> Result<()> {
    let own = std::env::current_exe().context("where this program is")?;
    let mut command = Command::new(own);
    command.args(verb).args(args).env("RAYON_NUM_THREADS", "1").stdin(Stdio::null());
    let output = command.output().with_context(|| verb.join(" "))?;
    if !output.status.success() {
        bail!("deepshade {} failed: {}", verb.join(" "), String::from_utf8_lossy(&output.stderr).trim());
    }
    Ok(())
}
