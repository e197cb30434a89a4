//! The library's documentation: public items of the crates that others build on.

use super::remove;
use crate::command::{self, cargo, root, target};
use crate::figures;
use anyhow::{Context, Result};
use std::fs;
use std::path::Path;

/// Their folders, the most asked for first.
pub const CRATES: [&str; 7] = ["infer", "render", "dataset", "train", "shaders", "glow", "phosphor"];
/// The page that leads to them, with a place for their list.
const PAGE: &str = include_str!("library.html");
const PLACE: &str = "{crates}";

/// Builds the documentation into a folder.
///
/// # Errors
/// If it does not build.
pub fn make(into: &Path) -> Result<()> {
    let fresh = target().join("site-library");
    remove(&fresh)?;
    let packages = CRATES.map(|folder| format!("--package=deepshade-{folder}"));
    let place = format!("--target-dir={}", fresh.display());
    let mut words = vec!["doc", "--release", "--locked", "--no-deps", "--lib", &place];
    words.extend(packages.iter().map(String::as_str));
    // The documentation of the tests has private items and stays where it is. What both need built is shared.
    command::run(cargo(&words).env("CARGO_BUILD_BUILD_DIR", target()))?;
    command::copy(&fresh.join("doc/."), into)?;
    figures::write_text(&into.join("index.html"), &page()?)?;
    remove(&fresh)
}

/// The page that leads to the crates.
fn page() -> Result<String> {
    let items: Result<Vec<String>> = CRATES.into_iter().map(item).collect();
    Ok(PAGE.replace(PLACE, &items?.join("\n")))
}

fn item(folder: &str) -> Result<String> {
    let said = description(folder)?;
    Ok(format!("<li><a href=\"deepshade_{folder}/index.html\">deepshade_{folder}</a>: {said}</li>"))
}

/// What a crate's manifest says of it, as HTML.
fn description(folder: &str) -> Result<String> {
    let file = root().join(folder).join("Cargo.toml");
    let manifest = fs::read_to_string(&file).with_context(|| file.display().to_string())?;
    let mut lines = manifest.lines();
    let said = lines.find_map(|line| line.strip_prefix("description = \"")?.strip_suffix('"'));
    let said = said.with_context(|| format!("{} says no description", file.display()))?;
    Ok(said.replace('&', "&amp;").replace('<', "&lt;"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn the_crates_are_all_but_programs_and_are_linked_to() {
        let manifest = fs::read_to_string(root().join("Cargo.toml")).expect("the manifest");
        let (_, list) = manifest.split_once("members = [").expect("members");
        let members =
            list.split(']').next().expect("an end").split(',').map(|name| name.trim().trim_matches('"'));
        let members: BTreeSet<&str> =
            members.filter(|name| ![".", "studies", "xtask"].contains(name)).collect();
        assert_eq!(members, BTreeSet::from(CRATES));
        let page = page().expect("descriptions");
        assert!(!page.contains('{'), "a place is left");
        for folder in CRATES {
            assert!(page.contains(&format!("href=\"deepshade_{folder}/index.html\"")), "{folder}");
        }
    }
}
