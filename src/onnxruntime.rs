//! onnxruntime's CPU provider: the oracle that the project's own forms of a network are checked against, and
//! the rival that their speed is measured beside.
//!
//! Its native library is loaded when it is first needed; nothing else of the program needs it.

use anyhow::{Context, Result, anyhow, bail};
use deepshade_shaders::Planes;
use ort::{environment::Environment, session, value::TensorRef};
use std::{
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
};

/// Names the library where `--onnxruntime` does not.
const VARIABLE: &str = "ORT_DYLIB_PATH";

/// The library's environment; a process may have only one.
static ENVIRONMENT: Mutex<Option<Environment>> = Mutex::new(None);

/// Command-line arguments of verbs that use onnxruntime.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// onnxruntime's native library (1.22 or newer); else ORT_DYLIB_PATH, else what `cargo xtask test`
    /// installed
    #[arg(long, value_name = "FILE")]
    onnxruntime: Option<PathBuf>,
}

impl Args {
    /// Whether there is a library, which is then loaded.
    ///
    /// # Errors
    /// If one is named, and is none.
    pub fn is_there(&self) -> Result<bool> {
        let found = found(self.onnxruntime.as_deref());
        found.map(|_| environment(self.onnxruntime.as_deref())).transpose().map(|loaded| loaded.is_some())
    }

    /// Loads a network.
    ///
    /// # Errors
    /// If there is no onnxruntime, or it does not accept the network.
    pub fn session(&self, model: &Path, threads: usize) -> Result<Session> {
        let environment = environment(self.onnxruntime.as_deref())?;
        let failed = |error: &dyn std::fmt::Display| anyhow!("onnxruntime: {}: {error}", model.display());
        let builder = session::Session::builder(&environment).map_err(|error| failed(&error))?;
        let mut builder = builder.with_intra_threads(threads).map_err(|error| failed(&error))?;
        let inner = builder.commit_from_file(model).map_err(|error| failed(&error))?;
        Ok(Session { model: model.to_owned(), inner })
    }
}

/// A network, ready to run.
pub struct Session {
    model: PathBuf,
    inner: session::Session,
}

impl Session {
    /// The network's images of an input `[channels, height, width]`, each with its name: as many as the file
    /// has outputs.
    ///
    /// # Errors
    /// If the input does not fit the network.
    pub fn run(&mut self, input: &Planes) -> Result<Vec<(String, Planes)>> {
        let Self { model, inner } = self;
        let shape = [1, input.channels(), input.height(), input.width()];
        let tensor = TensorRef::from_array_view((shape, input.data()))?;
        let outputs =
            inner.run(ort::inputs![tensor]).with_context(|| format!("onnxruntime: {}", model.display()))?;
        outputs
            .iter()
            .map(|(name, value)| Ok((name.to_owned(), image(value.try_extract_tensor::<f32>()?)?)))
            .collect()
    }

    /// [`Session::run`] for a network with one output.
    ///
    /// # Errors
    /// If the input does not fit the network.
    pub fn image(&mut self, input: &Planes) -> Result<Planes> {
        let (_, image) = self.run(input)?.pop().context("onnxruntime: the network has no output")?;
        Ok(image)
    }
}

/// A tensor `[1, channels, height, width]` as an image.
fn image((shape, data): (&ort::value::Shape, &[f32])) -> Result<Planes> {
    match &shape[..] {
        [1, channels, height, width] => {
            Ok(Planes::from_data(*channels as usize, *height as usize, *width as usize, data.to_vec()))
        }
        other => bail!("onnxruntime gave a tensor of shape {other:?}; expected [1, channels, height, width]"),
    }
}

fn environment(wanted: Option<&Path>) -> Result<Environment> {
    let mut environment = ENVIRONMENT.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(environment) = &*environment {
        return Ok(environment.clone());
    }
    let library = library(wanted)?;
    let builder = ort::init_from(&library).with_context(|| format!("onnxruntime {}", library.display()))?;
    Ok(environment.insert(builder.build().context("onnxruntime")?).clone())
}

/// The library's path, from the first source that names one.
fn library(wanted: Option<&Path>) -> Result<PathBuf> {
    match found(wanted) {
        Some(library) if library.is_file() => Ok(library),
        Some(library) => bail!("onnxruntime: no file {}", library.display()),
        None => bail!(
            "onnxruntime is needed here. `cargo xtask test` installs it below target/; or take it from the Python \
             package `onnxruntime` and name the file (libonnxruntime.so.1.31.1) by --onnxruntime or {VARIABLE}"
        ),
    }
}

/// The path that the first source names, whatever is there.
fn found(wanted: Option<&Path>) -> Option<PathBuf> {
    let variable = || std::env::var_os(VARIABLE).filter(|path| !path.is_empty()).map(PathBuf::from);
    wanted.map(Path::to_owned).or_else(variable).or_else(installed)
}

/// What `cargo xtask test` installed in the target folder that this program lies in.
fn installed() -> Option<PathBuf> {
    let program = std::env::current_exe().ok()?;
    program.ancestors().skip(1).find_map(|folder| {
        let versions = sorted(&folder.join("python"));
        let libraries = versions.iter().rev().flat_map(|version| sorted(&version.join("onnxruntime/capi")));
        libraries.into_iter().find(|path| is_library(path))
    })
}

/// What a folder holds, in the order of names; nothing if there is no such folder.
fn sorted(folder: &Path) -> Vec<PathBuf> {
    let mut entries: Vec<PathBuf> =
        std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    entries.sort();
    entries
}

/// `libonnxruntime.so.1.31.1`, but not its neighbour `libonnxruntime_providers_shared.so`.
fn is_library(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    name.starts_with("libonnxruntime.")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_library_that_is_not_there_is_named() {
        let error = library(Some(Path::new("nowhere/libonnxruntime.so"))).expect_err("no such file");
        assert_eq!(error.to_string(), "onnxruntime: no file nowhere/libonnxruntime.so");
    }

    #[test]
    fn the_library_is_told_from_its_neighbours() {
        assert!(is_library(Path::new("capi/libonnxruntime.so.1.31.1")));
        assert!(!is_library(Path::new("capi/libonnxruntime_providers_shared.so")));
    }
}
