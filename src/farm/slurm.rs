//! Slurm: one task of a job array for each shard (sbatch(1), `--array`, `--requeue`).

use super::plan::{LOGS, Plan};
use anyhow::{Context, Result};
use std::path::Path;

/// The batch script, in the folder of jobs.
pub const FILE: &str = "slurm.sh";

/// The batch script. Tasks whose node is lost Slurm puts back by itself; those that fail ask for it.
///
/// # Errors
/// If a path cannot be written into a script.
pub fn script(plan: &Plan, jobs: &Path) -> Result<String> {
    let Plan { shards, cores, minutes, retries, .. } = plan;
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
#SBATCH --time={minutes}
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output=\"{log}/%a.log\"

export RAYON_NUM_THREADS={cores}
{program} farm work {folder} --shard \"$SLURM_ARRAY_TASK_ID\" && exit 0
code=$?
# A lost node's task is put back by Slurm, one that fails by itself, and goes on where it was.
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
