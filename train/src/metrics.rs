//! What a run measures: JSON lines, one object a line, a curve drawn from them, and events for TensorBoard.

use crate::events::EventFile;
use crate::{TrainError, files};
use deepshade_dataset::holder::Holder;
use plotters::prelude::*;
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

/// Name of the JSON lines in the run's folder.
pub const METRICS_FILE: &str = "metrics.jsonl";
/// Name of the curve in the run's folder.
pub const CURVE_FILE: &str = "curve.svg";
/// Height of the legend, pixels.
const LEGEND: i32 = 24;

/// A line of the metrics.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Line {
    /// Steps done.
    pub step: usize,
    /// Mean training loss since the line before, or since the run was resumed.
    pub loss: f32,
    /// DSSIM on the validation pairs, where it was measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub validation_loss: Option<f32>,
    /// The optimiser's rate.
    pub rate: f64,
    /// Images trained on a second in the same time, validation and checkpoints not counted.
    pub images_per_second: f64,
}

/// The lines that the run in a folder has written, but for one that a killed program left half-written.
///
/// # Errors
/// If there is no such file or it cannot be read.
pub fn read(folder: &Path) -> Result<Vec<Line>, TrainError> {
    let path = folder.join(METRICS_FILE);
    let bytes = std::fs::read(&path).map_err(TrainError::io("read", &path))?;
    Ok(whole_lines(&bytes).map(|(line, _)| line).collect())
}

/// The lines at the head of a file that are whole, each with its number of bytes. One that a killed run left
/// half-written is no JSON, or lacks its end.
fn whole_lines(bytes: &[u8]) -> impl Iterator<Item = (Line, u64)> {
    let texts = bytes.split_inclusive(|byte| *byte == b'\n').take_while(|text| text.ends_with(b"\n"));
    texts.map_while(|text| Some((serde_json::from_slice(text).ok()?, text.len() as u64)))
}

/// The metrics of a run, in memory and in its folder.
pub(crate) struct Metrics {
    folder: PathBuf,
    file: File,
    lines: Vec<Line>,
    events: EventFile,
    _holder: Holder,
}

impl Metrics {
    /// The metrics of a run whose folder was [taken](files::take), up to a step: what came after the
    /// checkpoint is measured again.
    ///
    /// # Errors
    /// If the file cannot be read or written.
    pub fn open(folder: &Path, (mut file, holder): (File, Holder), step: usize) -> Result<Self, TrainError> {
        let path = folder.join(METRICS_FILE);
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(TrainError::io("read", &path))?;
        let kept = whole_lines(&bytes).take_while(|(line, _)| line.step <= step);
        let (lines, lengths): (Vec<Line>, Vec<u64>) = kept.unzip();
        let end = lengths.iter().sum();
        file.set_len(end).map_err(TrainError::io("write", &path))?;
        let events = EventFile::new(folder, &lines)?;
        Ok(Self { folder: folder.to_owned(), file, lines, events, _holder: holder })
    }

    /// Adds a line.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn add(&mut self, line: Line) -> Result<(), TrainError> {
        let path = self.folder.join(METRICS_FILE);
        let json = serde_json::to_string(&line).expect("a line is plain data") + "\n";
        self.file.write_all(json.as_bytes()).map_err(TrainError::io("write", &path))?;
        self.lines.push(line);
        self.events.add(&line)
    }

    /// Draws the curve into the run's folder.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn draw(&self) -> Result<(), TrainError> {
        let path = self.folder.join(CURVE_FILE);
        let svg = curve(&self.lines).map_err(|problem| TrainError::damaged(&path, problem))?;
        files::replace(&path, svg.as_bytes())
    }
}

/// Training and validation loss over steps, on a logarithmic scale, as SVG.
fn curve(lines: &[Line]) -> Result<String, String> {
    let training: Vec<(f64, f64)> =
        lines.iter().map(|line| (line.step as f64, f64::from(line.loss))).collect();
    let validation: Vec<(f64, f64)> = lines
        .iter()
        .filter_map(|line| line.validation_loss.map(|loss| (line.step as f64, f64::from(loss))))
        .collect();
    let losses = training.iter().chain(&validation).map(|point| point.1.max(1e-6));
    let (low, high) = losses.fold((f64::INFINITY, 1e-6), |(low, high), loss| (low.min(loss), loss.max(high)));
    let last = training.last().map_or(1.0, |point| point.0);
    let mut svg = String::new();
    draw(&mut svg, &training, &validation, last, [low.min(high) / 1.1, high * 1.1])
        .map_err(|e| e.to_string())?;
    Ok(svg)
}

type DrawError = Box<dyn std::error::Error>;

fn draw(
    svg: &mut String,
    training: &[(f64, f64)],
    validation: &[(f64, f64)],
    last: f64,
    [low, high]: [f64; 2],
) -> Result<(), DrawError> {
    let area = SVGBackend::with_string(svg, (900, 500)).into_drawing_area();
    area.fill(&WHITE)?;
    let area = area.titled("Training", ("sans-serif", 20))?;
    // Above the axes, where no curve comes.
    let (legend, axes) = area.split_vertically(LEGEND);
    let mut chart = ChartBuilder::on(&axes)
        .margin(15)
        .x_label_area_size(40)
        .y_label_area_size(70)
        .build_cartesian_2d(0.0..last, (low..high).log_scale())?;
    chart
        .configure_mesh()
        .x_desc("step")
        .y_desc("loss")
        .x_label_formatter(&|step| format!("{step:.0}"))
        .y_label_formatter(&|loss| format!("{loss:.3}"))
        .light_line_style(WHITE)
        .draw()?;
    let (grey, blue) = (RGBColor(150, 150, 150), RGBColor(0, 90, 200));
    let curves = [
        (training, grey.stroke_width(1), "loss of training crops", 85),
        (validation, blue.stroke_width(2), "DSSIM of validation", 305),
    ];
    for (points, stroke, name, x) in curves {
        chart.draw_series(LineSeries::new(points.iter().copied(), stroke))?;
        legend.draw(&PathElement::new([(x, LEGEND / 2), (x + 24, LEGEND / 2)], stroke))?;
        legend.draw(&Text::new(name, (x + 32, LEGEND / 2 - 8), ("sans-serif", 14)))?;
    }
    area.present()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(step: usize, validation_loss: Option<f32>) -> Line {
        Line { step, loss: 0.2 / step as f32, validation_loss, rate: 1e-3, images_per_second: 9.5 }
    }

    #[test]
    fn what_came_after_the_checkpoint_and_half_lines_are_forgotten() {
        let folder = tempfile::tempdir().expect("a folder");
        let open = |step| {
            let file = files::take(folder.path()).expect("nobody else has it");
            Metrics::open(folder.path(), file, step).expect("opens")
        };
        let mut metrics = open(0);
        for step in [1, 2, 3] {
            metrics.add(line(step, None)).expect("adds");
        }
        let path = folder.path().join(METRICS_FILE);
        let text = std::fs::read_to_string(&path).expect("reads");
        drop(metrics);
        std::fs::write(&path, text.clone() + "{\"step\":4,\"lo").expect("writes");
        let metrics = open(9);
        assert_eq!(metrics.lines, [1, 2, 3].map(|step| line(step, None)));
        drop(metrics);
        let mut metrics = open(2);
        assert_eq!(metrics.lines, [line(1, None), line(2, None)]);
        metrics.add(line(3, None)).expect("adds");
        assert_eq!(std::fs::read_to_string(&path).expect("reads"), text);
        drop(metrics);
        drop(open(2));
        let kept = std::fs::read_to_string(&path).expect("reads");
        assert_eq!(kept.lines().collect::<Vec<_>>(), text.lines().take(2).collect::<Vec<_>>());
    }

    #[test]
    fn the_curve_shows_both_losses() {
        let lines: Vec<Line> = (1..50).map(|step| line(step, (step % 10 == 0).then_some(0.1))).collect();
        let svg = curve(&lines).expect("draws");
        assert!(svg.contains("validation") && svg.matches("<polyline").count() >= 2, "{svg}");
        assert!(curve(&[]).is_ok(), "a curve without points");
    }

    #[test]
    fn the_legend_lies_above_all_that_is_drawn() {
        // At the right end the curve is as high as it gets, where a legend would cover it.
        let rising = |step: usize| Line { loss: step as f32, ..line(step, Some(0.5 * step as f32)) };
        let svg = curve(&(1..50).map(rising).collect::<Vec<_>>()).expect("draws");
        let lines = svg.split("<polyline").skip(1);
        let points = lines.map(|line| line.split("points=\"").nth(1).and_then(|rest| rest.split('"').next()));
        let heights = |points: &str| -> Vec<f64> {
            points.split_whitespace().filter_map(|point| point.split(',').nth(1)?.parse().ok()).collect()
        };
        let curves: Vec<Vec<f64>> = points.flatten().map(heights).filter(|points| points.len() > 9).collect();
        let highest = curves.iter().flatten().copied().fold(f64::MAX, f64::min);
        let legend = svg.split("<text").find(|text| text.contains("DSSIM of validation")).expect("a legend");
        let y = legend.split(" y=\"").nth(1).and_then(|rest| rest.split('"').next()).expect("a place");
        assert!(curves.len() == 2 && y.parse::<f64>().expect("a number") + 20.0 < highest, "{y} {highest}");
    }
}
