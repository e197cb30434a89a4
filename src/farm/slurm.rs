//! Slurm: one task of a job array for each shard (sbatch(1), `--array`, `--requeue`).

use super::plan::{LOGS, Plan};
use super::submit::output;
use anyhow::{Context, Result};
use std::collections::HashSet;
use std::path::Path;
use std::process::Command;

/// The batch script, in the folder of jobs.
pub const FILE: &str = "slurm.sh";

/// Seconds before the end of its time at which a task is told, and puts itself back. Slurm may tell it up to a minute earlier.
const WARNING: u32 = 30;
/// Minutes of that time beside the task's own, which are over when it is told.
const BEYOND: u32 = 2;

/// Shards that Slurm has still to do or does just now: those of its tasks whose script is the one in that folder (squeue(1)).
///
/// # Errors
/// If Slurm is not there or does not say.
pub fn queued(jobs: &Path) -> Result<HashSet<usize>> {
    let script = jobs.join(FILE);
    let tasks = output(Command::new("squeue").args(["--noheader", "--array", "--format=%K %o"]))?;
    Ok(shards_of(&tasks, &script))
}

/// Numbers of the tasks, one a line with its script, that are of a script.
pub(super) fn shards_of(tasks: &str, script: &Path) -> HashSet<usize> {
    let script = script.to_string_lossy();
    let tasks = tasks.lines().filter_map(|line| line.trim().split_once(' '));
    tasks.filter(|(_, of)| of.trim() == script).filter_map(|(shard, _)| shard.parse().ok()).collect()
}

/// The batch script. Tasks whose node is lost Slurm puts back by itself. One that takes more than its time Slurm would end for good,
/// so it is told before, and puts itself back, as one that fails does.
///
/// # Errors
/// If a path cannot be written into a script.
pub fn script(plan: &Plan, jobs: &Path) -> Result<String> {
    let Plan { shards, cores, minutes, retries, .. } = plan;
    let time = minutes.saturating_add(BEYOND);
    let name = plan.name();
    let program = quoted(&plan.program)?;
    let folder = quoted(jobs)?;
    // Slurm takes the line as it is, but for its own signs.
    let log = text(&jobs.join(LOGS))?.replace('\\', "\\\\").replace('%', "%%");
    Ok(format!(
        "#!/bin/bash
# Shards of {name}, written by `deepshade farm plan`; `deepshade farm submit` submits those that are not made yet.
#SBATCH --job-name={name}
#SBATCH --array=1-{shards}
#SBATCH --ntasks=1
#SBATCH --cpus-per-task={cores}
#SBATCH --time={time}
#SBATCH --requeue
#SBATCH --signal=B:USR1@{WARNING}
#SBATCH --open-mode=append
#SBATCH --output=\"{log}/%a.log\"

worker= up=
# Its time is all but up, perhaps before the worker is known.
trap 'up=1; [ -n \"$worker\" ] && kill \"$worker\"' USR1
export RAYON_NUM_THREADS={cores}
{program} farm work {folder} --shard \"$SLURM_ARRAY_TASK_ID\" &
worker=$!
[ -n \"$up\" ] && kill \"$worker\"
# A signal ends the first wait before the worker has ended.
wait \"$worker\"; wait \"$worker\"
code=$?
[ \"$code\" -eq 0 ] && exit 0
# It goes on where it was.
if [ \"${{SLURM_RESTART_COUNT:-0}}\" -lt {retries} ]; then
    scontrol requeue \"${{SLURM_ARRAY_JOB_ID}}_${{SLURM_ARRAY_TASK_ID}}\"
fi
exit \"$code\"
"
    ))
}

/// A path as a word of a shell.
fn quoted(path: &Path) -> Result<String> {
    Ok(format!("'{}'", text(path)?.replace('\'', r"'\''")))
}

fn text(path: &Path) -> Result<&str> {
    let text = path.to_str().filter(|text| !text.contains(['\n', '"']));
    text.with_context(|| format!("{}: such a path cannot be in a script", path.display()))
}
