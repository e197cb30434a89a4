//! Where networks are: in folders here, among those that were installed with the program, by name.

#[cfg(feature = "train")]
use super::run;
use crate::location::Location;
use deepshade_infer::model::{SPEC, WEIGHTS};
use deepshade_shaders::Effect;
use std::path::{Path, PathBuf};

/// The folder in which an effect's network lies unless another one is named: below `models` here, else among
/// those that were installed with the program.
pub fn usual_folder(effect: Effect) -> PathBuf {
    shipped(effect.name()).unwrap_or_else(|| Path::new(MODELS).join(effect.name()))
}

/// Reads where a network is: a folder, an address, or the name of a network that is shipped or that the
/// program brings.
///
/// # Errors
/// If it is no folder and no address.
pub fn place(text: &str) -> Result<Location, String> {
    let location: Location = text.parse()?;
    let is_name = Path::new(text).components().count() == 1 && !Path::new(text).exists();
    Ok(if is_name {
        shipped(text).or_else(|| embedded(text)).map_or(location, Location::Folder)
    } else {
        location
    })
}

/// The folder of a network of that name which the program brings.
#[cfg(not(target_arch = "wasm32"))]
fn embedded(name: &str) -> Option<PathBuf> {
    super::embedded::folder(name)
}

/// A web page brings none: it fetches them.
#[cfg(target_arch = "wasm32")]
const fn embedded(_: &str) -> Option<PathBuf> {
    None
}

/// The folder of a network of that name, below `models` here or among those that were installed.
fn shipped(name: &str) -> Option<PathBuf> {
    let places = [PathBuf::from(MODELS)].into_iter().chain(installed());
    places.map(|models| models.join(name)).find(|folder| is_network(folder))
}

/// Where networks are below the working folder.
const MODELS: &str = "models";

/// Where packages put networks: `share/deepshade/models` beside the program's `bin`.
fn installed() -> Option<PathBuf> {
    let program = std::env::current_exe().ok()?;
    Some(program.parent()?.parent()?.join("share/deepshade/models"))
}

/// Whether a folder holds a network: a model, or a training run.
pub fn is_network(folder: &Path) -> bool {
    is_model(folder) || is_run(folder)
}

fn is_model(folder: &Path) -> bool {
    folder.join(SPEC).is_file()
}

/// Whether a folder holds a training run and no model.
#[cfg(feature = "train")]
pub fn is_run(folder: &Path) -> bool {
    !is_model(folder) && run::is_run(folder)
}

/// A program that cannot train knows no runs.
#[cfg(not(feature = "train"))]
pub const fn is_run(_: &Path) -> bool {
    false
}

/// The files in a network's folder by which it is told from others.
pub fn files(folder: &Path) -> [PathBuf; 2] {
    #[cfg(feature = "train")]
    if is_run(folder) {
        return run::FILES.map(|name| folder.join(name));
    }
    [SPEC, WEIGHTS].map(|name| folder.join(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_network_that_is_shipped_is_found_by_its_name() {
        let folder = |text: &str| match place(text).expect("a place") {
            Location::Folder(folder) => folder,
            Location::Store(_) => PathBuf::new(),
        };
        assert_eq!(folder("ao-small"), Path::new("models/ao-small"));
        assert_eq!(folder("models/ao"), Path::new("models/ao"));
        assert_eq!(folder("src"), Path::new("src"), "a folder is what it says");
        assert_eq!(folder("no-such"), Path::new("no-such"), "whoever reads it says that it is not there");
        assert!(matches!(place("s3://bucket/ao"), Ok(Location::Store(_))));
        assert_eq!(usual_folder(Effect::Ao), Path::new("models/ao"));
    }
}
