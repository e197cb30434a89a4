//! The program's command line.

#[cfg(feature = "view")]
use crate::view;
#[cfg(target_arch = "wasm32")]
use crate::web;
use crate::{
    bench, compare, dataset, demo, eval, farm, infer, interrupt, output, parameters, phosphor, render, scene,
    tune,
};
#[cfg(feature = "train")]
use crate::{export, parity, train};
use anyhow::Result;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use std::process::ExitCode;

/// Learned, analytic and path-traced screen-space shading side by side.
#[derive(Parser)]
#[command(name = "deepshade", version, about, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    /// The whole chain on scenes never seen in training: data, training, export, running, comparing.
    Demo(demo::Args),
    /// Says what a scene holds, or lists the procedural families.
    Scene(scene::Args),
    /// Renders a picture of one effect's truth, refining it before one's eyes.
    Render(render::Args),
    /// Generates, verifies and shows training pairs, and makes test sets.
    #[command(
        subcommand,
        after_help = "Example:\n  deepshade dataset generate dataset/recipes/ao.toml --out data/ao"
    )]
    Dataset(dataset::Verb),
    /// Makes a dataset on many machines, by Slurm, Ray or Kubernetes.
    #[command(
        subcommand,
        after_help = "Example:\n  deepshade farm plan dataset/recipes/ao.toml --out /shared/ao --shards 200 \
            --engine slurm --jobs /shared/jobs/ao"
    )]
    Farm(farm::Verb),
    /// Trains a network on a dataset; the same command resumes.
    #[cfg(feature = "train")]
    Train(train::Args),
    /// Turns a training run into a model folder.
    #[cfg(feature = "train")]
    Export(export::Args),
    /// Runs a network on a g-buffer file from any renderer.
    Infer(infer::Args),
    /// Checks that burn, the reference, WGSL and onnxruntime agree.
    #[cfg(feature = "train")]
    Parity(parity::Args),
    /// Compares methods on scenes: images, errors, milliseconds and a page to look at.
    Compare(compare::Args),
    /// Lists methods and what of each can be set.
    Methods(parameters::Args),
    /// Shows a scene in a window, by several methods at once, beside truth.
    #[cfg(feature = "view")]
    View(view::Args),
    /// Evaluates an effect's methods, learned and analytic, on a test set.
    Eval(eval::Args),
    /// Tunes a method's parameters on the validation views of a dataset.
    Tune(tune::Args),
    /// Phosphorescent materials: those that are known, are measured, or are asked for by how they should
    /// look.
    #[command(
        subcommand,
        after_help = "Example:\n  deepshade phosphor fit measured --states 2 --out paint.toml"
    )]
    Phosphor(phosphor::Verb),
    /// Measures speed: of networks beside onnxruntime, of training, of a live frame, of rays, of making data.
    #[command(subcommand, after_help = "Example:\n  deepshade bench net --networks ao --json net.json")]
    Bench(bench::Verb),
}

/// In a browser there is no command line: the page's script asks for what it wants.
#[cfg(target_arch = "wasm32")]
pub fn main() {
    web::start();
}

/// The program: reads its command line and does what it says.
#[cfg(not(target_arch = "wasm32"))]
pub fn main() -> ExitCode {
    let cli = Cli::from_arg_matches(&with_negative_numbers(Cli::command()).get_matches());
    let verb = cli.unwrap_or_else(|error| error.exit()).verb;
    ended(|| run(&verb))
}

#[cfg(not(target_arch = "wasm32"))]
fn run(verb: &Verb) -> Result<()> {
    match verb {
        Verb::Demo(args) => demo::run(args),
        Verb::Scene(args) => scene::run(args),
        Verb::Render(args) => render::run(args),
        Verb::Dataset(verb) => dataset::run(verb),
        Verb::Farm(verb) => farm::run(verb),
        #[cfg(feature = "train")]
        Verb::Train(args) => train::run(args),
        #[cfg(feature = "train")]
        Verb::Export(args) => export::run(args),
        Verb::Infer(args) => infer::run(args),
        #[cfg(feature = "train")]
        Verb::Parity(args) => parity::run(args),
        Verb::Compare(args) => compare::run(args),
        Verb::Methods(args) => parameters::run(args),
        #[cfg(feature = "view")]
        Verb::View(args) => view::run(args),
        Verb::Eval(args) => eval::run(args),
        Verb::Tune(args) => tune::run(args),
        Verb::Phosphor(verb) => phosphor::run(verb),
        Verb::Bench(verb) => bench::run(verb),
    }
}

/// Does work that Ctrl-C may interrupt, says what went wrong, and gives the code that a program ends with.
pub fn ended(work: impl FnOnce() -> Result<()>) -> ExitCode {
    interrupt::watch();
    match work() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if output::nobody_reads(&error) => ExitCode::SUCCESS,
        Err(error) => {
            let Some(interrupted) = error.downcast_ref::<interrupt::Interrupted>() else {
                note!("error: {}", output::message(&error));
                return ExitCode::FAILURE;
            };
            note!("{interrupted}");
            ExitCode::from(interrupted.code())
        }
    }
}

/// A command whose options take negative numbers for values, which their own checks refuse by name; else `-1`
/// would be taken for an option that nobody knows.
pub fn with_negative_numbers(command: clap::Command) -> clap::Command {
    let numbers = |arg: clap::Arg| {
        let takes = arg.get_action().takes_values();
        if takes { arg.allow_negative_numbers(true) } else { arg }
    };
    command.mut_args(numbers).mut_subcommands(with_negative_numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_sound_and_negative_numbers_are_refused_by_name() {
        let command = with_negative_numbers(Cli::command());
        command.clone().debug_assert();
        for (line, named) in [
            ("deepshade render --scene stairs:1 --radius -1", "'--radius <RADIUS>': -1 is not above 0"),
            ("deepshade bench net --budget -0.5", "'--budget <MILLISECONDS>': -0.5 is not above 0"),
            ("deepshade dataset show data --out a.png --pairs -3", "'--pairs <PAIRS>': -3 is not in"),
        ] {
            let error = command.clone().try_get_matches_from(line.split(' ')).expect_err(line).to_string();
            assert!(error.contains(named), "{error}");
        }
    }
}
