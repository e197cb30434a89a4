//! Slurm: one task of a job array for each shard (sbatch(1), `--array`, `--requeue`).

use super::plan::{FarmPlan, LOGS};
use anyhow::{Context, Result};
use std::path::Path;

/// Seconds before the end of its time at which a task is told, and puts itself back. Slurm may tell it up to
/// a minute earlier.
const WARNING: u32 = 30;
/// Minutes of that time beside the task's own, which are over when it is told.
const BEYOND: u32 = 2;

/// The batch script. Tasks whose node is lost Slurm puts back by itself. One that takes more than its time
/// Slurm would end for good, so it is told before, and puts itself back, as one that fails does.
///
/// # Errors
/// If a path cannot be written into a script.
pub fn script(plan: &FarmPlan, jobs: &Path) -> Result<String> {
    let FarmPlan { shards, cores, minutes, retries, .. } = plan;
    let time = minutes.saturating_add(BEYOND);
    let name = plan.name();
    let program = quoted(&plan.program)?;
    let folder = quoted(jobs)?;
    // Slurm takes the line as it is, but for its own signs.
    let log = text(&jobs.join(LOGS))?.replace('\\', "\\\\").replace('%', "%%");
    Ok(format!(
        "#!/bin/bash
# Shards of {name}, written by `deepshade farm plan`.
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
