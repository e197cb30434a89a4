//! Set-up and the commands that the README and CI call: `cargo xtask demo`, `cargo xtask test`,
//! `cargo xtask prove`, `cargo xtask crosscheck`, `cargo xtask models`, `cargo xtask book`, `cargo xtask deny`,
//! `cargo xtask targets`, `cargo xtask faults`, `cargo xtask fuzz`, `cargo xtask package`, `cargo xtask soak`, `cargo xtask store`, `cargo xtask farm`,
//! `cargo xtask unchanged`, `cargo xtask web`.
//!
//! Nothing but std and anyhow, but for what drives a browser (feature `browser`), so that it builds in seconds on a machine that has nothing else yet.

mod apt;
mod book;
mod command;
mod crosscheck;
mod demo;
mod deny;
mod farm;
mod faults;
mod figures;
mod fuzz;
mod models;
mod package;
mod program;
mod prove;
mod python;
mod soak;
mod store;
mod targets;
mod test;
mod unchanged;
mod vulkan;
mod web;

use anyhow::{Result, bail};
use std::process::ExitCode;

const HELP: &str = "\
Usage: cargo xtask <COMMAND>

Commands:
  demo [ARGS]  Set up Vulkan where it is missing, build deepshade and run `deepshade demo` with ARGS
  test         Set up Vulkan and onnxruntime where they are missing, then check everything: formatting, clippy,
               documentation, features, all tests; CI runs this
  prove [--json F]
               Prove truth: run the tests that hold it against closed forms, sampling densities and the rate at which
               errors must fall, each with a control that must fail, and print what they measured
  crosscheck [--json F] [--out DIR] [--only NAME] [--samples N]
               Set up Mitsuba 3 in a Python environment below the target folder, render the same scenes with it and
               with deepshade, and compare every effect pixel by pixel; some minutes. --only takes the cases whose
               name holds NAME (room, room.gi, .ao), --samples is of a pixel, 512 by default; other arguments, too, go
               to `deepshade-studies crosscheck`, whose --help lists them
  models [--only NAME] [--work DIR] [--device cpu|gpu]
               Make every network in `models` from nothing: data, training, export, test set, evaluation, parity, and
               what more steps would bring, from trainings of half and a quarter of them; hours.
               Given again it goes on. --device gpu trains on a GPU, by Vulkan. --work keeps data, runs and test sets,
               by default below the target folder
  book         Build the book in `book` with mdBook, as web pages below the target folder
  deny [--advisories]
               Check licences, banned crates and sources of all dependencies with cargo-deny, and advisories of known faults
               where their database can be fetched; with --advisories it is an error if it cannot
  targets      Check that the program compiles for Windows and macOS, with targets that rustup brings or, where Debian's
               compiler is new enough, with the standard library from Debian's source; nothing is linked
  faults [--kills N] [--seed S] [--json F]
               Kill the program at random moments of every long job, a farm's tasks too (60 times by default), fill its disk,
               stop it, limit its memory, interrupt it, start it twice, set its clock back, lose its graphics card: what it
               makes must be what it makes undisturbed, byte for byte
  fuzz [--executions N] [--only TARGET]... [--json F]
               Read changed files of every kind that others may have written, by libFuzzer, which needs a C++ compiler:
               10,000,000 a target by default, which takes hours. Given again it goes on
  package [--try] [--json F]
               Make the Debian package with cargo-deb. --try installs it, what `cargo install` makes, and what the container
               file says, each in a clean root of its own (debootstrap, as root), and runs the program there
  soak [--minutes N] [--json F]
               Make a dataset, train and look through a window under Xvfb, all at once, for two hours by default, and watch
               whether memory or open files grow
  store [--json F]
               Hold object stores against a server that speaks S3 on this machine, which is built with cargo, and measure it
  farm [--json F] [--only slurm|ray]
               Set up Slurm with several nodes, and Ray, on this machine, and make a dataset by each while workers are killed
               and one shard always fails; measure how many tasks Slurm starts where none waits for a node
  unchanged [--write] FILE
               Make small data of every recipe, and every method's image of every effect on two scenes, and hold
               the hashes of all files against those that --write noted in FILE, on the same machine
  web [--out DIR] [--serve] [--test [--json F]]
               Build the web page as static files, by default below the target folder: the program as WebAssembly, the
               networks, and what is shown where a browser has no WebGPU. On Debian it installs a compiler for browsers
               where rustup has none. --serve serves it to this machine; --test drives headless Chromium, installed
               where it is missing: images must be those of the program, slider and figures must work
  help         Print this

On Linux, set-up installs Debian or Ubuntu packages if it may (as root, or by sudo without a password); otherwise it
says which ones are missing and stops.";

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    match run(&args) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("xtask: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(args: &[String]) -> Result<()> {
    let (name, rest) = match args.split_first() {
        Some((name, rest)) => (name.as_str(), rest),
        None => ("help", args),
    };
    match (name, rest) {
        ("demo", rest) => demo::run(rest),
        ("test", []) => test::run(),
        ("prove", rest) => prove::run(rest),
        ("crosscheck", rest) => crosscheck::run(rest),
        ("models", rest) => models::run(rest),
        ("book", []) => book::run(),
        ("deny", rest) => deny::run(rest),
        ("targets", []) => targets::run(),
        ("faults", rest) => faults::run(rest),
        ("package", rest) => package::run(rest),
        ("fuzz", rest) => fuzz::run(rest),
        ("soak", rest) => soak::run(rest),
        ("store", rest) => store::run(rest),
        ("farm", rest) => farm::run(rest),
        ("unchanged", rest) => unchanged::run(rest),
        ("web", rest) => web::run(rest),
        ("help" | "-h" | "--help", []) => {
            println!("{HELP}");
            Ok(())
        }
        _ => bail!("do not understand `{}`\n\n{HELP}", args.join(" ")),
    }
}
