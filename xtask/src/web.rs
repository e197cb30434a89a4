//! `cargo xtask web`: the web page, as static files that any web server can host.
//!
//! The program is compiled to WebAssembly: with the toolchain's own target where it is installed or rustup
//! can add it, else with Debian's compiler of Rust for browsers, which builds the standard library from
//! source. What the page shows where a browser has no WebGPU is recorded by the program on this machine.

#[cfg(feature = "browser")]
mod browser;
pub mod serve;
pub mod toolchain;

use crate::command::{self, cargo, command, root, target};
use crate::program::{Program, WITH_STUDIES};
use crate::{figures, vulkan};
use anyhow::{Context, Result};
use serde_json::json;
use serve::Server;
use std::fs;
use std::path::{Path, PathBuf};

/// The page's own files, and the style that it shares with the pages of comparisons.
pub const STATIC: &str = "src/web/static";
const STYLE: &str = "src/report/page.css";
/// The folder of shipped networks, and the files of one that the page reads.
const MODELS: &str = "models";
const OF_MODEL: [&str; 2] = ["net.json", "weights.safetensors"];

/// What is done with the page.
#[derive(clap::Args)]
pub struct Args {
    /// Its folder, by default below the target folder.
    #[arg(long)]
    out: Option<PathBuf>,
    /// Serves it to this machine.
    #[arg(long)]
    serve: bool,
    /// Drives headless Chromium, installed where it is missing: images must be those of the program, slider
    /// and figures must work.
    #[arg(long)]
    test: bool,
    /// Writes the figures of the test here as JSON.
    #[arg(long, requires = "test")]
    json: Option<PathBuf>,
}

/// Builds the page, and serves or tests it where that is asked for.
///
/// # Errors
/// If something is missing and cannot be installed, does not build, or the page fails its test.
pub fn run(args: Args) -> Result<()> {
    if args.test && !cfg!(feature = "browser") {
        // What drives a browser is much to build for whoever wants none.
        return again();
    }
    let out = std::path::absolute(args.out.unwrap_or_else(|| target().join("web-page")))?;
    build(&out)?;
    println!("{}", out.join("index.html").display());
    #[cfg(feature = "browser")]
    if args.test {
        browser::test(&out, args.json.as_deref())?;
    }
    if args.serve { Server::start(&out)?.wait() } else { Ok(()) }
}

/// The same command line with what drives a browser.
pub fn again() -> Result<()> {
    let words = ["run", "--quiet", "--locked", "--package", "xtask", "--features", "browser", "--"];
    let mut again = cargo(&words);
    command::run(again.args(std::env::args_os().skip(1)).current_dir("."))
}

/// Builds everything into a folder.
///
/// # Errors
/// If something is missing and cannot be installed, or does not build.
pub fn build(out: &Path) -> Result<()> {
    fs::create_dir_all(out).with_context(|| out.display().to_string())?;
    let module = toolchain::compile()?;
    let bindgen = toolchain::bindgen()?;
    let [into, module] = [out, &module].map(|path| path.display().to_string());
    let words =
        ["--target", "web", "--no-typescript", "--out-dir", &into, "--out-name", "deepshade", &module];
    command::run(&mut command(&bindgen.display().to_string(), &words))?;
    for file in fs::read_dir(root().join(STATIC)).context(STATIC)? {
        let file = file?;
        copy(&file.path(), &out.join(file.file_name()))?;
    }
    copy(&root().join(STYLE), &out.join("report.css"))?;
    models(&out.join("models"))?;
    vulkan::ensure()?;
    Program::build_by(&WITH_STUDIES)?;
    Program::studies().run(&["web", "--out", &out.join("recorded").display().to_string()])
}

/// Copies the shipped networks, and writes their list.
fn models(into: &Path) -> Result<()> {
    let names = networks()?;
    for name in &names {
        let (from, to) = (root().join(MODELS).join(name), into.join(name));
        fs::create_dir_all(&to).with_context(|| to.display().to_string())?;
        for file in OF_MODEL {
            copy(&from.join(file), &to.join(file))?;
        }
    }
    figures::write_text(&into.join("models.json"), &format!("{}\n", json!(names)))
}

/// The names of the shipped networks, in order.
///
/// # Errors
/// If their folder cannot be read.
pub fn networks() -> Result<Vec<String>> {
    let mut names = Vec::new();
    for folder in fs::read_dir(root().join(MODELS)).context(MODELS)? {
        let folder = folder?;
        if folder.path().join(OF_MODEL[0]).is_file() {
            names.push(folder.file_name().to_string_lossy().into_owned());
        }
    }
    names.sort();
    Ok(names)
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    fs::copy(from, to).with_context(|| format!("{} to {}", from.display(), to.display()))?;
    Ok(())
}
