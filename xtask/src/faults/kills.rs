//! Killing jobs at random moments.

use super::job::Job;
use crate::program::Program;
use anyhow::{Context, Result};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

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
    while killed.kills < kills {
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
    let wanted = (1 + random.below(IN_A_ROW)) as usize;
    let mut met = 0;
    for _ in 0..wanted.min(most) {
        let moment = job.takes.mul_f64(random.share());
        let mut child =
            program.command(&job.words(out)).stdout(Stdio::null()).stderr(Stdio::null()).spawn()?;
        if !killed_at(&mut child, moment)? {
            break;
        }
        met += 1;
        match job.so_far(out).and_then(|found| job.check_so_far(&found)) {
            Ok(compared) => *bytes += compared,
            Err(error) => return Ok((met, Err(error.context("right after a kill")))),
        }
    }
    let outcome = program.run(&job.words(out)).and_then(|()| job.check_done(program, out));
    let outcome = outcome.map(|compared| *bytes += compared);
    Ok((met, outcome))
}

/// Kills a job after a time; whether that met it under way.
fn killed_at(child: &mut Child, moment: Duration) -> Result<bool> {
    let start = Instant::now();
    while start.elapsed() < moment {
        if child.try_wait()?.is_some() {
            return Ok(false);
        }
        std::thread::sleep(Duration::from_micros(200));
    }
    // One that has ended meanwhile has nothing to be killed.
    let _ = child.kill();
    Ok(!child.wait()?.success())
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
