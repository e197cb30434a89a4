//! Fits of materials that are known.

use super::fit::parameter_name;
use crate::figures::Figures;
use crate::table;
use anyhow::{Context, Result};
use deepshade_dataset::progress;
use deepshade_glow::file::MaterialFile;
use deepshade_phosphor::fit::Laboratory;
use deepshade_phosphor::self_test::{
    Coverage, StatesCompared, compare_states, coverage, hyperbolic_materials, two_state_materials,
};
use serde_json::{Value, json};
use std::path::Path;

/// What intervals say that they hold.
const CONFIDENCE: f64 = 0.95;

/// Measures, fits and prints.
///
/// # Errors
/// If a fit fails, or the figures cannot be written.
pub fn run(seeds: u64, json: Option<&Path>) -> Result<()> {
    let (laboratory, presets) = (Laboratory::thesis(), MaterialFile::presets());
    let of_one_state: Vec<_> =
        presets.materials.iter().filter(|material| material.states.len() == 1).collect();
    let bar = progress::bar("materials", of_one_state.len(), 0);
    let mut covered = Vec::new();
    for material in of_one_state {
        bar.set_message(material.name.clone());
        covered.push(coverage(&laboratory, material, seeds)?);
        bar.inc(1);
    }
    bar.finish_and_clear();
    let two = compare_states(&laboratory, &two_state_materials(), 1)?;
    let hyperbolic = compare_states(&laboratory, &hyperbolic_materials(), 1)?;
    let off = |found: &&Coverage| (found.share - CONFIDENCE).abs();
    let worst = covered.iter().max_by(|a, b| off(a).total_cmp(&off(b))).context("a material")?;
    let mut figures = Figures::new("phosphor fit");
    figures.set("coverage", worst.share);
    figures.set("coverage_least", covered.iter().map(least).fold(1.0, f64::min));
    let largest = |of: fn(&Coverage) -> f64| covered.iter().map(of).fold(0.0, f64::max);
    figures.set("residual_over_noise", largest(|found| found.residual_over_noise));
    figures.set("worst_residual_over_noise", largest(|found| found.worst_residual_over_noise));
    for (suffix, found) in [("", &two), ("_hyperbolic", &hyperbolic)] {
        figures.set(&format!("median_ratio_nc2_nc1{suffix}"), found.median_ratio);
        figures.set(&format!("last_ratio_nc2_nc1{suffix}"), found.last_ratio);
        for (states, [mean, least, largest]) in (1..).zip(found.differences) {
            figures.set(&format!("ciede2000_nc{states}{suffix}"), mean);
            figures.detail(&format!("ciede2000_nc{states}{suffix}_range"), json!([least, largest]));
        }
    }
    figures.detail("seeds", json!(seeds));
    let shares = covered.iter().map(|found| (found.material.clone(), json!(found.share)));
    figures.detail("coverage_by_material", shares.collect());
    let shares = covered.iter().map(|found| (found.material.clone(), by_parameter(found)));
    figures.detail("coverage_by_parameter", shares.collect());
    figures.write(json)?;
    say!("{}", table::aligned(&rows(&covered)))?;
    say!("\n{}", table::aligned(&rows_of_states([("two states", &two), ("a hyperbola", &hyperbolic)])))
}

/// The share of the parameter whose intervals hold the true value least often.
fn least(found: &Coverage) -> f64 {
    found.parameters.iter().map(|(_, _, share)| *share).fold(1.0, f64::min)
}

fn by_parameter(found: &Coverage) -> Value {
    let shares = found.parameters.iter().map(|(state, parameter, share)| {
        json!({ "state": state + 1, "parameter": parameter_name(*parameter), "share": share })
    });
    shares.collect()
}

fn rows(covered: &[Coverage]) -> Vec<Vec<String>> {
    let head = [
        "material",
        "intervals that hold what is true",
        "of one parameter, at least",
        "residual over noise",
        "worst seed",
    ];
    let row = |found: &Coverage| {
        vec![
            found.material.clone(),
            format!("{:.3}", found.share),
            format!("{:.3}", least(found)),
            format!("{:.3}", found.residual_over_noise),
            format!("{:.3}", found.worst_residual_over_noise),
        ]
    };
    std::iter::once(head.map(str::to_owned).to_vec()).chain(covered.iter().map(row)).collect()
}

fn rows_of_states(compared: [(&str, &StatesCompared); 2]) -> Vec<Vec<String>> {
    let head = [
        "materials that decay as",
        "error left by two states",
        "at the last photograph",
        "CIEDE2000 of one",
        "of two",
    ];
    let row = |(name, found): (&str, &StatesCompared)| {
        let [one, two] = found.differences.map(|[mean, ..]| format!("{mean:.2}"));
        vec![
            name.to_owned(),
            format!("{:.4}", found.median_ratio),
            format!("{:.4}", found.last_ratio),
            one,
            two,
        ]
    };
    let paper = ["thesis' real ones", "0.08", "0.18", "13.16", "5.46"].map(str::to_owned).to_vec();
    let head = std::iter::once(head.map(str::to_owned).to_vec());
    head.chain(compared.map(row)).chain([paper]).collect()
}
