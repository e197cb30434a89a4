//! `cargo xtask site`: the web page, the book, the library's documentation and the networks as one folder of
//! static files, which any web server can host.

mod first;
mod library;
mod links;
mod networks;

use crate::command::{root, target};
use crate::{book, figures, web};
use anyhow::{Context, Result, ensure};
use serde_json::json;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Where the site goes.
#[derive(clap::Args)]
pub struct Args {
    /// Its folder, by default below the target folder. A site that is there is replaced when all is made.
    #[arg(long)]
    out: Option<PathBuf>,
    /// Writes the figures here as JSON: megabytes and seconds.
    #[arg(long)]
    json: Option<PathBuf>,
}

/// A folder of the site, and what makes it.
type Part = (&'static str, fn(&Path) -> Result<()>);

/// The quick ones first, so that a missing tool is found soon.
const PARTS: [Part; 4] = [
    ("book", |into| book::build(&root().join("book"), into)),
    ("networks", networks::make),
    ("library", library::make),
    ("page", web::build),
];
/// The first page.
const INDEX: &str = "index.html";
/// Pages with links that are made here.
const LINKING: [&str; 3] = [INDEX, "library/index.html", "networks/index.html"];

/// Makes everything beside the folder, checks links, and puts it in the folder's place.
///
/// # Errors
/// If a tool is missing, something does not build, a link leads nowhere, or the folder is no site.
pub fn run(args: &Args) -> Result<()> {
    let begin = Instant::now();
    let out = std::path::absolute(args.out.clone().unwrap_or_else(|| target().join("site")))?;
    ensure_replaceable(&out)?;
    let partial = beside(&out, "partial")?;
    remove(&partial)?;
    let mut found = Vec::new();
    for (part, make) in PARTS {
        found.extend(made(part, make, &partial)?);
    }
    figures::write_text(&partial.join(INDEX), &first::page(&web::networks()?))?;
    for page in LINKING {
        links::check(&partial.join(page)).with_context(|| page.to_owned())?;
    }
    replace(&out, &partial)?;
    found.push(("megabytes".to_owned(), megabytes(&out)?));
    found.push(("seconds".to_owned(), begin.elapsed().as_secs_f64()));
    for (name, value) in &found {
        println!("{name} {value:.1}");
    }
    println!("{}", out.join(INDEX).display());
    figures::write(args.json.as_deref(), "site", &found, json!({}))
}

/// Makes a part; its size and what it took.
fn made(part: &str, make: fn(&Path) -> Result<()>, site: &Path) -> Result<[(String, f64); 2]> {
    let begin = Instant::now();
    let folder = site.join(part);
    fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    make(&folder).with_context(|| part.to_owned())?;
    let seconds = begin.elapsed().as_secs_f64();
    Ok([(format!("megabytes_{part}"), megabytes(&folder)?), (format!("seconds_{part}"), seconds)])
}

/// Refuses a folder with anything in it that is not of a site, since all in it goes.
fn ensure_replaceable(out: &Path) -> Result<()> {
    if !out.exists() {
        return Ok(());
    }
    let mut is_empty = true;
    for entry in fs::read_dir(out).with_context(|| out.display().to_string())? {
        let name = entry?.file_name();
        let is_ours = name == INDEX || PARTS.iter().any(|(part, _)| name == *part);
        ensure!(is_ours, "{} is no site: it holds {}", out.display(), name.display());
        is_empty = false;
    }
    let is_site = PARTS.iter().all(|(part, _)| out.join(part).is_dir());
    ensure!(is_site || is_empty, "{} is no site: it lacks a part of one", out.display());
    Ok(())
}

/// Puts a whole folder in the place of another.
fn replace(out: &Path, partial: &Path) -> Result<()> {
    let old = beside(out, "old")?;
    remove(&old)?;
    if out.exists() {
        fs::rename(out, &old).with_context(|| out.display().to_string())?;
    }
    fs::rename(partial, out).with_context(|| out.display().to_string())?;
    remove(&old)
}

/// A hidden folder beside one.
fn beside(out: &Path, word: &str) -> Result<PathBuf> {
    let name = out.file_name().with_context(|| format!("{} has no name", out.display()))?;
    Ok(out.with_file_name(format!(".{}-{word}", name.display())))
}

/// Removes a folder if it is there.
fn remove(folder: &Path) -> Result<()> {
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| folder.display().to_string())?;
    }
    Ok(())
}

/// The size of all files below a folder.
fn megabytes(folder: &Path) -> Result<f64> {
    let mut sum = 0.0;
    for entry in fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let entry = entry?;
        sum += match entry.file_type()?.is_dir() {
            true => megabytes(&entry.path())?,
            false => entry.metadata()?.len() as f64 / 1e6,
        };
    }
    Ok(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_site_is_replaced_whole_and_nothing_else_is() {
        let folder = std::env::temp_dir().join(format!("deepshade-site-{}", std::process::id()));
        let (out, partial) = (folder.join("site"), beside(&folder.join("site"), "partial").expect("a name"));
        figures::write_text(&out.join("book/stale.html"), "old").expect("written");
        figures::write_text(&partial.join("book/new.html"), "news").expect("written");
        ensure_replaceable(&out).expect_err("a folder that is called as a part of one");
        PARTS.iter().for_each(|(part, _)| fs::create_dir_all(out.join(part)).expect("made"));
        ensure_replaceable(&out).expect("a site");
        replace(&out, &partial).expect("replaced");
        assert!(out.join("book/new.html").is_file() && !out.join("book/stale.html").exists());
        assert_eq!(fs::read_dir(&folder).expect("a folder").count(), 1);
        assert!((megabytes(&out).expect("a size") - 4e-6).abs() < 1e-12);
        fs::write(out.join("thesis.tex"), "").expect("written");
        let refused = ensure_replaceable(&out).expect_err("no site").to_string();
        fs::remove_dir_all(&folder).expect("deleted");
        assert!(refused.ends_with("it holds thesis.tex"), "{refused}");
    }
}
