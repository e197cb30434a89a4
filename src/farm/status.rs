//! `deepshade farm status`: which shards are made, which failed and why, what is left and what it costs.

use super::plan::Plan;
use super::record::{End, Record};
use super::words;
use crate::arguments::positive;
use crate::figures::Figures;
use crate::place::Place;
use anyhow::Result;
use deepshade_dataset::Shard;
use deepshade_dataset::shard::pairs_so_far;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Says which shards are made, which failed and why, and what they cost.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade farm status /shared/jobs/ao --price 0.05")]
pub struct Args {
    /// Folder of the jobs.
    jobs: PathBuf,
    /// What an hour of one core costs.
    #[arg(long, value_parser = positive)]
    price: Option<f32>,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
}

/// What all shards came to so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Progress {
    /// Shards that are whole, and where they belong.
    pub made: usize,
    /// Tries of all shards.
    pub tries: usize,
    /// Pairs that are there, those of half-finished shards too.
    pub pairs: usize,
    /// Their size, of shards that are whole.
    pub bytes: u64,
    /// Time of all workers; of tries that were killed, until they were last heard of.
    pub hours: f64,
    /// Pairs that were rendered in that time.
    pub rendered: usize,
    /// Shards whose last try failed, with why.
    pub failed: Vec<(Shard, String)>,
    /// Shards whose last try has not come to an end.
    pub begun: Vec<Shard>,
    /// Shards that were made and are not there any more.
    pub gone: Vec<Shard>,
}

impl Progress {
    /// Of all shards of a plan.
    ///
    /// # Errors
    /// If a record cannot be read.
    pub fn of(plan: &Plan, jobs: &Path) -> Result<Self> {
        let mut progress = Self::default();
        let records = Record::all(jobs)?;
        let there = plan.there(&records)?;
        for shard in plan.shards() {
            let Some(record) = records.get(&shard.number()) else { continue };
            progress.tries += record.tries.len();
            progress.hours += record.seconds() / 3600.0;
            for one in &record.tries {
                if let Some(End::Made { rendered, .. }) = one.end {
                    progress.rendered += rendered;
                }
            }
            match record.made().filter(|_| there.contains(&shard.number())) {
                Some((pairs, bytes)) => {
                    progress.made += 1;
                    progress.pairs += pairs;
                    progress.bytes += bytes;
                }
                None => {
                    progress.pairs += half_made(plan, shard);
                    match record.error() {
                        Some(error) => progress.failed.push((shard, error.to_owned())),
                        None if record.made().is_some() => progress.gone.push(shard),
                        None => progress.begun.push(shard),
                    }
                }
            }
        }
        Ok(progress)
    }

    /// Pairs that one worker makes in an hour.
    fn pairs_an_hour(&self) -> f64 {
        self.rendered as f64 / self.hours
    }
}

/// Pairs of a shard that is not whole, where its folder is seen from here.
fn half_made(plan: &Plan, shard: Shard) -> usize {
    match plan.shard_place(shard) {
        Ok(Place::Folder(folder)) => pairs_so_far(&folder),
        _ => 0,
    }
}

/// Prints it.
///
/// # Errors
/// If the plan or a record cannot be read.
pub fn run(args: &Args) -> Result<()> {
    let plan = Plan::load(&args.jobs)?;
    let progress = Progress::of(&plan, &args.jobs)?;
    let core_hours = progress.hours * f64::from(plan.cores);
    let left = plan.pairs.saturating_sub(progress.pairs) as f64 / progress.pairs_an_hour();
    let mut figures = Figures::new("farm status");
    figures.set("shards", plan.shards.into());
    figures.set("shards_made", progress.made as f64);
    figures.set("shards_failed", progress.failed.len() as f64);
    figures.set("tries", progress.tries as f64);
    figures.set("pairs", plan.pairs as f64);
    figures.set("pairs_made", progress.pairs as f64);
    figures.set("bytes", progress.bytes as f64);
    figures.set("worker_hours", progress.hours);
    figures.set("worker_hours_left", left);
    figures.set("pairs_per_worker_hour", progress.pairs_an_hour());
    if let Some(price) = args.price {
        figures.set("cost", core_hours * f64::from(price));
    }
    let failed = progress.failed.iter().map(|(shard, error)| (shard.to_string(), json!(error))).collect();
    figures.detail("failed", failed);
    figures.write(args.json.as_deref())?;

    say!("{} of {} shards made, {} of {} pairs", progress.made, plan.shards, progress.pairs, plan.pairs)?;
    if progress.rendered > 0 {
        say!(
            "{} of workers for {} tries, {} more to come",
            words::time(progress.hours),
            progress.tries,
            words::time(left)
        )?;
    }
    if let Some(price) = args.price {
        say!(
            "cost so far {:.2}, {:.2} more to come",
            core_hours * f64::from(price),
            left * f64::from(plan.cores) * f64::from(price)
        )?;
    }
    for shard in &progress.begun {
        say!("shard {shard}: under way, or killed")?;
    }
    for shard in &progress.gone {
        say!("shard {shard}: was made, and is not there any more")?;
    }
    for (shard, error) in &progress.failed {
        say!("shard {shard}: failed: {error}")?;
    }
    if progress.made == plan.shards as usize {
        say!("next: deepshade farm merge {} --out FOLDER", args.jobs.display())?;
    }
    Ok(())
}
