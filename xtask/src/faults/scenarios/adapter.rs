//! A graphics card that goes away while it draws. Nothing outside of a program can take its device from it, so the tests of the
//! raster passes do: when a frame is encoded, when it is submitted, and at several moments while frames are awaited.

use crate::command::cargo;
use anyhow::{Context, Result, ensure};

/// What the names of these tests have in common.
const TESTS: &str = "a_device_that_is_lost";
/// How many there are.
const COUNT: &str = "2 passed; 0 failed";

/// Runs them.
///
/// # Errors
/// If one fails, or is no longer there.
pub fn lost() -> Result<()> {
    let words = ["test", "--release", "--locked", "-p", "deepshade-render", "--lib", TESTS];
    let output = cargo(&words).output().context("cannot start cargo")?;
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    ensure!(
        output.status.success() && said.contains(COUNT),
        "{}: {said}\n{}",
        output.status,
        String::from_utf8_lossy(&output.stderr)
    );
    Ok(())
}
