//! Error against time: a line a method through its qualities, all axes logarithmic, a panel for each way to
//! measure error. Where methods ran on several devices, numbers say on which.

use super::rivals::Rival;
use super::score::Evaluation;
use crate::figures::write_atomically;
use crate::methods::LEARNED;
use anyhow::{Result, anyhow};
use deepshade_shaders::Effect;
use plotters::coord::Shift;
use plotters::prelude::*;
use std::collections::BTreeSet;
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
type Line = (String, Vec<(f64, f64)>);

/// What a panel shows.
struct Panel {
    name: &'static str,
    lines: Vec<Line>,
    /// Error of the image of whoever does nothing, under its name.
    nothing: Option<(&'static str, f64)>,
    times: Range<f64>,
    errors: Range<f64>,
}

/// What is drawn of one evaluation.
#[derive(Clone, Copy)]
pub struct Curves<'a> {
    /// What the network is called.
    pub network: &'a str,
    /// Who was evaluated.
    pub rivals: &'a [Rival],
    /// Their scores.
    pub evaluation: &'a Evaluation,
}

/// Writes the curves of an evaluation into an SVG file.
///
/// # Errors
/// If nothing was measured or the file cannot be written.
pub fn write(path: &Path, effect: Effect, curves: Curves<'_>) -> Result<()> {
    let svg = svg(&format!("{effect}: error against time"), effect, &[curves]);
    write_atomically(path, svg.map_err(|error| anyhow!("{}: {error}", path.display()))?.as_bytes())
}

/// The curves of evaluations on the same frames as an SVG file. What several of them have, the first says.
///
/// # Errors
/// If nothing was measured that logarithmic axes can show.
pub fn svg(title: &str, effect: Effect, all: &[Curves<'_>]) -> Result<String> {
    let trivial = effect.definition().doing_nothing.name();
    let devices = devices(all);
    let panel = |measure: &Measure| {
        let nothing = all.iter().find_map(|curves| curves.error(measure, trivial));
        Panel::new(measure.name, lines(measure, all, &devices), nothing.map(|error| (trivial, error)))
            .ok_or_else(|| anyhow!("no times or errors above 0 to draw"))
    };
    let panels = MEASURES.iter().map(panel).collect::<Result<Vec<_>>>()?;
    let mut svg = String::new();
    draw(&mut svg, &titled(title, &devices), &panels).map_err(|error| anyhow!("{error}"))?;
    Ok(svg)
}

impl Curves<'_> {
    fn error(&self, measure: &Measure, name: &str) -> Option<f64> {
        self.evaluation.mean(&format!("{}_{name}", measure.figure)).map(measure.error)
    }

    /// A method at a quality, where it was measured.
    fn point<'a>(&'a self, measure: &Measure, rival: &'a Rival) -> Option<Point<'a>> {
        let milliseconds = self.evaluation.mean(&format!("ms_{}", rival.name))?;
        let error = self.error(measure, &rival.name)?;
        let is_network = rival.method_name == LEARNED;
        let [method, name] = if is_network { [self.network; 2] } else { [rival.method_name, &rival.name] };
        let device = self.evaluation.devices.get(&rival.name).map_or("", String::as_str);
        Some(Point { method, name, device, at: (milliseconds, error) })
    }
}

/// A method at a quality.
struct Point<'a> {
    /// Whose line it is on.
    method: &'a str,
    /// The method with its quality.
    name: &'a str,
    device: &'a str,
    /// Milliseconds and error.
    at: (f64, f64),
}

/// The devices that methods ran on.
fn devices<'a>(all: &'a [Curves<'_>]) -> Vec<&'a str> {
    let of = |curves: &'a Curves<'_>| curves.evaluation.devices.values().map(String::as_str);
    all.iter().flat_map(of).collect::<BTreeSet<_>>().into_iter().collect()
}

/// The lines of all methods, each with the number of its device where there are several.
fn lines(measure: &Measure, all: &[Curves<'_>], devices: &[&str]) -> Vec<Line> {
    let mut points: Vec<Point<'_>> = Vec::new();
    let measured =
        all.iter().flat_map(|curves| curves.rivals.iter().filter_map(|rival| curves.point(measure, rival)));
    for point in measured {
        if points.iter().all(|known| known.name != point.name) {
            points.push(point);
        }
    }
    let mut lines: Vec<Line> = Vec::new();
    for Point { method, device, at, .. } in points {
        let number = devices.iter().position(|known| *known == device).filter(|_| devices.len() > 1);
        let name = number.map_or_else(|| method.to_owned(), |number| format!("{method} [{}]", number + 1));
        match lines.iter_mut().find(|(known, _)| *known == name) {
            Some((_, points)) => points.push(at),
            None => lines.push((name, vec![at])),
        }
    }
    lines.iter_mut().for_each(|(_, points)| points.sort_by(|a, b| a.0.total_cmp(&b.0)));
    lines
}

/// A title with the devices, numbered where there are several.
fn titled(title: &str, devices: &[&str]) -> String {
    let numbered = |(number, device): (usize, &&str)| match devices.len() {
        1 => (*device).to_owned(),
        _ => format!("[{}] {device}", number + 1),
    };
    let devices: Vec<String> = devices.iter().enumerate().map(numbered).collect();
    format!("{title}; {}", devices.join(", "))
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
                .label(name)
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
    use super::super::paired::tests::rival;
    use super::super::score::tests::evaluation;
    use super::*;

    fn panel(name: &'static str, scale: f64) -> Option<Panel> {
        let lines = vec![
            ("fast".to_owned(), vec![(0.1, 0.5 * scale), (1.0, 0.2)]),
            ("slow".to_owned(), vec![(5.0, 0.1)]),
        ];
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
    fn several_devices_are_numbered_and_a_rival_of_two_networks_is_drawn_once() {
        let frame = [
            ("ms_learned", 2.0),
            ("ssim_learned", 0.9),
            ("ms_gtao", 1.0),
            ("ssim_gtao", 0.8),
            ("ms_gtao_low", 0.5),
            ("ssim_gtao_low", 0.7),
        ];
        let mut evaluation = evaluation(&[("cave:1", &[&frame])]);
        let rivals = [rival("learned", LEARNED), rival("gtao", "gtao"), rival("gtao_low", "gtao")];
        let both = |evaluation: &Evaluation| {
            let curves = |network| Curves { network, rivals: &rivals, evaluation };
            let all = [curves("ao"), curves("ao-small")];
            let devices = devices(&all);
            let lines = lines(&MEASURES[1], &all, &devices);
            let points = |(name, points): Line| format!("{name}: {}", points.len());
            (titled("ao", &devices), lines.into_iter().map(points).collect::<Vec<_>>())
        };
        evaluation.devices =
            ["learned", "gtao", "gtao_low"].map(|name| (name.to_owned(), "card".to_owned())).into();
        let (title, names) = both(&evaluation);
        assert_eq!((title.as_str(), names.join(", ").as_str()), ("ao; card", "ao: 1, gtao: 2, ao-small: 1"));
        evaluation.devices.insert("learned".to_owned(), "cpu".to_owned());
        let (title, names) = both(&evaluation);
        assert_eq!(title, "ao; [1] card, [2] cpu");
        assert_eq!(names.join(", "), "ao [2]: 1, gtao [1]: 2, ao-small [2]: 1");
    }

    #[test]
    fn what_logarithmic_axes_cannot_show_is_no_panel() {
        assert!(panel("", 0.0).is_none() && panel("", -1.0).is_none() && panel("", f64::INFINITY).is_none());
        assert!(Panel::new("", Vec::new(), Some(("white", 0.9))).is_none());
    }
}
