//! The page's content, ready to be filled into `page.html`.

use super::{Comparison, FrameReport, colour_map, floor_name, frame_folder, images};
use anyhow::{Result, ensure};
use askama::Template;
use deepshade_render::{method::Clock, metrics::Scores};
use deepshade_shaders::Effect;
use serde::Serialize;
use std::collections::BTreeSet;

/// The page as HTML.
///
/// # Errors
/// If the frames have not the same methods.
pub fn render(comparison: &Comparison) -> Result<String> {
    let names = |frame: &FrameReport| frame.methods.iter().map(|m| m.name.clone()).collect::<Vec<_>>();
    let methods = names(&comparison.frames[0]);
    ensure!(comparison.frames.iter().all(|frame| names(frame) == methods), "frames with different methods");
    let page = Page {
        title: title(comparison.effect),
        subtitle: format!(
            "{}, quality {}",
            subtitle(&methods, comparison.frames.len()),
            comparison.quality.name()
        ),
        means: mean_rows(comparison),
        frames: comparison
            .frames
            .iter()
            .enumerate()
            .map(|(index, frame)| Section::new(index, comparison.effect, frame))
            .collect(),
        images: methods.iter().cloned().chain(["truth".to_owned()]).collect(),
        floor: floor_name(comparison.effect),
        machine: &comparison.machine,
        difference_range: images::DIFFERENCE_RANGE,
        difference_stops: colour_map::css_stops(colour_map::diverging, -1.0, 1.0),
        flip_stops: colour_map::css_stops(colour_map::sequential, 0.0, 1.0),
        data: data(comparison, &methods)?,
    };
    Ok(page.render()?)
}

/// Everything that the template shows.
#[derive(Template)]
#[template(path = "report/page.html")]
struct Page<'a> {
    title: &'static str,
    subtitle: String,
    means: Vec<Row>,
    frames: Vec<Section<'a>>,
    /// Names of the images of every frame: the methods, then truth.
    images: Vec<String>,
    /// The image that shows what knowing nothing scores.
    floor: String,
    machine: &'a [(String, String)],
    difference_range: f32,
    difference_stops: String,
    flip_stops: String,
    /// What the script needs, as JSON that cannot end the element that it stands in.
    data: String,
}

/// A frame's part of the page.
struct Section<'a> {
    index: usize,
    folder: String,
    name: &'a str,
    facts: &'a [(String, String)],
    rows: Vec<Row>,
    width: usize,
    height: usize,
}

/// A line of a table.
struct Row {
    name: String,
    /// What kind of line: `method`, `ceiling` or `floor`.
    kind: &'static str,
    ssim: String,
    psnr: String,
    flip: String,
    relative_mse: String,
    time: String,
    measured_by: String,
}

/// What the script needs to know.
#[derive(Serialize)]
struct Data<'a> {
    images: &'a [String],
    views: [&'static str; 3],
    frames: Vec<DataFrame<'a>>,
}

#[derive(Serialize)]
struct DataFrame<'a> {
    folder: String,
    name: &'a str,
    width: usize,
    height: usize,
}

impl<'a> Section<'a> {
    fn new(index: usize, effect: Effect, frame: &'a FrameReport) -> Self {
        let methods = frame.methods.iter().map(|method| {
            let by = format!("{}, {}", clock_name(method.clock), method.device);
            Row::new(method.name.clone(), "method", method.scores, Some((method.milliseconds, by)))
        });
        let truth = &frame.truth;
        let rows =
            methods.chain(reference_rows(effect, truth.noise, truth.floor, truth.milliseconds)).collect();
        let image = &truth.truth.estimate.mean;
        Self {
            index,
            folder: frame_folder(index),
            name: &frame.name,
            facts: &frame.facts,
            rows,
            width: image.width(),
            height: image.height(),
        }
    }
}

impl Row {
    fn new(name: String, kind: &'static str, scores: Scores, time: Option<(f64, String)>) -> Self {
        Self {
            name,
            kind,
            ssim: number(scores.ssim, 3),
            psnr: number(scores.psnr, 1),
            flip: number(scores.flip, 3),
            relative_mse: number(scores.relative_mse, 4),
            time: time.as_ref().map_or_else(String::new, |(milliseconds, _)| duration(*milliseconds)),
            measured_by: time.map(|(_, by)| by).unwrap_or_default(),
        }
    }
}

/// Means over all frames, line by line.
fn mean_rows(comparison: &Comparison) -> Vec<Row> {
    let first = &comparison.frames[0];
    let methods = (0..first.methods.len()).map(|i| {
        let clocks: BTreeSet<_> = comparison.frames.iter().map(|f| clock_name(f.methods[i].clock)).collect();
        let clock = if clocks.len() == 1 { clock_name(first.methods[i].clock) } else { "mixed" };
        let milliseconds = comparison.mean(|frame| frame.methods[i].milliseconds);
        let scores = comparison.mean_scores(|frame| frame.methods[i].scores);
        let by = format!("{clock}, {}", first.methods[i].device);
        Row::new(first.methods[i].name.clone(), "method", scores, Some((milliseconds, by)))
    });
    let references = reference_rows(
        comparison.effect,
        comparison.mean_scores(|frame| frame.truth.noise),
        comparison.mean_scores(|frame| frame.truth.floor),
        comparison.mean(|frame| frame.truth.milliseconds),
    );
    methods.chain(references).collect()
}

/// The lines to read a method's scores beside.
fn reference_rows(effect: Effect, noise: Scores, floor: Scores, truth_milliseconds: f64) -> [Row; 2] {
    [
        Row::new(
            "truth, half against half".to_owned(),
            "ceiling",
            noise,
            Some((truth_milliseconds, clock_name(Clock::Cpu).to_owned())),
        ),
        Row::new(floor_name(effect), "floor", floor, None),
    ]
}

const fn title(effect: Effect) -> &'static str {
    match effect {
        Effect::Ao => "Ambient occlusion",
        Effect::Do => "Directional occlusion",
        Effect::Gi => "Diffuse indirect light",
        Effect::Glossy => "Indirect light in glossy surfaces",
        Effect::Ibl => "Image-based lighting",
        Effect::Sss => "Subsurface scattering in screen space",
        Effect::Subsurface => "Subsurface scattering",
        Effect::Dof => "Depth of field",
        Effect::MotionBlur => "Motion blur",
        Effect::Aa => "Anti-aliasing",
        Effect::Multi => "Ambient occlusion and depth of field",
        Effect::FogDirect => "Fog, light scattered once",
        Effect::FogIndirect => "Fog, light from surfaces",
        Effect::FogMultiple => "Fog, light scattered many times",
        Effect::Phosphor => "Phosphorescence",
        Effect::Path => "All light",
        Effect::Real => "The look of photographs",
    }
}

/// `learned, hbao and truth on 4 frames`.
fn subtitle(methods: &[String], frames: usize) -> String {
    let plural = if frames == 1 { "" } else { "s" };
    match methods {
        [] => format!("truth on {frames} frame{plural}"),
        methods => format!("{} and truth on {frames} frame{plural}", methods.join(", ")),
    }
}

const fn clock_name(clock: Clock) -> &'static str {
    match clock {
        Clock::Gpu => "GPU timestamps",
        Clock::Cpu => "wall clock",
    }
}

/// A number with so many decimals.
fn number(value: f64, decimals: usize) -> String {
    format!("{value:.decimals$}")
}

/// Milliseconds with three digits or more.
fn duration(milliseconds: f64) -> String {
    let decimals = match milliseconds {
        ..10.0 => 2,
        10.0..100.0 => 1,
        _ => 0,
    };
    number(milliseconds, decimals)
}

/// The script's data as JSON in which no `<` can end or open an element.
fn data(comparison: &Comparison, methods: &[String]) -> Result<String> {
    let images: Vec<String> = methods.iter().cloned().chain(["truth".to_owned()]).collect();
    let frames = comparison.frames.iter().enumerate().map(|(index, frame)| DataFrame {
        folder: frame_folder(index),
        name: &frame.name,
        width: frame.truth.truth.estimate.mean.width(),
        height: frame.truth.truth.estimate.mean.height(),
    });
    let data = Data { images: &images, views: images::VIEWS, frames: frames.collect() };
    Ok(serde_json::to_string(&data)?.replace('<', "\\u003c"))
}
