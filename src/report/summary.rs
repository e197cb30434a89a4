//! A comparison's means, line by line: what the terminal, the page, the Markdown file and the JSON file all show.

use super::record::FrameRecord;
use super::{Report, floor_colour, floor_name};
use crate::figures::Figures;
use crate::table;
use deepshade_render::method::Clock;
use deepshade_render::metrics::Scores;
use deepshade_shaders::Effect;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::fmt;

/// What a line is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A method.
    Method,
    /// Truth's own noise.
    Ceiling,
    /// An image of background.
    Floor,
}

/// A line of a table: means over some frames.
#[derive(Clone, Debug)]
pub struct Line {
    /// What it is called, with how many of the frames it is of where these are not all.
    pub name: String,
    /// What a method's figures are called by.
    pub label: String,
    /// What it is of.
    pub kind: Kind,
    /// The method's name; empty of truth and the floor.
    pub method: String,
    /// What its files are called, of a method and of truth.
    pub file: Option<String>,
    /// Mean scores.
    pub scores: Scores,
    /// Mean time of a run, milliseconds.
    pub milliseconds: Option<f64>,
    /// Which clock it is from, and of what.
    pub measured_by: String,
    /// What it ran on.
    pub device: String,
}

impl Kind {
    /// Its name on pages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Method => "method",
            Self::Ceiling => "ceiling",
            Self::Floor => "floor",
        }
    }
}

/// A line for each method of some frames of an effect, means over those that have it, and then those to read them beside.
pub fn lines(effect: Effect, frames: &[&FrameRecord]) -> Vec<Line> {
    let mut labels: Vec<&str> = Vec::new();
    for image in frames.iter().flat_map(|frame| &frame.images) {
        if !labels.contains(&image.label.as_str()) {
            labels.push(&image.label);
        }
    }
    let mut lines: Vec<Line> = labels.into_iter().map(|label| method_line(label, frames)).collect();
    let all = |of: fn(&FrameRecord) -> Scores| mean_scores(frames.iter().map(|frame| of(frame)));
    let time = mean(frames.iter().map(|frame| frame.truth.milliseconds));
    lines.push(Line {
        name: "truth, half against half".to_owned(),
        label: String::new(),
        kind: Kind::Ceiling,
        method: String::new(),
        file: Some(super::record::TRUTH.to_owned()),
        scores: all(|frame| frame.truth.noise),
        milliseconds: Some(time),
        measured_by: clock_name(Clock::Cpu).to_owned(),
        device: "the processor".to_owned(),
    });
    lines.push(Line {
        name: floor_name(effect),
        label: String::new(),
        kind: Kind::Floor,
        method: String::new(),
        file: None,
        scores: all(|frame| frame.truth.floor),
        milliseconds: None,
        measured_by: String::new(),
        device: String::new(),
    });
    lines
}

fn method_line(label: &str, frames: &[&FrameRecord]) -> Line {
    let images: Vec<_> =
        frames.iter().flat_map(|frame| &frame.images).filter(|image| image.label == label).collect();
    let some = images.len() < frames.len();
    let name = match some {
        true => format!("{label} ({} of {} frames)", images.len(), frames.len()),
        false => label.to_owned(),
    };
    let clocks: BTreeSet<_> = images.iter().map(|image| clock_name(image.clock)).collect();
    let clock = if clocks.len() == 1 { clock_name(images[0].clock) } else { "mixed" };
    Line {
        name,
        label: label.to_owned(),
        kind: Kind::Method,
        method: images[0].method.clone(),
        file: Some(images[0].file.clone()),
        scores: mean_scores(images.iter().map(|image| image.scores)),
        milliseconds: Some(mean(images.iter().map(|image| image.milliseconds))),
        measured_by: format!("{clock}, {}", images[0].device),
        device: images[0].device.clone(),
    }
}

/// Labels of methods of which the mean SSIM is below that of an image of background on the same frames:
/// whoever does nothing is better.
pub fn behind_nothing<'a>(frames: &[&'a FrameRecord]) -> Vec<&'a str> {
    let mut sums: Vec<(&str, f64)> = Vec::new();
    for (frame, image) in frames.iter().flat_map(|frame| frame.images.iter().map(move |image| (frame, image)))
    {
        let ahead = image.scores.ssim - frame.truth.floor.ssim;
        match sums.iter_mut().find(|(label, _)| *label == image.label) {
            Some((_, sum)) => *sum += ahead,
            None => sums.push((&image.label, ahead)),
        }
    }
    sums.into_iter().filter(|(_, sum)| *sum < 0.0).map(|(label, _)| label).collect()
}

/// That in a sentence, where there are some.
pub fn said_behind(effect: Effect, frames: &[&FrameRecord]) -> Option<String> {
    let behind = behind_nothing(frames);
    (!behind.is_empty()).then(|| format!("behind the {} by SSIM: {}", floor_name(effect), behind.join(", ")))
}

/// The mean of some numbers, of which there is one at least.
pub fn mean(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = values.clone().count();
    values.sum::<f64>() / count as f64
}

fn mean_scores(scores: impl Iterator<Item = Scores> + Clone) -> Scores {
    let of = |score: fn(Scores) -> f64| mean(scores.clone().map(score));
    Scores {
        ssim: of(|scores| scores.ssim),
        psnr: of(|scores| scores.psnr),
        flip: of(|scores| scores.flip),
        relative_mse: of(|scores| scores.relative_mse),
    }
}

const fn clock_name(clock: Clock) -> &'static str {
    match clock {
        Clock::Gpu => "GPU timestamps",
        Clock::Cpu => "wall clock",
    }
}

/// Names of the columns of a line's numbers.
pub const COLUMNS: [&str; 5] = ["SSIM", "PSNR", "FLIP", "relMSE", "ms"];

impl Line {
    /// Its numbers as [`COLUMNS`] name them, with as many digits as tables show.
    pub fn cells(&self) -> [String; 5] {
        let Scores { ssim, psnr, flip, relative_mse } = self.scores;
        let milliseconds = self.milliseconds.map_or_else(String::new, |value| format!("{value:.2}"));
        [
            format!("{ssim:.3}"),
            format!("{psnr:.1}"),
            format!("{flip:.3}"),
            format!("{relative_mse:.4}"),
            milliseconds,
        ]
    }

    /// The name that figures have for it.
    fn figure_name(&self, effect: Effect) -> String {
        match self.kind {
            Kind::Method => self.label.replace('-', "_"),
            Kind::Ceiling => "ceiling".to_owned(),
            Kind::Floor => floor_colour(effect).to_owned(),
        }
    }
}

impl Report {
    /// Sets `ssim_<method>`, `psnr_<method>`, `flip_<method>`, `relmse_<method>` and `ms_<method>`, means over
    /// frames, with underscores for hyphens; the same of truth's noise (`ssim_ceiling`, ...) and of the image of background
    /// (`ssim_white` or `ssim_black`, ...); and every frame's own as a detail. Of several effects each figure has the
    /// effect's name in it: `ssim_gi_<method>`.
    pub fn set_figures(&self, figures: &mut Figures) {
        let effects = self.effects();
        for effect in &effects {
            let of = if effects.len() == 1 {
                String::new()
            } else {
                format!("{}_", effect.name().replace('-', "_"))
            };
            for line in lines(*effect, &self.frames_of(*effect)) {
                let name = format!("{of}{}", line.figure_name(*effect));
                set_scores(figures, &name, line.scores);
                match (line.kind, line.milliseconds) {
                    (Kind::Ceiling, Some(time)) => figures.set(&format!("ms_{of}truth"), time),
                    (_, Some(time)) => figures.set(&format!("ms_{name}"), time),
                    (_, None) => {}
                }
            }
        }
        figures.set("frames", self.frames.len() as f64);
        figures.detail("frames", self.frames.iter().map(frame_detail).collect());
        figures.detail("machine", pairs(&self.machine));
    }
}

fn set_scores(figures: &mut Figures, name: &str, scores: Scores) {
    figures.set(&format!("ssim_{name}"), scores.ssim);
    figures.set(&format!("psnr_{name}"), scores.psnr);
    figures.set(&format!("flip_{name}"), scores.flip);
    figures.set(&format!("relmse_{name}"), scores.relative_mse);
}

fn frame_detail(frame: &FrameRecord) -> Value {
    let methods = frame.images.iter().map(|image| {
        let (scores, milliseconds, device) = (image.scores, image.milliseconds, &image.device);
        let value = json!({ "scores": scores, "milliseconds": milliseconds, "device": device });
        (image.label.clone(), value)
    });
    json!({
        "name": frame.name,
        "effect": frame.effect,
        "scene": frame.scene,
        "view": frame.view,
        "folder": frame.folder,
        "facts": pairs(&frame.facts),
        "methods": methods.collect::<serde_json::Map<_, _>>(),
        "ceiling": frame.truth.noise,
        floor_colour(frame.effect): frame.truth.floor,
    })
}

fn pairs(pairs: &[(String, String)]) -> Value {
    pairs.iter().map(|(name, value)| (name.clone(), json!(value))).collect::<serde_json::Map<_, _>>().into()
}

/// The means as a table an effect.
impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for effect in self.effects() {
            let frames = self.frames_of(effect);
            let head = format!("{effect} on {} frame(s), quality {}", frames.len(), self.quality);
            let head = [head].into_iter().chain(COLUMNS.map(str::to_owned)).chain(["on".to_owned()]);
            let mut rows: Vec<Vec<String>> = vec![head.collect()];
            rows.extend(lines(effect, &frames).into_iter().map(|line| {
                let cells = line.cells();
                [line.name].into_iter().chain(cells).chain([line.device]).collect()
            }));
            writeln!(f, "{}", table::aligned(&rows))?;
            said_behind(effect, &frames).iter().try_for_each(|said| writeln!(f, "{said}"))?;
            writeln!(f)?;
        }
        Ok(())
    }
}
