//! `cargo xtask test`: everything that must hold before a change goes in. CI runs the same.

use crate::{
    apt,
    command::{cargo, command, run as run_command, succeeds, target},
    python, vulkan,
};
use anyhow::{Context, Result};
use std::{
    path::Path,
    process::Command,
    time::{Duration, Instant},
};

#[path = "../../render/tests/real_data/mod.rs"]
mod real_data;

/// A check: what it is called, and the arguments of cargo.
type CargoCheck = (&'static str, &'static [&'static str]);

/// Lints and tests have the same features, so that a clean machine compiles each dependency once for either.
/// What drives a browser is apart: what it needs has serde_json keep the order of keys, which the program
/// does not. Training on Vulkan leaves the CPU's own kernels out: its step compiles what is there instead,
/// without the other features. Embree is loaded at run time and need not be there.
pub const FEATURES: &str = "store,embree";

const STEPS: [CargoCheck; 7] = [
    ("formatting", &["fmt", "--all", "--check"]),
    (
        "clippy",
        &[
            "clippy",
            "--release",
            "--locked",
            "--workspace",
            "--all-targets",
            "--features",
            FEATURES,
            "--",
            "-D",
            "warnings",
        ],
    ),
    (
        "documentation",
        &[
            "doc",
            "--release",
            "--locked",
            "--workspace",
            "--no-deps",
            "--document-private-items",
            "--features",
            FEATURES,
        ],
    ),
    (
        "what drives a browser",
        &[
            "clippy",
            "--release",
            "--locked",
            "-p",
            "xtask",
            "--features",
            "browser",
            "--all-targets",
            "--",
            "-D",
            "warnings",
        ],
    ),
    (
        "training on Vulkan",
        &[
            "clippy",
            "--release",
            "--locked",
            "--workspace",
            "--all-targets",
            "--features",
            "vulkan",
            "--",
            "-D",
            "warnings",
        ],
    ),
    (
        "the program without training",
        &["clippy", "--release", "--locked", "--no-default-features", "--", "-D", "warnings"],
    ),
    ("tests", &["test", "--release", "--locked", "--workspace", "--no-fail-fast", "--features", FEATURES]),
];

/// What the last step has built besides, and its arguments: networks in another program.
const EXAMPLE: (&str, [&str; 2]) = ("embed", ["models/ao", "models/ao"]);

/// Sets up and runs every check in order, up to the first that fails.
///
/// # Errors
/// If something is missing and cannot be installed, or a check fails.
pub fn run() -> Result<()> {
    let start = Instant::now();
    let onnxruntime = set_up().context("set-up")?;
    let mut times = vec![("set-up", start.elapsed())];
    for (name, args) in STEPS {
        println!("\n=== {name}: cargo {}", args.join(" "));
        times.push((name, passed(name, &mut check(args, &onnxruntime))?));
    }
    let (example, args) = EXAMPLE;
    println!("\n=== example {example} {}", args.join(" "));
    let program =
        target().join("release/examples").join(format!("{example}{}", std::env::consts::EXE_SUFFIX));
    times.push((example, passed(example, &mut command(&program.display().to_string(), &args))?));
    print_summary(&times);
    // Tests on real data pass without them, since not everybody has them.
    if let Some(folder) = real_data::data() {
        println!("Real scenes and images were read from {}", folder.display());
    }
    // As does the test beside PyTorch, which is large.
    if let Some(python) = std::env::var_os("DEEPSHADE_PYTHON") {
        println!("PyTorch was run by {}", python.display());
    }
    Ok(())
}

/// Runs a step to its end and gives how long it took.
fn passed(name: &str, step: &mut Command) -> Result<Duration> {
    let start = Instant::now();
    run_command(step).with_context(|| format!("step `{name}` failed"))?;
    println!("=== {name}: passed in {} s", start.elapsed().as_secs());
    Ok(start.elapsed())
}

/// Vulkan, a C++ compiler, Xvfb and onnxruntime; gives the path of the latter's library.
fn set_up() -> Result<std::path::PathBuf> {
    println!("=== set-up");
    vulkan::ensure()?;
    // The oracle of the FLIP metric, nv-flip, is C++.
    let compiler = std::env::var("CXX").unwrap_or_else(|_| "c++".to_owned());
    if !succeeds(&mut command(&compiler, &["--version"])) {
        apt::install(&["g++"], "A C++ compiler, for nv-flip in the tests,")?;
    }
    if cfg!(target_os = "linux") && !succeeds(&mut command("xvfb-run", &["--help"])) {
        apt::install(&["xvfb"], "A screen that is none (Xvfb), for the tests of the window,")?;
    }
    let onnxruntime = python::onnxruntime()?;
    println!("onnxruntime: {}", onnxruntime.display());
    Ok(onnxruntime)
}

/// A step's command, with warnings of rustdoc as errors and onnxruntime where the tests look for it.
fn check(args: &[&str], onnxruntime: &Path) -> Command {
    let mut check = cargo(args);
    check.env("RUSTDOCFLAGS", "-D warnings").env("ORT_DYLIB_PATH", onnxruntime);
    check
}

fn print_summary(times: &[(&str, Duration)]) {
    println!("\n=== everything passed");
    for (name, time) in times {
        println!("{:>6} s  {name}", time.as_secs());
    }
    let total: Duration = times.iter().map(|(_, time)| *time).sum();
    println!("{:>6} s  total", total.as_secs());
    println!(
        "Not part of this: `cargo xtask deny` (licences, advisories; needs cargo-deny) and `cargo xtask targets` (Windows, macOS)"
    );
}
