//! Error against time: both axes logarithmic, a method's qualities joined by a line, and the Pareto front,
//! than which nothing is both faster and better, as steps.

use super::summary::{Kind, Line as Row};
use super::times;
use crate::plot::{Line, Plot, Style};

/// Errors below this are drawn as this: a logarithm has no place for none.
const LEAST: f64 = 1e-6;
/// What the floor's level may be of the largest error of a method, so that it does not press all others
/// together.
const FAR: f64 = 10.0;

/// The front's colour, which is no method's.
const DARK: [u8; 3] = [40; 3];
/// The floor's.
const GREY: [u8; 3] = [150; 3];

/// A way to measure error.
pub struct Measure {
    /// What the page calls it.
    pub name: &'static str,
    /// What the axis says.
    pub axis: &'static str,
    error: fn(&Row) -> f64,
}

/// The ways to measure error.
pub const MEASURES: [Measure; 3] = [
    Measure { name: "relMSE", axis: "relative mean squared error", error: |row| row.scores.relative_mse },
    Measure { name: "SSIM", axis: "1 − SSIM", error: |row| 1.0 - row.scores.ssim },
    Measure { name: "FLIP", axis: "FLIP", error: |row| row.scores.flip },
];

/// The plot of some rows' times on the device that most of them have theirs from, as SVG; nothing where no
/// method has both time and error.
pub fn svg(rows: &[Row], measure: &Measure) -> Option<String> {
    let device = times::device(rows)?;
    let mut lines = methods(rows, measure, device);
    let points: Vec<(f64, f64)> = lines.iter().flat_map(|line| line.points.iter().copied()).collect();
    let largest = points.iter().map(|point| point.1).fold(0.0, f64::max);
    let front = front(points);
    let (first, last) = (front.first()?.0, front.last()?.0);
    lines.push(Line { style: Style::Curve, ..Line::dotted("Pareto front", front) }.coloured(DARK));
    for row in rows.iter().filter(|row| row.kind == Kind::Floor) {
        let error = (measure.error)(row);
        if error > 0.0 && error < FAR * largest {
            let level = Line::dotted(&row.name, vec![(first, error), (last, error)]);
            lines.push(Line { style: Style::Curve, ..level }.coloured(GREY));
        }
    }
    let plot = Plot { x: "milliseconds", is_logarithmic: true, y: measure.axis, lines, level: None };
    plot.log_log_svg(&format!("{} against milliseconds on {device}", measure.name)).ok()
}

/// A line through each method's qualities on a device, the fastest first.
fn methods(rows: &[Row], measure: &Measure, device: &str) -> Vec<Line> {
    let mut lines: Vec<Line> = Vec::new();
    for row in rows.iter().filter(|row| row.kind == Kind::Method) {
        let (time, error) = (row.time_on(Some(device)).unwrap_or(f64::NAN), (measure.error)(row));
        if !(time > 0.0 && time.is_finite() && error.is_finite()) {
            continue;
        }
        let point = (time, error.max(LEAST));
        match lines.iter_mut().find(|line| line.name == row.method) {
            Some(line) => line.points.push(point),
            None => lines.push(Line::dotted(&row.method, vec![point])),
        }
    }
    lines.iter_mut().for_each(|line| line.points.sort_by(|a, b| a.0.total_cmp(&b.0)));
    lines
}

/// The Pareto front of times and errors as steps, up to the longest time: with that much time that error can
/// be had.
fn front(mut points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut steps: Vec<(f64, f64)> = Vec::new();
    for (time, error) in points {
        let before = steps.last().map(|step| step.1);
        steps.extend(before.map(|before| (time, before)));
        steps.push((time, before.map_or(error, |before| before.min(error))));
    }
    steps
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_render::metrics::Scores;

    fn row(name: &str, kind: Kind, milliseconds: Option<f64>, error: f64) -> Row {
        let scores = Scores { ssim: 1.0 - error, psnr: 20.0, flip: error, relative_mse: error };
        let method = name.split('-').next().unwrap_or_default().to_owned();
        let (clock, device) = ("wall clock", "<a card>".to_owned());
        let (label, name) = (name.to_owned(), name.to_owned());
        Row { name, label, kind, method, file: None, scores, milliseconds, clock, device }
    }

    #[test]
    fn every_method_is_a_line_of_dots_with_its_name() {
        let rows = [
            row("fast-low", Kind::Method, Some(1.0), 0.3),
            row("fast", Kind::Method, Some(10.0), 0.1),
            row("slow<", Kind::Method, Some(100.0), 0.2),
            row("white image", Kind::Floor, None, 0.9),
        ];
        let svg = svg(&rows, &MEASURES[0]).expect("a plot");
        assert_eq!(svg.matches("<circle").count(), 3 + 2, "those of the legend, too");
        for name in ["fast", "slow&lt;", "white image", "Pareto front", "milliseconds on &lt;a card&gt;"] {
            assert!(svg.contains(name), "{name} in {svg}");
        }
        assert!(!svg.contains("NaN"));
    }

    #[test]
    fn times_of_two_devices_are_not_joined() {
        let here = [row("gtao", Kind::Method, Some(10.0), 0.1), row("hbao", Kind::Method, Some(5.0), 0.2)];
        let elsewhere =
            Row { device: "a processor".to_owned(), ..row("fast", Kind::Method, Some(1.0), 0.05) };
        let all = [here.to_vec(), vec![elsewhere]].concat();
        let plot = |rows: &[Row]| svg(rows, &MEASURES[0]).expect("a plot");
        assert_eq!(plot(&all), plot(&here), "who ran elsewhere has no dot");
    }

    #[test]
    fn nothing_to_show_is_no_plot_and_a_perfect_image_has_a_place() {
        let floor = row("white image", Kind::Floor, None, 0.9);
        assert_eq!(svg(std::slice::from_ref(&floor), &MEASURES[0]), None);
        assert_eq!(svg(&[row("a", Kind::Method, Some(1.0), f64::NAN), floor], &MEASURES[1]), None);
        let perfect = svg(&[row("a", Kind::Method, Some(1.0), 0.0)], &MEASURES[1]).expect("a plot");
        assert!(perfect.contains("<circle") && !perfect.contains("NaN") && !perfect.contains("inf"));
    }

    #[test]
    fn the_front_falls_in_steps_and_passes_what_is_beaten() {
        let points = vec![(10.0, 0.2), (1.0, 0.5), (20.0, 0.4), (30.0, 0.1)];
        let corners =
            [(1.0, 0.5), (10.0, 0.5), (10.0, 0.2), (20.0, 0.2), (20.0, 0.2), (30.0, 0.2), (30.0, 0.1)];
        assert_eq!(front(points), corners);
        assert!(front(Vec::new()).is_empty());
    }
}
