//! What compiles the program to WebAssembly.

use crate::apt;
use crate::command::{self, cargo, command, root, succeeds, target};
use anyhow::{Context, Result};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const TARGET: &str = "wasm32-unknown-unknown";
/// Debian's compiler for browsers, which has the standard library's source beside it.
const COMPILER: &str = "/usr/bin/rustc";
const SOURCE: &str = "/usr/lib/rustlib/src/rust/library/Cargo.lock";
/// The linker comes with the toolchain, or else in a package of its own.
const PACKAGES: [&str; 2] = ["rustc-web", "rust-web-src"];
/// Vector instructions, which every browser with WebGPU has, for truth; a stack as large as other programs'.
const FLAGS: &str = "-C target-feature=+simd128 -C link-arg=-zstack-size=4194304";

/// Compiles the program and gives its module.
///
/// # Errors
/// If there is no way to, or it does not build.
pub fn compile() -> Result<PathBuf> {
    let folder = target().join("web");
    let into = folder.display().to_string();
    let words = [
        "build",
        "--release",
        "--locked",
        "--no-default-features",
        "--target",
        TARGET,
        "--target-dir",
        &into,
    ];
    let mut build = cargo(&words);
    build
        .env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS", FLAGS)
        .env("CARGO_PROFILE_RELEASE_DEBUG", "false")
        // What features the module has is written in a section that wasm-bindgen wants to see.
        .env("CARGO_PROFILE_RELEASE_STRIP", "debuginfo");
    if !has_target(TARGET)? {
        debian(&mut build)?;
    }
    command::run(&mut build)?;
    Ok(folder.join(TARGET).join("release").join("deepshade.wasm"))
}

/// Whether the toolchain has a target, or rustup can bring it.
///
/// # Errors
/// If there is no toolchain.
pub fn has_target(target: &str) -> Result<bool> {
    let there = library()?.join(target).is_dir();
    Ok(there || succeeds(&mut command("rustup", &["target", "add", target])))
}

/// Has a build use Debian's compiler, installed where that is allowed, with the standard library from source.
fn debian(build: &mut Command) -> Result<()> {
    if !Path::new(SOURCE).is_file() || !Path::new(COMPILER).is_file() {
        apt::install(&PACKAGES, "A compiler of Rust for browsers")?;
    }
    if let Some(linker) = linker()? {
        build.env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER", linker);
    } else if !succeeds(&mut command("wasm-ld", &["--version"])) {
        apt::install(&["lld"], "A linker of WebAssembly")?;
        build.env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER", "wasm-ld");
    }
    // Building the standard library is an unstable feature of cargo's.
    build.env("RUSTC", COMPILER).env("RUSTC_BOOTSTRAP", "1").args(["-Z", "build-std=std,panic_abort"]);
    Ok(())
}

/// The linker that comes with the toolchain, if one does.
fn linker() -> Result<Option<PathBuf>> {
    let targets = fs::read_dir(library()?).context("the toolchain's targets")?;
    let linkers = targets.flatten().map(|target| target.path().join("bin/gcc-ld/wasm-ld"));
    Ok(linkers.into_iter().find(|linker| linker.is_file()))
}

/// Where the toolchain's targets are.
fn library() -> Result<PathBuf> {
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned());
    let output = command(&rustc, &["--print", "sysroot"]).output().context("cannot start rustc")?;
    Ok(PathBuf::from(String::from_utf8(output.stdout)?.trim()).join("lib/rustlib"))
}

/// The program that makes a browser's module of a compiler's, of the version that the program is built with.
///
/// # Errors
/// If it cannot be installed.
pub fn bindgen() -> Result<PathBuf> {
    let version = version(&fs::read_to_string(root().join("Cargo.lock")).context("Cargo.lock")?)
        .context("Cargo.lock has no wasm-bindgen")?;
    let folder = target().join(format!("wasm-bindgen-{version}"));
    let program = folder.join("bin").join(format!("wasm-bindgen{}", std::env::consts::EXE_SUFFIX));
    if !program.is_file() {
        let into = folder.display().to_string();
        // Not with its lock file: a package that it names may have been withdrawn since.
        let words = ["install", "wasm-bindgen-cli", "--version", &version, "--root", &into];
        command::run(&mut cargo(&words))?;
    }
    Ok(program)
}

/// The version of wasm-bindgen that a lock file has.
fn version(lock: &str) -> Option<String> {
    let mut lines = lock.lines().skip_while(|line| *line != "name = \"wasm-bindgen\"").skip(1);
    Some(lines.next()?.strip_prefix("version = \"")?.trim_end_matches('"').to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_version_is_that_of_the_package_of_exactly_that_name() {
        let lock = "[[package]]\nname = \"wasm-bindgen-macro\"\nversion = \"1.2.3\"\n\n[[package]]\nname = \"wasm-bindgen\"\nversion = \"4.5.6\"\n";
        assert_eq!(version(lock).as_deref(), Some("4.5.6"));
        assert_eq!(version("name = \"other\"\nversion = \"1.0.0\""), None);
    }
}
