//! `cargo xtask web`: the web page, as static files that any web server can host.
//!
//! The program is compiled to WebAssembly: with the toolchain's own target where it is installed or rustup can add it,
//! else with Debian's compiler of Rust for browsers, which builds the standard library from source. What the page shows
//! where a browser has no WebGPU is recorded by the program on this machine.

#[cfg(feature = "browser")]
mod browser;
mod serve;
pub mod toolchain;

use crate::command::{self, cargo, command, root, target};
use crate::program::Program;
use crate::{figures, vulkan};
use anyhow::{Context, Result, bail, ensure};
use std::fs;
use std::path::{Path, PathBuf};

/// The page's own files, and the style that it shares with the pages of comparisons.
const STATIC: &str = "src/web/static";
const STYLE: &str = "src/report/page.css";
/// The files of a network that the page reads.
const OF_MODEL: [&str; 2] = ["net.json", "weights.safetensors"];

/// What is asked for.
struct Args {
    out: PathBuf,
    serve: bool,
    test: bool,
    json: Option<PathBuf>,
}

/// Builds the page, and serves or tests it where that is asked for.
///
/// # Errors
/// If something is missing and cannot be installed, does not build, or the page fails its test.
pub fn run(args: &[String]) -> Result<()> {
    let args = read(args)?;
    if args.test && !cfg!(feature = "browser") {
        // What drives a browser is much to build for whoever wants none.
        return again(&args);
    }
    build(&args.out)?;
    println!("{}", args.out.join("index.html").display());
    if args.test {
        test(&args)?;
    }
    if args.serve { serve::forever(&args.out) } else { Ok(()) }
}

fn read(args: &[String]) -> Result<Args> {
    let (json, rest) = figures::json_argument(args)?;
    let mut read = Args { out: target().join("web-page"), serve: false, test: false, json };
    let mut rest = rest.iter();
    while let Some(arg) = rest.next() {
        match arg.as_str() {
            "--out" => read.out = std::path::absolute(rest.next().context("--out wants a folder")?)?,
            "--serve" => read.serve = true,
            "--test" => read.test = true,
            other => bail!("do not understand `{other}`; `cargo xtask help` lists what there is"),
        }
    }
    ensure!(read.test || read.json.is_none(), "--json has the figures of --test");
    Ok(read)
}

/// The same with what drives a browser.
fn again(args: &Args) -> Result<()> {
    let mut words =
        ["run", "--quiet", "--locked", "--package", "xtask", "--features", "browser", "--", "web", "--test"]
            .map(str::to_owned)
            .to_vec();
    words.extend(["--out".to_owned(), args.out.display().to_string()]);
    if let Some(json) = &args.json {
        words.extend(["--json".to_owned(), std::path::absolute(json)?.display().to_string()]);
    }
    words.extend(args.serve.then(|| "--serve".to_owned()));
    command::run(&mut cargo(&words))
}

#[cfg(feature = "browser")]
fn test(args: &Args) -> Result<()> {
    browser::test(&args.out, args.json.as_deref())
}

#[cfg(not(feature = "browser"))]
fn test(_: &Args) -> Result<()> {
    bail!("built without what drives a browser")
}

/// Builds everything into a folder.
fn build(out: &Path) -> Result<()> {
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
    Program::build()?.run(&["web", "--out", &out.join("recorded").display().to_string()])
}

/// The shipped networks, and their list.
fn models(into: &Path) -> Result<()> {
    let shipped = root().join("models");
    let folders = fs::read_dir(&shipped).with_context(|| shipped.display().to_string())?;
    let mut names = Vec::new();
    for folder in folders {
        let folder = folder?;
        if !folder.path().join(OF_MODEL[0]).is_file() {
            continue;
        }
        let to = into.join(folder.file_name());
        fs::create_dir_all(&to).with_context(|| to.display().to_string())?;
        for file in OF_MODEL {
            copy(&folder.path().join(file), &to.join(file))?;
        }
        names.push(format!("\"{}\"", folder.file_name().to_string_lossy()));
    }
    names.sort();
    figures::write(&into.join("models.json"), &format!("[{}]\n", names.join(", ")))
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    fs::copy(from, to).with_context(|| format!("{} to {}", from.display(), to.display()))?;
    Ok(())
}
