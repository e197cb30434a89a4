//! What a command found out, as a JSON file of the form that the program's own have: `{"command", "machine",
//! "figures", "details"}`.

use anyhow::{Context, Result};
use serde_json::{Map, Value, json};
use std::path::Path;

/// The file's value: figures, and what explains them.
pub fn to_json(command: &str, figures: &[(String, f64)], details: Value) -> Value {
    let figures: Map<_, _> = figures.iter().map(|(name, value)| (name.clone(), json!(value))).collect();
    json!({ "command": command, "machine": machine(), "figures": figures, "details": details })
}

/// The machine that figures are from, as the program says it.
fn machine() -> Value {
    let cpuinfo = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = cpuinfo.lines().find(|line| line.starts_with("model name"));
    json!({
        "os": std::env::consts::OS,
        "architecture": std::env::consts::ARCH,
        "processor": name.and_then(|line| line.split_once(':')).map(|(_, name)| name.trim()),
        "threads": std::thread::available_parallelism().map_or(1, usize::from),
        "version": env!("CARGO_PKG_VERSION"),
    })
}

/// Writes the file of a command, where one is asked for.
///
/// # Errors
/// If it cannot be written.
pub fn write(path: Option<&Path>, command: &str, figures: &[(String, f64)], details: Value) -> Result<()> {
    let Some(path) = path else { return Ok(()) };
    write_text(path, &format!("{:#}\n", to_json(command, figures, details)))
}

/// Writes a file, whole or not at all, and its folder where that is missing.
///
/// # Errors
/// If it cannot be written.
pub fn write_text(path: &Path, text: &str) -> Result<()> {
    let path = std::path::absolute(path)?;
    let folder = path.parent().context("a file's path")?;
    std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    let partial = folder.join(format!(".deepshade-{}", std::process::id()));
    let written = std::fs::write(&partial, text).and_then(|()| std::fs::rename(&partial, &path));
    written.with_context(|| path.display().to_string())
}
