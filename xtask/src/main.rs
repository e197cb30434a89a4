//! Set-up and checks: the commands that the README, CONTRIBUTING.md and CI call. What they need is little, so
//! that it builds in seconds on a machine that has nothing else yet; what drives a browser is the feature
//! `browser`.

mod apt;
mod book;
#[cfg(feature = "browser")]
mod browser;
mod command;
mod crosscheck;
mod demo;
mod deny;
mod figures;
mod fuzz;
mod hosts;
mod models;
mod program;
mod prove;
mod python;
mod release;
mod site;
mod targets;
mod test;
mod unchanged;
mod vulkan;
mod web;

use anyhow::Result;
use clap::{Parser, Subcommand};
use std::path::PathBuf;
use std::process::ExitCode;

/// Set-up and checks.
#[derive(Parser)]
#[command(
    name = "cargo xtask",
    bin_name = "cargo xtask",
    after_help = "On Linux, set-up installs Debian or Ubuntu packages if it may (as root, or by sudo without \
    a \
        password); otherwise it says which ones are missing and stops."
)]
struct Cli {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    /// Sets up Vulkan where it is missing, builds deepshade and runs `deepshade demo` with the arguments.
    Demo(Passed),
    /// Sets up Vulkan and onnxruntime where they are missing, then checks everything: formatting, clippy,
    /// documentation, features, all tests. CI runs this.
    Test,
    /// Proves truth: runs the tests that hold it against closed forms, sampling densities and the rate at
    /// which errors must fall, each with a control that must fail, and prints what they measured.
    Prove(Json),
    /// Sets up Mitsuba 3 in a Python environment below the target folder, renders the same scenes with it and
    /// with deepshade, and compares every effect pixel by pixel: `deepshade-studies crosscheck` with the
    /// arguments.
    Crosscheck(Passed),
    /// Tests what deepshade is used from: the page's package in headless Chromium, in a page of its own and
    /// in three.js, beside onnxruntime-web; the Python package with PyTorch, in an environment below the
    /// target folder (some gigabytes); the crate for Bevy, which a nightly compiler builds; and the add-on
    /// with Blender as a Python module. Where one fails, the others are tested nonetheless.
    Hosts(hosts::Args),
    /// Makes networks in `models` from nothing: data, training, export, test set, evaluation, parity, and
    /// what more steps would bring, from trainings of half and a quarter of them; hours. Given again it goes
    /// on.
    Models(models::Args),
    /// Builds the book in `book` with mdBook, as web pages below the target folder.
    Book,
    /// Checks licences, banned crates and sources of all dependencies with cargo-deny, and advisories of
    /// known faults where their database can be fetched.
    Deny(deny::Args),
    /// Checks that the program compiles for Windows and macOS, with targets that rustup brings or, where
    /// Debian's compiler is new enough, with the standard library from Debian's source. Nothing is linked.
    Targets,
    /// Reads changed files of every kind that others may have written, by libFuzzer, which needs a C++
    /// compiler. Given again it goes on.
    Fuzz(fuzz::Args),
    /// Makes all that people install into one folder with checksums: an archive, the packages for Debian, pip
    /// and npm, Blender's add-on, and the list of components. With --try it tries what has the program.
    Release(release::Args),
    /// Makes small data of every recipe, and every method's image of every effect on two scenes, and holds
    /// the hashes of all files against those that --write noted, on the same machine.
    Unchanged(unchanged::Args),
    /// Builds the web page as static files: the program as WebAssembly, the networks, and what is shown where
    /// a browser has no WebGPU. On Debian it installs a compiler for browsers where rustup has none.
    Web(web::Args),
    /// Makes one folder of static files of the web page, the book (by mdBook), the library's documentation
    /// and the networks with their cards, and checks the links of its first pages.
    Site(site::Args),
}

/// Arguments for another program.
#[derive(clap::Args)]
#[command(disable_help_flag = true)]
struct Passed {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    args: Vec<String>,
}

/// Where figures go.
#[derive(clap::Args)]
struct Json {
    /// Writes the figures here as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
}

fn main() -> ExitCode {
    match run(Cli::parse().verb) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("xtask: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(verb: Verb) -> Result<()> {
    match verb {
        Verb::Demo(passed) => demo::run(&passed.args),
        Verb::Test => test::run(),
        Verb::Prove(json) => prove::run(json.json.as_deref()),
        Verb::Crosscheck(passed) => crosscheck::run(&passed.args),
        Verb::Hosts(args) => hosts::run(&args),
        Verb::Models(args) => models::run(&args),
        Verb::Book => book::run(),
        Verb::Deny(args) => deny::run(&args),
        Verb::Targets => targets::run(),
        Verb::Fuzz(args) => fuzz::run(&args),
        Verb::Release(args) => release::run(&args),
        Verb::Unchanged(args) => unchanged::run(&args),
        Verb::Web(args) => web::run(args),
        Verb::Site(args) => site::run(&args),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_sound_and_arguments_are_passed_on() {
        Cli::command().debug_assert();
        let cli =
            Cli::try_parse_from(["cargo xtask", "crosscheck", "--only", "room", "--help"]).expect("read");
        assert!(
            matches!(cli.verb, Verb::Crosscheck(Passed { args }) if args == ["--only", "room", "--help"])
        );
    }
}
