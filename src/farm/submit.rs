//! `deepshade farm submit`: the shards that are not made yet, handed to the engine.

use super::plan::Plan;
use super::record::Record;
use super::{Engine, kubernetes, ray, slurm};
use anyhow::{Context, Result, bail, ensure};
use deepshade_dataset::holder::Holder;
use deepshade_dataset::lock;
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Hands the shards that are not made yet to the engine.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade farm submit /shared/jobs/ao\n\n\
    Given again it submits what is still missing, also shards that failed, but none that the engine has still to do. \
    With Ray it waits for the end. What `merge` finds damaged in a folder is made again by --again; in an object store the \
    object that it names and the shard's `commit.json` are to be deleted, after which the shard is missing.")]
pub struct Args {
    /// Folder of the jobs.
    jobs: PathBuf,
    /// Shards in folders that are to be made again though they are there, such as those that `merge` finds damaged: their numbers.
    #[arg(long, value_delimiter = ',')]
    again: Vec<usize>,
    /// Python with Ray.
    #[arg(long, default_value = "python3")]
    python: PathBuf,
}

/// The folder, in that of the jobs, of whoever submits.
const SUBMITS: &str = "submit";

/// Submits.
///
/// # Errors
/// If the engine is missing or refuses.
pub fn run(args: &Args) -> Result<()> {
    let plan = Plan::load(&args.jobs)?;
    let jobs = args.jobs.canonicalize().with_context(|| args.jobs.display().to_string())?;
    // What another one submits is not known to the engine as yet; with Ray it is the engine's until it ends.
    let note = jobs.join(SUBMITS);
    std::fs::create_dir_all(&note).with_context(|| note.display().to_string())?;
    let lock = lock::alone(&note.join("lock")).with_context(|| note.display().to_string())?;
    ensure!(lock.is_some(), "{}: {} submits it", jobs.display(), Holder::of(&note));
    let _holder = Holder::sign(&note);
    let mut waiting = waiting(&plan, &jobs, &args.again)?;
    if waiting.is_empty() {
        return say!("all {} shards are made; next: deepshade farm merge {}", plan.shards, jobs.display());
    }
    if plan.engine == Engine::Slurm {
        let queued = slurm::queued(&jobs)?;
        waiting.retain(|shard| !queued.contains(shard));
        if waiting.is_empty() {
            return say!("Slurm has still to do all shards that are missing");
        }
    }
    match plan.engine {
        Engine::Slurm => {
            let array = format!("--array={}", ranges(&waiting));
            let mut sbatch = Command::new("sbatch");
            let output = output(sbatch.args(["--parsable", &array]).arg(jobs.join(slurm::FILE)))?;
            let id = output.trim().split(';').next().unwrap_or_default();
            say!("job {id}: {} shards", waiting.len())
        }
        Engine::Ray => {
            let mut python = Command::new(&args.python);
            python.arg(jobs.join(ray::FILE)).args(waiting.iter().map(ToString::to_string));
            let status = python.stdin(Stdio::null()).status();
            let status = status.with_context(|| format!("cannot start {}", args.python.display()))?;
            ensure!(
                status.success(),
                "not all shards were made: `deepshade farm status {}` says why",
                jobs.display()
            );
            say!("{} shards made", waiting.len())
        }
        Engine::Kubernetes => {
            bail!(
                "Kubernetes takes it from kubectl: kubectl apply -f {}",
                jobs.join(kubernetes::FILE).display()
            )
        }
    }
}

/// Numbers of the shards that are not there, or are to be made again.
pub(super) fn waiting(plan: &Plan, jobs: &Path, again: &[usize]) -> Result<Vec<usize>> {
    let known: HashSet<usize> = plan.shards().map(|shard| shard.number()).collect();
    if let Some(unknown) = again.iter().find(|number| !known.contains(number)) {
        bail!("--again {unknown}: there are {} shards", plan.shards);
    }
    let there = plan.there(&Record::all(jobs)?)?;
    let numbers = plan.shards().map(|shard| shard.number());
    Ok(numbers.filter(|number| again.contains(number) || !there.contains(number)).collect())
}

/// Numbers in rising order as Slurm writes them: `1-3,7`.
pub(super) fn ranges(numbers: &[usize]) -> String {
    let runs = numbers.chunk_by(|one, next| one + 1 == *next);
    let written = runs.filter_map(|run| match (run.first()?, run.last()?) {
        (first, last) if first == last => Some(first.to_string()),
        (first, last) => Some(format!("{first}-{last}")),
    });
    written.collect::<Vec<_>>().join(",")
}

/// What a command of an engine says.
///
/// # Errors
/// If it is not there, or fails.
pub(super) fn output(command: &mut Command) -> Result<String> {
    let name = command.get_program().to_string_lossy().into_owned();
    let output = command.stdin(Stdio::null()).stderr(Stdio::inherit()).output();
    let output = output.with_context(|| format!("cannot start {name}: is the engine installed here?"))?;
    ensure!(output.status.success(), "{name} refused ({})", output.status);
    String::from_utf8(output.stdout).with_context(|| format!("what {name} says"))
}
