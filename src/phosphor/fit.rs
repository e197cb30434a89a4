//! `deepshade phosphor fit`: a material from measurements of it.

mod plots;
mod report;
mod rows;

pub(super) use rows::parameter_name;

use super::self_test;
use crate::figures::{Figures, write_atomically};
use crate::table;
use anyhow::{Context, Result};
use deepshade_glow::file::MaterialFile;
use deepshade_phosphor::fit::checker::Checker;
use deepshade_phosphor::fit::{Fit, Measurement, MeasurementKind, ParameterEstimate};
use deepshade_render::exr_file;
use deepshade_shaders::Planes;
use serde_json::json;
use std::error::Error;
use std::path::{Path, PathBuf};

/// Fits a material to measurements, or tests such fits on simulated ones.
///
/// A fit that may not mean what it says is warned of, here and in the report: where far more is left than
/// noise, or little of the decay is explained (R^2) where noise is not stated, or photographs cannot tell a
/// state, or much is left of a colour chart. A decay that grows is refused.
#[derive(clap::Args)]
#[command(after_help = EXAMPLE)]
pub struct Args {
    /// Folder of measurements: tables (CSV), and photographs that they list; see below.
    #[arg(required_unless_present = "self_test", conflicts_with = "self_test")]
    folder: Option<PathBuf>,
    /// States of the material.
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=3))]
    states: u8,
    /// What the material is called; by default as the folder.
    #[arg(long, conflicts_with = "self_test", value_parser = crate::arguments::name)]
    name: Option<String>,
    /// Writes the material here as TOML.
    #[arg(long, conflicts_with = "self_test")]
    out: Option<PathBuf>,
    /// Draws what is left of the decay that the fit does not explain, over the noise, into this SVG file.
    #[arg(long, conflicts_with = "self_test", value_parser = crate::arguments::svg_file)]
    plot: Option<PathBuf>,
    /// Writes a page about the fit into this HTML file: parameters, plots, how different photographs and the
    /// material look.
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

/// What `--help` ends with.
const EXAMPLE: &str = "The folder of measurements. Columns are separated by commas and named in the first line; lines that begin with # are left out.

  decay.csv         a row a photograph after the light went off:
                      time_s             seconds from light off to the open shutter, ascending
                      red, green, blue   the mean of the material's pixels, linear
                      exposure_s, and iso and f_number, or gain (what a radiance of 1 gives a pixel): where they differ; else 1 s,
                                         ISO 100, f/1
                      red_noise, green_noise, blue_noise   standard errors, where they are known; else a hundredth of the brightest
                      file               in place of colours, noise and gain: a photograph, linear EXR or PNG of 16 bits
  spectrum.csv      the same through filters: also filter, the column of filters.csv, from 1 on. With it the material is described
                    in eight bands from 400 to 700 nm, else in the camera's colours. Needs filters.csv and camera.csv
  filters.csv       wavelength_nm, and a column a filter: what it lets through
  camera.csv        wavelength_nm, red, green, blue: what each channel sees
  excitation.csv    the columns of decay.csv after light on what had been dark: also band, from 1 on, and light_s, how long it shone
  light.csv         wavelength_nm and the lamp's power; a halogen lamp where it is missing
  mask.png          bright where photographs show the material; as large as they are
  calibration.csv   file, exposure_s, iso, f_number: photographs of one thing in steady light, some under each setting. Needed where
                    photographs of the tables have several ISO or f-numbers
  checker.csv       what the camera saw of a colour chart, a row a patch, at least 6. With it all colours become linear sRGB by a
                    matrix (least squares), and 1 is a white diffuser in the light on the chart. Not beside spectrum.csv:
                      patch              its name on the classic chart: dark skin, light skin, blue sky, foliage, blue flower,
                                         bluish green, orange, purplish blue, moderate red, purple, yellow green, orange yellow,
                                         blue, green, red, yellow, magenta, cyan, white, neutral 8, neutral 6.5, neutral 5,
                                         neutral 3.5, black
                      red, green, blue   the mean of its pixels, linear; also exposure_s, and iso and f_number, or gain, as above
                      file, left, top, width, height   in place of colours and gain: a photograph and the patch's rectangle, in pixels
                      known_red, known_green, known_blue (linear sRGB), or lab_l, lab_a, lab_b (CIE L*a*b*, D50)   of any other chart,
                                         whose patches may have any name
                      filter             of the classic chart: the column of filters.csv that it was seen through, 0 for none
  checker-light.csv wavelength_nm and power of the light on the classic chart; daylight (D65) where it is missing

A decay as colours, and one as photographs with their calibration:

  time_s,exposure_s,red,green,blue          file,time_s,exposure_s,iso        file,exposure_s,iso
  0.1,1,0.412,0.301,0.154                   0001.png,0.1,1,100                grey-100.png,0.5,100
  5.1,1,0.347,0.254,0.129                   0002.png,5.1,1,100                grey-400.png,0.125,400
  10.1,1,0.293,0.214,0.110                  0003.png,10.1,1,400

`simulate` writes such a folder.

A colour chart as colours (the first rows), and as a photograph:

  patch,exposure_s,red,green,blue           patch,file,exposure_s,left,top,width,height
  dark skin,0.01,0.041,0.030,0.013          dark skin,chart.png,0.01,212,180,90,90
  light skin,0.01,0.152,0.118,0.062         light skin,chart.png,0.01,352,180,90,90

Examples:
  deepshade phosphor fit measured --states 2 --out paint.toml --plot paint.svg --report paint.html
  deepshade phosphor fit --self-test --json self-test.json

Of the self test's figures, coverage is the share of 95 % intervals that hold the true value, of the material for which it is \
farthest from 0.95, coverage_least that of the parameter of which fewest do; residual_over_noise what all fits of a material \
leave together, and worst_residual_over_noise what one of them does, the largest over materials; median_ratio_nc2_nc1 and \
last_ratio_nc2_nc1 what two states leave of the error of one, in the median over materials, at all photographs and at the last.";

/// Fits, writes and prints.
///
/// # Errors
/// If measurements cannot be read, make no sense, or are too few for so many states, or a file cannot be
/// written.
pub fn run(args: &Args) -> Result<()> {
    let Some(folder) = &args.folder else { return self_test::run(args.seeds, args.json.as_deref()) };
    let measurement = Measurement::read(folder, read_exr).with_context(|| folder.display().to_string())?;
    let name = args.name.clone().unwrap_or_else(|| folder_name(folder));
    let fit =
        Fit::new(&name, &measurement, args.states.into()).with_context(|| folder.display().to_string())?;
    let mut figures = Figures::new("phosphor fit");
    figures.set("residual_over_noise", fit.residual_over_noise());
    figures.set("r_squared", fit.explained());
    figures.set("states", f64::from(args.states));
    if let Some(checker) = &measurement.checker {
        figures.set("checker_rms", checker.rms);
        figures.set("checker_patches", checker.patches as f64);
        figures.detail("checker_matrix", json!(checker.matrix));
        figures.detail("checker_worst_patch", json!(checker.worst.0));
    }
    figures.detail("material", json!(fit.material));
    figures.detail("estimates", fit.estimates.iter().map(estimate_detail).collect());
    let unmeasured = fit.unmeasured.iter().map(|band| json!(band + 1));
    figures.detail("excitation_not_measured", unmeasured.collect());
    figures.detail("warnings", fit.warnings.iter().map(|warning| json!(warning.to_string())).collect());
    figures.write(args.json.as_deref())?;
    if let Some(path) = &args.out {
        let file = MaterialFile { materials: vec![fit.material.clone()], fragments: vec![] };
        write_atomically(path, file.text().as_bytes())?;
    }
    if let Some(path) = &args.plot {
        write_atomically(path, plots::residuals(&fit, MeasurementKind::Decay).svg(&name)?.as_bytes())?;
    }
    if let Some(path) = &args.report {
        write_atomically(path, report::page(&fit)?.as_bytes())?;
    }
    for warning in &fit.warnings {
        note!("warning: {warning}");
    }
    say!("{}", table::aligned(&rows::table(&fit)))?;
    if let Some(checker) = &measurement.checker {
        say!("{}", of_chart(checker))?;
    }
    say!("{}", how_well(&fit))
}

/// What a colour chart made of the camera's colours.
fn of_chart(checker: &Checker) -> String {
    let Checker { patches, rms, worst: (patch, left), .. } = checker;
    format!(
        "linear sRGB by {patches} patches of checker.csv: {rms:.4} is left (RMS of a channel, white being \
        1), most of `{patch}` ({left:.4}, all channels)"
    )
}

/// The picture of an EXR file, `[3, height, width]`.
pub(super) fn read_exr(path: &Path) -> Result<Planes, Box<dyn Error + Send + Sync>> {
    Ok(exr_file::read_colour(path)?.0)
}

/// How well a fit explains what was measured.
fn how_well(fit: &Fit) -> String {
    if fit.noise_is_known {
        let left = fit.residual_over_noise();
        return format!("residual over noise {left:.3}: 1 where the material explains all but the noise");
    }
    let explained = fit.explained();
    format!("R^2 of the decay {explained:.4}: 1 where the material explains all; noise was not stated")
}

fn folder_name(folder: &Path) -> String {
    folder.file_name().map_or_else(|| "fitted".to_owned(), |name| name.to_string_lossy().into_owned())
}

fn estimate_detail(estimate: &ParameterEstimate) -> serde_json::Value {
    json!({
        "state": estimate.state + 1, "parameter": parameter_name(estimate.parameter), "value": estimate.value,
        "interval": estimate.interval,
    })
}
