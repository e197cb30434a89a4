//! What a command found out, as one JSON file: `{"command", "machine", "figures", "details"}`, figures flat
//! and with stable names.

use anyhow::{Context, Result};
use deepshade_render::processor_name;
use deepshade_shaders::atomic_file;
use serde_json::{Map, Value, json};
use std::path::Path;

/// The results of a command.
#[derive(Debug)]
pub struct Figures {
    command: String,
    figures: Map<String, Value>,
    details: Map<String, Value>,
}

impl Figures {
    /// No results yet, of the command of that name (`eval`, `bench net`, ...).
    pub fn new(command: &str) -> Self {
        Self { command: command.to_owned(), figures: Map::new(), details: Map::new() }
    }

    /// Sets a figure. What is not finite is written as null, since JSON has no other way.
    pub fn set(&mut self, name: &str, value: f64) {
        self.figures.insert(name.to_owned(), json!(value));
    }

    /// A figure that was set.
    #[cfg(feature = "train")]
    pub fn get(&self, name: &str) -> Option<f64> {
        self.figures.get(name)?.as_f64()
    }

    /// Sets something that explains the figures.
    pub fn detail(&mut self, name: &str, value: Value) {
        self.details.insert(name.to_owned(), value);
    }

    /// Everything as JSON.
    pub fn to_json(&self) -> Value {
        json!({
            "command": self.command,
            "machine": machine(),
            "figures": self.figures,
            "details": self.details,
        })
    }

    /// Writes the JSON file, where one is asked for.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, path: Option<&Path>) -> Result<()> {
        let Some(path) = path else { return Ok(()) };
        let text = serde_json::to_string_pretty(&self.to_json()).context("figures as JSON")?;
        write_atomically(path, text.as_bytes())
    }
}

/// Writes a file, whole or not at all, and its folder where that is missing.
///
/// # Errors
/// If the folder cannot be written to.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<()> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).with_context(|| format!("folder {}", folder.display()))?;
    }
    atomic_file::write(path, bytes).with_context(|| path.display().to_string())
}

/// The machine that figures are from.
pub fn machine() -> Value {
    json!({
        "os": std::env::consts::OS,
        "architecture": std::env::consts::ARCH,
        "processor": processor_name(),
        "threads": rayon::current_num_threads(),
        "version": env!("CARGO_PKG_VERSION"),
    })
}

/// Resident memory of the program, megabytes; `None` where the system does not say.
pub fn memory() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<f64>().ok().map(|kilobytes| kilobytes / 1024.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_flat_and_the_file_is_whole() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("deep/figures.json");
        let mut figures = Figures::new("eval");
        figures.set("ssim_learned", 0.5);
        figures.detail("frames", json!(["a"]));
        figures.write(Some(&path)).expect("written");
        let read: Value = serde_json::from_slice(&std::fs::read(&path).expect("a file")).expect("JSON");
        assert_eq!(read["figures"]["ssim_learned"], 0.5);
        assert_eq!(read["command"], "eval");
        assert_eq!(std::fs::read_dir(path.parent().expect("a folder")).expect("entries").count(), 1);
    }
}
