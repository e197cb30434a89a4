//! A fit as a page that needs nothing else: parameters with their intervals, what was measured beside what
//! the material explains of it, what is left, and how different both look.

use super::plots::{explained, photographs, residuals};
use super::{how_well, rows};
use anyhow::Result;
use askama::Template;
use deepshade_phosphor::difference::ciede2000;
use deepshade_phosphor::fit::{Explained, Fit, MeasurementKind, Warning};

/// The page as HTML.
///
/// # Errors
/// If a plot or the template fails.
pub fn page(fit: &Fit) -> Result<String> {
    let mut plots = vec![explained(fit).svg("The decay: measured (dots) and fitted")?];
    for (part, title) in [
        (MeasurementKind::Decay, "What is left of the decay"),
        (MeasurementKind::Spectrum, "What is left of photographs through filters"),
        (MeasurementKind::Excitation, "What is left of photographs after light of one band"),
    ] {
        let plot = residuals(fit, part);
        if !plot.lines.is_empty() {
            plots.push(plot.svg(title)?);
        }
    }
    let page = Page {
        name: &fit.material.name,
        states: fit.material.states.len(),
        how_well: how_well(fit),
        warnings: &fit.warnings,
        rows: rows::table(fit).split_off(1),
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
    how_well: String,
    warnings: &'a [Warning],
    /// State, parameter, value, interval.
    rows: Vec<Vec<String>>,
    /// Of each photograph of the decay that is stated its time and CIEDE2000.
    differences: Vec<[String; 2]>,
    /// SVG.
    plots: Vec<String>,
}

/// CIEDE2000 between photograph and fit at the first, the middle and the last photograph of the decay, and in
/// the mean, the brightest colour of all being 1.
fn differences(fit: &Fit) -> Vec<[String; 2]> {
    let photographs: Vec<&[Explained]> = photographs(fit, MeasurementKind::Decay).collect();
    let brightest = photographs.iter().copied().flatten().map(|value| value.measured).fold(0.0, f64::max);
    let difference = |photograph: &&[Explained]| {
        let colour =
            |of: fn(&Explained) -> f64| [0, 1, 2].map(|c: usize| of(&photograph[c]).max(0.0) / brightest);
        ciede2000(colour(|value| value.fitted), colour(|value| value.measured))
    };
    let (Some(first), Some(last)) = (photographs.first(), photographs.last()) else { return Vec::new() };
    let middle = &photographs[photographs.len() / 2];
    let row = |photograph: &&[Explained]| {
        [format!("{:.2} s", photograph[0].seconds), format!("{:.2}", difference(photograph))]
    };
    let mean = photographs.iter().map(difference).sum::<f64>() / photographs.len() as f64;
    let mean = ["the mean of all".to_owned(), format!("{mean:.2}")];
    vec![row(first), row(middle), row(last), mean]
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_glow::file::MaterialFile;
    use deepshade_phosphor::fit::Laboratory;

    #[test]
    fn a_page_says_what_was_found_and_how_it_looks() {
        let presets = MaterialFile::presets();
        let pink = presets.named("pink").expect("a preset");
        let measurement = Laboratory::thesis().measure(pink, 1).expect("a measurement");
        let mut fit = Fit::new("pink & warm", &measurement, 1).expect("a fit");
        let said = page(&fit).expect("a page");
        assert!(
            said.contains("pink &#38; warm, 1 state<") || said.contains("pink &amp; warm, 1 state<"),
            "{said}"
        );
        let decay = rows::significant(fit.estimates[0].value);
        assert!(said.contains(&decay) && said.matches("<svg").count() == 4);
        assert!(said.contains("residual over noise") && !said.contains("Warning"), "{said}");
        (fit.warnings, fit.noise_is_known) = (vec![Warning::Slow(1)], false);
        let said = page(&fit).expect("a page");
        assert!(said.contains("Warning: state 1 decays more slowly") && said.contains("R^2"), "{said}");
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
