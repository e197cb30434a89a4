//! `cargo xtask deny`: licences, banned crates and sources, as deny.toml allows them, and advisories of known
//! faults.

use crate::command::{cargo, run as run_command, succeeds};
use anyhow::{Result, bail};

/// What is checked.
#[derive(clap::Args)]
pub struct Args {
    /// It is an error if the advisories cannot be fetched.
    #[arg(long)]
    advisories: bool,
}

/// What each workspace is, by its manifest.
const WORKSPACES: [&str; 3] = ["Cargo.toml", "fuzz/Cargo.toml", "bevy/Cargo.toml"];
const CONFIG: [&str; 3] = ["deny", "--config", "deny.toml"];

/// Runs cargo-deny. The advisories are in a repository that cannot be fetched everywhere: where it cannot,
/// that is said, and is an error only with `--advisories`.
///
/// # Errors
/// If it is not installed or finds something.
pub fn run(args: &Args) -> Result<()> {
    if !succeeds(&mut cargo(&["deny", "--version"])) {
        bail!("cargo-deny is missing; install it with\n    cargo install cargo-deny --locked");
    }
    let fetched = succeeds(&mut cargo(&[&CONFIG[..], &["fetch", "db"]].concat()));
    let mut checks = vec!["licenses", "bans", "sources"];
    if fetched {
        checks.push("advisories");
    } else if args.advisories {
        bail!("advisories: their database cannot be fetched here (`cargo deny fetch db` says why)");
    }
    for manifest in WORKSPACES {
        let place = ["--manifest-path", manifest, "--all-features", "check"];
        run_command(&mut cargo(&[&CONFIG[..], &place, &checks].concat()))?;
    }
    if !fetched {
        println!(
            "advisories were not checked: their database cannot be fetched here (`cargo deny fetch db` says why)"
        );
    }
    Ok(())
}
