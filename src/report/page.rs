//! The page's content, ready to be filled into `page.html`.

use super::folder::{DESCRIPTION, MARKDOWN};
use super::record::{FrameRecord, TRUTH};
use super::scatter::{self, MEASURES};
use super::summary::{Line, lines, remarks};
use super::{Report, colour_map, floor_name, images, times};
use anyhow::Result;
use askama::Template;
use serde::Serialize;

/// The page as HTML.
///
/// # Errors
/// If the template cannot be filled.
pub fn render(report: &Report) -> Result<String> {
    let effects: Vec<EffectPart> =
        report.effects().into_iter().map(|effect| EffectPart::new(report, effect)).collect();
    let titles: Vec<&str> = effects.iter().map(|part| part.title).collect();
    let mut floors: Vec<String> = report.effects().into_iter().map(floor_name).collect();
    floors.dedup();
    let page = Page {
        title: titles.join(", "),
        subtitle: subtitle(report),
        frames: report.frames.iter().enumerate().map(|(index, frame)| FramePart::new(index, frame)).collect(),
        floor: floors.join(" or "),
        machine: &report.machine,
        description: DESCRIPTION,
        markdown: MARKDOWN,
        difference_range: images::DIFFERENCE_RANGE,
        difference_stops: colour_map::css_stops(colour_map::diverging, -1.0, 1.0),
        flip_stops: colour_map::css_stops(colour_map::sequential, 0.0, 1.0),
        data: data(report)?,
        effects,
    };
    Ok(page.render()?)
}

/// Everything that the template shows.
#[derive(Template)]
#[template(path = "report/page.html")]
struct Page<'a> {
    title: String,
    subtitle: String,
    effects: Vec<EffectPart>,
    frames: Vec<FramePart<'a>>,
    /// The image that shows what knowing nothing scores.
    floor: String,
    machine: &'a [(String, String)],
    description: &'static str,
    markdown: &'static str,
    difference_range: f32,
    difference_stops: String,
    flip_stops: String,
    /// What the script needs, as JSON that cannot end the element that it stands in.
    data: String,
}

/// An effect's part of the page: means, error against time, and scene by scene.
struct EffectPart {
    name: &'static str,
    title: &'static str,
    frames: usize,
    rows: Vec<Row>,
    /// What is to be said of the means; nothing of one frame, whose own part says it.
    remarks: Vec<String>,
    /// Of each measure, if there is something to draw.
    plots: Vec<(&'static str, String)>,
    /// Empty of one scene.
    scenes: Vec<Row>,
}

/// A frame's part of the page.
struct FramePart<'a> {
    index: usize,
    folder: &'a str,
    effect: &'static str,
    title: &'static str,
    name: &'a str,
    facts: &'a [(String, String)],
    rows: Vec<Row>,
    /// What is to be said of its lines.
    remarks: Vec<String>,
    width: usize,
    height: usize,
    /// Labels and names of files, truth last.
    images: Vec<(&'a str, &'a str)>,
}

/// A line of a table.
struct Row {
    /// Of a table scene by scene.
    scene: String,
    name: String,
    /// What kind of line: `method`, `ceiling` or `floor`.
    kind: &'static str,
    /// Texts, and numbers to sort by.
    cells: Vec<(String, String)>,
    /// Where the values are, if they are one image's.
    exr: Option<String>,
}

/// What the script needs to know.
#[derive(Serialize)]
struct Data<'a> {
    views: [&'static str; 3],
    frames: Vec<DataFrame<'a>>,
}

#[derive(Serialize)]
struct DataFrame<'a> {
    folder: &'a str,
    effect: &'static str,
    scene: &'a str,
    view: &'a str,
    width: usize,
    height: usize,
    /// Names of files by label, truth last.
    images: Vec<(&'a str, &'a str)>,
}

impl EffectPart {
    fn new(report: &Report, effect: deepshade_shaders::Effect) -> Self {
        let (frames, scenes) = (report.frames_of(effect), report.scenes_of(effect));
        let means = lines(effect, &frames);
        let device = times::device(&means);
        let plots = MEASURES
            .iter()
            .filter_map(|measure| Some((measure.name, scatter::svg(&means, measure)?)))
            .collect();
        let by_scene = scenes.iter().filter(|_| scenes.len() > 1).flat_map(|(scene, frames)| {
            let row = |line| Row::new(scene, &line, None, device);
            lines(effect, frames).into_iter().map(row).collect::<Vec<_>>()
        });
        Self {
            name: effect.name(),
            title: effect.definition().title,
            frames: frames.len(),
            rows: means.iter().map(|line| Row::new("", line, None, device)).collect(),
            remarks: if frames.len() > 1 { remarks(effect, &frames) } else { Vec::new() },
            plots,
            scenes: by_scene.collect(),
        }
    }
}

impl<'a> FramePart<'a> {
    fn new(index: usize, frame: &'a FrameRecord) -> Self {
        let lines = lines(frame.effect, &[frame]);
        let row = |line: &Line| Row::new("", line, Some(&frame.folder), times::device(&lines));
        Self {
            index,
            folder: &frame.folder,
            effect: frame.effect.name(),
            title: frame.effect.definition().title,
            name: &frame.name,
            facts: &frame.facts,
            rows: lines.iter().map(row).collect(),
            remarks: remarks(frame.effect, &[frame]),
            width: frame.width,
            height: frame.height,
            images: images_of(frame),
        }
    }
}

impl Row {
    fn new(scene: &str, line: &Line, folder: Option<&str>, device: Option<&str>) -> Self {
        let scores = line.scores;
        let values = [scores.ssim, scores.psnr, scores.flip, scores.relative_mse].map(Some);
        let values = values.into_iter().chain([line.time_on(device)]);
        let value = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
        let exr = folder.zip(line.file.as_ref()).map(|(folder, file)| format!("{folder}/{file}.exr"));
        Self {
            scene: scene.to_owned(),
            name: line.name.clone(),
            kind: line.kind.name(),
            cells: line.cells(device).into_iter().zip(values.map(value)).collect(),
            exr,
        }
    }
}

/// Labels of a frame's images with the names of their files, truth last.
fn images_of(frame: &FrameRecord) -> Vec<(&str, &str)> {
    let methods = frame.images.iter().map(|image| (image.label.as_str(), image.file.as_str()));
    methods.chain([(TRUTH, TRUTH)]).collect()
}

/// `learned, hbao and truth on 4 frames of 2 scenes, quality high`.
fn subtitle(report: &Report) -> String {
    let mut methods: Vec<&str> = Vec::new();
    let mut scenes: Vec<&str> = Vec::new();
    for frame in &report.frames {
        if !scenes.contains(&frame.scene.as_str()) {
            scenes.push(&frame.scene);
        }
        for image in &frame.images {
            if !methods.contains(&image.method.as_str()) {
                methods.push(&image.method);
            }
        }
    }
    let count = |count: usize, what: &str| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
    let methods = if methods.is_empty() { String::new() } else { format!("{} and ", methods.join(", ")) };
    let scenes =
        if scenes.len() > 1 { format!(" of {}", count(scenes.len(), "scene")) } else { String::new() };
    format!("{methods}truth on {}{scenes}, quality {}", count(report.frames.len(), "frame"), report.quality)
}

/// The script's data as JSON in which no `<` can end or open an element.
fn data(report: &Report) -> Result<String> {
    let frames = report.frames.iter().map(|frame| DataFrame {
        folder: &frame.folder,
        effect: frame.effect.name(),
        scene: &frame.scene,
        view: &frame.view,
        width: frame.width,
        height: frame.height,
        images: images_of(frame),
    });
    let data = Data { views: images::VIEWS, frames: frames.collect() };
    Ok(serde_json::to_string(&data)?.replace('<', "\\u003c"))
}
