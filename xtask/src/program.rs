//! The program itself, built as people build it, for commands that watch it from outside.

use crate::command::{self, cargo, command, target};
use anyhow::{Context, Result, ensure};
use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Arguments of cargo's that build the program and that of studies; features come behind them.
pub const WITH_STUDIES: [&str; 7] =
    ["build", "--release", "--locked", "--package", "deepshade", "--package", "deepshade-studies"];

/// What temporary files are called until they are whole (`shaders::atomic_file`).
const TEMPORARY_PREFIX: &str = ".deepshade-";

/// A built program.
#[derive(Clone, Debug)]
pub struct Program(PathBuf);

impl Program {
    /// Builds it.
    ///
    /// # Errors
    /// If it does not build.
    pub fn build() -> Result<Self> {
        Self::build_by(&["build", "--release", "--locked"])
    }

    /// Builds it by such arguments of cargo's.
    ///
    /// # Errors
    /// If it does not build.
    pub fn build_by<S: AsRef<OsStr>>(words: &[S]) -> Result<Self> {
        command::run(&mut cargo(words))?;
        Ok(Self::built())
    }

    /// The one that was built last, with whatever features.
    pub fn built() -> Self {
        Self::named("deepshade")
    }

    /// That of studies, which was built last.
    pub fn studies() -> Self {
        Self::named("deepshade-studies")
    }

    fn named(name: &str) -> Self {
        Self(target().join("release").join(format!("{name}{}", std::env::consts::EXE_SUFFIX)))
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// It with arguments, to be run in the workspace's root.
    pub fn command<S: AsRef<OsStr>>(&self, args: &[S]) -> Command {
        command(&self.0.display().to_string(), args)
    }

    /// Runs it to its end.
    ///
    /// # Errors
    /// If it fails, with what it says.
    pub fn run<S: AsRef<OsStr>>(&self, args: &[S]) -> Result<()> {
        let output = self.output(args)?;
        ensure!(output.status.success(), "{}: {}", output.status, message(&output));
        Ok(())
    }

    /// Runs it to whatever end it comes.
    ///
    /// # Errors
    /// If it cannot be started.
    pub fn output<S: AsRef<OsStr>>(&self, args: &[S]) -> Result<Output> {
        self.command(args).output().with_context(|| format!("cannot start {}", self.0.display()))
    }
}

/// The last line of what a program says on stderr, where strace, which slows it, may have words of its own.
pub fn message(output: &Output) -> String {
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    let said = text.trim().lines().rfind(|line| !line.starts_with("strace: "));
    said.unwrap_or_default().to_owned()
}

/// All files below a folder by name, none where there is no folder; those that are half-written are left out.
///
/// # Errors
/// If one cannot be read.
pub fn contents(folder: &Path) -> Result<BTreeMap<PathBuf, Vec<u8>>> {
    let mut found = BTreeMap::new();
    collect(folder, folder, &mut found)?;
    Ok(found)
}

fn collect(root: &Path, folder: &Path, found: &mut BTreeMap<PathBuf, Vec<u8>>) -> Result<()> {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if entry.file_name().to_string_lossy().starts_with(TEMPORARY_PREFIX) {
            continue;
        }
        if path.is_dir() {
            collect(root, &path, found)?;
        } else {
            let bytes = std::fs::read(&path).with_context(|| path.display().to_string())?;
            found.insert(path.strip_prefix(root)?.to_owned(), bytes);
        }
    }
    Ok(())
}

/// A folder below the target folder for one run of a command, empty.
///
/// # Errors
/// If it cannot be made.
pub fn work_folder(name: &str) -> Result<PathBuf> {
    let folder = target().join(format!("{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    Ok(folder)
}
