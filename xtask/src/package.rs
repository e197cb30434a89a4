//! `cargo xtask package`: the Debian package, and with `--try` all ways of installing, each in a clean root.

mod container;
mod root;

use crate::command::{self, cargo, command, succeeds, target};
use crate::figures;
use crate::program::Program;
use anyhow::{Context, Result, bail, ensure};
use root::Root;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What is tried once it is installed: the version, and a network on the GPU beside an analytic method and
/// truth.
const TRIALS: [&str; 2] = [
    "deepshade --version",
    "cd /tmp && XDG_RUNTIME_DIR=/tmp deepshade compare --scene stairs:7 --effect ao --methods \
    truth,hbao,learned \
     --width 64 --height 64 --samples 16 --out report && test -s report/index.html",
];
/// What is packaged: the program that can do everything that needs nothing more of the system.
pub const BUILD: [&str; 5] = ["build", "--release", "--locked", "--features", "store"];
/// What programs need of the system, where no package says so.
const LIBRARIES: &str = "libvulkan1 mesa-vulkan-drivers";

/// What is done with the package.
#[derive(clap::Args)]
pub struct Args {
    /// Installs it, what `cargo install` makes, and what the container file says, each in a clean root of its
    /// own (debootstrap, as root), and runs the program there.
    #[arg(long = "try")]
    tried: bool,
    /// Writes the figures here as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
}

/// Makes the package, and tries it if it is asked to.
///
/// # Errors
/// If a tool is missing, something does not build, or what was installed does not work.
pub fn run(args: &Args) -> Result<()> {
    if !succeeds(&mut cargo(&["deb", "--version"])) {
        bail!("cargo-deb is missing; install it with\n    cargo install cargo-deb --locked");
    }
    Program::build_by(&BUILD)?;
    let package = target().join("debian/deepshade.deb");
    let out = package.display().to_string();
    command::run(&mut cargo(&["deb", "--no-build", "--locked", "--output", &out]))?;
    let bytes = package.metadata().with_context(|| out.clone())?.len();
    let mut figures = vec![("package_bytes".to_owned(), bytes as f64)];
    println!("{out}: {bytes} bytes");
    if args.tried {
        for (name, way) in WAYS {
            let begin = Instant::now();
            way(&package).with_context(|| name.to_owned())?;
            println!("{name}: works");
            figures.push((format!("{name}_works"), 1.0));
            figures.push((format!("{name}_seconds"), begin.elapsed().as_secs_f64()));
        }
    }
    figures::write(args.json.as_deref(), "package", &figures, json!({}))
}

type Way = (&'static str, fn(&Path) -> Result<()>);

/// Each leads to a program that works.
const WAYS: [Way; 3] = [("package", by_package), ("cargo_install", by_cargo), ("container", by_container)];

fn by_package(package: &Path) -> Result<()> {
    let root = Root::new("package")?;
    root.put(package, "tmp/deepshade.deb")?;
    root.run("apt-get update --quiet && apt-get install --yes --quiet /tmp/deepshade.deb")?;
    TRIALS.iter().try_for_each(|line| root.run(line))?;
    root.run("apt-get purge --yes --quiet deepshade && ! test -e /usr/share/deepshade")
}

/// The program alone, with networks as the repository has them.
fn by_cargo(_: &Path) -> Result<()> {
    let root = Root::new("cargo")?;
    let place = root.path("usr/local").display().to_string();
    let install = ["install", "--path", ".", "--locked", "--force", "--no-track", "--root", &place];
    command::run(&mut cargo(&install))?;
    root.run(&format!(
        "apt-get update --quiet && apt-get install --yes --quiet --no-install-recommends {LIBRARIES}"
    ))?;
    root.put(&command::root().join("models"), "tmp/models")?;
    TRIALS.iter().try_for_each(|line| root.run(line))
}

/// The container file: what its first stage builds, and the steps of its second.
fn by_container(_: &Path) -> Result<()> {
    let text = std::fs::read_to_string(command::root().join("Containerfile"))?;
    let program = Program::build_by(&container::build(&text)?)?;
    let steps = container::last_stage(&text)?;
    ensure!(steps.len() > 3, "the container file has too few steps to be checked");
    let root = Root::new("container")?;
    for step in steps {
        match step {
            container::Instruction::Run(line) => root.run(&line)?,
            container::Instruction::Copy(from, to) => {
                root.put(&built(&program, &from)?, to.trim_start_matches('/'))?
            }
        }
    }
    TRIALS.iter().try_for_each(|line| root.run_as("deepshade", line))
}

/// What the container file's first stage has at a path: the repository, built.
fn built(program: &Program, path: &str) -> Result<PathBuf> {
    let inside = path.strip_prefix("/src/").with_context(|| format!("{path} is not below /src"))?;
    if inside == "target/release/deepshade" {
        return Ok(program.path().to_owned());
    }
    let found = command::root().join(inside);
    ensure!(found.exists(), "{} is not there to be copied", found.display());
    Ok(found)
}

/// Copies a file or a folder.
pub fn copy(from: &Path, to: &Path) -> Result<()> {
    if let Some(folder) = to.parent() {
        std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    }
    let [from, to] = [from, to].map(|path| path.display().to_string());
    command::run(&mut command("cp", &["-a", &from, &to]))
}
