//! PyTorch, with the package in `python/`.

use crate::command::{self, root, target};
use crate::program::Program;
use crate::python;
use anyhow::{Context, Result};
use std::process::Command;

/// What the tests of the Python package import.
const PACKAGES: [&str; 6] =
    ["torch==2.15.0", "numpy>=1.26", "safetensors>=0.4.3", "OpenEXR>=3.3", "blake3>=1.0", "pytest>=8"];

/// Runs the package's tests in a Python environment below the target folder; how far PyTorch's images are at
/// most from those that networks have in their folders.
///
/// # Errors
/// If the environment cannot be made or a test fails.
pub fn test(program: &Program) -> Result<Vec<(String, f64)>> {
    let interpreter = python::environment("hosts-python", &PACKAGES)?;
    let report = target().join("hosts-python/report.xml");
    let mut tests = Command::new(interpreter);
    tests.current_dir(root().join("python")).env("DEEPSHADE", program.path());
    tests
        .args(["-m", "pytest", "-q", "-p", "no:cacheprovider"])
        .arg(format!("--junitxml={}", report.display()));
    command::run(&mut tests)?;
    let text = std::fs::read_to_string(&report).with_context(|| report.display().to_string())?;
    let deviations = recorded(&text, "max_abs");
    let largest = deviations.iter().copied().fold(f64::NAN, f64::max);
    Ok(vec![("max_abs_torch".to_owned(), largest)])
}

/// The numbers that tests have recorded under a name, in a report of pytest's.
fn recorded(report: &str, name: &str) -> Vec<f64> {
    let start = format!("<property name=\"{name}\" value=\"");
    let values = report.split(&start).skip(1).filter_map(|rest| rest.split('"').next());
    values.filter_map(|value| value.parse().ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_tests_recorded_is_read() {
        let report = r#"<testcase><properties><property name="max_abs" value="1.5e-06" />
            <property name="share" value="0.1" /></properties></testcase>
            <property name="max_abs" value="0.25" />"#;
        assert_eq!(recorded(report, "max_abs"), [1.5e-6, 0.25]);
        assert!(recorded(report, "nothing").is_empty());
    }
}
