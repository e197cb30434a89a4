//! `deepshade forecast`: what more steps of training would bring, from runs of one network that differ in their steps alone.
//!
//! The rate falls to its end within each run, so that only ends are alike: a run's own curve, half way, is not where a run
//! of half the steps ends.

mod law;

use crate::arguments::{svg_file, written_file};
use crate::figures::{Figures, write_atomically};
use crate::plot::{Line, Plot, Style};
use crate::table;
use anyhow::{Context, Result, ensure};
use deepshade_train::TrainConfig;
use deepshade_train::metrics;
use law::Law;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Extrapolates what more steps would bring from runs that differ in their steps alone.
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  deepshade train --dataset data/ao --out runs/ao-quarter --steps 5000 --patience 0\n  \
    deepshade train --dataset data/ao --out runs/ao-half --steps 10000 --patience 0\n  \
    deepshade train --dataset data/ao --out runs/ao --steps 20000 --patience 0\n  \
    deepshade forecast runs/ao-quarter runs/ao-half runs/ao --plot forecast.svg\n\n\
    Two laws are fitted to the DSSIM that the runs end with: a power of the steps, which falls for ever, and one above a \
    floor. What they say of more steps is a range: as far as they are apart, nothing is known. Neither knows of frames \
    that were never trained on becoming worse again."
)]
pub struct Args {
    /// Folders of finished runs, three at least, on the same data with the same settings but for the steps.
    #[arg(required = true, num_args = LEAST..)]
    runs: Vec<PathBuf>,
    /// Draws the curves, their ends and both laws into this SVG file.
    #[arg(long, value_parser = svg_file)]
    plot: Option<PathBuf>,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = written_file)]
    json: Option<PathBuf>,
}

/// Runs that a floor, a scale and a power need.
const LEAST: usize = 3;
/// How many times the steps of the longest run are looked ahead to.
const AHEAD: [usize; 4] = [2, 4, 16, 64];

/// A run, as far as it matters here.
struct Run {
    name: String,
    steps: usize,
    /// Steps and DSSIM of its validations.
    curve: Vec<(f64, f64)>,
    /// DSSIM of the network that would be exported.
    end: f64,
}

impl Run {
    /// The run of a folder.
    ///
    /// # Errors
    /// If there is none, or it has not come to its end.
    fn load(folder: &Path, config: &TrainConfig) -> Result<Self> {
        let lines = metrics::read(folder)?;
        let done = lines.last().map_or(0, |line| line.step);
        let steps = config.steps;
        ensure!(done == steps, "{}: has come to step {done} of {steps} only", folder.display());
        let curve: Vec<(f64, f64)> = lines
            .iter()
            .filter_map(|line| Some((line.step as f64, f64::from(line.validation_loss?))))
            .collect();
        let end = curve.iter().map(|point| point.1).min_by(f64::total_cmp);
        let end = end.with_context(|| format!("{}: was never validated", folder.display()))?;
        Ok(Self { name: folder.display().to_string(), steps, curve, end })
    }
}

/// Reads the runs, prints and writes what more steps would bring.
///
/// # Errors
/// If a run cannot be read or has not ended, runs differ in more than their steps, or a file cannot be written.
pub fn run(args: &Args) -> Result<()> {
    let runs = runs(&args.runs)?;
    let ends: Vec<(f64, f64)> = runs.iter().map(|run| (run.steps as f64, run.end)).collect();
    let laws = laws(&ends);
    let most = runs[runs.len() - 1].steps;
    let mut figures = Figures::new("forecast");
    let mut rows = vec![["steps", "DSSIM of validation", "SSIM of validation"].map(str::to_owned).to_vec()];
    for Run { steps, end, .. } in &runs {
        figures.set(&format!("dssim_{steps}"), *end);
        rows.push(vec![steps.to_string(), format!("{end:.4}"), format!("{:.4}", similarity(*end))]);
    }
    for (steps, times) in AHEAD.map(|times| (times * most, times)) {
        let Some([low, high]) = laws.map(|laws| bounds(laws, steps as f64)) else { break };
        figures.set(&format!("dssim_low_x{times}"), low);
        figures.set(&format!("dssim_high_x{times}"), high);
        rows.push(vec![
            format!("{steps}, forecast"),
            format!("{low:.4} to {high:.4}"),
            format!("{:.4} to {:.4}", similarity(high), similarity(low)),
        ]);
    }
    let described = laws.iter().flatten().map(|law| json!([law.floor, law.scale, law.exponent]));
    figures.detail("floor_scale_exponent", described.collect());
    figures.write(args.json.as_deref())?;
    if let Some(path) = &args.plot {
        write_atomically(path, plot(&runs, laws.as_ref()).svg("What more steps bring")?.as_bytes())?;
    }
    table::markdown(&rows).iter().try_for_each(|line| say!("{line}"))?;
    match laws {
        Some(laws) => laws.iter().try_for_each(|law| say!("DSSIM = {law}")),
        None => say!("DSSIM does not fall with the steps: more of them would bring nothing"),
    }
}

/// Structural similarity of a dissimilarity.
fn similarity(dssim: f64) -> f64 {
    1.0 - 2.0 * dssim
}

/// The runs of some folders, the shortest first.
fn runs(folders: &[PathBuf]) -> Result<Vec<Run>> {
    let first = TrainConfig::load(&folders[0])?;
    let mut runs = Vec::new();
    for folder in folders {
        let config = TrainConfig::load(folder)?;
        let mut others = config.differences(&first);
        others.retain(|field| field != "steps");
        ensure!(
            others.is_empty(),
            "{} differs from {} in more than its steps: {}",
            folder.display(),
            folders[0].display(),
            others.join(", ")
        );
        runs.push(Run::load(folder, &config)?);
    }
    runs.sort_by_key(|run| run.steps);
    for pair in runs.windows(2) {
        let [a, b] = pair else { continue };
        ensure!(a.steps < b.steps, "{} and {} have as many steps", a.name, b.name);
    }
    Ok(runs)
}

/// The laws that runs' ends may follow, without a floor and with the one that fits best; `None` where they do not fall.
fn laws(ends: &[(f64, f64)]) -> Option<[Law; 2]> {
    Some([Law::fitted(ends, 0.0)?, Law::best(ends)?])
}

/// The least and the most of what laws say of so many steps.
fn bounds(laws: [Law; 2], steps: f64) -> [f64; 2] {
    let [a, b] = laws.map(|law| law.at(steps));
    [a.min(b), a.max(b)]
}

/// Every run's curve, their ends, and both laws beyond these.
fn plot(runs: &[Run], laws: Option<&[Law; 2]>) -> Plot {
    let mut lines: Vec<Line> = runs
        .iter()
        .map(|run| Line {
            name: format!("{} steps", run.steps),
            points: run.curve.clone(),
            style: Style::Curve,
            colour: None,
        })
        .collect();
    let ends = runs.iter().map(|run| (run.steps as f64, run.end)).collect();
    lines.push(Line { name: "ends of runs".to_owned(), points: ends, style: Style::Points, colour: None });
    let (from, to) = (runs[0].steps, AHEAD[AHEAD.len() - 1] * runs[runs.len() - 1].steps);
    for (law, name) in laws.into_iter().flatten().zip(["a power of the steps", "a power above a floor"]) {
        let steps = std::iter::successors(Some(from as f64), |steps| Some(steps * 1.25));
        let points = steps.take_while(|steps| *steps <= to as f64).map(|steps| (steps, law.at(steps)));
        lines.push(Line {
            name: name.to_owned(),
            points: points.collect(),
            style: Style::Curve,
            colour: None,
        });
    }
    Plot { x: "steps", is_logarithmic: true, y: "DSSIM of validation", lines, level: None }
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_infer::{ChannelOrder, NetSpec, Reach};

    /// A finished run of so many steps that ends with this loss.
    fn write_run(folder: &Path, steps: usize, end: f64, seed: u64) -> PathBuf {
        let folder = folder.join(steps.to_string());
        std::fs::create_dir_all(&folder).expect("a folder");
        let reach = Reach { radius: 0.25, diagonal_share: 0.1, height: 64 };
        let spec = NetSpec::ao(ChannelOrder::Interleaved, reach);
        let config = TrainConfig { steps, seed, ..TrainConfig::new(spec, "data".into()) };
        std::fs::write(folder.join("config.json"), serde_json::to_vec(&config).expect("plain"))
            .expect("written");
        let line = |step: usize, loss: f64| {
            format!(
                "{{\"step\":{step},\"loss\":0.3,\"validation_loss\":{loss},\"rate\":0.001,\"images_per_second\":9.0}}\n"
            )
        };
        let text = line(steps / 2, 1.5 * end) + &line(steps, end);
        std::fs::write(folder.join("metrics.jsonl"), text).expect("written");
        folder
    }

    #[test]
    fn more_steps_lie_between_a_law_with_a_floor_and_one_without() {
        let folder = tempfile::tempdir().expect("a folder");
        let law = |steps: usize| 0.1 + 2.0 * (steps as f64).powf(-0.5);
        let folders = [4000, 1000, 2000].map(|steps| write_run(folder.path(), steps, law(steps), 1));
        let (plot, json) = (folder.path().join("a.svg"), folder.path().join("a.json"));
        let args = Args { runs: folders.to_vec(), plot: Some(plot.clone()), json: Some(json.clone()) };
        run(&args).expect("a forecast");
        let file: serde_json::Value =
            serde_json::from_slice(&std::fs::read(json).expect("read")).expect("JSON");
        let figure = |name: &str| file["figures"][name].as_f64().expect("a figure");
        assert!((figure("dssim_high_x4") - law(16_000)).abs() < 1e-4, "{file}");
        assert!(figure("dssim_low_x4") < law(16_000) - 1e-3, "without a floor it falls farther");
        let svg = std::fs::read_to_string(plot).expect("read");
        for name in ["1000 steps", "4000 steps", "a power above a floor"] {
            assert!(svg.contains(name), "{name}");
        }
    }

    #[test]
    fn what_does_not_fall_has_no_forecast() {
        let folder = tempfile::tempdir().expect("a folder");
        let folders = [(1000, 0.2), (2000, 0.3), (4000, 0.4)]
            .map(|(steps, end)| write_run(folder.path(), steps, end, 1));
        let json = folder.path().join("a.json");
        run(&Args { runs: folders.to_vec(), plot: None, json: Some(json.clone()) }).expect("a table");
        let file: serde_json::Value =
            serde_json::from_slice(&std::fs::read(json).expect("read")).expect("JSON");
        let figures: Vec<&String> = file["figures"].as_object().expect("figures").keys().collect();
        assert_eq!(figures, ["dssim_1000", "dssim_2000", "dssim_4000"]);
    }

    #[test]
    fn runs_that_are_no_series_are_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let error = |folders: [PathBuf; 3]| {
            let args = Args { runs: folders.to_vec(), plot: None, json: None };
            format!("{:#}", run(&args).expect_err("no series"))
        };
        let [a, b, c] = [(1000, 0.2), (2000, 0.15), (4000, 0.12)]
            .map(|(steps, end)| write_run(folder.path(), steps, end, 1));
        let other = write_run(&folder.path().join("other"), 4000, 0.12, 2);
        let said = error([a.clone(), b.clone(), other]);
        assert!(said.ends_with("in more than its steps: seed"), "{said}");
        let said = error([a.clone(), b.clone(), b.clone()]);
        assert!(said.ends_with("have as many steps"), "{said}");
        std::fs::write(c.join("metrics.jsonl"), "").expect("written");
        assert!(error([a, b, c]).ends_with("has come to step 0 of 4000 only"), "an unfinished run");
    }
}
