//! Slurm, from Debian's packages: a controller, three nodes of one core each, and one that says it has many, all on this machine,
//! with files of their own.

use super::Engine;
use super::hunt;
use crate::apt;
use crate::command::{self, command, succeeds};
use crate::program::Program;
use anyhow::{Context, Result, ensure};
use std::fmt::Write;
use std::net::{Ipv4Addr, TcpListener};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

const NODES: [&str; 3] = ["one", "two", "three"];
/// The one that is lost.
const LOST: &str = "three";
/// The node with room for all tasks that do nothing, in a partition of that name, so that the nodes are not what they wait for; and
/// its cores, which nobody has.
const WIDE: &str = "wide";
const WIDE_CORES: u32 = 256;

/// A cluster, as long as this lives.
pub struct Slurm {
    folder: PathBuf,
}

impl Slurm {
    /// Starts it.
    ///
    /// # Errors
    /// If it is not there and cannot be installed, or does not start.
    pub fn start(folder: &Path) -> Result<Self> {
        if !succeeds(&mut command("slurmctld", &["-V"])) || !succeeds(&mut command("munged", &["--version"]))
        {
            apt::install(&["slurmctld", "slurmd", "slurm-client", "munge"], "Slurm")?;
        }
        for part in ["run", "state", "spool", "logs"] {
            std::fs::create_dir_all(folder.join(part))?;
        }
        let cluster = Self { folder: folder.to_owned() };
        std::fs::write(cluster.path("slurm.conf"), configuration(folder)?)?;
        cluster.munge()?;
        command::run(&mut cluster.command("slurmctld", &["-c", "-i"]))?;
        for node in nodes() {
            command::run(&mut cluster.command("slurmd", &["-c", "-N", node]))?;
        }
        let begin = Instant::now();
        while cluster.said("sinfo", &["-h", "-N", "-t", "idle", "-o", "%N"])?.lines().count()
            < nodes().count()
        {
            ensure!(
                begin.elapsed() < Duration::from_secs(30),
                "the nodes do not come up; see {}",
                folder.display()
            );
            std::thread::sleep(Duration::from_millis(200));
        }
        Ok(cluster)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// The daemon that vouches for messages between the others, with a key of this run.
    fn munge(&self) -> Result<()> {
        let key = self.path("munge.key");
        let random = std::fs::read("/proc/sys/kernel/random/uuid")?.repeat(4);
        std::fs::write(&key, random)?;
        command::run(&mut command("chmod", &["400", &key.display().to_string()]))?;
        let option = |name: &str, file: &str| format!("--{name}={}", self.path(file).display());
        let files = [
            option("key-file", "munge.key"),
            option("socket", "run/munge.sock"),
            option("pid-file", "run/munged.pid"),
            option("log-file", "logs/munged.log"),
            option("seed-file", "state/seed"),
        ];
        command::run(command("munged", &["--force"]).args(files))
    }

    fn command(&self, program: &str, args: &[&str]) -> Command {
        let mut command = command(program, args);
        command.env("SLURM_CONF", self.path("slurm.conf"));
        command
    }

    fn said(&self, program: &str, args: &[&str]) -> Result<String> {
        let output = self.command(program, args).output().with_context(|| program.to_owned())?;
        Ok(String::from_utf8_lossy(&output.stdout).into_owned())
    }
}

impl Engine for Slurm {
    fn name(&self) -> &'static str {
        "slurm"
    }

    fn submit(&mut self, program: &Program, jobs: &Path) -> Result<()> {
        let mut submit = program.command(&["farm", "submit", &jobs.display().to_string()]);
        command::run(submit.env("SLURM_CONF", self.path("slurm.conf")))
    }

    fn submitted_once(&mut self, program: &Program, jobs: &Path) -> Result<()> {
        let mut again = program.command(&["farm", "submit", &jobs.display().to_string()]);
        let output = again.env("SLURM_CONF", self.path("slurm.conf")).output()?;
        let said = String::from_utf8_lossy(&output.stdout);
        ensure!(output.status.success() && said.contains("has still to do all"), "submitted twice: {said}");
        Ok(())
    }

    /// Tasks that do nothing, as many as keep it busy for a while, on a node with room for them: what each takes is the
    /// scheduler's time at most, for all daemons share this machine.
    fn launch(&mut self) -> Result<Option<f64>> {
        const TASKS: u32 = 600;
        let begin = Instant::now();
        let array = format!("--array=1-{TASKS}");
        let task = ["--output=/dev/null", "--partition", WIDE, &array, "--wrap=true"];
        command::run(&mut self.command("sbatch", &task))?;
        while !self.idle()? {
            ensure!(begin.elapsed() < Duration::from_mins(5), "tasks that do nothing do not end");
            std::thread::sleep(Duration::from_millis(100));
        }
        Ok(Some(begin.elapsed().as_secs_f64() / f64::from(TASKS)))
    }

    fn idle(&mut self) -> Result<bool> {
        let tasks = self.said("squeue", &["-h", "-r", "-o", "%i %r"])?;
        // What is put back waits for two minutes, whatever the configuration.
        for task in tasks.lines().filter_map(|line| line.strip_suffix(" BeginTime")) {
            self.said("scontrol", &["update", &format!("JobId={task}"), "StartTime=now"])?;
        }
        Ok(tasks.trim().is_empty())
    }

    fn workers(&self, jobs: &Path) -> Vec<u32> {
        hunt::workers(jobs)
    }

    fn lose_node(&mut self) -> Result<()> {
        let daemon = std::fs::read_to_string(self.path(&format!("run/slurmd-{LOST}.pid")))?;
        hunt::kill(daemon.trim().parse().context("the daemon's number")?);
        let there = format!("SLURMD_NODENAME={LOST}");
        let conf = format!("SLURM_CONF={}", self.path("slurm.conf").display());
        let on_node = |_: &str, environment: &str| {
            [&there, &conf].iter().all(|name| environment.lines().any(|line| line == name.as_str()))
        };
        for process in hunt::processes(on_node) {
            // The step's daemon is not started with the node's name.
            let parent =
                hunt::parent(process).filter(|parent| hunt::words(*parent, "cmdline").contains("slurmstepd"));
            for process in parent.into_iter().chain([process]) {
                hunt::kill(process);
            }
        }
        Ok(())
    }
}

impl Drop for Slurm {
    fn drop(&mut self) {
        let _ = self.said("scancel", &["--full", "-u", "root"]);
        let daemons = nodes().map(|node| format!("slurmd-{node}"));
        for name in daemons.chain(["slurmctld", "munged"].map(str::to_owned)) {
            let process = std::fs::read_to_string(self.path(&format!("run/{name}.pid")));
            if let Some(process) = process.ok().and_then(|text| text.trim().parse().ok()) {
                hunt::kill(process);
            }
        }
    }
}

/// All nodes.
fn nodes() -> impl Iterator<Item = &'static str> {
    NODES.into_iter().chain([WIDE])
}

/// slurm.conf(5): the least that several nodes on one machine need, times short.
fn configuration(folder: &Path) -> Result<String> {
    let host = String::from_utf8(command("hostname", &["-s"]).output()?.stdout)?;
    let host = host.trim();
    let user = String::from_utf8(command("id", &["-un"]).output()?.stdout)?;
    let listeners = (0..=nodes().count())
        .map(|_| TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).context("a port"))
        .collect::<Result<Vec<_>>>()?;
    let ports =
        listeners.iter().map(|listener| Ok(listener.local_addr()?.port())).collect::<Result<Vec<_>>>()?;
    let (folder, user, controller) = (folder.display(), user.trim(), ports[0]);
    let mut text = format!(
        "ClusterName=deepshade
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller}
SlurmUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/run/munge.sock
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool/%n
SlurmctldPidFile={folder}/run/slurmctld.pid
SlurmdPidFile={folder}/run/slurmd-%n.pid
SlurmctldLogFile={folder}/logs/slurmctld.log
SlurmdLogFile={folder}/logs/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
MpiDefault=none
SwitchType=switch/none
SlurmdTimeout=10
KillWait=2
MessageTimeout=10
SchedulerParameters=sched_interval=2,batch_sched_delay=0
SlurmdParameters=config_overrides
"
    );
    for (node, port) in nodes().zip(&ports[1..]) {
        let cores = if node == WIDE { WIDE_CORES } else { 1 };
        writeln!(
            text,
            "NodeName={node} NodeAddr=127.0.0.1 NodeHostname={host} Port={port} CPUs={cores} RealMemory=1000"
        )?;
    }
    let few = NODES.join(",");
    writeln!(text, "PartitionName=all Nodes={few} Default=YES MaxTime=INFINITE State=UP")?;
    writeln!(text, "PartitionName={WIDE} Nodes={WIDE} MaxTime=INFINITE State=UP")?;
    Ok(text)
}
