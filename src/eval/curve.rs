//! Error against time: a line a method through its qualities, all axes logarithmic, a panel for each way to
//! measure error. All that is drawn ran on one device.

use super::rivals::Rival;
use super::score::Evaluation;
use crate::figures::write_atomically;
use crate::methods::LEARNED;
use crate::statistics::MeanInterval;
use anyhow::{Result, anyhow};
use deepshade_shaders::Effect;
use plotters::coord::Shift;
use plotters::prelude::*;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

/// How much of the time axis the legend takes, as a factor.
const LEGEND: f64 = 6.0;

/// A way to measure error: what it is called, the figure that it is from, and how.
struct Measure {
    name: &'static str,
    figure: &'static str,
    error: fn(f64) -> f64,
}

/// Few pixels decide about the one, all tiles count alike in the other.
const MEASURES: [Measure; 2] = [
    Measure { name: "relative mean squared error", figure: "relmse", error: |error| error },
    Measure { name: "1 - SSIM", figure: "ssim", error: |similarity| 1.0 - similarity },
];

/// The points of a method: milliseconds and error, the fastest first.
type Line = (&'static str, Vec<(f64, f64)>);

/// What a panel shows.
struct Panel {
    name: &'static str,
    lines: Vec<Line>,
    /// Error of the image of whoever does nothing, under its name.
    nothing: Option<(&'static str, f64)>,
    times: Range<f64>,
    errors: Range<f64>,
}

/// Draws the curves of what ran on one device into an SVG file, and says which methods ran on others.
///
/// # Errors
/// If nothing was measured or the file cannot be written.
pub fn write(path: &Path, effect: Effect, rivals: &[Rival], evaluation: &Evaluation) -> Result<()> {
    let estimates = &evaluation.estimates();
    let device = device(&evaluation.devices);
    let (drawn, others): (Vec<&Rival>, Vec<&Rival>) =
        rivals.iter().partition(|rival| evaluation.devices.get(&rival.name).map(String::as_str) == device);
    if !others.is_empty() {
        let mut names: Vec<&str> = others.iter().map(|rival| rival.method_name).collect();
        names.dedup();
        note!("{}: not drawn, since they ran on another device: {}", path.display(), names.join(", "));
    }
    let panel = |measure: &Measure| {
        let trivial = effect.definition().doing_nothing.name();
        let nothing = estimates.get(format!("{}_{trivial}", measure.figure).as_str());
        let nothing = nothing.map(|estimate| (trivial, (measure.error)(estimate.mean)));
        Panel::new(measure.name, lines(measure, &drawn, estimates), nothing)
            .ok_or_else(|| anyhow!("{}: no times or errors above 0 to draw", path.display()))
    };
    let panels = MEASURES.iter().map(panel).collect::<Result<Vec<_>>>()?;
    let mut svg = String::new();
    let title = format!("{effect}: error against time, {}", device.unwrap_or("unknown device"));
    draw(&mut svg, &title, &panels).map_err(|error| anyhow!("{}: {error}", path.display()))?;
    write_atomically(path, svg.as_bytes())
}

/// The device that curves are of, by what each method ran on: the network's, without one that of most
/// methods.
fn device(devices: &BTreeMap<String, String>) -> Option<&str> {
    let count = |device: &String| devices.values().filter(|other| *other == device).count();
    let most = || devices.values().max_by_key(|device| count(device));
    devices.get(LEARNED).or_else(most).map(String::as_str)
}

fn lines(measure: &Measure, rivals: &[&Rival], estimates: &BTreeMap<&str, MeanInterval>) -> Vec<Line> {
    let mut lines: Vec<Line> = Vec::new();
    for rival in rivals {
        let figure = |name: &str| estimates.get(format!("{name}_{}", rival.name).as_str()).map(|e| e.mean);
        let Some((time, value)) = figure("ms").zip(figure(measure.figure)) else { continue };
        let point = (time, (measure.error)(value));
        match lines.iter_mut().find(|(name, _)| *name == rival.method_name) {
            Some((_, points)) => points.push(point),
            None => lines.push((rival.method_name, vec![point])),
        }
    }
    lines.iter_mut().for_each(|(_, points)| points.sort_by(|a, b| a.0.total_cmp(&b.0)));
    lines
}

impl Panel {
    /// `None` where there is nothing that logarithmic axes can show.
    fn new(name: &'static str, lines: Vec<Line>, nothing: Option<(&'static str, f64)>) -> Option<Self> {
        let points = || lines.iter().flat_map(|(_, points)| points);
        let times = decades(points().map(|point| point.0))?;
        let errors = decades(points().map(|point| point.1).chain(nothing.map(|(_, error)| error)))?;
        Some(Self { name, times, errors, lines, nothing })
    }

    fn draw(&self, area: &DrawingArea<SVGBackend<'_>, Shift>) -> Result<(), Box<dyn std::error::Error>> {
        let mut chart = ChartBuilder::on(area)
            .margin(12)
            .x_label_area_size(44)
            .y_label_area_size(64)
            // The legend stands to the right of all points.
            .build_cartesian_2d(
                (self.times.start..self.times.end * LEGEND).log_scale(),
                self.errors.clone().log_scale(),
            )?;
        chart
            .configure_mesh()
            .max_light_lines(1)
            .x_desc("milliseconds")
            .y_desc(self.name)
            .x_label_formatter(&|x| x.to_string())
            .y_label_formatter(&|y| format!("{y:.4}").trim_end_matches(['0', '.']).to_owned())
            .draw()?;
        for (index, (name, points)) in self.lines.iter().enumerate() {
            let colour = Palette99::pick(index).to_rgba();
            chart
                .draw_series(LineSeries::new(points.iter().copied(), colour.stroke_width(2)).point_size(4))?
                .label(*name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2)));
        }
        if let Some((name, error)) = self.nothing {
            let level = [(self.times.start, error), (self.times.end, error)];
            chart
                .draw_series(DashedLineSeries::new(level, 6, 4, BLACK.mix(0.7).stroke_width(2)))?
                .label(name)
                .legend(|(x, y)| PathElement::new([(x, y), (x + 18, y)], BLACK.mix(0.7).stroke_width(2)));
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperRight)
            .background_style(WHITE.mix(0.85))
            .border_style(BLACK.mix(0.3))
            .draw()?;
        Ok(())
    }
}

/// The whole decades that hold all values, so that axes have numbers; `None` where one is not above 0.
fn decades(values: impl Iterator<Item = f64>) -> Option<Range<f64>> {
    let (low, high) = values.fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)));
    let sound = low > 0.0 && low.is_finite() && high.is_finite() && low <= high;
    let power = |exponent: f64| 10f64.powf(exponent);
    sound.then(|| power((low / 1.01).log10().floor())..power((high * 1.01).log10().ceil()))
}

fn draw(svg: &mut String, title: &str, panels: &[Panel]) -> Result<(), Box<dyn std::error::Error>> {
    let width = 720 * panels.len() as u32;
    let area = SVGBackend::with_string(svg, (width, 480)).into_drawing_area();
    area.fill(&WHITE)?;
    let below = area.titled(title, ("sans-serif", 20))?;
    for (panel, area) in panels.iter().zip(below.split_evenly((1, panels.len()))) {
        panel.draw(&area)?;
    }
    area.present()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn panel(name: &'static str, scale: f64) -> Option<Panel> {
        let lines = vec![("fast", vec![(0.1, 0.5 * scale), (1.0, 0.2)]), ("slow", vec![(5.0, 0.1)])];
        Panel::new(name, lines, Some(("white", 0.9)))
    }

    #[test]
    fn every_method_is_a_line_through_its_points_in_every_panel() {
        let panels: Vec<Panel> =
            MEASURES.iter().map(|measure| panel(measure.name, 1.0).expect("points")).collect();
        assert_eq!((panels[0].times.clone(), panels[0].errors.clone()), (0.01..10.0, 0.01..1.0));
        let mut svg = String::new();
        draw(&mut svg, "ao on a card", &panels).expect("a picture");
        for (text, count) in
            [("fast", 2), ("slow", 2), ("white", 2), ("1 - SSIM", 1), ("relative mean squared error", 1)]
        {
            assert_eq!(svg.matches(text).count(), count, "{text}");
        }
        assert!(svg.matches("<polyline").count() >= 6, "{svg}");
        assert_eq!(svg.matches("<circle").count(), 6, "a dot a point");
    }

    #[test]
    fn curves_are_of_the_network_s_device_or_of_most_methods() {
        let devices = |of: &[(&str, &str)]| -> BTreeMap<String, String> {
            of.iter().map(|(name, device)| ((*name).to_owned(), (*device).to_owned())).collect()
        };
        let analytic = [("gtao", "a processor"), ("hbao", "a card"), ("surfel", "a card")];
        assert_eq!(device(&devices(&analytic)), Some("a card"));
        let with_network = [&analytic[..], &[(LEARNED, "a processor")]].concat();
        assert_eq!(device(&devices(&with_network)), Some("a processor"));
        assert_eq!(device(&BTreeMap::new()), None);
    }

    #[test]
    fn what_logarithmic_axes_cannot_show_is_no_panel() {
        assert!(panel("", 0.0).is_none() && panel("", -1.0).is_none() && panel("", f64::INFINITY).is_none());
        assert!(Panel::new("", Vec::new(), Some(("white", 0.9))).is_none());
    }
}
