//! Tests in Python, by pytest in an environment below the target folder, and the figures that they record.

use crate::command::{self, root, target};
use crate::program::Program;
use crate::python;
use anyhow::{Context, Result};
use std::fs;
use std::process::Command;

/// What pytest has said of tests that passed.
pub struct Report(String);

impl Report {
    /// Runs the tests of a folder of the repository. They are told of the program by `DEEPSHADE`.
    ///
    /// # Errors
    /// If the environment cannot be made or a test fails.
    pub fn of(folder: &str, environment: &str, packages: &[&str], program: &Program) -> Result<Self> {
        let interpreter = python::environment(environment, packages)?;
        let report = target().join(environment).join("report.xml");
        let mut tests = Command::new(interpreter);
        tests.current_dir(root().join(folder)).env("DEEPSHADE", program.path());
        tests
            // The newer form of reports knows no figures.
            .args(["-m", "pytest", "-q", "-p", "no:cacheprovider", "-o", "junit_family=xunit1"])
            .arg(format!("--junitxml={}", report.display()));
        command::run(&mut tests)?;
        fs::read_to_string(&report).with_context(|| report.display().to_string()).map(Self)
    }

    /// The numbers that tests have recorded, with their names.
    pub fn figures(&self) -> Vec<(String, f64)> {
        let properties = self.0.split("<property ").skip(1);
        properties
            .filter_map(|of| Some((attribute(of, "name")?, attribute(of, "value")?.parse().ok()?)))
            .collect()
    }

    /// How many tests were skipped.
    pub fn skipped(&self) -> Option<u32> {
        attribute(self.0.split("<testsuite ").nth(1)?, "skipped")?.parse().ok()
    }
}

/// An attribute of the element that a text begins in.
fn attribute(text: &str, name: &str) -> Option<String> {
    let element = text.split('>').next()?;
    let (_, value) = element.split_once(&format!("{name}=\""))?;
    Some(value.split('"').next()?.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_tests_recorded_and_skipped_is_read() {
        let report = Report(
            r#"<testsuites name="all"><testsuite name="pytest" errors="0" skipped="2" tests="5">
            <testcase><properties><property name="max_abs" value="1.5e-06" />
            <property name="words" value="of more than numbers" /></properties></testcase>
            <property name="max_abs" value="0.25" /></testsuite></testsuites>"#
                .to_owned(),
        );
        let wanted = [("max_abs".to_owned(), 1.5e-6), ("max_abs".to_owned(), 0.25)];
        assert_eq!(report.figures(), wanted);
        assert_eq!(report.skipped(), Some(2));
        assert_eq!(Report(String::new()).skipped(), None);
    }
}
