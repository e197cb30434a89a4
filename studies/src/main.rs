//! deepshade-studies: what papers and the thesis measured, and contests with other programs. People who
//! render, train or measure need none of it; figures of the book do.

// Programs that print use the same macros.
#[macro_use]
extern crate deepshade;

mod cards;
mod crosscheck;
#[cfg(feature = "embree")]
mod embree;
mod epipolar;
mod experiment;
mod forecast;
mod kills;
mod lpv;
mod phosphor;
mod program;
mod slope;
mod stages;
mod surfel;
mod volume_shell;
mod web;

use anyhow::Result;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use deepshade::shared::command_line::{ended, with_negative_numbers};
use std::process::ExitCode;

/// What papers and the thesis measured, and contests with other programs.
#[derive(Parser)]
#[command(name = "deepshade-studies", version, about, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    /// Reruns a study of the thesis: data, networks, tests, a table and plots.
    Experiment(experiment::Args),
    /// Extrapolates what more steps of training would bring.
    Forecast(forecast::Args),
    /// Milliseconds and memory of shading by surfels, stage by stage; thresholds, levels, resolution.
    Surfel(Box<surfel::Args>),
    /// Fog by partial-sum trees beside marching at equal error: speed-ups, how times grow.
    Epipolar(epipolar::Args),
    /// Milliseconds and errors of volume shells, stage by stage; thresholds, improvements, how times grow.
    VolumeShell(volume_shell::Args),
    /// Milliseconds and errors of light propagation volumes, stage by stage; the paper's alternatives, how
    /// far propagation is right.
    Lpv(lpv::Args),
    /// Milliseconds of designing phosphorescent materials, and what light of the past costs.
    Phosphor(phosphor::Args),
    /// Rays a second beside Embree on the very same rays.
    #[cfg(feature = "embree")]
    Embree(embree::Args),
    /// Checks truth against Mitsuba 3; `cargo xtask crosscheck` sets it up and calls this.
    Crosscheck(crosscheck::Args),
    /// Long jobs killed at random moments: whether they make, byte for byte, what they make undisturbed.
    Kills(kills::Args),
    /// Records what the web page shows where a browser has no WebGPU; `cargo xtask web` calls this.
    Web(web::Args),
}

fn main() -> ExitCode {
    let cli = Cli::from_arg_matches(&with_negative_numbers(Cli::command()).get_matches());
    let verb = cli.unwrap_or_else(|error| error.exit()).verb;
    ended(|| run(&verb))
}

fn run(verb: &Verb) -> Result<()> {
    match verb {
        Verb::Experiment(args) => experiment::run(args),
        Verb::Forecast(args) => forecast::run(args),
        Verb::Surfel(args) => surfel::run(args),
        Verb::Epipolar(args) => epipolar::run(args),
        Verb::VolumeShell(args) => volume_shell::run(args),
        Verb::Lpv(args) => lpv::run(args),
        Verb::Phosphor(args) => phosphor::run(args),
        #[cfg(feature = "embree")]
        Verb::Embree(args) => embree::run(args),
        Verb::Crosscheck(args) => crosscheck::run(args),
        Verb::Kills(args) => kills::run(args),
        Verb::Web(args) => web::run(args),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_sound_and_every_study_has_an_example() {
        let mut command = with_negative_numbers(Cli::command());
        command.clone().debug_assert();
        for verb in command.get_subcommands_mut() {
            let (name, help) = (verb.get_name().to_owned(), verb.render_long_help().to_string());
            assert!(help.contains(&format!("deepshade-studies {name}")), "{help}");
        }
    }
}
