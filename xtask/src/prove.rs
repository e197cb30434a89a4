//! `cargo xtask prove`: truth against closed forms.

mod comparison;

use crate::command::{self, cargo, target};
use crate::figures;
use crate::test::FEATURES;
use anyhow::{Context, Result, ensure};
use comparison::Comparison;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The tests that prove: those of the integrators of truth and what they share. Built as all tests are, so
/// that a machine holds one build of the dependencies.
const TESTS: [&str; 9] =
    ["test", "--release", "--locked", "--workspace", "--features", FEATURES, "--lib", "--", "path::"];

/// Tells the tests where to write what they compare.
const FILE: &str = "DEEPSHADE_PROOFS";

/// Runs the proofs, writes their figures to `--json F` and prints a table.
///
/// # Errors
/// If the tests do not build, a proof fails, or a control is not found out.
pub fn run(json: Option<&Path>) -> Result<()> {
    let lines = PathBuf::from(format!("{}.{}", target().join("proofs").display(), std::process::id()));
    let passed = command::run(cargo(&TESTS).env(FILE, &lines));
    let text = std::fs::read_to_string(&lines).unwrap_or_default();
    // Nothing is lost where it stays.
    let _ = std::fs::remove_file(&lines);
    let proofs = Proofs::parse(&text)?;
    figures::write(json, "prove", &proofs.figures(), proofs.details())?;
    proofs.print();
    passed?;
    proofs.check()
}

/// All comparisons, by the names of their proofs.
struct Proofs {
    by_name: BTreeMap<String, Vec<Comparison>>,
}

impl Proofs {
    fn parse(text: &str) -> Result<Self> {
        let mut by_name: BTreeMap<String, Vec<Comparison>> = BTreeMap::new();
        for line in text.lines() {
            let comparison: Comparison =
                serde_json::from_str(line).with_context(|| format!("not a comparison: {line}"))?;
            by_name.entry(comparison.name.clone()).or_default().push(comparison);
        }
        Ok(Self { by_name })
    }

    fn all(&self) -> impl Iterator<Item = &Comparison> {
        self.by_name.values().flatten()
    }

    /// # Errors
    /// If there is none, one fails, or one lacks a control that was found out.
    fn check(&self) -> Result<()> {
        ensure!(!self.by_name.is_empty(), "nothing was proved");
        for (name, comparisons) in &self.by_name {
            for comparison in comparisons {
                let Comparison { value, expected, .. } = comparison;
                ensure!(comparison.holds(), "{name}: {value} beside {expected}");
            }
            let has = |control: bool| comparisons.iter().any(|comparison| comparison.control == control);
            ensure!(has(false) && has(true), "{name} lacks its proof or its control");
        }
        Ok(())
    }

    /// Names and values, flat.
    fn figures(&self) -> Vec<(String, f64)> {
        let count = |control: bool, held: bool| {
            let counts =
                |comparison: &&Comparison| comparison.control == control && (comparison.holds() || !held);
            self.all().filter(counts).count() as f64
        };
        let proofs = || self.all().filter(|comparison| !comparison.control);
        let worst = proofs()
            .filter(|comparison| comparison.slope_of().is_none())
            .filter_map(Comparison::deviation)
            .fold(0.0, |worst: f64, deviation| worst.max(deviation.abs()));
        let mut figures = vec![
            ("proofs".to_owned(), count(false, false)),
            ("proofs_held".to_owned(), count(false, true)),
            ("worst_deviation".to_owned(), worst),
            ("controls".to_owned(), count(true, false)),
            ("controls_found".to_owned(), count(true, true)),
        ];
        for comparison in proofs() {
            if let Some(effect) = comparison.slope_of() {
                figures.push((format!("slope_{effect}"), comparison.value));
            }
            if comparison.name == "veach/mis_over_best" {
                figures.push(("mis_over_best".to_owned(), comparison.value));
            }
        }
        figures
    }

    /// One row for each proof, of the comparison that is farthest off.
    fn print(&self) {
        println!(
            "{:<32} {:>6} {:>12} {:>12} {:>10}  control found",
            "proof", "values", "value", "expected", "deviation"
        );
        for (name, comparisons) in &self.by_name {
            let (controls, proofs): (Vec<_>, Vec<_>) =
                comparisons.iter().partition(|comparison| comparison.control);
            // Of probabilities the smallest.
            let off = |comparison: &Comparison| comparison.deviation().map_or(-comparison.value, f64::abs);
            let worst = proofs.iter().max_by(|a, b| off(a).total_cmp(&off(b)));
            let Some(Comparison { value, expected, .. }) = worst else { continue };
            let deviation = worst
                .and_then(|worst| worst.deviation())
                .map_or("-".to_owned(), |deviation| format!("{deviation:.2}"));
            let found = controls.iter().all(|control| control.holds()) && !controls.is_empty();
            let found = if found { "yes" } else { "NO" };
            println!(
                "{name:<32} {:>6} {value:>12.6} {expected:>12.6} {deviation:>10}  {found}",
                proofs.len()
            );
        }
        println!("Deviations are in standard errors; of probabilities and ratios `expected` is the bound.");
        for (name, value) in self.figures() {
            println!("{name}: {value:.4}");
        }
    }

    /// All comparisons.
    fn details(&self) -> Value {
        // Tests end in any order.
        let mut comparisons: Vec<&Comparison> = self.all().collect();
        comparisons.sort_by(|a, b| a.name.cmp(&b.name).then(a.value.total_cmp(&b.value)));
        json!({ "comparisons": comparisons })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PROOF: &str = "{\"name\": \"ao/disk\", \"value\": 0.24, \"expected\": 0.25, \"standard_error\": \
    0.01, \
                         \"within\": true, \"control\": false}\n";
    const CONTROL: &str = "{\"name\": \"ao/disk\", \"value\": 0.24, \"expected\": 0.4, \"standard_error\": \
    0.01, \
                           \"within\": false, \"control\": true}\n";
    const SLOPE: &str = "{\"name\": \"slope/fog-direct\", \"value\": -0.7, \"expected\": -0.5, \
                         \"standard_error\": 0.02, \"within\": true, \"control\": false}\n";

    fn checked(text: &str) -> Result<()> {
        Proofs::parse(text).expect("lines").check()
    }

    #[test]
    fn a_proof_holds_with_its_control_and_not_without() {
        assert!(checked(&format!("{PROOF}{CONTROL}")).is_ok());
        assert!(checked(PROOF).is_err() && checked(CONTROL).is_err() && checked("").is_err());
        assert!(checked(&format!("{}{CONTROL}", PROOF.replace("true", "false"))).is_err());
        let passing = CONTROL.replace("\"within\": false", "\"within\": true");
        assert!(checked(&format!("{PROOF}{passing}")).is_err());
        assert!(Proofs::parse("nonsense").is_err());
    }

    #[test]
    fn figures_are_those_of_the_comparisons() {
        let proofs = Proofs::parse(&format!("{PROOF}{CONTROL}{SLOPE}")).expect("lines");
        let figures: BTreeMap<String, f64> = proofs.figures().into_iter().collect();
        assert_eq!((figures["proofs"], figures["controls_found"]), (2.0, 1.0));
        assert!((figures["worst_deviation"] - 1.0).abs() < 1e-9, "slopes may be steeper");
        assert_eq!(figures["slope_fog-direct"], -0.7);
        let proof: Value = serde_json::from_str(PROOF).expect("JSON");
        assert_eq!(proofs.details()["comparisons"][0], proof);
    }
}
