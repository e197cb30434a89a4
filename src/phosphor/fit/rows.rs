//! The parameters of a fit as a table.

use deepshade_phosphor::fit::{Fit, Parameter, ParameterEstimate, listed_bands};
use std::f64::consts::LN_2;

/// How many digits of a number count.
const DIGITS: usize = 5;

/// State, parameter, value and interval of each parameter, below their names.
pub fn table(fit: &Fit) -> Vec<Vec<String>> {
    let mut rows = vec![["state", "parameter", "value", "95 % interval"].map(str::to_owned).to_vec()];
    for estimate in &fit.estimates {
        if estimate.parameter == Parameter::Emission(0) && !fit.unmeasured.is_empty() {
            let parameter = format!("excitation, {}", listed_bands(&fit.unmeasured));
            rows.push(row(estimate.state, parameter, String::new(), "not measured".to_owned()));
        }
        rows.push(estimated(estimate));
        if estimate.parameter == Parameter::Decay {
            rows.push(half_life(estimate));
        }
    }
    rows
}

/// A parameter's name.
pub fn parameter_name(parameter: Parameter) -> String {
    match parameter {
        Parameter::Decay => "decay, 1/s".to_owned(),
        Parameter::Excitation(band) => format!("excitation, band {}", band + 1),
        Parameter::Emission(band) => format!("emission, band {}", band + 1),
    }
}

/// A number with the digits that count, however small or large it is.
pub fn significant(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let decimals = DIGITS - 1;
    let rounded = format!("{value:.decimals$e}");
    // Rounding may give a number a digit more.
    match rounded.split_once('e').and_then(|(_, power)| power.parse::<i32>().ok()) {
        Some(power @ -4..6) => format!("{value:.*}", (decimals as i32 - power).max(0) as usize),
        _ => rounded,
    }
}

fn row(state: usize, parameter: String, value: String, interval: String) -> Vec<String> {
    vec![(state + 1).to_string(), parameter, value, interval]
}

fn estimated(estimate: &ParameterEstimate) -> Vec<String> {
    let name = parameter_name(estimate.parameter);
    row(estimate.state, name, significant(estimate.value), interval(estimate, |[low, high]| [low, high]))
}

/// What a decay means as a time.
fn half_life(decay: &ParameterEstimate) -> Vec<String> {
    let interval = interval(decay, |[low, high]| [LN_2 / high, LN_2 / low]);
    row(decay.state, "half life, s".to_owned(), significant(LN_2 / decay.value), interval)
}

/// What becomes of the ends of an interval, in words.
fn interval(estimate: &ParameterEstimate, of: fn([f64; 2]) -> [f64; 2]) -> String {
    if !estimate.interval[1].is_finite() {
        return "not known".to_owned();
    }
    let [low, high] = of(estimate.interval).map(significant);
    format!("{low} to {high}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_glow::file::MaterialFile;
    use deepshade_glow::spectrum::lights::Light;
    use deepshade_phosphor::fit::Laboratory;

    #[test]
    fn digits_that_count_are_shown() {
        assert_eq!(
            [0.0, 0.0123456, 1.0, 123.456, 123_456.7].map(significant),
            ["0", "0.012346", "1.0000", "123.46", "123457"]
        );
        assert_eq!([9.99999, 99_999.9, 999_999.9].map(significant), ["10.000", "100000", "1.0000e6"]);
        assert_eq!(
            [1.23456e-7, 0.000_123_456, 9.87654e8, -2.5e-9].map(significant),
            ["1.2346e-7", "0.00012346", "9.8765e8", "-2.5000e-9"]
        );
    }

    /// Mercury has light that excites in the first band alone; the table leaves no band out.
    #[test]
    fn half_lives_are_beside_rates_and_bands_without_light_are_named() {
        let presets = MaterialFile::presets();
        let blue = presets.named("blue").expect("a preset");
        let laboratory = Laboratory { lamp: Light::Mercury, ..Laboratory::thesis() };
        let mut fit =
            Fit::new("blue", &laboratory.measure(blue, 1).expect("a measurement"), 1).expect("a fit");
        (fit.estimates[0].value, fit.estimates[0].interval) = (LN_2 / 20.0, [LN_2 / 25.0, LN_2 / 16.0]);
        let rows = table(&fit);
        assert_eq!(rows[1][..3], ["1", "decay, 1/s", "0.034657"]);
        assert_eq!(rows[2], ["1", "half life, s", "20.000", "16.000 to 25.000"]);
        assert_eq!(rows[3][1], "excitation, band 1");
        assert_eq!(rows[4], ["1", "excitation, bands 2 to 8", "", "not measured"]);
        assert_eq!((rows[5][1].as_str(), rows.len()), ("emission, band 1", 13));
        fit.estimates[0].interval = [0.0, f64::INFINITY];
        assert_eq!(table(&fit)[2][3], "not known");
    }
}
