//! `deepshade eval --results`: one file with what every network came to, each as its last evaluation left it.
//!
//! `{"networks": {NETWORK: {...}}}`: of each network its figures, how sure they are, and what they were
//! measured on.

use super::names::{of_network, set_figures};
use super::score::Evaluation;
use crate::figures::{Figures, machine, write_atomically};
use anyhow::{Context, Result, ensure};
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

/// Refuses, before any work, what [`add`] could not do after it.
///
/// # Errors
/// If the file is another one, or is to be written as JSON, too.
pub fn check(path: &Path, json: Option<&Path>) -> Result<()> {
    ensure!(json != Some(path), "--results and --json are the same file, {}", path.display());
    read(path).map(drop)
}

/// Writes a network into a file, in place of what it had of the same one.
///
/// # Errors
/// If the file is another one, or cannot be written.
pub fn add(path: &Path, entry: &Entry<'_>, gpu: &Gpu) -> Result<()> {
    let mut networks = read(path)?;
    networks.insert(entry.network.clone(), described(entry, &gpu.info.name));
    let text = serde_json::to_string_pretty(&json!({ "networks": networks })).context("results as JSON")?;
    write_atomically(path, format!("{text}\n").as_bytes())
}

/// The networks of a file; none where there is no file.
fn read(path: &Path) -> Result<Map<String, Value>> {
    let networks = || -> Result<Map<String, Value>> {
        let file: Value = serde_json::from_slice(&std::fs::read(path)?)?;
        file["networks"].as_object().cloned().context("has no `networks`: it is not a file of results")
    };
    if path.exists() { networks().with_context(|| path.display().to_string()) } else { Ok(Map::new()) }
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
        "scenes": evaluation.scenes.len(),
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
            (evaluation.frames, evaluation.scenes) = (frames, vec!["cave:1".to_owned()]);
            let entry = Entry { network: network.to_owned(), evaluation: &evaluation, target: "truth" };
            add(&path, &entry, &gpu)
        };
        evaluated("gi", 200).expect("written");
        evaluated("gi_paper", 40).expect("written");
        evaluated("gi", 300).expect("written");
        let file: Value = serde_json::from_slice(&std::fs::read(&path).expect("a file")).expect("JSON");
        let figures = |network: &str| file["networks"][network]["figures"].clone();
        assert_eq!(figures("gi"), json!({ "frames_gi": 300.0, "frames_of_flip_gi": 0.0 }));
        assert_eq!(figures("gi_paper"), json!({ "frames_gi_paper": 40.0, "frames_of_flip_gi_paper": 0.0 }));
        assert_eq!(file["networks"]["gi"]["target"], "truth");
        check(&path, None).expect("a file of results");
        let error = format!("{:#}", check(&path, Some(&path)).expect_err("one file for two"));
        assert!(error.contains("the same file"), "{error}");
        std::fs::write(&path, "{}").expect("written");
        let error = format!("{:#}", check(&path, None).expect_err("another file"));
        assert!(error.ends_with("results.json: has no `networks`: it is not a file of results"), "{error}");
    }
}
