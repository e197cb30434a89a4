//! `cargo xtask book`: the documentation as a book of web pages, by mdBook.

use crate::command::{command, succeeds, target};
use anyhow::{Result, bail};

/// Builds the book into the target folder.
///
/// # Errors
/// If mdBook is not installed or fails.
pub fn run() -> Result<()> {
    if !succeeds(&mut command("mdbook", &["--version"])) {
        bail!("mdbook is missing; install it with\n    cargo install mdbook --locked");
    }
    let into = target().join("book");
    let folder = into.display().to_string();
    crate::command::run(&mut command("mdbook", &["build", "book", "--dest-dir", &folder]))?;
    println!("{}", into.join("index.html").display());
    Ok(())
}
