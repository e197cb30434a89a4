//! Where networks are, by name: in folders here, among those that were installed with the program, and in the
//! program itself.

#[cfg(not(target_arch = "wasm32"))]
use super::embedded;
#[cfg(feature = "train")]
use super::run;
use crate::location::Location;
use deepshade_infer::model::{SPEC, WEIGHTS};
use deepshade_shaders::Effect;
use deepshade_shaders::names::did_you_mean;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The folder in which an effect's network lies unless another one is named: below `models` here, else among
/// those that were installed with the program, else that of one that the program brings. Where there is none,
/// the one below `models` in which it would lie.
pub fn usual_folder(effect: Effect) -> PathBuf {
    found(effect.name(), places()).unwrap_or_else(|| Path::new(MODELS).join(effect.name()))
}

/// Reads where a network is: a folder, an address, or the name of a network that is shipped or that the
/// program brings.
///
/// # Errors
/// If it is no address, or a mere name that neither a folder here nor a network has.
pub fn place(text: &str) -> Result<Location, String> {
    let location: Location = text.parse()?;
    let is_name = Path::new(text).components().count() == 1 && !Path::new(text).exists();
    if !is_name {
        return Ok(location);
    }
    found(text, places()).map(Location::Folder).ok_or_else(|| unknown(text))
}

/// What is said of a name that no network has.
fn unknown(name: &str) -> String {
    let names: Vec<String> = names().into_iter().collect();
    let meant = did_you_mean(name, names.iter().map(String::as_str));
    format!("no folder and no network is called `{name}`{meant}; there are {}", names.join(", "))
}

/// Names of the networks that are found by name.
fn names() -> BTreeSet<String> {
    let folders = places().flat_map(std::fs::read_dir).flatten().flatten().map(|entry| entry.path());
    let networks = folders.filter(|folder| is_network(folder));
    let shipped = networks.filter_map(|folder| Some(folder.file_name()?.to_string_lossy().into_owned()));
    shipped.chain(embedded::names().map(str::to_owned)).collect()
}

/// The folder of a network of that name: in one of some places, else that of one that the program brings.
fn found(name: &str, places: impl Iterator<Item = PathBuf>) -> Option<PathBuf> {
    let shipped = places.map(|models| models.join(name)).find(|folder| is_network(folder));
    shipped.or_else(|| embedded::folder(name))
}

/// Folders that have networks in folders, the first the one that counts.
fn places() -> impl Iterator<Item = PathBuf> {
    [PathBuf::from(MODELS)].into_iter().chain(installed())
}

/// A web page brings none: it fetches them.
#[cfg(target_arch = "wasm32")]
mod embedded {
    use std::path::PathBuf;

    pub const fn folder(_: &str) -> Option<PathBuf> {
        None
    }

    pub fn names() -> impl Iterator<Item = &'static str> {
        std::iter::empty()
    }
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
        assert_eq!(folder("no/such"), Path::new("no/such"), "whoever reads it says that it is not there");
        assert!(matches!(place("s3://bucket/ao"), Ok(Location::Store(_))));
        assert_eq!(usual_folder(Effect::Ao), Path::new("models/ao"));
    }

    #[test]
    fn a_name_that_no_network_has_is_refused_with_those_that_there_are() {
        let error = place("ao-smal").expect_err("no network");
        assert!(error.contains("`ao-smal` (did you mean `ao-small`?); there are aa, ao, ao-"), "{error}");
        // One that is shipped, and is no part of the program.
        assert!(error.contains("ao-paper, ao-small, do,"), "{error}");
    }

    #[test]
    fn a_network_of_the_program_stands_in_where_no_folder_has_one() {
        let models = tempfile::tempdir().expect("a folder");
        let found = |name: &str| found(name, [models.path().to_owned()].into_iter());
        assert_eq!(found("ao"), embedded::folder("ao"));
        assert_eq!((found("ibl"), usual_folder(Effect::Ibl)), (None, PathBuf::from("models/ibl")));
        let own = models.path().join("ao");
        std::fs::create_dir(&own).expect("made");
        assert_eq!(found("ao"), embedded::folder("ao"), "a folder without a network");
        std::fs::write(own.join(SPEC), "{}").expect("written");
        assert_eq!(found("ao"), Some(own));
    }
}
