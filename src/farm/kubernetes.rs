//! Kubernetes: an indexed job (batch/v1, `completionMode: Indexed`) with one index for each shard, as a file
//! for kubectl.
//!
//! A volume that all pods share is at the folder of jobs: the claim `deepshade`, or another one once the file
//! is edited. Credentials of a store come from the secret `deepshade`, if there is one: each of its keys is a
//! variable of the environment.

use super::plan::FarmPlan;
use anyhow::{Context, Result};
use serde_json::json;
use std::path::Path;

/// Name of the volume's claim and of the secret.
const NAME: &str = "deepshade";

/// Pods at a time, at most; an autoscaler adds nodes for those that find none.
const AT_ONCE: u32 = 1000;

/// The job, as JSON, which kubectl reads as it reads YAML. A shard that always fails uses up its own retries
/// and nobody else's; a pod that takes more than its time is ended, which counts as one of them.
///
/// # Errors
/// If a path is no text.
pub fn job(plan: &FarmPlan, jobs: &Path) -> Result<String> {
    let jobs = jobs.to_str().context("the folder of jobs is no text")?;
    // Indices begin at 0. The paths are arguments of the shell, not part of what it reads.
    let work = "exec \"$0\" farm work \"$1\" --shard $((JOB_COMPLETION_INDEX + 1))";
    let job = json!({
        "apiVersion": "batch/v1",
        "kind": "Job",
        "metadata": { "name": plan.name() },
        "spec": {
            "completionMode": "Indexed",
            "completions": plan.shards,
            "parallelism": plan.shards.min(AT_ONCE),
            "backoffLimitPerIndex": plan.retries,
            "maxFailedIndexes": plan.shards,
            "template": { "spec": {
                "restartPolicy": "Never",
                "activeDeadlineSeconds": 60 * u64::from(plan.minutes),
                "containers": [{
                    "name": "shard",
                    "image": plan.image,
                    "command": ["sh", "-c", work, plan.program, jobs],
                    "envFrom": [{ "secretRef": { "name": NAME, "optional": true } }],
                    "env": [{ "name": "RAYON_NUM_THREADS", "value": plan.cores.to_string() }],
                    "resources": { "requests": { "cpu": plan.cores.to_string() } },
                    "volumeMounts": [{ "name": "jobs", "mountPath": jobs }],
                }],
                "volumes": [{ "name": "jobs", "persistentVolumeClaim": { "claimName": NAME } }],
            } },
        },
    });
    serde_json::to_string_pretty(&job).context("a job as JSON")
}
