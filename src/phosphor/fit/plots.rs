//! What was measured beside what a fit explains of it, as plots.

use crate::plot::{CHANNELS, Line, Plot, Style};
use deepshade_glow::spectrum::{Axis, Bands};
use deepshade_phosphor::fit::{Explained, Fit, MeasurementKind};

/// Colours of eight bands of light, from violet to red, no two alike.
const SPECTRUM: [[u8; 3]; 8] = [
    [112, 48, 160],
    [0, 70, 190],
    [86, 180, 233],
    [0, 158, 115],
    [130, 190, 30],
    [230, 159, 0],
    [213, 94, 0],
    [150, 20, 30],
];

/// The photographs of a part, each as its values in the channels.
pub fn photographs(fit: &Fit, part: MeasurementKind) -> impl Iterator<Item = &[Explained]> {
    fit.values.chunks_exact(CHANNELS.len()).filter(move |photograph| photograph[0].part == part)
}

/// What was measured of the decay, as dots, and what the material explains of it.
pub fn explained(fit: &Fit) -> Plot {
    let of_channel = |(channel, (name, colour)): (usize, (&str, [u8; 3]))| {
        let points = |of: fn(&Explained) -> f64| {
            let decay = photographs(fit, MeasurementKind::Decay).map(|photograph| &photograph[channel]);
            decay.map(|value| (value.seconds, of(value))).collect::<Vec<_>>()
        };
        let line = |name: String, points, style| Line { name, points, style, colour: Some(colour) };
        [
            line(format!("{name}, measured"), points(|value| value.measured), Style::Points),
            line(format!("{name}, fitted"), points(|value| value.fitted), Style::Curve),
        ]
    };
    let lines = CHANNELS.into_iter().enumerate().flat_map(of_channel).collect();
    Plot { x: "time in the dark, s", is_logarithmic: false, y: "radiance", lines, level: None }
}

/// What is left of a part of the measurements, over its noise; without lines where there is none of it. Of
/// the decay and of photographs through filters each channel is shown, of excitation for each band the
/// channel of which most is left.
pub fn residuals(fit: &Fit, part: MeasurementKind) -> Plot {
    let each = "measured less fitted, standard errors";
    let (x, y, lines) = match part {
        MeasurementKind::Decay => {
            ("time in the dark, s", each, of_channels(fit, part, Style::Dots, |value| value.seconds))
        }
        MeasurementKind::Spectrum => {
            let number = |value: &Explained| (value.place + 1) as f64;
            (
                "filter, counted as the columns of filters.csv",
                each,
                of_channels(fit, part, Style::Points, number),
            )
        }
        MeasurementKind::Excitation => {
            let farthest = "measured less fitted, standard errors, of the channel farthest off";
            ("time of light, s", farthest, of_bands(fit))
        }
    };
    Plot {
        x,
        is_logarithmic: false,
        y,
        lines: lines.into_iter().filter(|line| !line.points.is_empty()).collect(),
        level: Some(("0", 0.0)),
    }
}

/// A line a channel, against what a value has for `x`.
fn of_channels(fit: &Fit, part: MeasurementKind, style: Style, x: fn(&Explained) -> f64) -> Vec<Line> {
    let line = |(channel, (name, colour)): (usize, (&str, [u8; 3]))| {
        let values = photographs(fit, part).map(|photograph| &photograph[channel]);
        let points = values.map(|value| (x(value), left(value))).collect();
        Line { style, ..Line::dotted(name, points).coloured(colour) }
    };
    CHANNELS.into_iter().enumerate().map(line).collect()
}

/// A line a band of light, against how long it shone.
fn of_bands(fit: &Fit) -> Vec<Line> {
    let line = |band: usize| {
        let its =
            photographs(fit, MeasurementKind::Excitation).filter(|photograph| photograph[0].place == band);
        let mut points: Vec<_> =
            its.map(|photograph| (photograph[0].seconds, farthest(photograph))).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (name, colour) = light_of(fit.material.bands, band);
        Line::dotted(name, points).coloured(colour)
    };
    (0..fit.material.bands.count()).map(line).collect()
}

/// What is left of a value, over its noise.
fn left(value: &Explained) -> f64 {
    (value.measured - value.fitted) / value.noise
}

/// What is left, over its noise, of the value of which most is.
fn farthest(values: &[Explained]) -> f64 {
    let farther = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
    values.iter().map(left).fold(0.0, farther)
}

/// What light of a band is called, and its colour.
fn light_of(bands: Bands, band: usize) -> (String, [u8; 3]) {
    match bands {
        Bands::Rgb => (CHANNELS[band].0.to_owned(), CHANNELS[band].1),
        Bands::Eight => (format!("{:.0} nm", Axis::EIGHT.centres()[band]), SPECTRUM[band]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_glow::file::MaterialFile;
    use deepshade_phosphor::fit::Laboratory;

    fn fit() -> Fit {
        let presets = MaterialFile::presets();
        let measurement = Laboratory::thesis().measure(presets.named("pink").expect("a preset"), 1);
        Fit::new("pink", &measurement.expect("a measurement"), 1).expect("a fit")
    }

    #[test]
    fn filters_lie_side_by_side() {
        let plot = residuals(&fit(), MeasurementKind::Spectrum);
        assert_eq!(plot.lines.len(), 3);
        for line in plot.lines {
            let places: Vec<f64> = line.points.iter().map(|point| point.0).collect();
            assert_eq!(places, (1..=31).map(f64::from).collect::<Vec<_>>());
            assert_eq!(line.style, Style::Points, "filters have nothing between them");
        }
    }

    #[test]
    fn every_band_of_light_has_a_line_of_its_own() {
        let mut fit = fit();
        fit.values.reverse();
        let plot = residuals(&fit, MeasurementKind::Excitation);
        let names: Vec<&str> = plot.lines.iter().map(|line| line.name.as_str()).collect();
        assert_eq!(names, ["419 nm", "456 nm", "494 nm"]);
        for line in &plot.lines {
            assert!(line.points.len() == 11 && line.points.is_sorted_by(|a, b| a.0 < b.0), "{line:?}");
            assert!(line.points.iter().all(|point| point.1.abs() < 6.0), "{line:?}");
        }
        fit.values.retain(|value| value.part == MeasurementKind::Decay);
        assert!(residuals(&fit, MeasurementKind::Excitation).lines.is_empty());
        assert_eq!(residuals(&fit, MeasurementKind::Decay).lines.len(), 3);
    }

    #[test]
    fn bands_have_the_colours_of_their_light() {
        let mut fit = fit();
        let lines = residuals(&fit, MeasurementKind::Excitation).lines;
        let colours: Vec<_> = lines.iter().map(|line| line.colour).collect();
        assert_eq!(colours, SPECTRUM[..3].iter().copied().map(Some).collect::<Vec<_>>());
        assert!((0..8).all(|band| !SPECTRUM[..band].contains(&SPECTRUM[band])), "no two alike");
        fit.material.bands = Bands::Rgb;
        let lines = residuals(&fit, MeasurementKind::Excitation).lines;
        let named: Vec<_> = lines.iter().map(|line| (line.name.as_str(), line.colour)).collect();
        assert_eq!(named, CHANNELS.map(|(name, colour)| (name, Some(colour))));
    }

    /// One channel too bright and another too dark are two errors, not none.
    #[test]
    fn channels_do_not_make_up_for_each_other() {
        let mut fit = fit();
        for (index, value) in fit.values.iter_mut().enumerate() {
            value.measured = value.fitted + [4.0, 0.0, -5.0][index % 3] * value.noise;
        }
        let plot = residuals(&fit, MeasurementKind::Excitation);
        let mut points = plot.lines.iter().flat_map(|line| &line.points);
        assert!(points.all(|point| (point.1 + 5.0).abs() < 1e-6), "{:?}", plot.lines);
    }
}
