//! A fit as a page that needs nothing else: parameters with their intervals, what was measured beside what the material explains of it,
//! what is left, and how different both look.

use super::{estimate_row, residuals};
use crate::plot::{CHANNELS, Line, Plot, Style};
use anyhow::Result;
use askama::Template;
use deepshade_render::phosphor::difference::ciede2000;
use deepshade_render::phosphor::fit::{Explained, Fit, Part};

/// The page as HTML.
///
/// # Errors
/// If a plot or the template fails.
pub fn page(fit: &Fit) -> Result<String> {
    let mut plots = vec![explained(fit).svg("The decay: measured (dots) and fitted")?];
    for (part, title) in [
        (Part::Decay, "What is left of the decay"),
        (Part::Spectrum, "What is left of photographs through filters"),
        (Part::Excitation, "What is left of photographs after light of one band"),
    ] {
        if fit.values.iter().any(|value| value.part == part) {
            plots.push(residuals(fit, part).svg(title)?);
        }
    }
    let page = Page {
        name: &fit.material.name,
        states: fit.material.states.len(),
        residual: format!("{:.3}", fit.residual_over_noise()),
        rows: fit.estimates.iter().map(estimate_row).collect(),
        differences: differences(fit),
        plots,
    };
    Ok(page.render()?)
}

#[derive(Template)]
#[template(path = "phosphor/fit/report.html")]
struct Page<'a> {
    name: &'a str,
    states: usize,
    residual: String,
    /// State, parameter, value, interval.
    rows: Vec<Vec<String>>,
    /// Of each photograph of the decay that is stated its time and CIEDE2000.
    differences: Vec<[String; 2]>,
    /// SVG.
    plots: Vec<String>,
}

/// What was measured of the decay, as dots, and what the material explains of it.
fn explained(fit: &Fit) -> Plot {
    let of_channel = |(channel, (name, colour)): (usize, (&str, [u8; 3]))| {
        let its = |value: &&Explained| value.part == Part::Decay && value.channel == channel;
        let points = |of: fn(&Explained) -> f64| {
            fit.values.iter().filter(its).map(|value| (value.seconds, of(value))).collect::<Vec<_>>()
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

/// CIEDE2000 between photograph and fit at the first, the middle and the last photograph of the decay, and in the mean, the brightest
/// colour of all being 1.
fn differences(fit: &Fit) -> Vec<[String; 2]> {
    let decay: Vec<&Explained> = fit.values.iter().filter(|value| value.part == Part::Decay).collect();
    let brightest = decay.iter().map(|value| value.measured).fold(0.0, f64::max);
    let photographs: Vec<&[&Explained]> = decay.chunks_exact(CHANNELS.len()).collect();
    let difference = |photograph: &&[&Explained]| {
        let colour =
            |of: fn(&Explained) -> f64| [0, 1, 2].map(|c: usize| of(photograph[c]).max(0.0) / brightest);
        ciede2000(colour(|value| value.fitted), colour(|value| value.measured))
    };
    let (Some(first), Some(last)) = (photographs.first(), photographs.last()) else { return Vec::new() };
    let middle = &photographs[photographs.len() / 2];
    let row = |photograph: &&[&Explained]| {
        [format!("{:.2} s", photograph[0].seconds), format!("{:.2}", difference(photograph))]
    };
    let mean = photographs.iter().map(difference).sum::<f64>() / photographs.len() as f64;
    let mean = ["the mean of all".to_owned(), format!("{mean:.2}")];
    vec![row(first), row(middle), row(last), mean]
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_render::phosphor::fit::Laboratory;
    use deepshade_render::phosphor::material::file::MaterialFile;

    #[test]
    fn a_page_says_what_was_found_and_how_it_looks() {
        let presets = MaterialFile::presets();
        let pink = presets.named("pink").expect("a preset");
        let measurement = Laboratory::thesis().measure(pink, 1).expect("a measurement");
        let fit = Fit::new("pink & warm", &measurement, 1).expect("a fit");
        let page = page(&fit).expect("a page");
        assert!(
            page.contains("pink &#38; warm, 1 state<") || page.contains("pink &amp; warm, 1 state<"),
            "{page}"
        );
        let decay = format!("{:.5}", fit.estimates[0].value);
        assert!(page.contains(&decay) && page.matches("<svg").count() == 4);
        let stated: Vec<f64> =
            differences(&fit).iter().map(|[_, value]| value.parse().expect("a number")).collect();
        assert!(
            stated.len() == 4 && stated.iter().all(|value| *value < 1.0),
            "the right material: {stated:?}"
        );
        // A material whose colours are exchanged looks different.
        let mut wrong = fit;
        wrong
            .values
            .chunks_exact_mut(3)
            .for_each(|colour| (colour[0].fitted, colour[2].fitted) = (colour[2].fitted, colour[0].fitted));
        assert!(differences(&wrong)[3][1].parse::<f64>().expect("a number") > 5.0);
    }
}
