//! Files that are not as a job left them, and clocks that say they are from a later time.

use super::Stage;
use crate::apt;
use crate::command::{command, succeeds};
use crate::faults::job::JOURNAL;
use crate::program::{contents, message};
use anyhow::{Context, Result, bail, ensure};
use std::path::PathBuf;
use std::time::{Duration, SystemTime};

/// By how many days clocks are set back.
const DAYS: u64 = 400;

/// How a clock is set back.
#[derive(Clone, Copy)]
pub enum Clock {
    /// For the program alone, by faketime.
    Set,
    /// Not at all, but files have times as where it was.
    Seeming,
}

/// The best way that there is here.
pub fn clock() -> Clock {
    let there = || succeeds(&mut command("faketime", &["--version"]));
    if there() || apt::install(&["faketime"], "faketime, which sets a program's clock,").is_ok() && there() {
        return Clock::Set;
    }
    println!("faketime is missing: files will be from a later time, but no clock is set back");
    Clock::Seeming
}

impl Clock {
    /// What it is called among scenarios.
    pub fn name(self) -> &'static str {
        match self {
            Self::Set => "clock set back",
            Self::Seeming => "files from a later time",
        }
    }

    /// What happens.
    pub fn scenario(self) -> fn(&Stage<'_>) -> Result<()> {
        match self {
            Self::Set => with_an_earlier_clock,
            Self::Seeming => in_the_future,
        }
    }
}

/// The journal of a job under way.
fn journal(stage: &Stage<'_>) -> PathBuf {
    stage.job.made(&stage.out).join(JOURNAL)
}

/// The job goes on when its clock says that its files will be made in a year.
fn with_an_earlier_clock(stage: &Stage<'_>) -> Result<()> {
    stage.kill_some()?;
    let back = format!("-{DAYS}d");
    // Files keep the times that they have, and clocks that only go forward go on, as they do where a clock is set.
    let earlier = ["env", "NO_FAKE_STAT=1", "faketime", "-m", "--exclude-monotonic", "-f", back.as_str()];
    let date = command(earlier[0], &[&earlier[1..], &["date", "+%s"]].concat()).output()?;
    let seconds: u64 = String::from_utf8_lossy(&date.stdout).trim().parse().context("faketime's clock")?;
    let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH)?.as_secs();
    ensure!(seconds + (DAYS - 1) * 24 * 3600 < now, "faketime does not set the clock");
    let output = stage.command(&earlier).output()?;
    ensure!(output.status.success(), "{}: {}", output.status, message(&output));
    stage.check(&stage.out)
}

/// All files are from the future.
fn in_the_future(stage: &Stage<'_>) -> Result<()> {
    stage.kill_some()?;
    let future = SystemTime::now() + Duration::from_hours(24 * DAYS);
    for name in contents(&stage.out)?.into_keys() {
        std::fs::File::options().append(true).open(stage.out.join(name))?.set_modified(future)?;
    }
    stage.finish()
}

/// A finished pair gets another byte.
pub fn damaged(stage: &Stage<'_>) -> Result<()> {
    stage.kill_some()?;
    let made = stage.job.made(&stage.out);
    let names = contents(&made)?.into_keys();
    let Some(pair) = names.into_iter().find(|name| name.extension().is_some_and(|kind| kind == "exr")) else {
        bail!("there is no pair")
    };
    let path = made.join(pair);
    let mut bytes = std::fs::read(&path)?;
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(&path, bytes)?;
    stage.finish()
}

/// The journal's last line is half there.
pub fn journal_cut_off(stage: &Stage<'_>) -> Result<()> {
    stage.kill_some()?;
    let file = std::fs::File::options().write(true).open(journal(stage))?;
    file.set_len(file.metadata()?.len() - 20)?;
    stage.finish()
}
