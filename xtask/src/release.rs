//! `cargo xtask release`: all that people install, in one folder with checksums.

use crate::command::{self, cargo, command, root, succeeds, target};
use crate::package;
use crate::web::toolchain::has_target;
use anyhow::{Context, Result, bail, ensure};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

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
}

/// A tool, how to ask whether it is there, and how to get it.
const TOOLS: [(&[&str], &str); 4] = [
    (&["cargo", "deb", "--version"], "cargo install cargo-deb --locked"),
    (&["cargo", "cyclonedx", "--version"], "cargo install cargo-cyclonedx --locked"),
    (&["maturin", "--version"], "pip install 'maturin>=1.9.4,<2'"),
    (&["npm", "--version"], "apt-get install npm"),
];

/// What goes into the archive beside the program: from the repository, and where to. The program looks for
/// networks in `share` beside its own `bin`.
const ARCHIVED: [(&str, &str); 6] = [
    ("models", "share/deepshade"),
    ("dataset/recipes", "share/deepshade"),
    ("README.md", ""),
    ("CHANGELOG.md", ""),
    ("LICENSE-MIT", ""),
    ("LICENSE-APACHE", ""),
];

/// What is made for one machine, into one folder.
struct Release<'a> {
    version: String,
    triple: &'a str,
    /// Whether it is for this machine.
    is_native: bool,
    out: PathBuf,
}

/// Makes everything.
///
/// # Errors
/// If a tool is missing, or something does not build.
pub fn run(args: &Args) -> Result<()> {
    let missing = TOOLS.iter().filter(|(asks, _)| !succeeds(&mut command(asks[0], &asks[1..])));
    let missing: Vec<&str> = missing.map(|(_, install)| *install).collect();
    ensure!(missing.is_empty(), "tools are missing; install them with\n    {}", missing.join("\n    "));
    let (version, host) = (version()?, host()?);
    let triple = args.triple.as_deref().unwrap_or(&host);
    if triple != host && !has_target(triple)? {
        bail!("there is no standard library for {triple}: rustup target add {triple}");
    }
    let usual = || target().join(format!("release-{version}"));
    let out = std::path::absolute(args.out.clone().unwrap_or_else(usual))?;
    fs::create_dir_all(&out).with_context(|| out.display().to_string())?;
    let release = Release { version, triple, is_native: triple == host, out };
    let program = release.program()?;
    release.archive(&program)?;
    release.debian_package()?;
    release.wheel()?;
    release.for_npm()?;
    release.for_blender()?;
    release.components()?;
    release.checksums()
}

impl Release<'_> {
    /// Builds the program as packages have it.
    fn program(&self) -> Result<PathBuf> {
        let words = [&package::BUILD[..], &["--target", self.triple]].concat();
        command::run(&mut cargo(if self.is_native { &package::BUILD[..] } else { &words }))?;
        let folder = if self.is_native { target() } else { target().join(self.triple) };
        Ok(folder.join("release/deepshade"))
    }

    /// `deepshade-VERSION-TRIPLE.tar.gz`: `bin`, `share` and documents in a folder of that name.
    fn archive(&self, program: &Path) -> Result<()> {
        let name = format!("deepshade-{}-{}", self.version, self.triple);
        let stage = target().join("release-stage");
        let folder = stage.join(&name);
        if folder.exists() {
            fs::remove_dir_all(&folder).with_context(|| folder.display().to_string())?;
        }
        package::copy(program, &folder.join("bin/deepshade"))?;
        for (from, to) in ARCHIVED {
            package::copy(&root().join(from), &folder.join(to).join(file_name(Path::new(from))?))?;
        }
        let archive = self.out.join(format!("{name}.tar.gz")).display().to_string();
        let stage = stage.display().to_string();
        // Test sets are for those who have the repository.
        let plain = ["--owner=0", "--group=0", "--numeric-owner", "--sort=name", "--exclude=testset*"];
        let words = [&plain[..], &["-C", &stage, "-czf", &archive, &name]].concat();
        command::run(&mut command("tar", &words))?;
        fs::remove_dir_all(&folder).with_context(|| folder.display().to_string())
    }

    fn debian_package(&self) -> Result<()> {
        let out = self.out.display().to_string();
        let words = ["deb", "--no-build", "--locked", "--output", &out];
        let of_target = [&words[..], &["--target", self.triple]].concat();
        command::run(&mut cargo(if self.is_native { &words[..] } else { &of_target }))
    }

    /// For pip: the program beside the Python package.
    fn wheel(&self) -> Result<()> {
        let out = self.out.display().to_string();
        let words = ["build", "--release", "--strip", "--features", "store", "--out", &out];
        let of_target = [&words[..], &["--target", self.triple]].concat();
        let words = if self.is_native { &words[..] } else { &of_target };
        command::run(command("maturin", words).current_dir(root().join("python")))
    }

    fn for_npm(&self) -> Result<()> {
        let out = self.out.display().to_string();
        let words = ["pack", "--silent", "--pack-destination", &out];
        command::run(command("npm", &words).current_dir(root().join("js")))
    }

    /// Blender installs an add-on from its one file.
    fn for_blender(&self) -> Result<()> {
        let addon = root().join("blender/deepshade_addon.py");
        // Its name is that of a Python module.
        package::copy(&addon, &self.out.join("deepshade_addon.py"))
    }

    /// The list of components in CycloneDX's form, of the program's features.
    fn components(&self) -> Result<()> {
        let name = format!("deepshade-{}-{}.cdx", self.version, self.triple);
        let features = ["--features", "store", "--target", self.triple];
        let words = [&["cyclonedx", "--format", "json", "--override-filename", &name][..], &features];
        let written = command::run(&mut cargo(&words.concat()));
        let file = format!("{name}.json");
        let copied = written.and_then(|()| package::copy(&root().join(&file), &self.out.join(&file)));
        // It writes one beside each manifest.
        for folder in members()? {
            let beside = folder.join(&file);
            if beside.is_file() {
                fs::remove_file(&beside).with_context(|| beside.display().to_string())?;
            }
        }
        copied
    }

    /// `SHA256SUMS` of all files of the folder, as sha256sum checks them.
    fn checksums(&self) -> Result<()> {
        const SUMS: &str = "SHA256SUMS";
        let mut names = Vec::new();
        for entry in fs::read_dir(&self.out).with_context(|| self.out.display().to_string())? {
            let entry = entry?;
            if entry.file_type()?.is_file() {
                names.push(entry.file_name().to_string_lossy().into_owned());
            }
        }
        names.retain(|name| name != SUMS);
        names.sort();
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

/// The repository's root and the folders in it.
fn members() -> Result<Vec<PathBuf>> {
    let entries = fs::read_dir(root()).context("the repository's root")?;
    let inside = entries.map(|entry| Ok(entry?.path()));
    std::iter::once(Ok(root())).chain(inside).collect()
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
