//! Bevy, with the crate in `bevy/`: its tests, and Bevy's own ambient occlusion and depth of field beside the
//! networks'.

use crate::command::{self, root, target};
use crate::program::Program;
use anyhow::{Context, Result, ensure};
use serde_json::Value;
use std::path::PathBuf;
use std::process::Command;

/// What the example measures and is told: mean scores of frames, of occlusion against path-traced truth, of
/// depth of field against the mean of Bevy's own frames over the lens; milliseconds; and the largest
/// difference from the program's image of the same frame.
const FIGURES: [&str; 24] = [
    "max_abs_bevy",
    "stray_bevy",
    "ssim_bevy_ssao",
    "ssim_bevy_ssao_64",
    "ssim_bevy_ssao_custom",
    "ssim_bevy_learned",
    "ssim_bevy_learned_small",
    "mean_abs_bevy_ssao",
    "mean_abs_bevy_learned",
    "mean_abs_bevy_learned_small",
    "ms_bevy_ssao",
    "ms_bevy_ssao_custom",
    "ms_bevy_learned",
    "ms_bevy_learned_small",
    "max_abs_bevy_dof",
    "ssim_bevy_dof",
    "ssim_bevy_dof_best",
    "ssim_bevy_dof_learned",
    "ssim_bevy_dof_none",
    "mean_abs_bevy_dof",
    "mean_abs_bevy_dof_learned",
    "mean_abs_bevy_dof_none",
    "ms_bevy_dof",
    "ms_bevy_dof_learned",
];
/// Largest difference. Rounding moves borders of what `gtao` counts, as between two devices.
const WORST: f64 = 0.05;
/// Share of an image's values that may be off by more than 2e-3.
const STRAY: f64 = 0.01;

/// Runs the crate's tests, then its example that measures; pictures go below the target folder.
///
/// # Errors
/// If the crate does not build, a test fails, or an image is not the program's.
pub fn test(program: &Program) -> Result<Vec<(String, f64)>> {
    let stage = target().join("hosts-bevy");
    std::fs::create_dir_all(&stage).with_context(|| stage.display().to_string())?;
    let json = stage.join("figures.json");
    command::run(&mut cargo("test"))?;
    let mut measure = cargo("run");
    measure.args(["--example", "measure", "--", "--program"]).arg(absolute(program.path().to_owned())?);
    measure.arg("--json").arg(absolute(json.clone())?).arg("--out").arg(absolute(stage)?);
    command::run(&mut measure)?;
    let text = std::fs::read_to_string(&json).with_context(|| json.display().to_string())?;
    let measured: Value = serde_json::from_str(&text)?;
    let figure = |name: &str| {
        let value = measured["figures"][name].as_f64();
        value.with_context(|| format!("{}: no figure {name}", json.display()))
    };
    for effect in ["bevy", "bevy_dof"] {
        let [worst, stray] = ["max_abs", "stray"].map(|name| figure(&format!("{name}_{effect}")));
        let (worst, stray) = (worst?, stray?);
        let percent = 100.0 * stray;
        ensure!(worst < WORST && stray < STRAY, "{effect}: off by up to {worst}; {percent:.2} % stray");
    }
    FIGURES.into_iter().map(|name| Ok((name.to_owned(), figure(name)?))).collect()
}

/// Cargo in the crate's folder, of the toolchain that stands there: Bevy wants a newer one than the program.
fn cargo(verb: &str) -> Command {
    let mut command = command::command("cargo", &[verb, "--locked", "--ignore-rust-version"]);
    command.current_dir(root().join("bevy"));
    // What rustup has told this program of its own toolchain.
    ["RUSTUP_TOOLCHAIN", "CARGO", "RUSTC", "RUSTDOC"].iter().for_each(|name| {
        command.env_remove(name);
    });
    command
}

fn absolute(path: PathBuf) -> Result<PathBuf> {
    std::path::absolute(&path).with_context(|| path.display().to_string())
}
