//! The shipped networks: their files, and their cards as a small book.

use super::remove;
use crate::command::{root, target};
use crate::{book, command, figures, web};
use anyhow::{Context, Result};
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// Makes the book in a folder.
///
/// # Errors
/// If a network has no card, or mdBook fails.
pub fn make(into: &Path) -> Result<()> {
    let source = target().join("site-networks");
    remove(&source)?;
    stage(&source, &web::networks()?)?;
    book::build(&source, into)?;
    remove(&source)
}

/// Writes the book's source. mdBook copies what is no chapter as it is.
fn stage(source: &Path, networks: &[String]) -> Result<()> {
    let chapters: Vec<String> = networks.iter().map(|name| format!("- [{name}]({name}/card.md)\n")).collect();
    let list = chapters.concat();
    let write = |file: &str, text: &str| figures::write_text(&source.join(file), text);
    write("book.toml", "[book]\ntitle = \"Networks of deepshade\"\nlanguage = \"en\"\n")?;
    write("src/SUMMARY.md", &format!("# Summary\n\n[Networks](index.md)\n\n{list}"))?;
    let first = "Each with its files. [The first page](../index.html) says what else there is.";
    write("src/index.md", &format!("# Networks\n\n{first}\n\n{list}"))?;
    for name in networks {
        let into = source.join("src").join(name);
        let files = copy(&root().join("models").join(name), &into)?;
        let card = into.join("card.md");
        let text = fs::read_to_string(&card).with_context(|| card.display().to_string())?;
        figures::write_text(&card, &chapter(name, &text, &files))?;
    }
    Ok(())
}

/// Copies a network's files, but no test sets; their names but the card's.
fn copy(from: &Path, into: &Path) -> Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in fs::read_dir(from).with_context(|| from.display().to_string())? {
        let entry = entry?;
        if entry.file_type()?.is_file() {
            command::copy(&entry.path(), &into.join(entry.file_name()))?;
            names.push(entry.file_name().to_string_lossy().into_owned());
        }
    }
    names.retain(|name| name != "card.md");
    names.sort();
    Ok(names)
}

/// A card by the network's name, since its title is that of the effect, with links to the files.
fn chapter(name: &str, card: &str, files: &[String]) -> String {
    let (_, body) = card.split_once('\n').unwrap_or_default();
    let mut chapter = format!("# {name}\n{body}\n## Download\n\n");
    for file in files {
        let _ = writeln!(chapter, "- [`{file}`]({file})");
    }
    chapter
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_book_has_every_card_with_its_files() {
        let source = std::env::temp_dir().join(format!("deepshade-networks-{}", std::process::id()));
        let networks = web::networks().expect("networks");
        stage(&source, &networks).expect("staged");
        let text = |file: &str| fs::read_to_string(source.join("src").join(file)).expect("a file");
        let (summary, small) = (text("SUMMARY.md"), text("ao-small/card.md"));
        let files = ["model.onnx", "net.json", "weights.safetensors"];
        let all_there = files.iter().all(|file| source.join("src/ao-small").join(file).is_file());
        let has_tests = source.join("src/ao/testset-small").exists();
        fs::remove_dir_all(&source).expect("deleted");
        assert!(networks.iter().all(|name| summary.contains(&format!("[{name}]({name}/card.md)"))));
        assert!(small.starts_with("# ao-small\n") && small.contains("| Effect | ao |"), "{small}");
        assert!(small.ends_with("- [`weights.safetensors`](weights.safetensors)\n"), "{small}");
        assert!(all_there && !has_tests);
    }
}
