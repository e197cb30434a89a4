//! The test sets that methods are evaluated on: `testset` and `testset-*` in a network's folder, or one that
//! is asked for.

use anyhow::{Result, ensure};
use deepshade_dataset::{SceneOrCapture, TestSet};
use deepshade_render::scene::SceneSource;
use deepshade_shaders::Effect;
use std::path::{Path, PathBuf};

/// Name of a network's test set, and what the names of further ones begin with.
const USUAL: &str = "testset";

/// The set that figures of all sets leave out: scenes of files, which are not there everywhere.
pub const ARTISTS: &str = "artists";

/// What no set can be called: figures have these words for the ends of intervals and for all sets.
const TAKEN: [&str; 3] = ["low", "high", "all"];

/// A test set under the name that figures have for it.
pub struct NamedSet {
    /// What follows `testset-` in its folder's name; nothing of `testset`, and of the only one.
    pub name: String,
    /// The set.
    pub set: TestSet,
}

impl NamedSet {
    /// Its name in words.
    pub fn title(&self) -> &str {
        if self.name.is_empty() { USUAL } else { &self.name }
    }
}

/// The folders of a network's test sets, by name: those in its own folder, else those of the network that has
/// the name of its effect and lies beside it. Where there is none, the one where it would be.
pub fn folders(model: &Path, effect: Effect) -> Vec<PathBuf> {
    let beside = model.parent().map(|models| models.join(effect.name()));
    let found = [Some(model.to_owned()), beside].into_iter().flatten().map(|folder| inside(&folder));
    found.into_iter().find(|folders| !folders.is_empty()).unwrap_or_else(|| vec![model.join(USUAL)])
}

/// The folders of test sets in a folder, by name.
fn inside(model: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(model).into_iter().flatten();
    let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let mut names: Vec<String> = names.filter(|name| suffix(name).is_some()).collect();
    names.sort();
    let mut folders: Vec<PathBuf> = names.iter().map(|name| model.join(name)).collect();
    folders.retain(|folder| TestSet::is_in(folder));
    folders
}

/// What the name of a test set's folder says of it: nothing of `testset`, `small` of `testset-small`.
fn suffix(folder: &str) -> Option<&str> {
    match folder.strip_prefix(USUAL)? {
        "" => Some(""),
        rest => rest.strip_prefix('-').filter(|suffix| !suffix.is_empty()),
    }
}

/// Opens the test sets in some folders. Of several, those whose scene files are not there are passed over,
/// which is said.
///
/// # Errors
/// If one cannot be read, is for another effect or has a name that figures have for something else, or all
/// are passed over.
pub fn open(folders: &[PathBuf], effect: Effect, scenes: Option<&Path>) -> Result<Vec<NamedSet>> {
    let several = folders.len() > 1;
    let mut sets = Vec::new();
    for folder in folders {
        let set = located(read(folder, effect)?, scenes);
        let file = folder.file_name().unwrap_or_default().to_string_lossy();
        let name = suffix(&file).filter(|_| several).unwrap_or_default();
        ensure!(
            !TAKEN.contains(&name),
            "{}: figures cannot be told apart by the name `{name}`",
            folder.display()
        );
        if several && let Some(file) = missing(&set) {
            note!(
                "{}: passed over, there is no {}; --scenes says where scene files are",
                folder.display(),
                file.display()
            );
            continue;
        }
        sets.push(NamedSet { name: name.replace(['-', '.'], "_"), set });
    }
    ensure!(!sets.is_empty(), "no test set has its scene files here; --scenes says where they are");
    Ok(sets)
}

fn read(folder: &Path, effect: Effect) -> Result<TestSet> {
    ensure!(
        TestSet::is_in(folder),
        "no test set in {0}; `deepshade dataset testset dataset/recipes/{effect}-test.toml --out {0}` makes \
         one, and --testset says where another is",
        folder.display()
    );
    let set = TestSet::open(folder)?;
    let made = set.recipe().effect;
    ensure!(made == effect, "{} is for {made}, not for {effect}", folder.display());
    Ok(set)
}

/// A set with its scene files where they are: in the folder that is asked for, else where the set remembers
/// them, else among the open scenes.
fn located(set: TestSet, scenes: Option<&Path>) -> TestSet {
    if let Some(scenes) = scenes {
        return set.with_scenes(scenes);
    }
    if missing(&set).is_none() {
        return set;
    }
    let data = std::env::var_os("DEEPSHADE_DATA").map_or_else(|| "../shared/data/open".into(), PathBuf::from);
    let elsewhere = set.clone().with_scenes(&data.join("scenes"));
    if missing(&elsewhere).is_none() { elsewhere } else { set }
}

/// The first file or folder that a set's scenes are from and that is not there.
fn missing(set: &TestSet) -> Option<PathBuf> {
    let file = |source: &SceneOrCapture| match source {
        SceneOrCapture::Scene(SceneSource::File(path)) | SceneOrCapture::Capture(path) => {
            Some(set.recipe().folder.join(path))
        }
        SceneOrCapture::Scene(SceneSource::Procedural(..)) => None,
    };
    set.frames().iter().filter_map(|frame| file(&frame.scene.source)).find(|path| !path.exists())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_say_which_set_they_hold() {
        for (folder, expected) in [
            ("testset", Some("")),
            ("testset-small", Some("small")),
            ("testset-far-away", Some("far-away")),
            ("testset-", None),
            ("testsets", None),
            ("my-testset", None),
        ] {
            assert_eq!(suffix(folder), expected, "{folder}");
        }
    }

    #[test]
    fn a_network_s_sets_are_found_by_name() {
        let model = tempfile::tempdir().expect("a folder");
        let folders = |model: &Path| folders(model, Effect::Ao);
        assert_eq!(folders(model.path()), [model.path().join("testset")], "where it would be");
        assert_eq!(folders(&model.path().join("gone")), [model.path().join("gone/testset")]);
        for (folder, whole) in
            [("testset-small", true), ("testset", true), ("testset-large", false), ("pictures", true)]
        {
            std::fs::create_dir(model.path().join(folder)).expect("made");
            if whole {
                std::fs::write(model.path().join(folder).join("testset.json"), "{}").expect("written");
            }
        }
        assert_eq!(folders(model.path()), ["testset", "testset-small"].map(|name| model.path().join(name)));
    }

    #[test]
    fn a_network_without_sets_has_those_of_its_effect_s_network() {
        let models = tempfile::tempdir().expect("a folder");
        let path = |folder: &str| models.path().join(folder);
        std::fs::create_dir_all(path("ao/testset-small")).expect("made");
        std::fs::write(path("ao/testset-small/testset.json"), "{}").expect("written");
        std::fs::create_dir(path("small")).expect("made");
        assert_eq!(folders(&path("small"), Effect::Ao), [path("ao/testset-small")]);
        assert_eq!(folders(&path("small"), Effect::Gi), [path("small/testset")], "another effect");
        std::fs::create_dir(path("small/testset")).expect("made");
        std::fs::write(path("small/testset/testset.json"), "{}").expect("written");
        assert_eq!(folders(&path("small"), Effect::Ao), [path("small/testset")], "its own come first");
    }

    #[test]
    fn a_set_that_is_not_there_is_named() {
        let model = tempfile::tempdir().expect("a folder");
        let error =
            open(&folders(model.path(), Effect::Sss), Effect::Sss, None).err().expect("none").to_string();
        assert!(error.contains("no test set in") && error.contains("sss-test.toml"), "{error}");
    }
}
