//! PyTorch, with the package in `python/`.

use super::pytest::Report;
use crate::program::Program;
use anyhow::Result;

/// What the tests of the Python package import.
const PACKAGES: [&str; 6] =
    ["torch==2.15.0", "numpy>=1.26", "safetensors>=0.4.3", "OpenEXR>=3.3", "blake3>=1.0", "pytest>=8"];

/// Runs the package's tests; how far PyTorch's images are at most from those that networks have in their
/// folders.
///
/// # Errors
/// If the environment cannot be made or a test fails.
pub fn test(program: &Program) -> Result<Vec<(String, f64)>> {
    let report = Report::of("python", "hosts-python", &PACKAGES, program)?;
    let deviations = report.figures().into_iter().filter(|(name, _)| name == "max_abs");
    let largest = deviations.map(|(_, deviation)| deviation).fold(f64::NAN, f64::max);
    Ok(vec![("max_abs_torch".to_owned(), largest)])
}
