//! The libraries that a file names.

use super::files::Files;
use super::library;
use super::material::Library;
use super::parse::Named;
use super::text;
use super::warnings::Warnings;
use crate::scene::{SceneError, file};
use std::path::{Path, PathBuf};

/// The most spaces that the name of a library has.
const MOST_SPACES: usize = 32;

/// The libraries that an OBJ file names and that are there, each read once. Those that are not are said of
/// the OBJ file; what is odd in the others is put with their sentences.
///
/// # Errors
/// If a library cannot be read.
pub(super) fn libraries(
    folder: &Path,
    obj: &Path,
    named: &[Named],
    about_obj: &mut Warnings,
    about_libraries: &mut Vec<String>,
) -> Result<Vec<Library>, SceneError> {
    let files = Files::beside(folder, obj);
    let mut libraries: Vec<Library> = Vec::new();
    for Named { name, line } in named {
        for path in paths(&files, name, *line, about_obj) {
            if libraries.iter().any(|library| library.path == path) {
                continue;
            }
            let mut about = Warnings::default();
            let beside = Files::beside(folder, &path);
            let materials = library::parse(&text(&file::read(&path)?), &beside, &mut about);
            about_libraries.append(&mut about.about(&path));
            libraries.push(Library { path, materials });
        }
    }
    Ok(libraries)
}

/// The files that follow `mtllib`: from each word on the longest name of a file that there is. Names may have
/// spaces.
fn paths(files: &Files, names: &str, line: usize, warnings: &mut Warnings) -> Vec<PathBuf> {
    let (mut paths, mut missing, mut rest) = (Vec::new(), Vec::new(), names.trim());
    while !rest.is_empty() {
        if let Some((path, behind)) = longest(files, rest) {
            paths.push(path);
            rest = behind;
        } else if rest.starts_with('#') {
            break;
        } else {
            let (word, behind) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
            rest = behind.trim_start();
            match files.called(word) {
                Some(path) => paths.push(instead(word, path, line, warnings)),
                None => missing.push(word),
            }
        }
    }
    if !missing.is_empty() {
        let name = missing.join(" ");
        match files.called(&name) {
            Some(path) => paths.push(instead(&name, path, line, warnings)),
            None => warnings.add(line, format!("there is no library `{name}` in the scene's folder")),
        }
    }
    paths
}

/// The file with the longest name that a text begins with, and what follows it.
fn longest<'a>(files: &Files, text: &'a str) -> Option<(PathBuf, &'a str)> {
    let spaces = text.char_indices().filter(|(_, letter)| letter.is_whitespace()).map(|(at, _)| at);
    let mut ends: Vec<usize> = spaces.take(MOST_SPACES).collect();
    if ends.len() < MOST_SPACES {
        ends.push(text.len());
    }
    let file = |end: &usize| files.named(&text[..*end]).map(|path| (path, text[*end..].trim_start()));
    ends.iter().rev().find_map(file)
}

/// A file in place of one that is not there, which is said.
fn instead(name: &str, path: PathBuf, line: usize, warnings: &mut Warnings) -> PathBuf {
    warnings.add(line, format!("there is no library `{name}`; `{}` is read in its place", path.display()));
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names of the files that are found among `red.mtl`, `my lib.mtl` and `lib #1.mtl`, and what is said.
    fn found(names: &str) -> (Vec<String>, Vec<String>) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        for name in ["red.mtl", "my lib.mtl", "lib #1.mtl"] {
            std::fs::write(folder.path().join(name), "").expect("a file");
        }
        let mut warnings = Warnings::default();
        let obj = folder.path().join("a.obj");
        let paths = paths(&Files::beside(folder.path(), &obj), names, 3, &mut warnings);
        let name = |path: &PathBuf| path.file_name().map(|name| name.to_string_lossy().into_owned());
        (paths.iter().filter_map(name).collect(), warnings.about(Path::new("a")))
    }

    #[test]
    fn names_have_spaces_and_stand_behind_each_other() {
        let cases: [(&str, &[&str]); 4] = [
            ("my lib.mtl red.mtl", &["my lib.mtl", "red.mtl"]),
            ("red.mtl \"my lib.mtl\" # red.mtl", &["red.mtl", "my lib.mtl"]),
            ("lib #1.mtl red.mtl", &["lib #1.mtl", "red.mtl"]),
            ("#red.mtl", &[]),
        ];
        for (names, expected) in cases {
            assert_eq!(found(names).0, expected, "{names}");
        }
        assert!(found("my lib.mtl red.mtl # red").1.is_empty());
    }

    #[test]
    fn what_is_missing_is_said_and_looked_for_by_the_last_part_of_its_name() {
        let (files, said) = found("gone away.mtl red.mtl");
        assert_eq!(files, ["red.mtl"]);
        assert_eq!(said, ["a: line 3: there is no library `gone away.mtl` in the scene's folder"]);
        let (files, said) = found("C:\\x y\\red.mtl");
        assert_eq!((files, said.len()), (vec!["red.mtl".to_owned()], 2), "{said:?}");
        let (files, said) = found("/home/x/my lib.mtl");
        assert_eq!((files, said.len()), (vec!["my lib.mtl".to_owned()], 1), "{said:?}");
    }
}
