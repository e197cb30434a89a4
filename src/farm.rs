//! `deepshade farm`: the shards of a dataset on many machines, by engines that exist: Slurm's job arrays,
//! Ray's tasks, Kubernetes' indexed jobs.
//!
//! `plan` writes a folder of jobs that all machines see: what is made (`plan`), and the engine's file
//! (`slurm`, `kubernetes`, `ray_tasks.py`), which people hand to the engine themselves. Every task of the
//! engine calls `farm work`, which makes one shard, and leaves a note where it fails (`work`). Where tasks
//! run, and what is tried again, the engine decides. `status` looks for the shards; `merge` puts them
//! together.

mod kubernetes;
mod plan;
mod slurm;
mod status;
mod work;

use crate::location::Location;
use anyhow::{Result, ensure};
use clap::ValueEnum;
use plan::FarmPlan;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// What to do with a farm.
#[derive(clap::Subcommand)]
pub enum Verb {
    /// Writes the job files for a recipe.
    Plan(plan::Args),
    /// Says which shards are made, which failed and why, and how the rest is handed to the engine.
    Status(status::Args),
    /// Makes one shard; the engine's tasks call this.
    Work(work::Args),
    /// Puts the shards together.
    Merge(Merge),
}

/// Puts the shards of a farm together, once all are made.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade farm merge jobs/ao --out data/ao")]
pub struct Merge {
    /// Folder of the jobs.
    jobs: PathBuf,
    /// Folder or address of the dataset.
    #[arg(long)]
    out: Location,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
}

/// What places tasks on machines and tries them again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Engine {
    /// A job array.
    Slurm,
    /// Tasks of a cluster that runs.
    Ray,
    /// An indexed job, for kubectl.
    Kubernetes,
}

/// Ray's script, which reads the plan beside it.
const RAY_TASKS: &str = include_str!("farm/ray_tasks.py");

impl Engine {
    /// The engine's file in the folder of jobs: its name and text.
    fn file(self, plan: &FarmPlan, jobs: &Path) -> Result<(&'static str, String)> {
        Ok(match self {
            Self::Slurm => ("slurm.sh", slurm::script(plan, jobs)?),
            Self::Ray => ("ray_tasks.py", RAY_TASKS.to_owned()),
            Self::Kubernetes => ("kubernetes.json", kubernetes::job(plan, jobs)?),
        })
    }

    /// The command that hands shards to the engine, at least one; all of them without numbers.
    fn command(self, jobs: &Path, shards: &[usize]) -> String {
        let jobs = jobs.display();
        let numbers = shards.iter().map(ToString::to_string).collect::<Vec<_>>();
        match self {
            Self::Slurm if shards.is_empty() => format!("sbatch {jobs}/slurm.sh"),
            Self::Slurm => format!("sbatch --array={} {jobs}/slurm.sh", numbers.join(",")),
            Self::Ray => format!("python3 {jobs}/ray_tasks.py {}", numbers.join(" ")).trim_end().to_owned(),
            Self::Kubernetes if shards.is_empty() => format!("kubectl apply -f {jobs}/kubernetes.json"),
            // Indices whose shards are made end at once.
            Self::Kubernetes => format!("kubectl replace --force -f {jobs}/kubernetes.json"),
        }
    }
}

/// Does it.
///
/// # Errors
/// If a recipe or a folder of jobs is at fault, or a shard is missing or cannot be made.
pub fn run(verb: &Verb) -> Result<()> {
    match verb {
        Verb::Plan(args) => plan::run(args),
        Verb::Status(args) => status::run(args),
        Verb::Work(args) => work::run(args),
        Verb::Merge(args) => {
            let plan = FarmPlan::load(&args.jobs)?;
            let missing = plan.missing()?;
            let names: Vec<String> = missing.iter().map(ToString::to_string).collect();
            ensure!(missing.is_empty(), "{}: shards are missing: {}", args.out, names.join(", "));
            let shards = plan.shards().map(|shard| plan.shard_place(shard)).collect::<Result<Vec<_>>>()?;
            crate::dataset::merge_places(&shards, &args.out, args.json.as_deref())
        }
    }
}

#[cfg(test)]
mod tests;
