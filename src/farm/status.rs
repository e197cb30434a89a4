//! `deepshade farm status`: which shards are made, which failed and why, and what comes next.

use super::plan::FarmPlan;
use super::work;
use crate::figures::Figures;
use anyhow::Result;
use serde_json::json;
use std::path::PathBuf;

/// Says which shards are made, which failed and why, and how the rest is handed to the engine.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade farm status /shared/jobs/ao\n\n\
    What it prints for the shards that are missing is for when the engine has ended with them. One that is \
    handed to it twice is made once.")]
pub struct Args {
    /// Folder of the jobs.
    jobs: PathBuf,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
}

/// Prints it.
///
/// # Errors
/// If the plan or a note cannot be read, or the shards' place cannot be looked at.
pub fn run(args: &Args) -> Result<()> {
    let plan = FarmPlan::load(&args.jobs)?;
    let missing = plan.missing()?;
    let mut failed = Vec::new();
    for shard in &missing {
        failed.extend(work::failure(&args.jobs, *shard)?.map(|error| (shard.to_string(), error)));
    }
    let made = plan.shards as usize - missing.len();
    let mut figures = Figures::new("farm status");
    figures.set("shards", plan.shards.into());
    figures.set("shards_made", made as f64);
    figures.set("shards_failed", failed.len() as f64);
    figures.set("pairs", plan.pairs as f64);
    figures.detail("failed", failed.iter().map(|(shard, error)| (shard.clone(), json!(error))).collect());
    figures.write(args.json.as_deref())?;
    say!("{made} of {} shards made", plan.shards)?;
    failed.iter().try_for_each(|(shard, error)| say!("shard {shard}: failed: {error}"))?;
    if missing.is_empty() {
        return say!("next: deepshade farm merge {} --out FOLDER", args.jobs.display());
    }
    let numbers: Vec<usize> = missing.iter().map(|shard| shard.number()).collect();
    say!("missing: {}", plan.engine.command(&args.jobs, &numbers))
}
