//! `cargo xtask hosts`: the tests of programs that deepshade's data and networks are used from, each in the
//! real thing.

mod bevy;
#[cfg(feature = "browser")]
mod javascript;
mod torch;

use crate::program::{AS_TESTS, Program};
use crate::{figures, vulkan, web};
use anyhow::Result;
use serde_json::json;
use std::path::PathBuf;

/// Which hosts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Host {
    /// The package in `js/`, in headless Chromium, with three.js.
    Browser,
    /// The package in `python/`, with PyTorch.
    Torch,
    /// The crate in `bevy/`, in Bevy.
    Bevy,
}

/// What is tested.
#[derive(clap::Args)]
pub struct Args {
    /// Only that host.
    #[arg(long)]
    only: Option<Host>,
    /// Writes the figures here as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
}

/// Tests them and says what was measured.
///
/// # Errors
/// If something is missing and cannot be installed, the program does not build, or a test fails.
pub fn run(args: &Args) -> Result<()> {
    let is_wanted = |host| args.only.is_none_or(|only| only == host);
    if is_wanted(Host::Browser) && !cfg!(feature = "browser") {
        return web::again();
    }
    vulkan::ensure()?;
    let program = Program::build_by(&AS_TESTS)?;
    let mut found = Vec::new();
    #[cfg(feature = "browser")]
    if is_wanted(Host::Browser) {
        found.extend(javascript::test(&program)?);
    }
    if is_wanted(Host::Torch) {
        found.extend(torch::test(&program)?);
    }
    if is_wanted(Host::Bevy) {
        found.extend(bevy::test(&program)?);
    }
    for (name, value) in &found {
        println!("{name} {value:.3e}");
    }
    figures::write(args.json.as_deref(), "hosts", &found, json!({}))
}
