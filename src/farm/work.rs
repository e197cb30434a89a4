//! `deepshade farm work`: one shard, made by a task of the engine.

use super::plan::Plan;
use super::record::{End, Entry};
use anyhow::{Context, Result, ensure};
use deepshade_dataset::{Shard, Summary};
use std::path::PathBuf;

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

/// Makes it.
///
/// # Errors
/// If the recipe has changed or cannot be followed, or the shard is in use or cannot be written.
pub fn run(args: &Args) -> Result<()> {
    end_with_parent();
    let plan = Plan::load(&args.jobs)?;
    let shard: Shard = format!("{}/{}", args.shard, plan.shards).parse().map_err(anyhow::Error::msg)?;
    let entry = Entry::begin(&args.jobs, shard)?;
    let made = make(&plan, shard);
    let seconds = entry.end(match &made {
        Ok(Summary { pairs, rendered, bytes }) => {
            End::Made { rendered: *rendered, pairs: *pairs, bytes: *bytes }
        }
        Err(error) => End::Failed { error: crate::output::message(error) },
    })?;
    let summary = made.with_context(|| format!("shard {shard}"))?;
    say!(
        "shard {shard}: {} pairs, {} of them rendered now in {seconds:.0} s",
        summary.pairs,
        summary.rendered
    )
}

fn make(plan: &Plan, shard: Shard) -> Result<Summary> {
    let recipe = plan.recipe()?;
    let summary = crate::dataset::made(&recipe, &plan.shard_place(shard)?, Some(shard))?;
    ensure!(summary.pairs > 0, "no pair is planned for it");
    Ok(summary)
}

/// Where an engine kills its task, what the task has started goes, too: it would hold the shard that is tried again elsewhere.
fn end_with_parent() {
    #[cfg(target_os = "linux")]
    // Where that is refused, the shard's lock still keeps others away.
    let _ = rustix::process::set_parent_process_death_signal(Some(rustix::process::Signal::KILL));
}
