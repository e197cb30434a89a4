//! Disks that are full, read-only or slow, and too little memory.

use super::{DELAY, Stage};
use crate::program::message;
use anyhow::{Context, Result, bail, ensure};
use std::time::Instant;

/// Seconds after which a job that is short of memory hangs.
const SECONDS: &str = "120";
/// What timeout(1) ends with then.
const HUNG: [i32; 2] = [124, 137];
/// With as many megabytes a program is not even loaded.
const LEAST_MEGABYTES: usize = 40;
const MOST_MEGABYTES: usize = 4000;
const STEP_MEGABYTES: usize = 5;

/// In a folder whose disk has room for a part of what is made; then it gets more.
pub fn on_small_disk(stage: &Stage<'_>) -> Result<()> {
    let few = stage.job.few_kilobytes.context("there is more in its folder than what it makes")?;
    on_disk(stage, &format!("size={few}k"), "size=100m", "No space left")
}

/// In a folder that cannot be written to; then it can.
pub fn read_only(stage: &Stage<'_>) -> Result<()> {
    on_disk(stage, "size=100m,ro", "rw", "Read-only file system")
}

/// Runs the job in a folder that is on a disk with such options, where it must fail, and again with others, by a script in
/// which `$out` is the folder and `"$@"` the job. Nobody else sees these mounts: what is there then is copied to where it can be
/// seen.
fn on_disk(stage: &Stage<'_>, first: &str, then: &str, said: &str) -> Result<()> {
    std::fs::create_dir_all(&stage.out)?;
    let seen = stage.out.with_extension("seen");
    let script = format!(
        "out=$1; seen=$2; shift 2; set -u; mount -t tmpfs -o {first} none \"$out\" || exit 4; \"$@\" && exit 3; \
         mount -o remount,{then} \"$out\" && \"$@\" && cp -a \"$out\" \"$seen\" || exit 4"
    );
    let [out, copy] = [&stage.out, &seen].map(|path| path.display().to_string());
    let apart = ["unshare", "--mount", "--map-root-user", "bash", "-c", &script, "bash", &out, &copy];
    let output = stage.command(&apart).output().context("unshare (util-linux)")?;
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    ensure!(output.status.success(), "{}: {errors}", output.status);
    ensure!(errors.contains(said), "it does not say `{said}`: {errors}");
    stage.check(&seen)
}

/// Files take their time to get to the disk.
pub fn slow(stage: &Stage<'_>) -> Result<()> {
    let begin = Instant::now();
    // By one thread, so that it is known how much longer all files take, one after the other.
    let output = stage.slowed().env("RAYON_NUM_THREADS", "1").output().context("strace")?;
    let took = begin.elapsed();
    ensure!(output.status.success(), "{}", message(&output));
    // Each is synced and renamed.
    let least = 2 * DELAY * u32::try_from(stage.job.calm.len())?;
    ensure!(took >= least, "nothing was slow: it took {took:?}, and the files alone must take {least:?}");
    stage.check(&stage.out)
}

/// With too little memory, then with more and more until it is enough.
pub fn short_of_memory(stage: &Stage<'_>) -> Result<()> {
    let mut asked = false;
    for megabytes in (LEAST_MEGABYTES..=MOST_MEGABYTES).step_by(STEP_MEGABYTES) {
        let line = format!("ulimit -v {}; exec timeout --kill-after=5 {SECONDS} \"$@\"", megabytes * 1000);
        let output = stage.command(&["bash", "-c", &line, "bash"]).output()?;
        stage.check_so_far().with_context(|| format!("with {megabytes} MB"))?;
        if output.status.success() {
            ensure!(asked, "{megabytes} MB were enough, and with less it was not even loaded");
            return stage.check(&stage.out);
        }
        let hung = output.status.code().is_some_and(|code| HUNG.contains(&code));
        ensure!(!hung, "it hangs with {megabytes} MB");
        let said = String::from_utf8_lossy(&output.stderr);
        asked |= ["error: ", "panicked", "memory allocation"].iter().any(|word| said.contains(word));
    }
    bail!("{MOST_MEGABYTES} MB were not enough")
}
