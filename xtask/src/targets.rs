//! `cargo xtask targets`: whether the program compiles for Windows and macOS, as far as that is seen without
//! their linkers and C libraries: everything that is Rust is type-checked.

use crate::command::{self, cargo, command, root, target};
use crate::web::toolchain::has_target;
use anyhow::{Context, Result, ensure};
use std::path::Path;
use std::process::Command;

/// One of each system.
const TARGETS: [&str; 2] = ["x86_64-pc-windows-gnu", "aarch64-apple-darwin"];
/// Debian's compiler, and the standard library's source where its package of that is installed.
const COMPILER: &str = "/usr/bin/rustc";
const SOURCE: &str = "/usr/lib/rustlib/src/rust/library/Cargo.lock";
/// Nothing is linked: what dependencies have in C and assembler need not be compiled, and what does nothing
/// stands for the tools.
const NO_TOOL: &str = "true";

/// Checks all targets that can be had here.
///
/// # Errors
/// If one does not compile, or cannot be had.
pub fn run() -> Result<()> {
    let mut missing = Vec::new();
    for target in TARGETS {
        let mut check = check(target)?;
        match standard_library(&mut check, target)? {
            Ok(()) => {
                command::run(&mut check).with_context(|| target.to_owned())?;
                println!("{target}: compiles");
            }
            Err(why) => missing.push(format!("{target} was not checked: {why}")),
        }
    }
    ensure!(missing.is_empty(), "{}", missing.join("\n"));
    Ok(())
}

/// cargo check for a target.
fn check(triple: &str) -> Result<Command> {
    // The profile of development: nothing is made, and build scripts and macros are those of xtask.
    let mut check = cargo(&["check", "--locked", "--workspace", "--target", triple]);
    let name = triple.replace('-', "_");
    for tool in ["CC", "CXX", "AR", "RANLIB"] {
        check.env(format!("{tool}_{name}"), NO_TOOL);
    }
    // Where these are not said, Apple's own tools are asked for them.
    let sdk = target();
    std::fs::create_dir_all(&sdk).with_context(|| sdk.display().to_string())?;
    check.env("SDKROOT", &sdk).env("MACOSX_DEPLOYMENT_TARGET", "11.0");
    Ok(check)
}

/// Sees to the standard library of a target: that of the toolchain, which rustup may bring, else from
/// Debian's source by Debian's compiler. What is given inside says why there is none.
fn standard_library(check: &mut Command, target: &str) -> Result<Result<(), String>> {
    if has_target(target)? {
        return Ok(Ok(()));
    }
    let rustup = format!("`rustup target add {target}` does not bring its standard library");
    if !Path::new(SOURCE).is_file() {
        return Ok(Err(format!("{rustup}, and there is no {SOURCE} (Debian: rustc-web, rust-web-src)")));
    }
    let output = command(COMPILER, &["--version"]).output().context(COMPILER)?;
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    let manifest = std::fs::read_to_string(root().join("Cargo.toml")).context("Cargo.toml")?;
    let wanted = oldest(&manifest).context("Cargo.toml says no rust-version")?;
    if version(&said).is_none_or(|found| found < wanted) {
        let [major, minor] = wanted;
        return Ok(Err(format!(
            "{rustup}, and Debian's compiler is older than {major}.{minor}: {}",
            said.trim()
        )));
    }
    // Building the standard library is an unstable feature of cargo's.
    check.env("RUSTC", COMPILER).env("RUSTC_BOOTSTRAP", "1").args(["-Z", "build-std=std,panic_abort"]);
    Ok(Ok(()))
}

/// Major and minor version in what `rustc --version` says.
fn version(said: &str) -> Option<[u32; 2]> {
    numbers(said.strip_prefix("rustc ")?)
}

/// The oldest compiler that a manifest allows.
fn oldest(manifest: &str) -> Option<[u32; 2]> {
    numbers(manifest.lines().find_map(|line| line.strip_prefix("rust-version = \""))?)
}

/// Two numbers with a dot between them, and whatever comes after them.
fn numbers(text: &str) -> Option<[u32; 2]> {
    let mut numbers = text.split(|c: char| !c.is_ascii_digit()).map(str::parse);
    Some([numbers.next()?.ok()?, numbers.next()?.ok()?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_are_compared_as_numbers() {
        let found = version("rustc 1.85.0 (4d91de4e4 2025-02-17) (built from a source tarball)");
        assert_eq!(found, Some([1, 85]));
        assert!(
            version("rustc 1.100.0-nightly") > version("rustc 1.95.0") && version("cargo 1.95.0").is_none()
        );
        assert_eq!(oldest("edition = \"2024\"\nrust-version = \"1.95\"\n"), Some([1, 95]));
        assert_eq!(oldest("[package]\nrust-version.workspace = true\n"), None);
    }
}
