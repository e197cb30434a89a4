//! A clean root: Debian's least, and nothing of this machine.

use crate::apt;
use crate::command::{self, command, succeeds, target};
use anyhow::{Context, Result};
use std::path::{Path, PathBuf};

const RELEASE: &str = "bookworm";
const MIRROR: &str = "http://deb.debian.org/debian";

/// A root folder, deleted with this.
pub struct Root(PathBuf);

/// The root that others are copies of, made by debootstrap where it is missing.
///
/// # Errors
/// If debootstrap is not there or fails, or this is not run as root.
pub fn clean() -> Result<PathBuf> {
    let clean = target().join("clean-root");
    if !clean.join("complete").exists() {
        if !succeeds(&mut command("debootstrap", &["--version"])) {
            apt::install(&["debootstrap"], "debootstrap, which makes clean roots,")?;
        }
        let folder = clean.display().to_string();
        command::run(&mut command("debootstrap", &["--variant=minbase", RELEASE, &folder, MIRROR]))
            .context("a clean root, which is made as root")?;
        std::fs::write(clean.join("complete"), "")?;
    }
    Ok(clean)
}

impl Root {
    /// A copy of the clean one.
    ///
    /// # Errors
    /// As [`clean`].
    pub fn new(name: &str) -> Result<Self> {
        let clean = clean()?;
        let root = Self(target().join(format!("root-{name}-{}", std::process::id())));
        command::copy(&clean, &root.0)?;
        // Names are resolved as they are here.
        if Path::new("/etc/resolv.conf").exists() {
            std::fs::copy("/etc/resolv.conf", root.path("etc/resolv.conf")).context("/etc/resolv.conf")?;
        }
        Ok(root)
    }

    /// A path of the root's.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// Copies something into it.
    ///
    /// # Errors
    /// If it cannot be read or written.
    pub fn put(&self, from: &Path, to: &str) -> Result<()> {
        command::copy(from, &self.path(to))
    }

    /// Runs a line there, in a shell, with processes and mounts of its own.
    ///
    /// # Errors
    /// If it fails.
    pub fn run(&self, line: &str) -> Result<()> {
        self.run_as("root", line)
    }

    /// The same as a user of the root's.
    ///
    /// # Errors
    /// If it fails.
    pub fn run_as(&self, user: &str, line: &str) -> Result<()> {
        let root = self.0.display().to_string();
        let proc = format!("--mount-proc={}", self.path("proc").display());
        let apart = ["--mount", "--pid", "--fork", &proc, "chroot", &root];
        let clean = [
            "env",
            "-i",
            "PATH=/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin",
            "DEBIAN_FRONTEND=noninteractive",
        ];
        let shell = ["runuser", "-u", user, "--", "sh", "-ec", line];
        command::run(&mut command("unshare", &[&apart[..], &clean, &shell].concat()))
    }
}

impl Drop for Root {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
