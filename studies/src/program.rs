//! The program `deepshade`, which some studies watch from outside.

use anyhow::{Context, Result, ensure};
use std::path::PathBuf;

/// Where it is: beside this one, as cargo puts both.
///
/// # Errors
/// If it is not there.
pub fn deepshade() -> Result<PathBuf> {
    let own = std::env::current_exe().context("where this program is")?;
    let program = own.with_file_name(format!("deepshade{}", std::env::consts::EXE_SUFFIX));
    ensure!(program.is_file(), "no {}: `cargo build --release` makes it", program.display());
    Ok(program)
}
