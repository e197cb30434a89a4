//! `cargo xtask book`: the documentation as a book of web pages, by mdBook.

use crate::command::{command, root, succeeds, target};
use anyhow::{Result, bail};
use std::path::Path;

/// Builds the book into the target folder.
///
/// # Errors
/// If mdBook is not installed or fails.
pub fn run() -> Result<()> {
    let into = target().join("book");
    build(&root().join("book"), &into)?;
    println!("{}", into.join("index.html").display());
    Ok(())
}

/// Builds a book's source into a folder.
///
/// # Errors
/// If mdBook is not installed or fails.
pub fn build(source: &Path, into: &Path) -> Result<()> {
    if !succeeds(&mut command("mdbook", &["--version"])) {
        bail!("mdbook is missing; install it with\n    cargo install mdbook --locked");
    }
    let [source, into] = [source, into].map(|path| path.display().to_string());
    crate::command::run(&mut command("mdbook", &["build", &source, "--dest-dir", &into]))
}
