//! Blender as a Python module, with the add-on in `blender/`.

use super::pytest::Report;
use crate::program::Program;
use anyhow::{Context, Result, ensure};

/// The add-on wants Blender 4.2. Pip takes the latest one for this machine's Python, for 3.11 Blender 5.0.
const PACKAGES: [&str; 2] = ["bpy>=4.2", "pytest>=8"];

/// Runs the add-on's tests; how far images by networks are from those of Cycles.
///
/// # Errors
/// If there is no Blender for this machine's Python, or a test fails or is skipped.
pub fn test(program: &Program) -> Result<Vec<(String, f64)>> {
    let report = Report::of("blender", "hosts-blender", &PACKAGES, program)?;
    let skipped = report.skipped().context("pytest's report")?;
    ensure!(skipped == 0, "{skipped} tests were skipped");
    let figures = report.figures();
    ensure!(!figures.is_empty(), "the tests have recorded nothing");
    Ok(figures)
}
