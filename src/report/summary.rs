//! A comparison's means as text for the terminal and as figures for JSON.

use super::{Comparison, FrameReport, floor_colour, floor_name};
use crate::figures::Figures;
use crate::table;
use deepshade_render::metrics::Scores;
use deepshade_shaders::Effect;
use serde_json::{Value, json};
use std::fmt;

impl Comparison {
    /// Sets `ssim_<method>`, `psnr_<method>`, `flip_<method>`, `relmse_<method>` and `ms_<method>`, means over
    /// frames, with underscores for hyphens; the same of truth's noise (`ssim_ceiling`, ...) and of the image of background
    /// (`ssim_white` or `ssim_black`, ...); and every frame's own as a detail.
    pub fn set_figures(&self, figures: &mut Figures) {
        for (index, method) in self.frames[0].methods.iter().enumerate() {
            let name = method.name.replace('-', "_");
            set_scores(figures, &name, self.mean_scores(|frame| frame.methods[index].scores));
            figures.set(&format!("ms_{name}"), self.mean(|frame| frame.methods[index].milliseconds));
        }
        set_scores(figures, "ceiling", self.mean_scores(|frame| frame.truth.noise));
        set_scores(figures, floor_colour(self.effect), self.mean_scores(|frame| frame.truth.floor));
        figures.set("ms_truth", self.mean(|frame| frame.truth.milliseconds));
        figures.set("frames", self.frames.len() as f64);
        let detail = |frame| frame_detail(self.effect, frame);
        figures.detail("frames", self.frames.iter().map(detail).collect());
        figures.detail("machine", pairs(&self.machine));
    }
}

fn set_scores(figures: &mut Figures, name: &str, scores: Scores) {
    figures.set(&format!("ssim_{name}"), scores.ssim);
    figures.set(&format!("psnr_{name}"), scores.psnr);
    figures.set(&format!("flip_{name}"), scores.flip);
    figures.set(&format!("relmse_{name}"), scores.relative_mse);
}

fn frame_detail(effect: Effect, frame: &FrameReport) -> Value {
    let methods = frame.methods.iter().map(|method| {
        (
            method.name.clone(),
            json!({ "scores": method.scores, "milliseconds": method.milliseconds, "device": method.device }),
        )
    });
    json!({
        "name": frame.name,
        "facts": pairs(&frame.facts),
        "methods": methods.collect::<serde_json::Map<_, _>>(),
        "ceiling": frame.truth.noise,
        floor_colour(effect): frame.truth.floor,
    })
}

fn pairs(pairs: &[(String, String)]) -> Value {
    pairs.iter().map(|(name, value)| (name.clone(), json!(value))).collect::<serde_json::Map<_, _>>().into()
}

/// The means as a table.
impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let head =
            format!("{} on {} frame(s), quality {}", self.effect, self.frames.len(), self.quality.name());
        let mut rows =
            vec![[&head, "SSIM", "PSNR", "FLIP", "relMSE", "ms", "on"].map(str::to_owned).to_vec()];
        for (index, method) in self.frames[0].methods.iter().enumerate() {
            let milliseconds = self.mean(|frame| frame.methods[index].milliseconds);
            let scores = self.mean_scores(|frame| frame.methods[index].scores);
            rows.push(row(&method.name, scores, Some(milliseconds), &method.device));
        }
        let milliseconds = self.mean(|frame| frame.truth.milliseconds);
        let noise = self.mean_scores(|frame| frame.truth.noise);
        rows.push(row("truth, half against half", noise, Some(milliseconds), "the processor"));
        rows.push(row(&floor_name(self.effect), self.mean_scores(|frame| frame.truth.floor), None, ""));
        writeln!(f, "{}", table::aligned(&rows))
    }
}

fn row(name: &str, scores: Scores, milliseconds: Option<f64>, device: &str) -> Vec<String> {
    let Scores { ssim, psnr, flip, relative_mse } = scores;
    let milliseconds = milliseconds.map_or_else(String::new, |value| format!("{value:.2}"));
    vec![
        name.to_owned(),
        format!("{ssim:.3}"),
        format!("{psnr:.1}"),
        format!("{flip:.3}"),
        format!("{relative_mse:.4}"),
        milliseconds,
        device.to_owned(),
    ]
}
