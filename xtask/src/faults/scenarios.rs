//! What happens to programs beside being killed. Whatever it is, the same command makes the rest afterwards, and the bytes are
//! those of an undisturbed run.

mod adapter;
mod files;
mod shortage;
mod signals;

use super::job::Job;
use crate::command::{command, succeeds};
use crate::program::Program;
use anyhow::{Context, Result, ensure};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// The longest that a job may take to come so far that something can happen to it.
const PATIENCE: Duration = Duration::from_mins(2);

/// What a program asks of the system when it brings a file to the disk and gives it its name.
const TO_DISK: &str = "fsync,rename,renameat,renameat2";
/// By how much each of that takes longer in a slow folder.
const DELAY: Duration = Duration::from_millis(200);

/// Something that happens, and the jobs to which it does.
type Scenario = (&'static str, &'static [&'static str], fn(&Stage<'_>) -> Result<()>);

/// The one whose files are many and take their time.
const PAIRS: &[&str] = &["dataset"];
/// Jobs that keep a journal.
const FARMED: &[&str] = &["dataset", "farm"];
/// Jobs that go on where they were.
const RESUMED: &[&str] = &["dataset", "farm", "train"];
/// Jobs whose folder holds nothing but what they make, so that another disk may lie over it.
const OWN_FOLDER: &[&str] = &["dataset", "merge", "train", "export"];
/// All jobs.
const ALL: &[&str] = &["dataset", "farm", "merge", "train", "export"];

const SCENARIOS: [Scenario; 10] = [
    ("disk full", OWN_FOLDER, shortage::on_small_disk),
    ("read-only folder", OWN_FOLDER, shortage::read_only),
    ("slow folder", PAIRS, shortage::slow),
    ("memory limit", ALL, shortage::short_of_memory),
    ("Ctrl-C", ALL, signals::interrupted),
    ("ended by a scheduler", FARMED, signals::ended),
    ("stopped and continued", RESUMED, signals::stopped),
    ("two at once", RESUMED, signals::twice),
    ("damaged file", FARMED, files::damaged),
    ("journal cut off", FARMED, files::journal_cut_off),
];

/// A name and what came of it.
pub type Outcome = (String, Result<()>);

/// Plays all scenarios.
///
/// # Errors
/// If a tool is missing.
pub fn run(program: &Program, jobs: &[Job], folder: &Path) -> Result<Vec<Outcome>> {
    if !succeeds(&mut command("strace", &["--version"])) {
        crate::apt::install(&["strace"], "strace, which delays what a program asks of the system,")?;
    }
    let clock = files::clock();
    let mut outcomes = Vec::new();
    for (what, names, play) in SCENARIOS.into_iter().chain([(clock.name(), RESUMED, clock.scenario())]) {
        for job in jobs.iter().filter(|job| names.contains(&job.name)) {
            let name = format!("{what}, {}", job.name);
            let out = folder.join(name.replace([' ', ','], "-"));
            let stage = Stage { program, job, out };
            let outcome = job.prepare(program, &stage.out).and_then(|()| play(&stage));
            outcomes.push((name, outcome));
        }
    }
    outcomes.push(("adapter lost in mid-frame, by tests of deepshade-render".to_owned(), adapter::lost()));
    Ok(outcomes)
}

/// A folder in which something happens to a job.
struct Stage<'a> {
    program: &'a Program,
    job: &'a Job,
    out: PathBuf,
}

impl Stage<'_> {
    /// What is there in the end.
    fn check(&self, out: &Path) -> Result<()> {
        self.job.check_done(self.program, out).map(drop)
    }

    /// What is there on the way.
    fn check_so_far(&self) -> Result<()> {
        self.job.check_so_far(&self.job.so_far(&self.out)?).map(drop)
    }

    /// The job, after words that run it.
    fn command(&self, before: &[&str]) -> Command {
        self.job.command(self.program, &self.out, before)
    }

    /// The job, for which everything that brings a file to the disk, or to its name, takes as much longer as [`DELAY`] says.
    fn slowed(&self) -> Command {
        // Only what is traced is delayed.
        let traced = format!("trace={TO_DISK}");
        let delayed = format!("inject={TO_DISK}:delay_enter={}", DELAY.as_micros());
        // What delays is apart from the job, whose process it would else be the parent of.
        self.command(&["strace", "-D", "-f", "-qq", "-o", "/dev/null", "-e", &traced, "-e", &delayed])
    }

    /// Starts the job and waits until it has something to lose.
    fn start_some(&self) -> Result<Child> {
        let mut job = if self.job.is_quick() { self.slowed() } else { self.command(&[]) };
        let mut child = job.stdout(Stdio::null()).stderr(Stdio::piped()).spawn()?;
        let begin = Instant::now();
        while !self.job.begun(&self.out) {
            ensure!(child.try_wait()?.is_none(), "it ended before anything could happen");
            ensure!(begin.elapsed() < PATIENCE, "it does not begin");
            std::thread::sleep(Duration::from_millis(1));
        }
        Ok(child)
    }

    /// Starts the job and kills it when it has something to lose.
    fn kill_some(&self) -> Result<()> {
        let mut child = self.start_some()?;
        child.kill()?;
        child.wait()?;
        Ok(())
    }

    /// The same command again, undisturbed.
    fn finish(&self) -> Result<()> {
        self.job.run(self.program, &self.out).context("undisturbed again")?;
        self.check(&self.out)
    }
}
