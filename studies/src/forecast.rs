//! `deepshade-studies forecast`: what more steps of training would bring, from runs of one network that
//! differ in their steps alone.
//!
//! A run's own curve does not say where one of fewer steps ends: most of the fall comes as the rate falls, at
//! the end of each.

mod law;

use anyhow::{Context, Result, ensure};
use deepshade::shared::arguments::{svg_file, written_file};
use deepshade::shared::figures::{Figures, write_atomically};
use deepshade::shared::location::Location;
use deepshade::shared::plot::{Line, Plot, Style};
use deepshade::shared::table;
use deepshade_train::metrics;
use deepshade_train::{Optimiser, TrainConfig};
use law::Law;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Extrapolates what more steps would bring from runs that differ in their steps alone.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade train --dataset data/ao --out runs/ao-quarter --steps 5000 \
    --patience 0\n  \
    deepshade train --dataset data/ao --out runs/ao-half --steps 10000 --patience 0\n  \
    deepshade train --dataset data/ao --out runs/ao-whole --steps 20000 --patience 0\n  \
    deepshade-studies forecast runs/ao-quarter runs/ao-half runs/ao-whole --plot forecast.svg\n\n\
    The runs have the same settings but for --steps, --validate-every and --patience, each at least a \
    quarter more steps than the one before, and were validated four times or more. Their last validations \
    count, not their best.\n\n\
    Two laws are fitted to the DSSIM that the runs end with: a power of the steps, which falls for ever, and \
    one above a floor; both also to ends that are higher and lower by as much as they miss the law and as \
    validations differ from one to the next near the end. The range is what all of them say: a wide one says \
    that these runs do not tell. It knows nothing of overfitting.\n\n\
    Figures: dssim_whole, dssim_low_x2, dssim_high_x2, and of 4 and 16 times the steps.")]
pub struct Args {
    /// Folders or addresses of finished runs, three at least, on the same data with the same settings but for
    /// the steps.
    #[arg(required = true, num_args = LEAST..=MOST, value_name = "RUN")]
    runs: Vec<Location>,
    /// Draws the curves, their ends and the range into this SVG file.
    #[arg(long, value_parser = svg_file)]
    plot: Option<PathBuf>,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = written_file)]
    json: Option<PathBuf>,
}

/// Runs that a floor, a scale and a power need.
const LEAST: usize = 3;
/// More make twice as many ways each in which their ends may be off.
const MOST: usize = 8;
/// How many times the steps of the longest run are looked ahead to.
const AHEAD: [usize; 3] = [2, 4, 16];
/// Settings that may differ: the steps, how often they are validated, and what ends a run before its last
/// one, as it has not.
const FREE: [&str; 3] = ["steps", "validate_every", "patience"];
/// Validations that tell how far they are apart by chance.
const VALIDATIONS: usize = 4;

/// A run, as far as it matters here.
struct ForecastRun {
    name: String,
    steps: usize,
    /// Steps and DSSIM of its validations.
    curve: Vec<(f64, f64)>,
    /// The last of these.
    end: f64,
    /// How far validations near the end are from each other by chance.
    noise: f64,
}

impl ForecastRun {
    /// The run of a folder.
    ///
    /// # Errors
    /// If there is none, or it has not come to its last step.
    fn load(name: String, folder: &Path, config: &TrainConfig) -> Result<Self> {
        let lines = metrics::read(folder)?;
        let done = lines.last().map_or(0, |line| line.step);
        let steps = config.steps;
        ensure!(
            done == steps,
            "{name}: has come to step {done} of {steps} only; the same command goes on, and what has stopped \
            early is trained anew with --patience 0, into another folder"
        );
        if let Optimiser::Adamw { warm_up, .. } = config.optimiser {
            ensure!(
                steps > 2 * warm_up,
                "{name}: of its {steps} steps the rate rises in {warm_up}: it is too short for what longer ones do"
            );
        }
        let curve: Vec<(f64, f64)> = lines
            .iter()
            .filter_map(|line| Some((line.step as f64, f64::from(line.validation_loss?))))
            .collect();
        ensure!(
            curve.len() >= VALIDATIONS,
            "{name}: was validated {} times, which is too few to know how much is chance; --validate-every {} would do",
            curve.len(),
            steps / VALIDATIONS
        );
        let (end, noise) = (curve[curve.len() - 1].1, noise(&curve));
        Ok(Self { name, steps, curve, end, noise })
    }
}

/// By how much one of the last validations, a fifth of all, is off by chance: the root of half the mean
/// squared difference between neighbours. At least three are looked at, of which there must be as many.
fn noise(curve: &[(f64, f64)]) -> f64 {
    let last = &curve[curve.len() - (curve.len() / 5).max(3)..];
    let squares: Vec<f64> = last.windows(2).map(|pair| (pair[1].1 - pair[0].1).powi(2)).collect();
    (0.5 * squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// Reads the runs, prints and writes what more steps would bring.
///
/// # Errors
/// If a run cannot be read or has not ended, runs differ in more than their steps, or a file cannot be
/// written.
pub fn run(args: &Args) -> Result<()> {
    ensure!(args.json.is_none() || args.json != args.plot, "--json and --plot are the same file");
    let runs = runs(&args.runs)?;
    let longest = &runs[runs.len() - 1];
    let (most, end) = (longest.steps, longest.end);
    let laws = laws(&runs);
    let mut figures = Figures::new("forecast");
    figures.set("dssim_whole", end);
    let mut rows = vec![["steps", "DSSIM of validation", "SSIM of validation"].map(str::to_owned).to_vec()];
    rows.extend(runs.iter().map(|ForecastRun { steps, end, .. }| {
        vec![steps.to_string(), format!("{end:.4}"), format!("{:.4}", similarity(*end))]
    }));
    for times in AHEAD {
        let steps = times * most;
        let Some([low, high]) = bounds(&laws, steps as f64) else { break };
        figures.set(&format!("dssim_low_x{times}"), low);
        figures.set(&format!("dssim_high_x{times}"), high);
        rows.push(vec![
            format!("{steps}, forecast"),
            format!("{low:.4} to {high:.4}"),
            format!("{:.4} to {:.4}", similarity(high), similarity(low)),
        ]);
    }
    let described = runs.iter().map(|ForecastRun { name, steps, end, noise, .. }| {
        json!({ "run": name, "steps": steps, "dssim": end, "noise": noise })
    });
    figures.detail("runs", described.collect());
    figures.write(args.json.as_deref())?;
    if let Some(path) = &args.plot {
        write_atomically(path, plot(&runs, &laws).svg("What more steps bring")?.as_bytes())?;
    }
    table::markdown(&rows).iter().try_for_each(|line| say!("{line}"))?;
    match laws.is_empty() {
        true => say!(
            "nothing can be extrapolated: DSSIM does not fall with the steps, or not as a power of them does"
        ),
        false => Ok(()),
    }
}

/// Structural similarity of a dissimilarity.
fn similarity(dssim: f64) -> f64 {
    1.0 - 2.0 * dssim
}

/// The runs of some places, the shortest first.
fn runs(locations: &[Location]) -> Result<Vec<ForecastRun>> {
    let mut first: Option<(String, TrainConfig)> = None;
    let mut runs = Vec::new();
    for location in locations {
        let (name, folder) = (location.to_string(), location.read()?);
        let config = TrainConfig::load(&folder).with_context(|| format!("{name} is no training run"))?;
        let (first_name, first) = first.get_or_insert_with(|| (name.clone(), config.clone()));
        let mut others = config.differences(first);
        others.retain(|field| !FREE.contains(&field.as_str()));
        let others = others.join(", ");
        ensure!(others.is_empty(), "{name} differs from {first_name} in more than its steps: {others}");
        runs.push(ForecastRun::load(name, &folder, &config)?);
    }
    runs.sort_by_key(|run| run.steps);
    for pair in runs.windows(2) {
        let [a, b] = pair else { continue };
        let [few, many] = [a.steps, b.steps];
        ensure!(
            5 * few <= 4 * many,
            "{} and {} have {few} and {many} steps, which is less than a quarter more",
            a.name,
            b.name
        );
    }
    Ok(runs)
}

/// The laws that runs' ends may follow, each without a floor and with the best one: first of the ends
/// themselves, then of ends that are off, each up or down, by their noise and by how far the best law misses
/// them. None where ends do not fall.
fn laws(runs: &[ForecastRun]) -> Vec<Law> {
    let exact: Vec<(f64, f64)> = runs.iter().map(|run| (run.steps as f64, run.end)).collect();
    let Some(best) = Law::with_floor(&exact) else { return Vec::new() };
    // A law has three numbers to fit with.
    let free = runs.len().saturating_sub(3).max(1) as f64;
    let missed = exact.iter().map(|(steps, end)| (best.at(*steps) - end).powi(2)).sum::<f64>() / free;
    let ends = |offset: &dyn Fn(usize) -> f64| -> Vec<(f64, f64)> {
        let off = |run: &ForecastRun| (run.noise.powi(2) + missed).sqrt();
        let moved =
            |(index, run): (usize, &ForecastRun)| (run.steps as f64, run.end + offset(index) * off(run));
        runs.iter().enumerate().map(moved).collect()
    };
    let of = |ends: &[(f64, f64)]| [Law::without_floor(ends), Law::with_floor(ends)].into_iter().flatten();
    let mut laws: Vec<Law> = of(&exact).collect();
    for signs in 0..1usize << runs.len() {
        laws.extend(of(&ends(&|index| if signs >> index & 1 == 1 { 1.0 } else { -1.0 })));
    }
    laws
}

/// The least and the most of what laws say of so many steps.
fn bounds(laws: &[Law], steps: f64) -> Option<[f64; 2]> {
    let all = laws.iter().map(|law| law.at(steps));
    let (low, high) = all.fold((f64::MAX, f64::MIN), |(low, high), loss| (low.min(loss), high.max(loss)));
    (low <= high).then_some([low, high])
}

/// Every run's curve, their ends, and the range beyond these.
fn plot(runs: &[ForecastRun], laws: &[Law]) -> Plot {
    let line = |name: &str, points: Vec<(f64, f64)>, style: Style| Line {
        name: name.to_owned(),
        points,
        style,
        colour: None,
    };
    let mut lines: Vec<Line> = runs
        .iter()
        .map(|run| line(&format!("{} steps", run.steps), run.curve.clone(), Style::Curve))
        .collect();
    let ends = runs.iter().map(|run| (run.steps as f64, run.end)).collect();
    lines.push(line("ends of runs", ends, Style::Points));
    let most = runs[runs.len() - 1].steps;
    let steps =
        || (0..=32).map(|part| most as f64 * (AHEAD[AHEAD.len() - 1] as f64).powf(f64::from(part) / 32.0));
    for (side, name) in ["forecast, lowest", "forecast, highest"].into_iter().enumerate() {
        let points = steps().filter_map(|steps| Some((steps, bounds(laws, steps)?[side])));
        lines.push(line(name, points.collect(), Style::Curve));
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
        // Validations differ by 0.0001 by chance.
        let noise = 1e-4 * std::f64::consts::SQRT_2;
        let text = line(steps / 8, 2.0 * end)
            + &line(steps / 2, 1.5 * end)
            + &line(steps - 2, end)
            + &line(steps - 1, end + noise)
            + &line(steps, end);
        std::fs::write(folder.join("metrics.jsonl"), text).expect("written");
        folder
    }

    fn locations(folders: &[PathBuf]) -> Vec<Location> {
        folders.iter().map(|folder| folder.to_str().expect("plain").parse().expect("a folder")).collect()
    }

    #[test]
    fn chance_is_told_from_how_neighbours_differ() {
        let curve = |losses: &[f64]| losses.iter().map(|loss| (1.0, *loss)).collect::<Vec<_>>();
        let [a, b] = [0.1, 0.1 + 2e-3];
        let steady = noise(&curve(&[0.9, 0.5, a, b, a, b]));
        assert!((steady - 2e-3 / std::f64::consts::SQRT_2).abs() < 1e-12, "{steady}");
    }

    #[test]
    fn more_steps_lie_between_a_law_with_a_floor_and_one_without() {
        let folder = tempfile::tempdir().expect("a folder");
        let law = |steps: usize| 0.1 + 2.0 * (steps as f64).powf(-0.5);
        let folders = [4000, 1000, 2000].map(|steps| write_run(folder.path(), steps, law(steps), 1));
        let (plot, json) = (folder.path().join("a.svg"), folder.path().join("a.json"));
        let args = Args { runs: locations(&folders), plot: Some(plot.clone()), json: Some(json.clone()) };
        run(&args).expect("a forecast");
        let file: serde_json::Value =
            serde_json::from_slice(&std::fs::read(json).expect("read")).expect("JSON");
        let figure = |name: &str| file["figures"][name].as_f64().expect("a figure");
        assert!(figure("dssim_low_x4") < law(16_000) - 1e-3, "without a floor it falls farther");
        assert!((figure("dssim_high_x4") - law(16_000)).abs() < 1e-3, "with one it falls as it does: {file}");
        let svg = std::fs::read_to_string(plot).expect("read");
        for name in ["1000 steps", "4000 steps", "forecast, highest"] {
            assert!(svg.contains(name), "{name}");
        }
    }

    #[test]
    fn what_does_not_fall_has_no_forecast() {
        let folder = tempfile::tempdir().expect("a folder");
        let folders = [(1000, 0.2), (2000, 0.3), (4000, 0.4)]
            .map(|(steps, end)| write_run(folder.path(), steps, end, 1));
        let json = folder.path().join("a.json");
        run(&Args { runs: locations(&folders), plot: None, json: Some(json.clone()) }).expect("a table");
        let file: serde_json::Value =
            serde_json::from_slice(&std::fs::read(json).expect("read")).expect("JSON");
        let figures: Vec<&String> = file["figures"].as_object().expect("figures").keys().collect();
        assert_eq!(figures, ["dssim_whole"]);
    }

    #[test]
    fn runs_that_are_no_series_are_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let error = |folders: [PathBuf; 3]| {
            let args = Args { runs: locations(&folders), plot: None, json: None };
            format!("{:#}", run(&args).expect_err("no series"))
        };
        let [a, b, c] = [(1000, 0.2), (2000, 0.15), (4000, 0.12)]
            .map(|(steps, end)| write_run(folder.path(), steps, end, 1));
        let other = write_run(&folder.path().join("other"), 4000, 0.12, 2);
        let said = error([a.clone(), b.clone(), other]);
        assert!(said.ends_with("in more than its steps: seed"), "{said}");
        let said = error([a.clone(), b.clone(), b.clone()]);
        assert!(said.ends_with("have 2000 and 2000 steps, which is less than a quarter more"), "{said}");
        let lines = std::fs::read_to_string(c.join("metrics.jsonl")).expect("read");
        let last = lines.lines().last().expect("a line");
        std::fs::write(c.join("metrics.jsonl"), format!("{last}\n")).expect("written");
        let said = error([a.clone(), b.clone(), c.clone()]);
        assert!(
            said.contains("was validated 1 times") && said.ends_with("--validate-every 1000 would do"),
            "{said}"
        );
        std::fs::write(c.join("metrics.jsonl"), "").expect("written");
        assert!(
            error([a.clone(), b.clone(), c]).contains("has come to step 0 of 4000 only"),
            "an unfinished run"
        );
        let short = write_run(folder.path(), 300, 0.3, 1);
        assert!(error([a, b, short]).contains("of its 300 steps the rate rises in 200"), "too short");
    }
}
