//! Ray: one task for each shard, on a cluster that runs.

/// The script, in the folder of jobs.
pub const FILE: &str = "ray_tasks.py";

/// The script; it reads the plan beside it.
pub const SCRIPT: &str = include_str!("ray_tasks.py");
