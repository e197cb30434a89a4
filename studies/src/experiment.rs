//! `deepshade-studies experiment`: the studies of the thesis (7.5), each a command that makes its data,
//! trains what it compares, tests it, and writes a table and plots.

mod field_of_view;
mod kernels;
mod losses;
mod radius;
mod regressors;
mod samples;
mod scenes;
mod size;
mod table;
mod test_frames;
mod workspace;

use anyhow::Result;
use clap::ValueEnum;
use deepshade::shared::figures::{Figures, machine, write_atomically};
use deepshade::shared::plot::{Line, Plot, Style};
use deepshade_train::Loss;
use serde_json::json;
use size::Size;
use std::path::{Path, PathBuf};
use std::time::Instant;
use table::Table;
use workspace::{TrainedRun, Workspace};

/// Reruns a study of the thesis: makes data, trains and tests networks, writes a table and plots.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  deepshade-studies experiment losses --json losses.json\n  \
    deepshade-studies experiment kernels --full\n\n\
    OUT/SIZE/NAME gets `table.md`, which says what was run and on which machine, `table.csv`, `plot.svg` \
    and, of what was trained, `curves.svg`. Data, networks and test sets lie beside it and are made once: \
    the same command goes on with a study that was interrupted, and studies share what they have in common.")]
pub struct Args {
    /// Which study.
    name: Study,
    /// Images, scenes and steps near those of the thesis, which take many hours, in place of some minutes.
    #[arg(long)]
    full: bool,
    /// Folder of everything that experiments make.
    #[arg(long, default_value = "experiments")]
    out: PathBuf,
    /// Writes the figures here as JSON: one a row of the table.
    #[arg(long, value_parser = deepshade::shared::arguments::written_file)]
    json: Option<PathBuf>,
}

/// A study.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Study {
    /// Kernels of 3x3 against 5x5 pixels, and 4, 8 or 16 of them on the first level.
    Kernels,
    /// Losses that the same network is trained for: L1, L2, DSSIM, mixes.
    Losses,
    /// Samples of a pixel against number of images, where both take as long, with noise that is known and
    /// that is not.
    Samples,
    /// As many pairs from few scenes and from many.
    Scenes,
    /// A network trained at 50 degrees on views of 20 to 90.
    FieldOfView,
    /// Effect radius against resolution.
    Radius,
    /// Perceptrons and random forests on patches beside the deep network.
    Regressors,
}

impl Study {
    fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }

    fn run(self, workspace: &Workspace) -> Result<Table> {
        match self {
            Self::Kernels => kernels::run(workspace),
            Self::Losses => losses::run(workspace),
            Self::Samples => samples::run(workspace),
            Self::Scenes => scenes::run(workspace),
            Self::FieldOfView => field_of_view::run(workspace),
            Self::Radius => radius::run(workspace),
            Self::Regressors => regressors::run(workspace),
        }
    }
}

/// Runs a study, writes its files and prints its table.
///
/// # Errors
/// If data, training or testing fail, or the folder cannot be written or holds data or runs of other
/// settings.
pub fn run(args: &Args) -> Result<()> {
    let size = if args.full { Size::FULL } else { Size::DEFAULT };
    let folder = args.out.join(size.name);
    let start = Instant::now();
    let device = deepshade_train::device_name()?;
    let workspace = Workspace::open(&folder, size)?;
    let table = args.name.run(&workspace)?;
    let seconds = start.elapsed().as_secs_f64();
    let results = folder.join(args.name.name());
    write(&results, &table, &workspace, seconds)?;
    let mut figures = Figures::new(&format!("experiment {}", args.name.name()));
    table.set_figures(&mut figures);
    figures.set("seconds", seconds);
    figures.detail("size", json!(size.name));
    figures.detail("trained_on", json!(device));
    figures.detail("made", json!(workspace.notes()));
    figures.write(args.json.as_deref())?;
    say!("{}, size `{}`", table.title, size.name)?;
    table.lines().iter().try_for_each(|line| say!("{line}"))?;
    say!("{}", results.join("table.md").display())
}

/// Writes the table and its plots.
fn write(folder: &Path, table: &Table, workspace: &Workspace, seconds: f64) -> Result<()> {
    write_atomically(&folder.join("table.md"), markdown(table, workspace, seconds).as_bytes())?;
    write_atomically(&folder.join("table.csv"), table.csv().as_bytes())?;
    write_atomically(&folder.join("plot.svg"), table.plot.svg(table.title)?.as_bytes())?;
    match workspace.runs().is_empty() {
        true => Ok(()),
        false => write_atomically(&folder.join("curves.svg"), curves(workspace).svg("Training")?.as_bytes()),
    }
}

/// The table with what it was made by.
fn markdown(table: &Table, workspace: &Workspace, seconds: f64) -> String {
    let machine = machine();
    let processor = machine["processor"].as_str().unwrap_or("processor unknown");
    let heads = [
        format!("size `{}`", workspace.size.name),
        format!("{processor}, {} threads", machine["threads"]),
        format!("{seconds:.0} s, what was there already not counted"),
    ];
    let list: String = heads.into_iter().chain(workspace.notes()).map(|line| format!("- {line}\n")).collect();
    format!("# {}\n\n{}\n\n{list}", table.title, table.lines().join("\n"))
}

/// All networks over their steps: validation, and faintly the training of those that are trained for the
/// same.
fn curves(workspace: &Workspace) -> Plot {
    let mut lines = Vec::new();
    for TrainedRun { name, loss, lines: measured } in workspace.runs() {
        let validation =
            measured.iter().filter_map(|line| Some((line.step as f64, line.validation_loss?.into())));
        lines.push(Line {
            name: name.clone(),
            points: validation.collect(),
            style: Style::Curve,
            colour: None,
        });
        if loss == Loss::Dssim {
            let training = measured.iter().map(|line| (line.step as f64, line.loss.into()));
            lines.push(Line { name, points: training.collect(), style: Style::Companion, colour: None });
        }
    }
    Plot {
        x: "step",
        is_logarithmic: false,
        y: "DSSIM of validation, faintly of training",
        lines,
        level: None,
    }
}

#[cfg(test)]
mod tests;
