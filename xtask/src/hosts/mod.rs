//! `cargo xtask hosts`: the tests of programs that deepshade's data and networks are used from, each in the
//! real thing.

mod bevy;
mod blender;
#[cfg(feature = "browser")]
mod javascript;
mod pytest;
mod torch;

use crate::program::{AS_TESTS, Program};
use crate::{figures, vulkan, web};
use anyhow::{Error, Result, ensure};
use clap::ValueEnum;
use serde_json::{Map, json};
use std::path::PathBuf;

/// Which hosts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Host {
    /// The package in `js/`, in headless Chromium, with three.js.
    Browser,
    /// The package in `python/`, with PyTorch.
    Torch,
    /// The crate in `bevy/`, in Bevy.
    Bevy,
    /// The add-on in `blender/`, with Blender as a Python module.
    Blender,
}

/// What is tested.
#[derive(clap::Args)]
pub struct Args {
    /// Only that host.
    #[arg(long)]
    only: Option<Host>,
    /// The program `deepshade`; without it one is built as the tests have it.
    #[arg(long, value_name = "FILE")]
    program: Option<PathBuf>,
    /// Writes the figures here as JSON, also those of hosts that passed where another failed.
    #[arg(long)]
    json: Option<PathBuf>,
}

type Figures = Vec<(String, f64)>;

/// Tests them all, says what was measured, and only then what failed.
///
/// # Errors
/// If something is missing and cannot be installed, the program does not build, or a test fails.
pub fn run(args: &Args) -> Result<()> {
    let hosts = match &args.only {
        Some(only) => std::slice::from_ref(only),
        None => Host::value_variants(),
    };
    if hosts.contains(&Host::Browser) && !cfg!(feature = "browser") {
        return web::again();
    }
    vulkan::ensure()?;
    let program = match &args.program {
        Some(path) => Program::at(path)?,
        None => Program::build_by(&AS_TESTS)?,
    };
    let (found, failed) = test_all(hosts, |host| host.test(&program));
    for (name, value) in &found {
        println!("{name} {value:.3e}");
    }
    let reasons: Map<_, _> =
        failed.iter().map(|(host, error)| (host.name(), format!("{error:#}").into())).collect();
    figures::write(args.json.as_deref(), "hosts", &found, json!({ "failed": reasons }))?;
    let names: Vec<String> = failed.iter().map(|(host, _)| host.name()).collect();
    ensure!(names.is_empty(), "failed: {}", names.join(", "));
    Ok(())
}

/// Figures of the hosts that pass, and why others fail, which is also said at once.
fn test_all(hosts: &[Host], test: impl Fn(Host) -> Result<Figures>) -> (Figures, Vec<(Host, Error)>) {
    let (mut found, mut failed) = (Vec::new(), Vec::new());
    for host in hosts {
        match test(*host) {
            Ok(figures) => found.extend(figures),
            Err(error) => {
                eprintln!("{}: {error:#}", host.name());
                failed.push((*host, error));
            }
        }
    }
    (found, failed)
}

impl Host {
    fn name(self) -> String {
        format!("{self:?}").to_lowercase()
    }

    fn test(self, program: &Program) -> Result<Figures> {
        match self {
            #[cfg(feature = "browser")]
            Self::Browser => javascript::test(program),
            #[cfg(not(feature = "browser"))]
            Self::Browser => anyhow::bail!("built without the feature `browser`"),
            Self::Torch => torch::test(program),
            Self::Bevy => bevy::test(program),
            Self::Blender => blender::test(program),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::bail;

    #[test]
    fn a_host_that_fails_takes_no_figures_from_others() {
        let test = |host| match host {
            Host::Torch => bail!("no wheel"),
            _ => Ok(vec![(host.name(), 1.0)]),
        };
        let (found, failed) = test_all(&[Host::Browser, Host::Torch, Host::Blender], test);
        assert_eq!(found, [("browser".to_owned(), 1.0), ("blender".to_owned(), 1.0)]);
        let said: Vec<_> = failed.iter().map(|(host, error)| (*host, error.to_string())).collect();
        assert_eq!(said, [(Host::Torch, "no wheel".to_owned())]);
    }

    #[test]
    fn hosts_are_named_as_on_the_command_line() {
        for host in Host::value_variants() {
            assert_eq!(Host::from_str(&host.name(), false), Ok(*host));
        }
    }
}
