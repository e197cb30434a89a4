//! Private Python environments below the target folder: one that the tests take onnxruntime's library from,
//! one for the renderer that truth is compared with.

use crate::{
    apt,
    command::{command, run, succeeds, target},
};
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};

/// The version that the tests compare with.
const ONNXRUNTIME: &str = "1.31.1";

/// Any of the versions that onnxruntime has wheels for: its library is the same in all of them, and this way
/// the machine's own Python may be older.
const WHEEL: &str = "3.12";

/// Path of onnxruntime's native library, after installing it if need be.
///
/// # Errors
/// If Python or its venv module is missing and cannot be installed, or if the wheel cannot be fetched.
pub fn onnxruntime() -> Result<PathBuf> {
    let folder = target().join("python");
    let packages = folder.join(format!("onnxruntime-{ONNXRUNTIME}"));
    if let Some(library) = library(&packages) {
        return Ok(library);
    }
    make_environment(&folder)?;
    let pip = folder.join("bin/pip").display().to_string();
    let partial = folder.join("partial");
    let into = partial.display().to_string();
    let wheel = format!("onnxruntime=={ONNXRUNTIME}");
    let only_library =
        ["--no-deps", "--only-binary=:all:", "--python-version", WHEEL, "--upgrade", "--target"];
    let quiet = ["install", "--quiet", "--disable-pip-version-check", "--no-input"];
    run(&mut command(&pip, &[&quiet[..], &only_library, &[&into, &wheel]].concat()))
        .context("cannot install onnxruntime, which the tests compare with")?;
    std::fs::rename(&partial, &packages).with_context(|| format!("cannot rename {into}"))?;
    library(&packages).with_context(|| format!("no libonnxruntime in {}", packages.display()))
}

/// The interpreter of an environment with packages of exact versions, after making it if need be.
///
/// # Errors
/// If Python or its venv module is missing and cannot be installed, or if a package cannot be fetched.
pub fn environment(name: &str, packages: &[&str]) -> Result<PathBuf> {
    let folder = target().join(name);
    let interpreter = folder.join("bin/python");
    // Written last, so that an environment that was given up halfway is not taken for a whole one.
    let record = folder.join("packages.txt");
    let wanted = packages.join("\n");
    if std::fs::read_to_string(&record).is_ok_and(|installed| installed == wanted) {
        return Ok(interpreter);
    }
    make_environment(&folder)?;
    let pip = folder.join("bin/pip").display().to_string();
    let quiet = ["install", "--quiet", "--disable-pip-version-check", "--no-input", "--only-binary=:all:"];
    run(&mut command(&pip, &[&quiet[..], packages].concat()))
        .with_context(|| format!("cannot install {name}"))?;
    std::fs::write(&record, wanted).with_context(|| format!("cannot write {}", record.display()))?;
    Ok(interpreter)
}

/// An empty Python environment with pip.
fn make_environment(folder: &Path) -> Result<()> {
    // Debian splits the module: `venv` can be imported without `ensurepip`, but does not work then.
    let ready = || succeeds(&mut command("python3", &["-c", "import venv, ensurepip"]));
    if !ready() {
        apt::install(&["python3-venv"], "Python's venv module")?;
    }
    if !ready() {
        bail!("python3 cannot import `venv` and `ensurepip` although python3-venv is installed");
    }
    let folder = folder.display().to_string();
    run(&mut command("python3", &["-m", "venv", "--clear", &folder]))
}

/// The native library in the folder that the wheel was unpacked to.
fn library(packages: &Path) -> Option<PathBuf> {
    let files = std::fs::read_dir(packages.join("onnxruntime/capi")).ok()?;
    let mut found: Vec<PathBuf> =
        files.flatten().map(|file| file.path()).filter(|path| is_library(path)).collect();
    found.sort();
    found.into_iter().next()
}

/// `libonnxruntime.so.1.31.1`, or `libonnxruntime.1.31.1.dylib` on macOS.
fn is_library(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    name == format!("libonnxruntime.so.{ONNXRUNTIME}")
        || name == format!("libonnxruntime.{ONNXRUNTIME}.dylib")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_library_is_told_from_its_neighbours() {
        assert!(is_library(Path::new("capi/libonnxruntime.so.1.31.1")));
        assert!(!is_library(Path::new("capi/libonnxruntime_providers_shared.so")));
        assert!(!is_library(Path::new("capi/onnxruntime_pybind11_state.so")));
    }
}
