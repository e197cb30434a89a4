//! Error against time: a line a method through its qualities, both axes logarithmic.

use super::rivals::{Rival, trivial_name};
use crate::figures::write_atomically;
use crate::statistics::Estimate;
use anyhow::{Result, anyhow};
use deepshade_shaders::Effect;
use plotters::prelude::*;
use std::collections::BTreeMap;
use std::path::Path;

/// How much of the time axis the legend takes, as a factor.
const LEGEND: f64 = 6.0;

/// The points of a method: milliseconds and relative mean squared error, the fastest first.
type Line = (&'static str, Vec<(f64, f64)>);

/// Draws the curves into an SVG file.
///
/// # Errors
/// If nothing was measured or the file cannot be written.
pub fn write(
    path: &Path,
    effect: Effect,
    rivals: &[Rival],
    estimates: &BTreeMap<&str, Estimate>,
) -> Result<()> {
    let lines = lines(rivals, estimates);
    let points: Vec<(f64, f64)> = lines.iter().flat_map(|(_, points)| points.iter().copied()).collect();
    let nothing = estimates.get(format!("relmse_{}", trivial_name(effect)).as_str()).map(|e| e.mean);
    let errors = || points.iter().map(|point| point.1).chain(nothing);
    let range = |values: &mut dyn Iterator<Item = f64>| {
        let (low, high) = values.fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)));
        // Whole decades, so that both axes have numbers.
        let decade = |value: f64, up: bool| {
            let exponent = value.log10();
            10f64.powf(if up { exponent.ceil() } else { exponent.floor() })
        };
        let sound = low > 0.0 && low.is_finite() && high.is_finite();
        sound.then(|| decade(low / 1.01, false)..decade(high * 1.01, true))
    };
    let (Some(times), Some(range_of_errors)) =
        (range(&mut points.iter().map(|point| point.0)), range(&mut errors()))
    else {
        return Err(anyhow!("{}: no times or errors above 0 to draw", path.display()));
    };
    let mut svg = String::new();
    let drawn = draw(&mut svg, effect, &lines, nothing, times, range_of_errors);
    drawn.map_err(|error| anyhow!("{}: {error}", path.display()))?;
    write_atomically(path, svg.as_bytes())
}

fn lines(rivals: &[Rival], estimates: &BTreeMap<&str, Estimate>) -> Vec<Line> {
    let mut lines: Vec<Line> = Vec::new();
    for rival in rivals {
        let figure =
            |metric: &str| estimates.get(format!("{metric}_{}", rival.name).as_str()).map(|e| e.mean);
        let Some(point) = figure("ms").zip(figure("relmse")) else { continue };
        match lines.iter_mut().find(|(name, _)| *name == rival.method_name) {
            Some((_, points)) => points.push(point),
            None => lines.push((rival.method_name, vec![point])),
        }
    }
    lines.iter_mut().for_each(|(_, points)| points.sort_by(|a, b| a.0.total_cmp(&b.0)));
    lines
}

fn draw(
    svg: &mut String,
    effect: Effect,
    lines: &[Line],
    nothing: Option<f64>,
    times: std::ops::Range<f64>,
    errors: std::ops::Range<f64>,
) -> Result<(), Box<dyn std::error::Error>> {
    let area = SVGBackend::with_string(svg, (720, 480)).into_drawing_area();
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .caption(format!("{effect}: error against time"), ("sans-serif", 20))
        .margin(12)
        .x_label_area_size(44)
        .y_label_area_size(64)
        // The legend stands to the right of all points.
        .build_cartesian_2d((times.start..times.end * LEGEND).log_scale(), errors.log_scale())?;
    chart
        .configure_mesh()
        .max_light_lines(1)
        .x_desc("milliseconds")
        .y_desc("relative mean squared error")
        .x_label_formatter(&|x| x.to_string())
        .y_label_formatter(&|y| format!("{y:.4}").trim_end_matches(['0', '.']).to_owned())
        .draw()?;
    for (index, (name, points)) in lines.iter().enumerate() {
        let colour = Palette99::pick(index).to_rgba();
        chart
            .draw_series(LineSeries::new(points.iter().copied(), colour.stroke_width(2)).point_size(4))?
            .label(*name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2)));
    }
    if let Some(error) = nothing {
        let level = [(times.start, error), (times.end, error)];
        chart
            .draw_series(DashedLineSeries::new(level, 6, 4, BLACK.mix(0.7).stroke_width(2)))?
            .label(trivial_name(effect))
            .legend(|(x, y)| PathElement::new([(x, y), (x + 18, y)], BLACK.mix(0.7).stroke_width(2)));
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_is_a_line_through_its_points() {
        let lines = [("fast", vec![(0.1, 0.5), (1.0, 0.2)]), ("slow", vec![(5.0, 0.1)])];
        let mut svg = String::new();
        draw(&mut svg, Effect::Ao, &lines, Some(0.9), 0.05..10.0, 0.05..1.0).expect("a picture");
        assert!(svg.contains("fast") && svg.contains("slow") && svg.contains("white"));
        assert!(svg.matches("<polyline").count() >= 3, "{svg}");
        assert_eq!(svg.matches("<circle").count(), 3, "a dot a point");
    }
}
