//! Plots: lines through points, over an axis that may be logarithmic, as SVG.

use anyhow::{Result, anyhow};
use plotters::prelude::*;
use std::ops::Range;

/// What a plot shows.
#[derive(Clone, Debug)]
pub struct Plot {
    /// What the horizontal axis is.
    pub x: &'static str,
    /// Whether it is logarithmic.
    pub is_logarithmic: bool,
    /// What the vertical axis is.
    pub y: &'static str,
    /// What is shown; one point is a dot.
    pub lines: Vec<Line>,
    /// A dashed level to compare with, and its name.
    pub level: Option<(&'static str, f64)>,
}

/// Points under one name.
#[derive(Clone, Debug)]
pub struct Line {
    /// What the legend calls it.
    pub name: String,
    /// Points, from left to right.
    pub points: Vec<(f64, f64)>,
    /// How they are drawn.
    pub style: Style,
    /// Their colour, red, green and blue; by default the next that no other line has.
    pub colour: Option<[u8; 3]>,
}

/// How points are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    /// A line with a dot a point.
    Dots,
    /// A dot a point.
    Points,
    /// A line.
    Curve,
    /// A faint line in the colour of the one before, which the legend leaves out.
    Companion,
}

/// Colours that people of all kinds of sight can tell apart (Okabe and Ito 2008), without their yellow; the first again
/// after the last.
const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
];
/// Of these the ones of lines that are of red, green and blue light.
pub const CHANNELS: [(&str, [u8; 3]); 3] =
    [("red", [213, 94, 0]), ("green", [0, 158, 115]), ("blue", [0, 114, 178])];
/// Share of the plot's width that the legend takes to the right of all points.
const LEGEND: f64 = 0.4;
/// Share of the points' range that is left free around it.
const MARGIN: f64 = 0.06;

impl Line {
    /// A line with a dot a point.
    pub fn dotted(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.into(), points, style: Style::Dots, colour: None }
    }

    /// The line in a colour of its own.
    pub fn coloured(self, colour: [u8; 3]) -> Self {
        Self { colour: Some(colour), ..self }
    }
}

impl Plot {
    /// The plot as SVG. Points that are not finite are left out.
    ///
    /// # Errors
    /// If there is no point.
    pub fn svg(&self, title: &str) -> Result<String> {
        let mut svg = String::new();
        self.draw(&mut svg, title).map_err(|error| anyhow!("plot `{title}`: {error}"))?;
        Ok(svg)
    }

    /// The points of a line where the axes are linear.
    fn placed(&self, line: &Line) -> Vec<(f64, f64)> {
        let x = |x: f64| if self.is_logarithmic { x.log2() } else { x };
        let points = line.points.iter().map(|point| (x(point.0), point.1));
        points.filter(|point| point.0.is_finite() && point.1.is_finite()).collect()
    }

    fn draw(&self, svg: &mut String, title: &str) -> Result<(), Box<dyn std::error::Error>> {
        let lines: Vec<Vec<(f64, f64)>> = self.lines.iter().map(|line| self.placed(line)).collect();
        let level = self.level.iter().map(|level| level.1);
        let xs = range(lines.iter().flatten().map(|point| point.0)).ok_or("no points")?;
        let ys = range(lines.iter().flatten().map(|point| point.1).chain(level)).ok_or("no points")?;
        let with_legend = xs.start..xs.end + LEGEND * (xs.end - xs.start);
        // Below the legend nothing is measured.
        let number = |x: &f64| match *x > xs.end {
            true => String::new(),
            false => short(if self.is_logarithmic { x.exp2() } else { *x }, 0),
        };
        // Neighbours on the axis, an eighth of it apart at least, are not to look alike.
        let digits = (1.0 - (0.125 * (ys.end - ys.start)).log10()).clamp(0.0, 9.0) as usize;
        let area = SVGBackend::with_string(svg, (860, 480)).into_drawing_area();
        area.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(&area)
            .caption(title, ("sans-serif", 20))
            .margin(12)
            .x_label_area_size(44)
            .y_label_area_size(64)
            .build_cartesian_2d(with_legend, ys)?;
        chart
            .configure_mesh()
            .max_light_lines(1)
            .x_desc(self.x)
            .y_desc(self.y)
            .x_label_formatter(&number)
            .y_label_formatter(&|y| short(*y, digits))
            .draw()?;
        let mut names = 0;
        for (line, points) in self.lines.iter().zip(lines) {
            if line.style == Style::Companion {
                let colour = COLOURS[(names - names.min(1)) % COLOURS.len()].mix(0.4);
                chart.draw_series(LineSeries::new(points, colour.stroke_width(1)))?;
                continue;
            }
            let of_its_own = line.colour.map(|[red, green, blue]| RGBColor(red, green, blue));
            let colour = of_its_own.unwrap_or(COLOURS[names % COLOURS.len()]);
            names += 1;
            let dot = if matches!(line.style, Style::Dots | Style::Points) { 4 } else { 0 };
            // The legend shows what is drawn, since dots and a curve of one colour may stand for two things.
            if line.style == Style::Points {
                chart
                    .draw_series(points.into_iter().map(|at| Circle::new(at, dot, colour.filled())))?
                    .label(&line.name)
                    .legend(move |(x, y)| Circle::new((x + 9, y), dot, colour.filled()));
            } else {
                chart
                    .draw_series(LineSeries::new(points, colour.stroke_width(2)).point_size(dot))?
                    .label(&line.name)
                    .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2)));
            }
        }
        if let Some((name, value)) = self.level {
            let grey = BLACK.mix(0.7).stroke_width(2);
            chart
                .draw_series(DashedLineSeries::new([(xs.start, value), (xs.end, value)], 6, 4, grey))?
                .label(name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], grey));
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperRight)
            .background_style(WHITE.mix(0.85))
            .border_style(BLACK.mix(0.3))
            .draw()?;
        area.present()?;
        Ok(())
    }
}

/// The range of values, and a little more; none without a value.
fn range(values: impl Iterator<Item = f64>) -> Option<Range<f64>> {
    let (low, high) = values.fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)));
    // A single value gets an axis too.
    let margin = if high > low { MARGIN * (high - low) } else { 0.1 * high.abs().max(1e-3) };
    (low <= high).then_some(low - margin..high + margin)
}

/// A number with three digits that count, and at least so many after the point, where these are not 0.
fn short(value: f64, least: usize) -> String {
    let digits = ((2 - value.abs().max(1e-4).log10().floor() as i32).clamp(0, 6) as usize).max(least);
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(lines: Vec<Line>) -> Plot {
        Plot { x: "samples", is_logarithmic: true, y: "SSIM", lines, level: Some(("white", 0.4)) }
    }

    #[test]
    fn every_point_is_a_dot_and_every_line_has_a_name() {
        let lines = vec![
            Line::dotted("few", vec![(4.0, 0.5), (64.0, 0.7)]),
            Line::dotted("one", vec![(16.0, f64::NAN), (8.0, 0.6)]),
        ];
        let svg = plot(lines).svg("Samples").expect("a picture");
        assert_eq!(svg.matches("<circle").count(), 3, "{svg}");
        for text in ["few", "one", "white", "Samples", "SSIM", "samples"] {
            assert!(svg.contains(text), "{text}");
        }
        let [dots, companion] = [Style::Dots, Style::Companion].map(|style| {
            let points = vec![(1.0, 0.5), (2.0, 0.7)];
            let lines = vec![
                Line::dotted("few", points.clone()),
                Line { name: "more".into(), points, style, colour: None },
            ];
            plot(lines).svg("Samples").expect("a picture").contains("more")
        });
        assert!(dots && !companion, "the legend leaves companions out");
        let [marks, lines] = [Style::Points, Style::Curve].map(|style| {
            let line =
                Line { name: "wanted".into(), points: vec![(1.0, 0.5), (2.0, 0.7)], style, colour: None };
            plot(vec![line]).svg("Samples").expect("a picture").matches("<circle").count()
        });
        assert_eq!((marks, lines), (3, 0), "two dots and one of the legend");
        assert!(plot(vec![]).svg("Nothing").is_err());
    }

    #[test]
    fn numbers_beside_a_short_axis_differ() {
        let lines = vec![Line::dotted("flat", vec![(1.0, 0.3081), (2.0, 0.3113)])];
        let svg = Plot { level: None, ..plot(lines) }.svg("Flat").expect("a picture");
        let is_number = |text: &&str| text.starts_with("0.3");
        let labels: Vec<&str> = svg.split(['>', '<']).map(str::trim).filter(is_number).collect();
        let different: std::collections::BTreeSet<&str> = labels.iter().copied().collect();
        assert!(labels.len() > 3 && different.len() == labels.len(), "{labels:?}");
    }

    #[test]
    fn channels_have_their_colours() {
        let lines = CHANNELS.map(|(name, colour)| Line::dotted(name, vec![(1.0, 0.5)]).coloured(colour));
        let svg = plot(lines.to_vec()).svg("Channels").expect("a picture");
        let places = ["#D55E00", "#009E73", "#0072B2"].map(|colour| svg.find(colour).expect("its colour"));
        assert!(places.is_sorted(), "{svg}");
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(
            [0.6543, 12.345, 1234.6, 0.0, 0.5, 100.0].map(|value| short(value, 0)),
            ["0.654", "12.3", "1235", "0", "0.5", "100"]
        );
        assert_eq!([0.3105, 0.311, 12.0].map(|value| short(value, 4)), ["0.3105", "0.311", "12"]);
    }
}
