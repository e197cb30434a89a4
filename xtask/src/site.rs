//! `cargo xtask site`: the web page, the book, the library's documentation and the networks as one folder of
//! static files, which any web server can host.

use crate::command::{self, cargo, root, target};
use crate::{book, web};
use anyhow::{Context, Result};
use std::fs;
use std::path::{Path, PathBuf};

/// Where the site goes.
#[derive(clap::Args)]
pub struct Args {
    /// Its folder, by default below the target folder.
    #[arg(long)]
    out: Option<PathBuf>,
}

/// The first page, which leads to the others.
const INDEX: &str = include_str!("site/index.html");

/// Builds everything into the folder.
///
/// # Errors
/// If a tool is missing, or something does not build.
pub fn run(args: &Args) -> Result<()> {
    let out = std::path::absolute(args.out.clone().unwrap_or_else(|| target().join("site")))?;
    book::build(&out.join("book"))?;
    document(&out.join("library"))?;
    networks(&out.join("networks"))?;
    web::build(&out.join("page"))?;
    let index = out.join("index.html");
    fs::write(&index, INDEX).with_context(|| index.display().to_string())?;
    println!("{}", index.display());
    Ok(())
}

/// The library's documentation.
fn document(into: &Path) -> Result<()> {
    let words = ["doc", "--release", "--locked", "--workspace", "--exclude", "xtask", "--no-deps", "--lib"];
    command::run(&mut cargo(&words))?;
    copy_all(&target().join("doc"), into)
}

/// The shipped networks, without the test sets of the repository.
fn networks(into: &Path) -> Result<()> {
    let shipped = root().join("models");
    for folder in fs::read_dir(&shipped).with_context(|| shipped.display().to_string())? {
        let folder = folder?.path();
        if folder.join("net.json").is_file() {
            copy_files(&folder, &into.join(folder.file_name().unwrap_or_default()))?;
        }
    }
    Ok(())
}

/// Copies a folder with all that is in it.
fn copy_all(from: &Path, to: &Path) -> Result<()> {
    copy_files(from, to)?;
    for entry in fs::read_dir(from).with_context(|| from.display().to_string())? {
        let entry = entry?;
        if entry.file_type()?.is_dir() {
            copy_all(&entry.path(), &to.join(entry.file_name()))?;
        }
    }
    Ok(())
}

/// Copies the files of a folder.
fn copy_files(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to).with_context(|| to.display().to_string())?;
    for entry in fs::read_dir(from).with_context(|| from.display().to_string())? {
        let entry = entry?;
        if entry.file_type()?.is_file() {
            let to = to.join(entry.file_name());
            fs::copy(entry.path(), &to).with_context(|| to.display().to_string())?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_copied_with_what_is_below_it() {
        let folder = tempfile::tempdir().expect("a folder");
        let (from, to) = (folder.path().join("from"), folder.path().join("to"));
        fs::create_dir_all(from.join("a/b")).expect("folders");
        fs::write(from.join("one"), "1").expect("a file");
        fs::write(from.join("a/b/two"), "2").expect("a file");
        copy_all(&from, &to).expect("copied");
        assert_eq!(fs::read_to_string(to.join("one")).expect("the file"), "1");
        assert_eq!(fs::read_to_string(to.join("a/b/two")).expect("the file"), "2");
        copy_files(&from, &folder.path().join("flat")).expect("copied");
        assert!(!folder.path().join("flat/a").exists());
        assert!(copy_all(&folder.path().join("nothing"), &to).is_err());
    }
}
