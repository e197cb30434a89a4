//! Plots: lines through points, over axes that may be logarithmic, as SVG.

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

/// Colours that people of all kinds of sight can tell apart (Okabe and Ito 2008), without their yellow; after
/// the last the first again, with triangles for dots.
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
/// Width of the axes with what stands beside them, and height of a plot, pixels.
const AXES: (u32, u32) = (640, 480);
/// Height of a line of the legend, which stands to the right of the axes.
const LINE: i32 = 19;
/// Share of the points' range that is left free around it.
const MARGIN: f64 = 0.06;

impl Line {
    /// A line with a dot a point.
    pub fn dotted(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.into(), points, style: Style::Dots, colour: None }
    }

    /// Whether it stands in the legend.
    fn is_named(&self) -> bool {
        self.style != Style::Companion
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
        self.scaled_svg(title, [Scale::of(self.is_logarithmic), Scale::Linear])
    }

    /// As [`Self::svg`], with both axes logarithmic.
    ///
    /// # Errors
    /// If there is no point.
    pub fn log_log_svg(&self, title: &str) -> Result<String> {
        self.scaled_svg(title, [Scale::Logarithmic; 2])
    }

    fn scaled_svg(&self, title: &str, scales: [Scale; 2]) -> Result<String> {
        let mut svg = String::new();
        self.draw(&mut svg, title, scales).map_err(|error| anyhow!("plot `{title}`: {error}"))?;
        Ok(svg)
    }

    fn draw(
        &self,
        svg: &mut String,
        title: &str,
        [x_scale, y_scale]: [Scale; 2],
    ) -> Result<(), Box<dyn std::error::Error>> {
        let placed = |line: &Line| -> Vec<(f64, f64)> {
            let points = line.points.iter().map(|point| (x_scale.place(point.0), y_scale.place(point.1)));
            points.filter(|point| point.0.is_finite() && point.1.is_finite()).collect()
        };
        let lines: Vec<Vec<(f64, f64)>> = self.lines.iter().map(placed).collect();
        let keys = self.keys();
        let level = self.level.map(|(name, value)| (name, y_scale.place(value)));
        let xs = range(lines.iter().flatten().map(|point| point.0)).ok_or("no points")?;
        let ys = range(lines.iter().flatten().map(|point| point.1).chain(level.map(|level| level.1)))
            .ok_or("no points")?;
        let number = |x: &f64| short(x_scale.value(*x), 0);
        // Neighbours on the axis, an eighth of it apart at least, are not to look alike.
        let step = y_scale.value(ys.start + 0.125 * (ys.end - ys.start)) - y_scale.value(ys.start);
        let digits = (1.0 - step.log10()).clamp(0.0, 9.0) as usize;
        let (width, height) = self.legend_size();
        let size = (AXES.0 + width, AXES.1.max(height));
        let area = SVGBackend::with_string(svg, size).into_drawing_area();
        area.fill(&WHITE)?;
        let (axes, legend) = area.titled(title, ("sans-serif", 20))?.split_horizontally(AXES.0);
        let mut chart = ChartBuilder::on(&axes)
            .margin(12)
            .x_label_area_size(44)
            .y_label_area_size(64)
            .build_cartesian_2d(xs.clone(), ys)?;
        chart
            .configure_mesh()
            .max_light_lines(1)
            .x_desc(self.x)
            .y_desc(self.y)
            .x_label_formatter(&number)
            .y_label_formatter(&|y| short(y_scale.value(*y), digits))
            .draw()?;
        for ((line, key), points) in self.lines.iter().zip(&keys).zip(lines) {
            if line.style != Style::Points {
                chart.draw_series(LineSeries::new(points.iter().copied(), key.stroke()))?;
            }
            if line.style.has_dots() {
                chart.draw_series(points.into_iter().map(|at| key.dot(at)))?;
            }
        }
        let mut y = LINE;
        for (key, line) in keys.iter().zip(&self.lines).filter(|(_, line)| line.is_named()) {
            // The legend shows what is drawn, since dots and a curve of one colour may stand for two things.
            if line.style != Style::Points {
                legend.draw(&PathElement::new([(4, y), (24, y)], key.stroke()))?;
            }
            if line.style.has_dots() {
                legend.draw(&key.dot((14, y)))?;
            }
            legend.draw(&Text::new(line.name.clone(), (32, y - 6), ("sans-serif", 12)))?;
            y += LINE;
        }
        if let Some((name, value)) = level {
            let grey = BLACK.mix(0.7).stroke_width(2);
            chart.draw_series(DashedLineSeries::new([(xs.start, value), (xs.end, value)], 6, 4, grey))?;
            for x in [4, 16] {
                legend.draw(&PathElement::new([(x, y), (x + 8, y)], grey))?;
            }
            legend.draw(&Text::new(name, (32, y - 6), ("sans-serif", 12)))?;
        }
        area.present()?;
        Ok(())
    }

    /// Pixels that the legend and the title above it take.
    fn legend_size(&self) -> (u32, u32) {
        let lines = self.lines.iter().filter(|line| line.is_named()).map(|line| line.name.as_str());
        let names: Vec<&str> = lines.chain(self.level.map(|level| level.0)).collect();
        let longest = names.iter().map(|name| name.chars().count()).max().unwrap_or(0);
        (48 + 7 * longest as u32, (names.len() as u32 + 3) * LINE as u32)
    }

    /// How the lines are drawn: in the next colour if they have none of their own, a companion in that of the
    /// line before.
    fn keys(&self) -> Vec<Key> {
        let mut keys: Vec<Key> = Vec::with_capacity(self.lines.len());
        let mut named = 0;
        for line in &self.lines {
            let before = keys.last().filter(|_| !line.is_named());
            let of_its_own = line.colour.map(|[red, green, blue]| RGBColor(red, green, blue));
            keys.push(match before {
                Some(before) => Key { colour: before.colour.mix(0.4), width: 1, ..*before },
                None => Key {
                    colour: of_its_own.unwrap_or(COLOURS[named % COLOURS.len()]).mix(1.0),
                    width: 2,
                    is_triangle: named >= COLOURS.len(),
                },
            });
            named += usize::from(line.is_named());
        }
        keys
    }
}

/// What an axis is divided by.
#[derive(Clone, Copy)]
enum Scale {
    Linear,
    Logarithmic,
}

impl Scale {
    const fn of(is_logarithmic: bool) -> Self {
        if is_logarithmic { Self::Logarithmic } else { Self::Linear }
    }

    /// Where a value lies on the axis.
    fn place(self, value: f64) -> f64 {
        match self {
            Self::Linear => value,
            Self::Logarithmic => value.log2(),
        }
    }

    /// The value at a place.
    fn value(self, place: f64) -> f64 {
        match self {
            Self::Linear => place,
            Self::Logarithmic => place.exp2(),
        }
    }
}

impl Style {
    fn has_dots(self) -> bool {
        matches!(self, Self::Dots | Self::Points)
    }
}

/// How a line and its dots are drawn.
struct Key {
    colour: RGBAColor,
    width: u32,
    is_triangle: bool,
}

impl Key {
    fn stroke(&self) -> ShapeStyle {
        self.colour.stroke_width(self.width)
    }

    fn dot<C: Clone + 'static>(&self, at: C) -> DynElement<'static, SVGBackend<'_>, C> {
        if self.is_triangle {
            TriangleMarker::new(at, 5, self.colour.filled()).into_dyn()
        } else {
            Circle::new(at, 4, self.colour.filled()).into_dyn()
        }
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
        assert_eq!(svg.matches("<circle").count(), 5, "those of the legend, too: {svg}");
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
    fn lines_of_one_colour_have_different_dots() {
        let lines = (0..9).map(|at| Line {
            style: Style::Points,
            ..Line::dotted(format!("line {at}"), vec![(1.0, f64::from(at))])
        });
        let svg = plot(lines.collect()).svg("Nine").expect("a picture");
        assert_eq!([svg.matches("<circle").count(), svg.matches("<polygon").count()], [14, 4], "{svg}");
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
