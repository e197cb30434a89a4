//! `cargo xtask crosscheck`: truth against Mitsuba 3.

use crate::program::{AS_TESTS, Program};
use crate::{
    apt,
    command::{self, command},
    python,
};
use anyhow::{Result, bail};
use std::path::PathBuf;

/// The version that is compared with, and the compiler that it needs.
const MITSUBA: [&str; 2] = ["mitsuba==3.9.1", "drjit==1.5.0"];

/// The first version of LLVM that compiles what Mitsuba's compiler writes for processors with AVX-512.
const OLDEST_LLVM: u32 = 16;

/// What has it on Debian and Ubuntu.
const LLVM_PACKAGE: &str = "libllvm19";

/// Sets up Mitsuba and runs `deepshade-studies crosscheck` with the arguments.
///
/// # Errors
/// If Mitsuba cannot be installed, or the program does not build or finds a disagreement.
pub fn run(args: &[String]) -> Result<()> {
    let python = python::environment("mitsuba", &MITSUBA)?;
    let llvm = llvm()?;
    let python = python.display().to_string();
    Program::build_by(&AS_TESTS)?;
    let mut check = Program::studies().command(&["crosscheck", "--python", &python]);
    if let Some(llvm) = llvm {
        check.env("DRJIT_LIBLLVM_PATH", llvm);
    }
    command::run(check.args(args))
}

/// The LLVM library that Mitsuba's vectorised variant loads; `None` where the user or the system names it.
fn llvm() -> Result<Option<PathBuf>> {
    if !cfg!(target_os = "linux") || std::env::var_os("DRJIT_LIBLLVM_PATH").is_some() {
        return Ok(None);
    }
    if let Some(library) = newest_llvm() {
        return Ok(Some(library));
    }
    apt::install(&[LLVM_PACKAGE], "LLVM, which Mitsuba compiles with,")?;
    match newest_llvm() {
        Some(library) => Ok(Some(library)),
        None => bail!("no LLVM library from version {OLDEST_LLVM} on although {LLVM_PACKAGE} is installed"),
    }
}

/// The newest LLVM library that the dynamic linker knows, if it is new enough.
fn newest_llvm() -> Option<PathBuf> {
    // ldconfig is in a folder that is not on every user's search path.
    let list = ["ldconfig", "/sbin/ldconfig"]
        .iter()
        .find_map(|ldconfig| command(ldconfig, &["-p"]).output().ok())?;
    newest_in(&String::from_utf8_lossy(&list.stdout))
}

fn newest_in(list: &str) -> Option<PathBuf> {
    let library = |line: &str| {
        let (name, path) = (line.split_whitespace().next()?, line.split_once("=> ")?.1);
        Some((version(name)?, PathBuf::from(path.trim())))
    };
    let (version, path) = list.lines().filter_map(library).max()?;
    (version >= OLDEST_LLVM).then_some(path)
}

/// 15 of `libLLVM-15.so.1`, 19 of `libLLVM.so.19.1`.
fn version(name: &str) -> Option<u32> {
    let rest = name.strip_prefix("libLLVM")?;
    let number = rest.strip_prefix(".so.").or_else(|| rest.strip_prefix('-'))?;
    number.split('.').next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_library_is_taken_if_it_is_new_enough() {
        let line = |name: &str| format!("\t{name} (libc6,x86-64) => /usr/lib/{name}\n");
        let old = ["libLLVM-14.so.1", "libLLVM-15.so.1", "libLLVMSPIRVLib.so.15"].map(line).concat();
        assert_eq!(newest_in(&old), None);
        assert_eq!(
            newest_in(&[old, line("libLLVM.so.19.1")].concat()),
            Some("/usr/lib/libLLVM.so.19.1".into())
        );
        assert_eq!(newest_in(&line("libLLVM-16.so.1")), Some("/usr/lib/libLLVM-16.so.1".into()));
    }
}
