//! `deepshade farm work`: one shard, made by a task of the engine.

use super::plan::FarmPlan;
use crate::figures::write_atomically;
use anyhow::{Context, Result, ensure};
use deepshade_dataset::{Shard, Summary};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Makes one shard of a farm; the engine's tasks call this.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade farm work /shared/jobs/ao --shard 7\n\n\
    A shard that was begun is taken up again. It ends when whoever started it ends.")]
pub struct Args {
    /// Folder of the jobs.
    jobs: PathBuf,
    /// Which shard, from 1.
    #[arg(long)]
    shard: u32,
}

/// Makes it, and notes why where that fails.
///
/// # Errors
/// If the recipe has changed or cannot be followed, or the shard is in use or cannot be written.
pub fn run(args: &Args) -> Result<()> {
    end_with_parent();
    let plan = FarmPlan::load(&args.jobs)?;
    let shard: Shard = format!("{}/{}", args.shard, plan.shards).parse().map_err(anyhow::Error::msg)?;
    let made = make(&plan, shard).with_context(|| format!("shard {shard}"));
    if let Err(error) = &made {
        write_atomically(&note(&args.jobs, shard), crate::output::message(error).as_bytes())?;
    }
    let Summary { pairs, rendered, .. } = made?;
    say!("shard {shard}: {pairs} pairs, {rendered} of them rendered now")
}

fn make(plan: &FarmPlan, shard: Shard) -> Result<Summary> {
    let recipe = plan.recipe()?;
    let summary = crate::dataset::made(&recipe, &plan.shard_place(shard)?, Some(shard))?;
    ensure!(summary.pairs > 0, "no pair is planned for it");
    Ok(summary)
}

/// The note of why a shard failed.
fn note(jobs: &Path, shard: Shard) -> PathBuf {
    jobs.join("failed").join(format!("{}.txt", shard.number()))
}

/// Why a shard, which is not there, failed the last time; `None` if it did not.
///
/// # Errors
/// If that cannot be read.
pub fn failure(jobs: &Path, shard: Shard) -> Result<Option<String>> {
    let path = note(jobs, shard);
    match std::fs::read_to_string(&path) {
        Ok(text) => Ok(Some(text)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error).with_context(|| path.display().to_string()),
    }
}

/// Where an engine kills its task, what the task has started goes, too: it would hold the shard that is tried
/// again elsewhere.
fn end_with_parent() {
    #[cfg(target_os = "linux")]
    // Where that is refused, the shard's lock still keeps others away.
    let _ = rustix::process::set_parent_process_death_signal(Some(rustix::process::Signal::KILL));
}
