//! The program itself, built as people build it, for commands that watch it from outside.

use crate::command::{self, cargo, command, target};
use crate::test::FEATURES;
use anyhow::{Context, Result, ensure};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Arguments of cargo's that build the program and that of studies; features come behind them.
pub const WITH_STUDIES: [&str; 7] =
    ["build", "--release", "--locked", "--package", "deepshade", "--package", "deepshade-studies"];

/// Arguments of cargo's that build all programs as tests are built, so that a machine holds one build of the
/// dependencies.
pub const AS_TESTS: [&str; 6] = ["build", "--release", "--locked", "--workspace", "--features", FEATURES];

/// A built program.
#[derive(Clone, Debug)]
pub struct Program(PathBuf);

impl Program {
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

    /// One that is somewhere else.
    ///
    /// # Errors
    /// If it is not there.
    pub fn at(path: &Path) -> Result<Self> {
        let path = std::path::absolute(path)?;
        ensure!(path.is_file(), "there is no program {}", path.display());
        Ok(Self(path))
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
        let output = self.command(args).output();
        let output = output.with_context(|| format!("cannot start {}", self.0.display()))?;
        let said = String::from_utf8_lossy(&output.stderr);
        ensure!(output.status.success(), "{}: {}", output.status, said.trim());
        Ok(())
    }
}
