//! Killing jobs at random moments.

use super::job::Job;
use crate::program::{Program, message};
use anyhow::{Context, Result, anyhow};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Child, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// After so many faults it is known that something is wrong.
const MANY_FAULTS: usize = 20;
/// A job is killed at most so often before it may come to its end.
const IN_A_ROW: u64 = 6;

/// What killing came to.
#[derive(Debug, Default)]
pub struct Killed {
    /// Kills that met a job under way.
    pub kills: usize,
    /// Those of them after which everything was as it must be.
    pub survived: usize,
    /// Bytes that were held against those of an undisturbed job.
    pub bytes: u64,
    /// Kills of each job.
    pub by_job: BTreeMap<&'static str, usize>,
}

/// Kills jobs in turn until there were so many kills. What went wrong is added to `faults`.
///
/// # Errors
/// If the program cannot be started or a folder not be read.
pub fn run(
    program: &Program,
    jobs: &[Job],
    folder: &Path,
    kills: usize,
    seed: u64,
    faults: &mut Vec<String>,
) -> Result<Killed> {
    let mut random = Random(seed);
    let mut killed = Killed::default();
    let mut round = 0;
    while killed.kills < kills && faults.len() < MANY_FAULTS {
        let job = &jobs[round % jobs.len()];
        let out = folder.join(format!("killed-{round}"));
        let met = row(program, job, &out, &mut random, kills - killed.kills, &mut killed.bytes);
        round += 1;
        let (met, outcome) = met?;
        killed.kills += met;
        *killed.by_job.entry(job.name).or_default() += met;
        match outcome {
            Ok(()) => {
                killed.survived += met;
                std::fs::remove_dir_all(&out).with_context(|| out.display().to_string())?;
            }
            Err(error) => {
                faults.push(format!("{} after {met} kills, in {}: {error:#}", job.name, out.display()))
            }
        }
    }
    Ok(killed)
}

/// One job, killed a few times and then left alone: how often it was, and whether it came to what it must.
fn row(
    program: &Program,
    job: &Job,
    out: &Path,
    random: &mut Random,
    most: usize,
    bytes: &mut u64,
) -> Result<(usize, Result<()>)> {
    job.prepare(program, out)?;
    let wanted = (1 + random.below(IN_A_ROW)) as usize;
    let mut met = 0;
    for _ in 0..wanted.min(most) {
        let moment = job.takes.mul_f64(random.share());
        let child = job.command(program, out, &[]).stdout(Stdio::null()).stderr(Stdio::piped()).spawn()?;
        match killed_at(child, moment)? {
            Met::Done => break,
            Met::Failed(why) => return Ok((met, Err(anyhow!("it failed before it was killed: {why}")))),
            Met::AtWork => met += 1,
        }
        match job.so_far(out).and_then(|found| job.check_so_far(&found)) {
            Ok(compared) => *bytes += compared,
            Err(error) => return Ok((met, Err(error.context("right after a kill")))),
        }
    }
    let outcome = job.run(program, out).and_then(|()| job.check_done(program, out));
    let outcome = outcome.map(|compared| *bytes += compared);
    Ok((met, outcome))
}

/// How a kill met a job.
enum Met {
    /// Under way.
    AtWork,
    /// Not any more: it was done.
    Done,
    /// Not any more: it had failed, which is a fault whatever comes after it.
    Failed(String),
}

/// Kills a job after a time.
fn killed_at(mut child: Child, moment: Duration) -> Result<Met> {
    let start = Instant::now();
    while start.elapsed() < moment && child.try_wait()?.is_none() {
        std::thread::sleep(Duration::from_micros(200));
    }
    // One that has ended meanwhile has nothing to be killed.
    let _ = child.kill();
    let output = child.wait_with_output()?;
    Ok(match output.status {
        status if status.success() => Met::Done,
        status if is_killed(status) => Met::AtWork,
        status => Met::Failed(format!("{status}: {}", message(&output))),
    })
}

/// Whether SIGKILL has ended a process; elsewhere than on Unix, which has no signals, whether it did not end well.
fn is_killed(status: ExitStatus) -> bool {
    #[cfg(unix)]
    return std::os::unix::process::ExitStatusExt::signal(&status) == Some(9);
    #[cfg(not(unix))]
    return !status.success();
}

/// Random numbers (splitmix64), so that a seed gives the same moments again.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^ (bits >> 31)
    }

    /// From 0 to 1.
    fn share(&mut self) -> f64 {
        self.next() as f64 / u64::MAX as f64
    }

    fn below(&mut self, bound: u64) -> u64 {
        self.next() % bound
    }
}
