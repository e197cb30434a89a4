//! A comparison's means, line by line: what the terminal, the page, the Markdown file and the JSON file all
//! show.

use super::record::FrameRecord;
use super::{Report, floor_name, noise, times};
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
    /// Which clock that is from; empty without one.
    pub clock: &'static str,
    /// What it ran on; of frames that ran on several devices, that in words.
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

/// A line for each method of some frames of an effect, means over those that have it, and then those to read
/// them beside.
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
        clock: clock_name(Clock::Cpu),
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
        clock: "",
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
    let devices: BTreeSet<_> = images.iter().map(|image| image.device.as_str()).collect();
    Line {
        name,
        label: label.to_owned(),
        kind: Kind::Method,
        method: images[0].method.clone(),
        file: Some(images[0].file.clone()),
        scores: mean_scores(images.iter().map(|image| image.scores)),
        milliseconds: Some(mean(images.iter().map(|image| image.milliseconds))),
        clock: if clocks.len() == 1 { clock_name(images[0].clock) } else { "several clocks" },
        device: if devices.len() == 1 { images[0].device.clone() } else { "several devices".to_owned() },
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

/// What is to be said of the lines of some frames of an effect: whose times they have, who is not told apart,
/// and who is behind doing nothing.
pub fn remarks(effect: Effect, frames: &[&FrameRecord]) -> Vec<String> {
    let lines = lines(effect, frames);
    times::said(&lines).into_iter().chain(noise::said(&lines)).chain(said_behind(effect, frames)).collect()
}

/// Who is behind doing nothing in a sentence, where there are some.
fn said_behind(effect: Effect, frames: &[&FrameRecord]) -> Option<String> {
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
    /// Its time, if that is a method's on a device.
    pub fn time_on(&self, device: Option<&str>) -> Option<f64> {
        let there = self.kind == Kind::Method && device == Some(self.device.as_str());
        self.milliseconds.filter(|_| there)
    }

    /// Its numbers as [`COLUMNS`] name them, with as many digits as tables show; the time if it is of a
    /// device.
    pub fn cells(&self, device: Option<&str>) -> [String; 5] {
        let Scores { ssim, psnr, flip, relative_mse } = self.scores;
        let milliseconds = self.time_on(device).map_or_else(String::new, |value| format!("{value:.2}"));
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
            Kind::Floor => effect.definition().doing_nothing.name().to_owned(),
        }
    }
}

impl Report {
    /// Sets `ssim_<method>`, `psnr_<method>`, `flip_<method>`, `relmse_<method>` and `ms_<method>`, means
    /// over frames, with underscores for hyphens; the same of truth's noise (`ssim_ceiling`, ...) and of the
    /// image of background (`ssim_white`, `ssim_black` or `ssim_light`, ...); and every frame's own as a
    /// detail. Of several effects each figure has the effect's name in it: `ssim_gi_<method>`. A frame's
    /// detail names the device of each time, and the detail `remarks` has what tables say of an effect.
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
        let remarks = effects
            .iter()
            .map(|effect| (effect.name().to_owned(), json!(remarks(*effect, &self.frames_of(*effect)))));
        figures.detail("remarks", remarks.collect::<serde_json::Map<_, _>>().into());
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
        frame.effect.definition().doing_nothing.name(): frame.truth.floor,
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
            let head = [head].into_iter().chain(COLUMNS.map(str::to_owned));
            let mut rows: Vec<Vec<String>> = vec![head.collect()];
            let lines = lines(effect, &frames);
            let device = times::device(&lines);
            let row = |line: &Line| [line.name.clone()].into_iter().chain(line.cells(device)).collect();
            rows.extend(lines.iter().map(row));
            writeln!(f, "{}", table::aligned(&rows))?;
            remarks(effect, &frames).iter().try_for_each(|said| writeln!(f, "{said}"))?;
            writeln!(f)?;
        }
        Ok(())
    }
}
