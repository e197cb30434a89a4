//! What an evaluation prints: a table for each test set, one of the network against its strongest rivals, and
//! the scenes in which it is worse than doing nothing.

use super::outcome::{EvaluationOutcome, NetworkComparison, Scored};
use super::rivals::Rival;
use crate::methods::LEARNED;
use crate::statistics::MeanInterval;
use crate::table;
use anyhow::Result;
use deepshade_render::methods::Quality;
use deepshade_shaders::Effect;

/// Prints everything.
///
/// # Errors
/// If nobody reads it.
pub fn print(effect: Effect, outcome: &EvaluationOutcome) -> Result<()> {
    for set in &outcome.sets {
        let of = if outcome.is_divided() { format!(", {}", set.title) } else { String::new() };
        say!(
            "{effect}{of}: {} frames of {} scenes, FLIP of {} of them; means over scenes with 95 % confidence \
             intervals, milliseconds on the device that is named",
            set.evaluation.frames,
            set.evaluation.scenes.len(),
            set.evaluation.frames_of_flip()
        )?;
        say!("{}", methods(effect, &outcome.rivals, set))?;
    }
    let pairs = outcome.pairs();
    if !pairs.is_empty() {
        say!(
            "\n`{LEARNED}` less the best by SSIM of the methods that take no longer on the same device, or the \
             fastest where all take longer, on the same frames; better is more of SSIM and PSNR, less of FLIP \
             and relMSE"
        )?;
        say!("{}", table::aligned(&differences(&pairs)))?;
    }
    match outcome.below_trivial(effect) {
        Some(scenes) if !scenes.is_empty() => {
            let (count, names) = (scenes.len(), scenes.join(", "));
            say!(
                "\n`{LEARNED}` is behind the {} image in {count} scenes: {names}",
                effect.definition().doing_nothing.name()
            )
        }
        _ => Ok(()),
    }
}

/// One row a method.
fn methods(effect: Effect, rivals: &[Rival], set: &Scored) -> String {
    let head = ["method", "quality", "SSIM", "PSNR (dB)", "FLIP", "relMSE", "bias", "ms", "on"];
    let (estimates, devices) = (set.evaluation.estimates(), &set.evaluation.devices);
    let row = |name: &str, method: &str, quality: String| {
        let found = |metric: &str| estimates.get(format!("{metric}_{name}").as_str());
        let interval = |metric: &str| found(metric).map_or(String::new(), MeanInterval::to_string);
        let number = |metric: &str, digits: usize| {
            found(metric).map_or(String::new(), |estimate| format!("{:.digits$}", estimate.mean))
        };
        vec![
            method.to_owned(),
            quality,
            interval("ssim"),
            interval("psnr"),
            interval("flip"),
            number("relmse", 4),
            number("bias", 4),
            number("ms", 2),
            devices.get(name).cloned().unwrap_or_default(),
        ]
    };
    let methods = rivals.iter().map(|rival| row(&rival.name, rival.method_name, tuned(rival)));
    let others =
        [effect.definition().doing_nothing.name(), "ceiling"].map(|name| row(name, name, String::new()));
    let rows: Vec<_> = [head.map(str::to_owned).to_vec()].into_iter().chain(methods).chain(others).collect();
    table::aligned(&rows)
}

/// A rival's quality, and what of it is set by hand.
pub(super) fn tuned(rival: &Rival) -> String {
    let quality = rival.quality.map_or("", Quality::name);
    [quality, &rival.changes.to_string()].join(" ").trim().to_owned()
}

/// A head, and one row a pair.
pub(super) fn differences(pairs: &[NetworkComparison<'_>]) -> Vec<Vec<String>> {
    let head = ["test set", "against", "its ms", "ms", "SSIM", "PSNR (dB)", "FLIP", "relMSE"];
    let row = |versus: &NetworkComparison<'_>| {
        let pair = &versus.pair;
        let milliseconds = |time: f64| format!("{time:.2}");
        let own = milliseconds(pair.milliseconds.0);
        let rival = pair.milliseconds.1.map_or("on another device".to_owned(), milliseconds);
        let against = format!("{} {}", pair.rival.method_name, tuned(pair.rival)).trim().to_owned();
        let [ssim, psnr, flip, relmse] = pair.differences;
        let text = |difference: Option<MeanInterval>, digits: usize| {
            difference.map_or(String::new(), |MeanInterval { mean, low, high }| {
                format!("{mean:+.digits$} [{low:+.digits$}, {high:+.digits$}]")
            })
        };
        let numbers = [text(ssim, 3), text(psnr, 2), text(flip, 3), text(relmse, 4)];
        [versus.title.to_owned(), against, rival, own].into_iter().chain(numbers).collect()
    };
    [head.map(str::to_owned).to_vec()].into_iter().chain(pairs.iter().map(row)).collect()
}
