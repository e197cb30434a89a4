//! What happens to programs beside being killed, each to the making of a dataset. Whatever it is, the same command makes the
//! rest afterwards, and the bytes are those of an undisturbed run.

use super::job::{JOURNAL, Job};
use crate::command::command;
use crate::program::{Program, contents, message};
use anyhow::{Context, Result, bail, ensure};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A name and what came of it.
pub type Outcome = (&'static str, Result<()>);

/// Plays all scenarios.
///
/// # Errors
/// If a folder cannot be made.
pub fn run(program: &Program, job: &Job, folder: &Path) -> Result<Vec<Outcome>> {
    let stage = |name: &str| Stage { program, job, out: folder.join(name) };
    Ok(vec![
        ("disk full", stage("full").on_small_disk()),
        ("read-only folder", stage("read-only").read_only()),
        ("slow folder", stage("slow").slow()),
        ("memory limit", stage("memory").short_of_memory()),
        ("Ctrl-C", stage("interrupted").interrupted("-INT", 130)),
        ("ended by a scheduler", stage("terminated").interrupted("-TERM", 143)),
        ("stopped and continued", stage("stopped").stopped()),
        ("two at once", stage("twice").twice()),
        ("clock set back", stage("clock").in_the_future()),
        ("damaged file", stage("damaged").damaged()),
        ("journal cut off", stage("cut").journal_cut_off()),
    ])
}

/// A folder in which something happens.
struct Stage<'a> {
    program: &'a Program,
    job: &'a Job,
    out: PathBuf,
}

impl Stage<'_> {
    /// The journal of a job under way.
    fn journal(&self) -> PathBuf {
        self.out.join(JOURNAL)
    }

    /// What is there in the end.
    fn check(&self, out: &Path) -> Result<()> {
        self.job.check_done(self.program, out).map(drop)
    }

    fn start(&self) -> Result<Child> {
        let mut command = self.program.command(&self.job.words(&self.out));
        Ok(command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn()?)
    }

    /// Starts the job and waits until some pairs are there.
    fn start_some(&self) -> Result<Child> {
        let mut child = self.start()?;
        let begin = Instant::now();
        let lines =
            || std::fs::read(self.journal()).unwrap_or_default().iter().filter(|b| **b == b'\n').count();
        while lines() < 3 {
            ensure!(child.try_wait()?.is_none(), "it ended before anything could happen");
            ensure!(begin.elapsed() < Duration::from_mins(2), "no pair in two minutes");
            std::thread::sleep(Duration::from_millis(1));
        }
        Ok(child)
    }

    /// Starts the job and kills it when some pairs are there.
    fn kill_some(&self) -> Result<()> {
        let mut child = self.start_some()?;
        child.kill()?;
        child.wait()?;
        Ok(())
    }

    /// The same command again, undisturbed.
    fn finish(&self) -> Result<()> {
        self.program.run(&self.job.words(&self.out)).context("undisturbed again")?;
        self.check(&self.out)
    }

    /// Runs the job by bash, after some words of it.
    fn by_bash(&self, before: &str) -> Command {
        let line = format!("{before} exec \"$@\"");
        let mut bash = command("bash", &["-c", &line, "bash"]);
        bash.arg(self.program.path()).args(self.job.words(&self.out));
        bash
    }

    /// In a folder whose disk has room for a few pairs; then it gets more.
    fn on_small_disk(&self) -> Result<()> {
        self.on_disk(
            "mount -t tmpfs -o size=150k none \"$out\"; \"$@\" && exit 3; mount -o remount,size=100m \"$out\"; \"$@\"",
            "No space left",
        )
    }

    /// In a folder that cannot be written to; then it can.
    fn read_only(&self) -> Result<()> {
        self.on_disk(
            "mount -t tmpfs -o size=100m,ro none \"$out\"; \"$@\" && exit 3; mount -o remount,rw \"$out\"; \"$@\"",
            "Read-only file system",
        )
    }

    /// Runs a script, in which `$out` is the job's folder and `"$@"` the job, with mounts that nobody else sees. What is there
    /// then is copied to where it can be seen.
    fn on_disk(&self, script: &str, said: &str) -> Result<()> {
        std::fs::create_dir_all(&self.out)?;
        let seen = self.out.with_extension("seen");
        let all = format!("out=$1; seen=$2; shift 2; set -u; {script} || exit 4; cp -a \"$out\" \"$seen\"");
        let mut unshare = command("unshare", &["--mount", "--map-root-user", "bash", "-c", &all, "bash"]);
        unshare.arg(&self.out).arg(&seen).arg(self.program.path()).args(self.job.words(&self.out));
        let output = unshare.output().context("unshare (util-linux)")?;
        let errors = String::from_utf8_lossy(&output.stderr).into_owned();
        ensure!(output.status.success(), "{}: {errors}", output.status);
        ensure!(errors.contains(said), "it does not say `{said}`: {errors}");
        self.check(&seen)
    }

    /// Every file takes a fifth of a second to get to the disk.
    fn slow(&self) -> Result<()> {
        if !crate::command::succeeds(&mut command("strace", &["--version"])) {
            crate::apt::install(&["strace"], "strace, which delays what a program asks of the system,")?;
        }
        let delayed = "inject=fsync,rename,renameat,renameat2:delay_enter=200000";
        let mut strace =
            command("strace", &["-f", "-qq", "-o", "/dev/null", "-e", "trace=none", "-e", delayed]);
        strace.arg(self.program.path()).args(self.job.words(&self.out));
        let output = strace.output().context("strace")?;
        ensure!(output.status.success(), "{}", message(&output));
        self.check(&self.out)
    }

    /// With too little memory, then with more and more until it is enough.
    fn short_of_memory(&self) -> Result<()> {
        const MEGABYTES: [u32; 12] = [100, 150, 200, 250, 300, 350, 400, 500, 700, 1000, 2000, 4000];
        for megabytes in MEGABYTES {
            let output = self.by_bash(&format!("ulimit -v {};", megabytes * 1000)).output()?;
            self.job.check_so_far(&self.job.so_far(&self.out)?)?;
            if output.status.success() {
                ensure!(megabytes > MEGABYTES[0], "{megabytes} MB were enough");
                return self.check(&self.out);
            }
        }
        bail!("4 GB were not enough")
    }

    /// By a signal that asks it to end.
    fn interrupted(&self, signal: &str, code: i32) -> Result<()> {
        let child = self.start_some()?;
        send(signal, &child)?;
        let output = child.wait_with_output()?;
        ensure!(output.status.code() == Some(code), "it ended with {}", output.status);
        ensure!(message(&output).contains("the same command goes on"), "it says: {}", message(&output));
        self.job.check_so_far(&self.job.so_far(&self.out)?)?;
        self.finish()
    }

    /// For a second, in the middle.
    fn stopped(&self) -> Result<()> {
        let mut child = self.start_some()?;
        send("-STOP", &child)?;
        std::thread::sleep(Duration::from_secs(1));
        send("-CONT", &child)?;
        ensure!(child.wait()?.success(), "it failed when it was continued");
        self.check(&self.out)
    }

    /// A second one is started while the first is at work.
    fn twice(&self) -> Result<()> {
        let mut first = self.start_some()?;
        send("-STOP", &first)?;
        let second = self.program.output(&self.job.words(&self.out));
        send("-CONT", &first)?;
        ensure!(first.wait()?.success(), "the first failed");
        let second = second?;
        let holder = format!("process {}", first.id());
        ensure!(second.status.code() == Some(1), "the second ended with {}", second.status);
        ensure!(message(&second).contains(&holder), "it does not name {holder}: {}", message(&second));
        self.check(&self.out)
    }

    /// All files are from the future, as they are where a clock was set back.
    fn in_the_future(&self) -> Result<()> {
        self.kill_some()?;
        let future = std::time::SystemTime::now() + Duration::from_hours(24 * 365);
        for name in contents(&self.out)?.into_keys() {
            std::fs::File::options().append(true).open(self.out.join(name))?.set_modified(future)?;
        }
        self.finish()
    }

    /// A finished pair gets another byte.
    fn damaged(&self) -> Result<()> {
        self.kill_some()?;
        let names = contents(&self.out)?.into_keys();
        let Some(pair) = names.into_iter().find(|name| name.extension().is_some_and(|kind| kind == "exr"))
        else {
            bail!("there is no pair")
        };
        let path = self.out.join(pair);
        let mut bytes = std::fs::read(&path)?;
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        std::fs::write(&path, bytes)?;
        self.finish()
    }

    /// The journal's last line is half there.
    fn journal_cut_off(&self) -> Result<()> {
        self.kill_some()?;
        let file = std::fs::File::options().write(true).open(self.journal())?;
        file.set_len(file.metadata()?.len() - 20)?;
        self.finish()
    }
}

/// Sends a signal, named as kill(1) has it.
fn send(signal: &str, child: &Child) -> Result<()> {
    crate::command::run(&mut command("kill", &[signal, &child.id().to_string()]))
}
