//! `deepshade farm`: the shards of a dataset on many machines, by engines that exist: Slurm's job arrays, Ray's tasks,
//! Kubernetes' indexed jobs.
//!
//! `plan` writes a folder of jobs that all machines see: what is made (`plan`), and the engine's file (`slurm`, `ray`,
//! `kubernetes`). Every task of the engine calls `farm work`, which makes one shard and keeps a record of how it went
//! (`work`). Where tasks run, and what is tried again, the engine decides. `status` reads the records and the shards'
//! own lists (`status`); `merge` puts the shards together. `cost` says what all of it would take, by a `model` of it.

mod cost;
mod kubernetes;
mod model;
mod plan;
mod ray;
mod record;
mod slurm;
mod status;
mod submit;
mod words;
mod work;

pub use cost::{measured, program};
pub use model::{Farm, Outcome, Parts};

use crate::place::Place;
use anyhow::{Result, ensure};
use clap::ValueEnum;
use plan::Plan;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// What to do with a farm.
#[derive(clap::Subcommand)]
pub enum Verb {
    /// Writes the job files for a recipe.
    Plan(plan::Args),
    /// Hands the shards that are not made yet to the engine.
    Submit(submit::Args),
    /// Says which shards are made, which failed and why, and what they cost.
    Status(status::Args),
    /// Makes one shard; the engine's tasks call this.
    Work(work::Args),
    /// Puts the shards together.
    Merge(Merge),
    /// Says what datasets would take on many machines: hours, cores, bytes, and what holds them up.
    Cost(cost::Args),
}

/// Puts the shards of a farm together, once all are made.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade farm merge jobs/ao --out data/ao")]
pub struct Merge {
    /// Folder of the jobs.
    jobs: PathBuf,
    /// Folder or address of the dataset.
    #[arg(long)]
    out: Place,
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

/// Does it.
///
/// # Errors
/// If a recipe, a folder of jobs or the engine is at fault, or a shard cannot be made.
pub fn run(verb: &Verb) -> Result<()> {
    match verb {
        Verb::Plan(args) => plan::run(args),
        Verb::Submit(args) => submit::run(args),
        Verb::Status(args) => status::run(args),
        Verb::Work(args) => work::run(args),
        Verb::Cost(args) => cost::run(args),
        Verb::Merge(args) => {
            let plan = Plan::load(&args.jobs)?;
            let missing = plan.missing()?;
            ensure!(missing.is_empty(), "{}: shards are missing: {}", args.out, missing.join(", "));
            let shards = plan.places().collect::<Vec<_>>();
            crate::dataset::merge_places(&shards, &args.out, args.json.as_deref())
        }
    }
}

#[cfg(test)]
mod tests;
