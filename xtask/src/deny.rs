//! `cargo xtask deny`: licences, banned crates and sources, as deny.toml allows them.

use crate::command::{cargo, succeeds};
use anyhow::{Result, bail};

/// Runs cargo-deny.
///
/// # Errors
/// If it is not installed or finds something.
pub fn run() -> Result<()> {
    if !succeeds(&mut cargo(&["deny", "--version"])) {
        bail!("cargo-deny is missing; install it with\n    cargo install cargo-deny --locked");
    }
    let checks = ["--config", "deny.toml", "--all-features", "check", "licenses", "bans", "sources"];
    for workspace in ["Cargo.toml", "fuzz/Cargo.toml"] {
        crate::command::run(&mut cargo(&[&["deny", "--manifest-path", workspace][..], &checks].concat()))?;
    }
    Ok(())
}
