//! `deepshade eval --results`: one file with what every network came to, each as its last evaluation left it.
//!
//! `{"figures": {...}, "networks": {NETWORK: {...}}}`: all figures under names of their own, and of each network what they
//! were measured on and how sure they are.

use super::networks::{of_network, set_figures};
use super::score::Evaluation;
use crate::figures::{Figures, machine, write_atomically};
use anyhow::{Context, Result};
use deepshade_shaders::gpu::Gpu;
use serde_json::{Map, Value, json};
use std::path::Path;

/// A network that was evaluated.
pub struct Entry<'a> {
    /// Its name in figures.
    pub network: String,
    /// Its scores.
    pub evaluation: &'a Evaluation,
    /// What it was scored against.
    pub target: &'a str,
}

/// Writes networks into a file, in place of what it had of the same ones.
///
/// # Errors
/// If the file is another one, or cannot be written.
pub fn add(path: &Path, entries: &[Entry], gpu: &Gpu) -> Result<()> {
    let mut networks = read(path).with_context(|| path.display().to_string())?;
    for entry in entries {
        networks.insert(entry.network.clone(), described(entry, &gpu.info.name));
    }
    let figures: Map<String, Value> = networks
        .values()
        .filter_map(|network| network["figures"].as_object())
        .flatten()
        .map(|(name, value)| (name.clone(), value.clone()))
        .collect();
    let text = serde_json::to_string_pretty(&json!({ "figures": figures, "networks": networks }));
    write_atomically(path, format!("{}\n", text.context("results as JSON")?).as_bytes())
}

/// The networks of a file; none where there is no file.
fn read(path: &Path) -> Result<Map<String, Value>> {
    if !path.exists() {
        return Ok(Map::new());
    }
    let file: Value = serde_json::from_slice(&std::fs::read(path)?)?;
    file["networks"].as_object().cloned().context("has no `networks`: it is not a file of results")
}

fn described(entry: &Entry, adapter: &str) -> Value {
    let Entry { network, evaluation, target } = entry;
    let mut figures = Figures::new("eval");
    set_figures(&mut figures, network, evaluation);
    let intervals: Map<String, Value> = evaluation
        .estimates()
        .into_iter()
        .map(|(name, estimate)| (of_network(network, name), json!([estimate.low, estimate.high])))
        .collect();
    let mut parts = evaluation.parts();
    // One by one they are in the file of the evaluation.
    parts.remove("scenes");
    json!({
        "figures": figures.to_json()["figures"],
        "confidence_95": intervals,
        "scenes": evaluation.scenes,
        "target": target,
        "adapter": adapter,
        "devices": evaluation.devices,
        "machine": machine(),
        "parts": parts,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_network_takes_the_place_of_its_own_older_results_and_of_no_others() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("results.json");
        let gpu = Gpu::new().expect("an adapter");
        let evaluated = |network: &str, frames: usize| {
            let mut evaluation = Evaluation::default();
            (evaluation.frames, evaluation.scenes) = (frames, 2);
            add(
                &path,
                &[Entry { network: network.to_owned(), evaluation: &evaluation, target: "truth" }],
                &gpu,
            )
        };
        evaluated("gi", 200).expect("written");
        evaluated("gi_paper", 40).expect("written");
        evaluated("gi", 300).expect("written");
        let file: Value = serde_json::from_slice(&std::fs::read(&path).expect("a file")).expect("JSON");
        let expected = json!({ "frames_gi": 300.0, "frames_gi_paper": 40.0 });
        assert_eq!(file["figures"], expected, "{file}");
        assert_eq!(file["networks"]["gi"]["target"], "truth");
        std::fs::write(&path, "{}").expect("written");
        let error = format!("{:#}", evaluated("gi", 1).expect_err("another file"));
        assert!(error.ends_with("results.json: has no `networks`: it is not a file of results"), "{error}");
    }
}
