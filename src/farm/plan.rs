//! What a farm makes: written once, read by every task.

use super::Engine;
use crate::figures::{Figures, write_atomically};
use crate::location::Location;
use anyhow::{Context, Result, bail, ensure};
use deepshade_dataset::{Recipe, Shard};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::path::{Component, Path, PathBuf};

/// The plan's file in the folder of jobs.
pub const PLAN: &str = "farm.json";
/// Where tasks write what they say, in the folder of jobs.
pub const LOGS: &str = "logs";
/// Form of the plan.
const VERSION: u32 = 1;

/// Writes the job files for a recipe.
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  deepshade farm plan dataset/recipes/ao.toml --out /shared/ao --shards 200 \
    --engine slurm --jobs /shared/jobs/ao\n  sbatch /shared/jobs/ao/slurm.sh\n  \
    deepshade farm status /shared/jobs/ao\n  deepshade farm merge /shared/jobs/ao --out data/ao\n\n\
    It names the command that hands the shards to the engine. All machines must see the recipe, the program \
    and the \
    folder of jobs under the same paths; shards may be in an object store. With Kubernetes they must be \
    below the \
    folder of jobs or in a store, since pods have one volume, at that folder: a ReadWriteMany claim, \
    `deepshade`. \
    Tasks that fail or are killed are tried again by the engine and go on where they were."
)]
pub struct Args {
    /// The recipe, a TOML file.
    recipe: PathBuf,
    /// Folder that the scene files of the recipe are relative to, where it is not the recipe's own.
    #[arg(long)]
    scenes: Option<PathBuf>,
    /// Folder or address that the shards are to be in; with Kubernetes a folder below --jobs, or an address.
    #[arg(long)]
    out: Location,
    /// Into how many shards the dataset is cut: each a task of minutes to hours.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    shards: u32,
    /// What runs the tasks.
    #[arg(long, value_enum)]
    engine: Engine,
    /// Folder of the jobs, a new one.
    #[arg(long)]
    jobs: PathBuf,
    /// Threads of a task.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1024))]
    cores: u32,
    /// Minutes after which a task is taken for stuck, and tried again; Slurm is asked for two more, which its
    /// partition must allow.
    #[arg(long, default_value_t = 240, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    minutes: u32,
    /// How often a task is tried again.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(0..=100))]
    retries: u32,
    /// The program on the machines that work; by default this one, with Kubernetes `deepshade` as the image
    /// finds it.
    #[arg(long)]
    program: Option<PathBuf>,
    /// Image of the container that Kubernetes runs, which has the program and the recipe; needed with that
    /// engine.
    #[arg(long)]
    image: Option<String>,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
}

/// What is made, by what, in how many parts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FarmPlan {
    version: u32,
    /// The recipe's file, its whole path.
    pub recipe: PathBuf,
    /// Its hash: tasks refuse another one.
    pub recipe_blake3: String,
    /// What its scene files are relative to, where that is not its folder.
    pub scenes: Option<PathBuf>,
    /// Where the shards are, as [`Location`] reads it.
    pub out: String,
    /// How many there are.
    pub shards: u32,
    /// Pairs of all shards.
    pub pairs: usize,
    /// What runs the tasks.
    pub engine: Engine,
    /// Threads of a task.
    pub cores: u32,
    /// Minutes that a task may take.
    pub minutes: u32,
    /// How often a task is tried again.
    pub retries: u32,
    /// The program.
    pub program: PathBuf,
    /// Kubernetes' image.
    pub image: Option<String>,
}

impl FarmPlan {
    /// The plan in a folder of jobs.
    ///
    /// # Errors
    /// If there is none, or it makes no sense.
    pub fn load(jobs: &Path) -> Result<Self> {
        let path = jobs.join(PLAN);
        let bytes =
            std::fs::read(&path).with_context(|| format!("{}: no farm is planned there", path.display()))?;
        let plan: Self = serde_json::from_slice(&bytes).with_context(|| path.display().to_string())?;
        ensure!(plan.version == VERSION && plan.shards > 0, "{}: of another version", path.display());
        plan.location().with_context(|| path.display().to_string())?;
        Ok(plan)
    }

    /// The recipe, if it is still the one that was planned.
    ///
    /// # Errors
    /// If it is gone, has changed or cannot be followed.
    pub fn recipe(&self) -> Result<Recipe> {
        ensure!(
            file_hash(&self.recipe)? == self.recipe_blake3,
            "{} has changed since the farm was planned: plan it anew, with other folders",
            self.recipe.display()
        );
        Ok(match &self.scenes {
            Some(scenes) => Recipe::load_with_scenes(&self.recipe, scenes)?,
            None => Recipe::load(&self.recipe)?,
        })
    }

    /// All shards in their order.
    pub fn shards(&self) -> impl Iterator<Item = Shard> {
        let count = self.shards;
        (1..=count).filter_map(move |number| format!("{number}/{count}").parse().ok())
    }

    /// Where a shard is.
    ///
    /// # Errors
    /// If the plan names no place, which [`FarmPlan::load`] has seen to.
    pub fn shard_place(&self, shard: Shard) -> Result<Location> {
        Ok(self.location()?.join(&format!("shard-{}-of-{}", shard.number(), shard.count())))
    }

    /// Shards that are not where they belong, or not whole, in their order.
    ///
    /// # Errors
    /// If their place cannot be looked at.
    pub fn missing(&self) -> Result<Vec<Shard>> {
        let shards: Vec<Shard> = self.shards().collect();
        let missing = |shard: &Shard| -> Result<Option<Shard>> {
            let there = self.shard_place(*shard)?.holds(&shard.file_name())?;
            Ok((!there).then_some(*shard))
        };
        shards.par_iter().filter_map(|shard| missing(shard).transpose()).collect()
    }

    fn location(&self) -> Result<Location> {
        self.out.parse().map_err(anyhow::Error::msg)
    }

    /// Name of the job: the recipe's, as far as all engines take it.
    pub fn name(&self) -> String {
        let stem = self.recipe.file_stem().unwrap_or_default().to_string_lossy().to_lowercase();
        let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
        format!("deepshade-{}", stem.chars().map(plain).collect::<String>().trim_matches('-'))
    }
}

/// Writes the plan and the engine's file.
///
/// # Errors
/// If the recipe is at fault, or the folder holds something or cannot be written.
pub fn run(args: &Args) -> Result<()> {
    let mut plan = planned(args)?;
    let below = match (args.engine, &args.out) {
        (Engine::Kubernetes, Location::Folder(out)) => Some(in_volume(out, &args.jobs)?),
        _ => None,
    };
    let jobs = fresh(&args.jobs)?;
    // Pods see the volume where that folder is, not by links to it.
    if let Some(below) = below {
        plan.out = jobs.join(below).display().to_string();
    }
    let (name, text) = plan.engine.file(&plan, &jobs)?;
    write_atomically(&jobs.join(name), text.as_bytes())?;
    std::fs::create_dir_all(jobs.join(LOGS)).with_context(|| jobs.display().to_string())?;
    // The plan last: what has one is whole.
    write_atomically(
        &jobs.join(PLAN),
        serde_json::to_string_pretty(&plan).context("a plan as JSON")?.as_bytes(),
    )?;
    let mut figures = Figures::new("farm plan");
    figures.set("shards", plan.shards.into());
    figures.set("pairs", plan.pairs as f64);
    figures.write(args.json.as_deref())?;
    let next = plan.engine.command(&jobs, &[]);
    say!("{} pairs in {} shards; next: {next}", plan.pairs, plan.shards)
}

/// The way from the folder of jobs, where Kubernetes' pods have their volume, to that of the shards.
///
/// # Errors
/// If it leads elsewhere: what pods write there is lost with them.
pub(super) fn in_volume(out: &Path, jobs: &Path) -> Result<PathBuf> {
    let whole = |path: &Path| std::path::absolute(path).with_context(|| path.display().to_string());
    let below = whole(out)?.strip_prefix(whole(jobs)?).map(Path::to_owned).ok();
    below.filter(|way| way.components().all(|part| matches!(part, Component::Normal(_)))).with_context(|| {
        format!(
            "--out {}: Kubernetes' pods have their volume at the folder of jobs alone: a folder below {}, \
            such as {}, or an \
             address of a store keeps what they make",
            out.display(),
            jobs.display(),
            jobs.join("shards").display()
        )
    })
}

fn planned(args: &Args) -> Result<FarmPlan> {
    ensure!(
        args.engine != Engine::Kubernetes || args.image.is_some(),
        "--engine kubernetes needs --image, the container image that pods run, which has the program and the \
        recipe: \
         --image registry/deepshade:1"
    );
    let whole = |path: &Path| path.canonicalize().with_context(|| path.display().to_string());
    let recipe = whole(&args.recipe)?;
    let scenes = args.scenes.as_deref().map(whole).transpose()?;
    let out = match &args.out {
        Location::Folder(folder) => {
            std::path::absolute(folder).with_context(|| folder.display().to_string())?.display().to_string()
        }
        Location::Store(address) => address.to_string(),
    };
    let mut plan = FarmPlan {
        version: VERSION,
        recipe_blake3: file_hash(&recipe)?,
        recipe,
        scenes,
        out,
        shards: args.shards,
        pairs: 0,
        engine: args.engine,
        cores: args.cores,
        minutes: args.minutes,
        retries: args.retries,
        program: match &args.program {
            Some(program) => program.clone(),
            // Where this one is says nothing of an image.
            None if args.engine == Engine::Kubernetes => PathBuf::from("deepshade"),
            None => std::env::current_exe().context("where this program is; --program says it")?,
        },
        image: args.image.clone(),
    };
    let recipe = plan.recipe()?;
    plan.pairs = recipe.scene_count().saturating_mul(recipe.views_per_scene);
    ensure!(
        plan.pairs >= plan.shards as usize,
        "--shards {}: the recipe has {} pairs",
        plan.shards,
        plan.pairs
    );
    Ok(plan)
}

/// A folder for jobs, its whole path.
fn fresh(jobs: &Path) -> Result<PathBuf> {
    let place = || jobs.display().to_string();
    std::fs::create_dir_all(jobs).with_context(place)?;
    if std::fs::read_dir(jobs).with_context(place)?.next().is_some() {
        bail!("{} holds something: choose another folder, a new or an empty one", jobs.display());
    }
    jobs.canonicalize().with_context(place)
}

fn file_hash(path: &Path) -> Result<String> {
    let bytes = std::fs::read(path).with_context(|| path.display().to_string())?;
    Ok(blake3::hash(&bytes).to_hex().to_string())
}
