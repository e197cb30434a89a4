//! `cargo xtask release`: all that people install, in one folder with checksums.

mod clean_root;
mod container;
mod steps;
mod tried;

use crate::command::{self, cargo, command, root, succeeds, target};
use crate::figures;
use crate::web::toolchain::has_target;
use anyhow::{Context, Result, bail, ensure};
use serde_json::{Map, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;
use steps::{STEPS, Step};

/// Builds the program that can do everything that needs nothing more of the system.
const BUILD: [&str; 5] = ["build", "--release", "--locked", FEATURES[0], FEATURES[1]];
/// Its features, as cargo is told them.
const FEATURES: [&str; 2] = ["--features", "store"];

/// What is made, and of what.
#[derive(clap::Args)]
pub struct Args {
    /// The machine that programs are for, with Linux, such as aarch64-unknown-linux-gnu; by default this one.
    /// For another one rustup has to have its standard library, and cargo its linker
    /// (CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER=aarch64-linux-gnu-gcc).
    #[arg(long = "target", value_name = "TRIPLE")]
    triple: Option<String>,
    /// The folder; by default release-VERSION below the target folder.
    #[arg(long)]
    out: Option<PathBuf>,
    /// Installs archive, Debian package and wheel, what `cargo install` makes, and what the container file
    /// says, each in a clean root of its own (debootstrap, as root), and runs the program there. The npm
    /// package and the add-on are tried by `cargo xtask hosts`.
    #[arg(long = "try", conflicts_with = "triple")]
    tried: bool,
    /// Writes the figures here as JSON: the size of each file, how long it took to make it, and with --try
    /// how long to install it.
    #[arg(long)]
    json: Option<PathBuf>,
}

/// A tool, how to ask whether it is there, and how to get it.
const TOOLS: [(&[&str], &str); 4] = [
    (&["cargo", "deb", "--version"], "cargo install cargo-deb --locked"),
    (&["cargo", "cyclonedx", "--version"], "cargo install cargo-cyclonedx --locked"),
    (&["maturin", "--version"], "pip install 'maturin>=1.9.4,<2'"),
    (&["npm", "--version"], "apt-get install npm"),
];

/// What is made for one machine, into one folder.
struct Release {
    version: String,
    triple: String,
    /// Whether it is for this machine.
    is_native: bool,
    out: PathBuf,
}

/// What was made.
struct Made {
    /// As figures call it.
    name: &'static str,
    file: String,
    bytes: u64,
    seconds: f64,
}

/// Makes everything.
///
/// # Errors
/// If a tool is missing, or something does not build.
pub fn run(args: &Args) -> Result<()> {
    let missing = TOOLS.iter().filter(|(asks, _)| !succeeds(&mut command(asks[0], &asks[1..])));
    let missing: Vec<&str> = missing.map(|(_, install)| *install).collect();
    ensure!(missing.is_empty(), "tools are missing; install them with\n    {}", missing.join("\n    "));
    if args.tried {
        clean_root::clean()?;
    }
    let (version, host) = (version()?, host()?);
    let triple = args.triple.clone().unwrap_or_else(|| host.clone());
    let is_native = triple == host;
    if !is_native && !has_target(&triple)? {
        bail!("there is no standard library for {triple}: rustup target add {triple}");
    }
    let usual = || target().join(format!("release-{version}"));
    let out = std::path::absolute(args.out.clone().unwrap_or_else(usual))?;
    fs::create_dir_all(&out).with_context(|| out.display().to_string())?;
    let release = Release { version, triple, is_native, out };
    let mut made = vec![release.build()?];
    for step in STEPS {
        made.push(release.make(step)?);
    }
    release.checksums()?;
    let mut figures: Vec<(String, f64)> = made.iter().flat_map(Made::figures).collect();
    let files: Map<_, _> = made.iter().map(|one| (one.name.to_owned(), json!(one.file))).collect();
    let details = json!({ "version": release.version, "target": release.triple, "files": files });
    figures::write(args.json.as_deref(), "release", &figures, details.clone())?;
    if args.tried {
        figures.extend(tried::try_all(&release.out, &made)?);
        figures::write(args.json.as_deref(), "release", &figures, details)?;
    }
    Ok(())
}

impl Made {
    /// Of a file that was made since some time.
    fn since(begin: Instant, name: &'static str, path: &Path) -> Result<Self> {
        let seconds = begin.elapsed().as_secs_f64();
        let bytes = path.metadata().with_context(|| path.display().to_string())?.len();
        let file = file_name(path)?.to_string_lossy().into_owned();
        Ok(Self { name, file, bytes, seconds })
    }

    fn figures(&self) -> [(String, f64); 2] {
        let Self { name, bytes, seconds, .. } = self;
        [(format!("mb_{name}"), *bytes as f64 / 1e6), (format!("seconds_{name}"), *seconds)]
    }
}

impl Release {
    /// Builds the program as packages have it.
    fn build(&self) -> Result<Made> {
        let begin = Instant::now();
        let words = [&BUILD[..], &["--target", &self.triple]].concat();
        command::run(&mut cargo(if self.is_native { &BUILD[..] } else { &words }))?;
        Made::since(begin, "program", &self.program())
    }

    /// Where the program is built.
    fn program(&self) -> PathBuf {
        let folder = if self.is_native { target() } else { target().join(&self.triple) };
        folder.join("release/deepshade")
    }

    /// Makes a file in a folder of its own, so that it is known which one it is, and puts it to the others.
    fn make(&self, (name, step): Step) -> Result<Made> {
        let begin = Instant::now();
        let stage = empty(&target().join("release-stage").join(name))?;
        step(self, &stage).with_context(|| name.to_owned())?;
        let files = files(&stage)?;
        let [file] = &files[..] else { bail!("{name}: not one file but {}", files.join(", ")) };
        command::copy(&stage.join(file), &self.out.join(file))?;
        let made = Made::since(begin, name, &self.out.join(file))?;
        fs::remove_dir_all(&stage).with_context(|| stage.display().to_string())?;
        Ok(made)
    }

    /// `SHA256SUMS` of all files of the folder, as sha256sum checks them.
    fn checksums(&self) -> Result<()> {
        const SUMS: &str = "SHA256SUMS";
        let mut names = files(&self.out)?;
        names.retain(|name| name != SUMS);
        let output = output(command("sha256sum", &names).current_dir(&self.out))?;
        fs::write(self.out.join(SUMS), &output)?;
        for name in names {
            let bytes = self.out.join(&name).metadata()?.len();
            println!("{:>8.1} MB  {name}", bytes as f64 / 1e6);
        }
        println!("{}", self.out.display());
        Ok(())
    }
}

/// A folder with nothing in it.
fn empty(folder: &Path) -> Result<PathBuf> {
    let cleared = if folder.exists() { fs::remove_dir_all(folder) } else { Ok(()) };
    let made = cleared.and_then(|()| fs::create_dir_all(folder));
    made.with_context(|| folder.display().to_string())?;
    Ok(folder.to_owned())
}

/// Names of the files in a folder.
fn files(folder: &Path) -> Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let entry = entry?;
        if entry.file_type()?.is_file() {
            names.push(entry.file_name().to_string_lossy().into_owned());
        }
    }
    names.sort();
    Ok(names)
}

fn file_name(path: &Path) -> Result<&std::ffi::OsStr> {
    path.file_name().with_context(|| path.display().to_string())
}

/// The workspace's version.
fn version() -> Result<String> {
    let manifest = fs::read_to_string(root().join("Cargo.toml")).context("Cargo.toml")?;
    let line = manifest.lines().find_map(|line| line.strip_prefix("version = \""));
    let version = line.and_then(|line| line.strip_suffix('"'));
    version.map(str::to_owned).context("Cargo.toml says no version")
}

/// The machine that this compiler runs on.
fn host() -> Result<String> {
    let said = output(&mut command("rustc", &["--version", "--verbose"]))?;
    let host = said.lines().find_map(|line| line.strip_prefix("host: "));
    host.map(str::to_owned).context("rustc does not say its host")
}

/// What a command prints.
fn output(command: &mut Command) -> Result<String> {
    let output = command.output()?;
    ensure!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr).trim());
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_say_of_which_file_they_are() {
        let made = Made { name: "wheel", file: "a.whl".to_owned(), bytes: 2_500_000, seconds: 3.0 };
        assert_eq!(made.figures(), [("mb_wheel".to_owned(), 2.5), ("seconds_wheel".to_owned(), 3.0)]);
        let names: std::collections::BTreeSet<_> = STEPS.iter().map(|(name, _)| name).collect();
        assert_eq!(names.len(), STEPS.len(), "one figure of two files");
    }
}
