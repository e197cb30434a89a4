//! Ray, from PyPI: a head and a second node on this machine.

use super::Engine;
use super::hunt;
use crate::command::{self, command};
use crate::program::{Program, message};
use crate::python;
use anyhow::{Context, Result, ensure};
use std::net::{Ipv4Addr, TcpListener};
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::time::Duration;

/// The version that is tried.
const RAY: &str = "ray==2.60.0";

/// A cluster, as long as this lives.
pub struct Ray {
    python: PathBuf,
    address: String,
    /// Sockets have short names.
    folder: PathBuf,
    nodes: Vec<Child>,
    submission: Option<Child>,
}

impl Ray {
    /// Starts it.
    ///
    /// # Errors
    /// If it cannot be installed or does not start.
    pub fn start() -> Result<Self> {
        let python = python::environment("ray", &[RAY])?;
        let port = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?.local_addr()?.port();
        let folder = std::env::temp_dir().join(format!("ray-{}", std::process::id()));
        let address = format!("127.0.0.1:{port}");
        let mut cluster = Self { python, address, folder, nodes: Vec::new(), submission: None };
        let temporary = cluster.folder.display().to_string();
        let port = port.to_string();
        let head = ["--head", "--node-ip-address", "127.0.0.1", "--port", &port, "--temp-dir", &temporary];
        cluster.node(&[&head[..], &["--include-dashboard", "false", "--num-cpus", "2"]].concat())?;
        let address = cluster.address.clone();
        cluster.node(&["--address", &address, "--node-ip-address", "127.0.0.1", "--num-cpus", "1"])?;
        Ok(cluster)
    }

    /// A node, which lives as long as what it is started by.
    fn node(&mut self, options: &[&str]) -> Result<()> {
        let ray = self.python.with_file_name("ray").display().to_string();
        let mut start =
            command(&ray, &[&["start", "--block", "--disable-usage-stats"][..], options].concat());
        let child = start.stdout(Stdio::null()).stderr(Stdio::null()).spawn().context("ray")?;
        self.nodes.push(child);
        let wanted = self.nodes.len();
        let count = format!(
            "import ray, sys, time\nfor _ in range(150):\n try:\n  ray.init(address='{}', logging_level='ERROR', log_to_driver=False)\n  \
             alive = sum(node['Alive'] for node in ray.nodes())\n  ray.shutdown()\n  if alive == {wanted}: sys.exit(0)\n \
             except Exception: pass\n time.sleep(0.2)\nsys.exit(1)",
            self.address
        );
        let python = self.python.display().to_string();
        command::run(command(&python, &["-c", &count]).stdout(Stdio::null()).stderr(Stdio::null()))
            .context("the nodes do not come up")
    }
}

impl Engine for Ray {
    fn name(&self) -> &'static str {
        "ray"
    }

    fn submit(&mut self, program: &Program, jobs: &Path) -> Result<()> {
        let python = self.python.display().to_string();
        let mut submit =
            program.command(&["farm", "submit", &jobs.display().to_string(), "--python", &python]);
        submit.env("RAY_ADDRESS", &self.address).stdout(Stdio::null()).stderr(Stdio::null());
        self.submission = Some(submit.spawn()?);
        Ok(())
    }

    fn submitted_once(&mut self, program: &Program, jobs: &Path) -> Result<()> {
        let submission = self.submission.as_mut().context("a submission")?;
        // It has its lock before it starts Python, which takes a second.
        while !jobs.join("submit/lock").exists() && submission.try_wait()?.is_none() {
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(Duration::from_millis(100));
        let output = program.output(&["farm", "submit", &jobs.display().to_string()])?;
        ensure!(message(&output).contains("submits it"), "submitted twice: {}", message(&output));
        Ok(())
    }

    fn idle(&mut self) -> Result<bool> {
        match &mut self.submission {
            Some(submission) => Ok(submission.try_wait()?.is_some()),
            None => Ok(true),
        }
    }

    /// The program, and Ray's own processes that started it.
    fn workers(&self, jobs: &Path) -> Vec<u32> {
        let programs = hunt::workers(jobs);
        let ray = |process: &u32| {
            hunt::parent(*process).filter(|parent| hunt::words(*parent, "cmdline").contains("ray::"))
        };
        let mut all: Vec<u32> = programs.iter().filter_map(ray).chain(programs.iter().copied()).collect();
        all.sort_unstable();
        all
    }

    fn lose_node(&mut self) -> Result<()> {
        let node = self.nodes.pop().context("a node")?;
        end(node)
    }
}

/// Ends a node with all that it has started.
fn end(mut node: Child) -> Result<()> {
    command::succeeds(&mut command("kill", &["-TERM", &node.id().to_string()]));
    node.wait()?;
    Ok(())
}

impl Drop for Ray {
    fn drop(&mut self) {
        if let Some(mut submission) = self.submission.take() {
            let _ = submission.kill();
            let _ = submission.wait();
        }
        while let Some(node) = self.nodes.pop() {
            let _ = end(node);
        }
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}
