//! `cargo xtask site`: all that people read or try in a browser, as static files that any web server can host:
//! the book, the documentation of the crates, the page of methods, and the networks.

use crate::command::{self, cargo, root, target};
use crate::{book, figures, package, web};
use anyhow::{Context, Result};
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

/// The site's first page; a line stands for the networks.
const INDEX: &str = include_str!("site/index.html");
const NETWORKS: &str = "<!-- networks -->\n";
/// The crates whose documentation is part of it.
const CRATES: [&str; 5] =
    ["deepshade-shaders", "deepshade-render", "deepshade-infer", "deepshade-dataset", "deepshade-train"];
/// The files of a network that people download.
const OF_NETWORK: [&str; 4] = ["card.md", "net.json", "weights.safetensors", "model.onnx"];

/// Where it is made.
#[derive(clap::Args)]
pub struct Args {
    /// Its folder, by default below the target folder.
    #[arg(long)]
    out: Option<PathBuf>,
    /// Serves it to this machine.
    #[arg(long)]
    serve: bool,
}

/// Makes the site, and serves it where that is asked for.
///
/// # Errors
/// If something is missing and cannot be installed, or does not build.
pub fn run(args: Args) -> Result<()> {
    let out = std::path::absolute(args.out.unwrap_or_else(|| target().join("site")))?;
    book::build(&out.join("book"))?;
    documentation(&out.join("doc"))?;
    web::build(&out.join("page"))?;
    let networks = networks(&out.join("models"))?;
    figures::write_text(&out.join("index.html"), &index(&networks))?;
    println!("{}", out.join("index.html").display());
    if args.serve { web::serve::Server::start(&out)?.wait() } else { Ok(()) }
}

/// The crates' documentation.
fn documentation(into: &Path) -> Result<()> {
    let crates = CRATES.iter().flat_map(|name| ["--package", name]);
    let words: Vec<&str> = ["doc", "--release", "--locked", "--no-deps"].into_iter().chain(crates).collect();
    command::run(&mut cargo(&words))?;
    if into.exists() {
        fs::remove_dir_all(into).with_context(|| into.display().to_string())?;
    }
    package::copy(&target().join("doc"), into)
}

/// Copies the shipped networks; their names.
fn networks(into: &Path) -> Result<Vec<String>> {
    let shipped = root().join("models");
    let mut names = Vec::new();
    for folder in fs::read_dir(&shipped).with_context(|| shipped.display().to_string())? {
        let folder = folder?;
        if !folder.path().join(OF_NETWORK[0]).is_file() {
            continue;
        }
        for file in OF_NETWORK {
            package::copy(&folder.path().join(file), &into.join(folder.file_name()).join(file))?;
        }
        names.push(folder.file_name().to_string_lossy().into_owned());
    }
    names.sort();
    Ok(names)
}

/// The first page, with links to the networks of these names.
fn index(networks: &[String]) -> String {
    let mut rows = String::new();
    for name in networks {
        let links = OF_NETWORK.map(|file| format!("<a href=\"models/{name}/{file}\">{file}</a>"));
        let _ = writeln!(rows, "<tr><td>{name}</td><td>{}</td></tr>", links.join(" "));
    }
    INDEX.replace(NETWORKS, &rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_page_links_all_parts_and_every_file_of_a_network() {
        let page = index(&["ao".to_owned()]);
        for link in ["book/", "doc/deepshade_infer/", "page/", "models/ao/model.onnx", "models/ao/card.md"] {
            assert!(page.contains(&format!("href=\"{link}")), "{link}");
        }
        assert!(INDEX.contains(NETWORKS) && !page.contains(NETWORKS));
    }
}
