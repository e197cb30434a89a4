//! `deepshade phosphor fit`: a material from measurements of it.

mod report;

use super::self_test;
use crate::figures::{Figures, write_atomically};
use crate::plot::{CHANNELS, Line, Plot};
use crate::table;
use anyhow::{Context, Result};
use deepshade_render::phosphor::fit::{Estimate, Explained, Fit, Measurement, Parameter, Part};
use deepshade_render::phosphor::material::file::MaterialFile;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Fits a material to measurements, or tests such fits on simulated ones.
///
/// A folder of measurements holds `decay.csv` with a row a photograph after the light went off (`time_s`, `red`, `green`, `blue`;
/// `exposure_s` and `gain`, or `iso` and `f_number`, where they differ; `red_noise` and so on where they are known). With
/// `spectrum.csv` (the same through filters, `filter` being a column of `filters.csv`) and `camera.csv` the material is described in
/// eight bands, else in the camera's colours; `excitation.csv` has photographs after light of one `band` for `light_s` seconds,
/// `light.csv` the lamp. `simulate` writes such a folder.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    deepshade phosphor fit measured --states 2 --out paint.toml --plot paint.svg --report paint.html\n  \
    deepshade phosphor fit --self-test --json self-test.json\n\n\
    Of the self test's figures, coverage is the share of 95 % intervals that hold the true value, of the material for which it is \
    farthest from 0.95, coverage_least that of the parameter of which fewest do; residual_over_noise what all fits of a material \
    leave together, and worst_residual_over_noise what one of them does, the largest over materials; median_ratio_nc2_nc1 and last_ratio_nc2_nc1 what \
    two states leave of the error of one, in the median over materials, at all photographs and at the last.")]
pub struct Args {
    /// Folder of measurements.
    #[arg(required_unless_present = "self_test", conflicts_with = "self_test")]
    folder: Option<PathBuf>,
    /// States of the material.
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=3))]
    states: u8,
    /// What the material is called; by default as the folder.
    #[arg(long, conflicts_with = "self_test")]
    name: Option<String>,
    /// Writes the material here as TOML.
    #[arg(long, conflicts_with = "self_test")]
    out: Option<PathBuf>,
    /// Draws what is left of the decay that the fit does not explain, over the noise, into this SVG file.
    #[arg(long, conflicts_with = "self_test", value_parser = crate::arguments::svg_file)]
    plot: Option<PathBuf>,
    /// Writes a page about the fit into this HTML file: parameters, plots, how different photographs and the material look.
    #[arg(long, conflicts_with = "self_test", value_parser = crate::arguments::html_file)]
    report: Option<PathBuf>,
    /// Measures all known materials in a simulated laboratory, many times, and says how often fits find them.
    #[arg(long)]
    self_test: bool,
    /// How many times each.
    #[arg(long, requires = "self_test", default_value_t = 200, value_parser = clap::value_parser!(u64).range(2..=100_000))]
    seeds: u64,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
}

/// Fits, writes and prints.
///
/// # Errors
/// If measurements cannot be read, make no sense, or are too few for so many states, or a file cannot be written.
pub fn run(args: &Args) -> Result<()> {
    let Some(folder) = &args.folder else { return self_test::run(args.seeds, args.json.as_deref()) };
    let measurement = Measurement::read(folder).with_context(|| folder.display().to_string())?;
    let name = args.name.clone().unwrap_or_else(|| folder_name(folder));
    let fit =
        Fit::new(&name, &measurement, args.states.into()).with_context(|| folder.display().to_string())?;
    let mut figures = Figures::new("phosphor fit");
    figures.set("residual_over_noise", fit.residual_over_noise());
    figures.set("states", f64::from(args.states));
    figures.detail("material", json!(fit.material));
    figures.detail("estimates", fit.estimates.iter().map(estimate_detail).collect());
    figures.write(args.json.as_deref())?;
    if let Some(path) = &args.out {
        let file = MaterialFile { materials: vec![fit.material.clone()], fragments: vec![] };
        write_atomically(path, file.text().as_bytes())?;
    }
    if let Some(path) = &args.plot {
        write_atomically(path, residuals(&fit, Part::Decay).svg(&name)?.as_bytes())?;
    }
    if let Some(path) = &args.report {
        write_atomically(path, report::page(&fit)?.as_bytes())?;
    }
    let mut rows = vec![["state", "parameter", "value", "95 % interval"].map(str::to_owned).to_vec()];
    rows.extend(fit.estimates.iter().map(estimate_row));
    say!("{}", table::aligned(&rows))?;
    say!(
        "residual over noise {:.3}: 1 where the material explains all but the noise",
        fit.residual_over_noise()
    )
}

fn folder_name(folder: &Path) -> String {
    folder.file_name().map_or_else(|| "fitted".to_owned(), |name| name.to_string_lossy().into_owned())
}

pub(super) fn parameter_name(parameter: Parameter) -> String {
    match parameter {
        Parameter::Decay => "decay, 1/s".to_owned(),
        Parameter::Excitation(band) => format!("excitation, band {}", band + 1),
        Parameter::Emission(band) => format!("emission, band {}", band + 1),
    }
}

fn estimate_row(estimate: &Estimate) -> Vec<String> {
    let [low, high] = estimate.interval;
    let interval = if high.is_finite() { format!("{low:.5} to {high:.5}") } else { "not known".to_owned() };
    vec![
        (estimate.state + 1).to_string(),
        parameter_name(estimate.parameter),
        format!("{:.5}", estimate.value),
        interval,
    ]
}

fn estimate_detail(estimate: &Estimate) -> serde_json::Value {
    json!({
        "state": estimate.state + 1, "parameter": parameter_name(estimate.parameter), "value": estimate.value,
        "interval": estimate.interval,
    })
}

/// What is left of a part of the measurements, over its noise, against time.
fn residuals(fit: &Fit, part: Part) -> Plot {
    let of_channel = |channel: usize| {
        let its = |value: &&Explained| value.part == part && value.channel == channel;
        let point = |value: &Explained| (value.seconds, (value.measured - value.fitted) / value.noise);
        fit.values.iter().filter(its).map(point).collect::<Vec<_>>()
    };
    let line = |((name, colour), channel)| Line::dotted(name, of_channel(channel)).coloured(colour);
    Plot {
        x: if part == Part::Excitation { "time of light, s" } else { "time in the dark, s" },
        is_logarithmic: false,
        y: "measured less fitted, standard errors",
        lines: CHANNELS.into_iter().zip(0..).map(line).collect(),
        level: Some(("0", 0.0)),
    }
}
