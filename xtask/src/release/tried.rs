//! `cargo xtask release --try`: ways of installing the program, each from a clean root.

use super::clean_root::Root;
use super::{FEATURES, Made, container};
use crate::command::{self, cargo};
use crate::program::Program;
use anyhow::{Context, Result, ensure};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What is tried once it is installed: the version, and a network that is in the program, on the GPU, beside
/// an analytic method and truth.
const TRIALS: [&str; 2] = [
    "deepshade --version",
    "cd /tmp && XDG_RUNTIME_DIR=/tmp deepshade compare --scene stairs:7 --effect ao --methods \
     truth,hbao,learned --width 64 --height 64 --samples 16 --out report && test -s report/index.html",
];
/// Where networks are installed beside the program: one that is not in it.
const TRIAL_OF_NETWORKS: &str = "cd /tmp && XDG_RUNTIME_DIR=/tmp deepshade compare --scene stairs:7 \
     --effect ao --model ao-paper --methods learned --width 64 --height 64 --samples 16 --out of-networks";
/// Installs what programs need of the system, where no package says so.
const LIBRARIES: &str = "apt-get update --quiet && \
    apt-get install --yes --quiet --no-install-recommends libvulkan1 mesa-vulkan-drivers";

/// A way of installing the program.
struct Way {
    /// As figures call it.
    name: &'static str,
    /// What is installed.
    source: Source,
    /// The lines that people type.
    install: &'static [&'static str],
    /// The user that runs it.
    user: &'static str,
    /// Whether it brings the networks that are not in the program.
    brings_networks: bool,
    /// Lines that remove it and see that nothing is left, where the way has that.
    remove: &'static [&'static str],
}

/// Where what is installed comes from.
enum Source {
    /// The file of the release that figures call as the way.
    Release,
    /// What this builds into a root.
    Checkout(fn(&Root) -> Result<()>),
}

const WAYS: [Way; 5] = [
    Way {
        name: "archive",
        source: Source::Release,
        install: &[
            LIBRARIES,
            "tar -xzf /tmp/deepshade-*.tar.gz -C /opt",
            "ln -s /opt/deepshade-*/bin/deepshade /usr/local/bin",
        ],
        user: "root",
        brings_networks: true,
        remove: &[],
    },
    Way {
        name: "debian_package",
        source: Source::Release,
        install: &["apt-get update --quiet", "apt-get install --yes --quiet /tmp/deepshade_*.deb"],
        user: "root",
        brings_networks: true,
        remove: &["apt-get purge --yes --quiet deepshade", "! test -e /usr/share/deepshade"],
    },
    Way {
        name: "wheel",
        source: Source::Release,
        install: &[
            LIBRARIES,
            "apt-get install --yes --quiet python3-venv",
            "python3 -m venv /opt/venv",
            "/opt/venv/bin/pip install /tmp/deepshade-*.whl",
            "/opt/venv/bin/python -c 'import deepshade'",
            "ln -s /opt/venv/bin/deepshade /usr/local/bin",
        ],
        user: "root",
        brings_networks: false,
        remove: &[],
    },
    Way {
        name: "cargo",
        source: Source::Checkout(by_cargo),
        install: &[LIBRARIES],
        user: "root",
        brings_networks: false,
        remove: &[],
    },
    Way {
        name: "container",
        source: Source::Checkout(by_container_file),
        install: &[],
        user: "deepshade",
        brings_networks: true,
        remove: &[],
    },
];

/// Tries every way. Gives the seconds that files of the release in a folder took to install, with what they
/// need of the system.
///
/// # Errors
/// If this is not run as root, or what was installed does not work.
pub fn try_all(folder: &Path, made: &[Made]) -> Result<Vec<(String, f64)>> {
    let mut found = Vec::new();
    for way in &WAYS {
        let seconds = way.tried(folder, made).with_context(|| format!("installed by {}", way.name))?;
        println!("{}: works", way.name);
        if matches!(way.source, Source::Release) {
            found.push((format!("seconds_to_install_{}", way.name), seconds));
        }
    }
    Ok(found)
}

impl Way {
    /// Installs and runs it; the seconds that installing took.
    fn tried(&self, folder: &Path, made: &[Made]) -> Result<f64> {
        let root = Root::new(self.name)?;
        match self.source {
            Source::Release => {
                let file = made.iter().find(|file| file.name == self.name).context("it was not made")?;
                root.put(&folder.join(&file.file), "tmp/")?;
            }
            Source::Checkout(build) => build(&root)?,
        }
        let begin = Instant::now();
        self.install.iter().try_for_each(|line| root.run(line))?;
        let seconds = begin.elapsed().as_secs_f64();
        let of_networks = self.brings_networks.then_some(TRIAL_OF_NETWORKS);
        TRIALS.into_iter().chain(of_networks).try_for_each(|line| root.run_as(self.user, line))?;
        self.remove.iter().try_for_each(|line| root.run(line))?;
        Ok(seconds)
    }
}

/// The program alone, with the networks that are in it. With stores, so that what was built for the release
/// serves.
fn by_cargo(root: &Root) -> Result<()> {
    let place = root.path("usr/local").display().to_string();
    let install = ["install", "--path", ".", "--locked", "--force", "--no-track", "--root", &place];
    command::run(&mut cargo(&[&install[..], &FEATURES].concat()))
}

/// The container file: what its first stage builds, and the steps of its second.
fn by_container_file(root: &Root) -> Result<()> {
    let text = std::fs::read_to_string(command::root().join("Containerfile"))?;
    let program = Program::build_by(&container::build(&text)?)?;
    let steps = container::last_stage(&text)?;
    ensure!(steps.len() > 3, "the container file has too few steps to be checked");
    for step in steps {
        match step {
            container::Instruction::Run(line) => root.run(&line)?,
            container::Instruction::Copy(from, to) => {
                root.put(&built(&program, &from)?, to.trim_start_matches('/'))?
            }
        }
    }
    Ok(())
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::release::steps::STEPS;

    #[test]
    fn what_is_tried_of_a_release_is_made() {
        let of_release = WAYS.iter().filter(|way| matches!(way.source, Source::Release));
        for way in of_release {
            assert!(STEPS.iter().any(|(name, _)| *name == way.name), "{}", way.name);
        }
    }
}
