//! `deepshade tune`: a method's parameters, chosen on the validation views of a dataset, so that it meets the
//! network on equal terms.

mod views;

use crate::figures::Figures;
use crate::location::Location;
use crate::methods::{self, Runs, Setup};
use anyhow::{Context, Result, ensure};
use deepshade_dataset::{Dataset, progress};
use deepshade_render::method::Method;
use deepshade_render::methods::Quality;
use deepshade_render::methods::dials::{Changes, Dial, Tuning, Values};
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::names::did_you_mean;
use deepshade_shaders::{Effect, lists};
use serde_json::json;
use std::path::PathBuf;
use views::{Timed, View, similarities, timed};

/// Tunes a method's parameters on the validation views of a dataset.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  deepshade tune --dataset data/ao --method hbao --frames 12 --json tune.json\n  \
    deepshade tune --dataset data/dof --method ring-gather --quality low\n  \
    deepshade tune --dataset data/gi --method lpv --parameters cells,scale    # whole numbers are asked for by name\n\n\
    Of each parameter in turn it tries other values, 0.25 to 4 times what it is, and finer ones in a second round, and keeps \
    what is nearer to truth by more than its standard error over the views. Whole numbers are counts, which cost time, and \
    stay as the quality has them where they are not asked for; others may cost time, too: see the milliseconds. With few \
    views what is found may be theirs alone. Nothing is changed: what is printed `eval` takes, and its numbers a \
    comparison's file and the window's sliders.\n\n\
    Figures: ssim_default, ssim_tuned, ms_default, ms_tuned, and each parameter that is a number under its name."
)]
pub struct Args {
    /// Folder or address of the dataset.
    #[arg(long)]
    dataset: Location,
    /// The method, of the dataset's effect.
    #[arg(long)]
    method: String,
    /// The quality that it is tuned in.
    #[arg(long, default_value = Quality::default().name())]
    quality: Quality,
    /// Parameters that are tuned, with commas between them [default: all but whole numbers];
    /// `deepshade methods` lists them.
    #[arg(long, value_delimiter = ',', value_parser = crate::arguments::name)]
    parameters: Vec<String>,
    /// Folder that the recipe's scene files are relative to, where it is not the one that the dataset
    /// remembers.
    #[arg(long)]
    scenes: Option<PathBuf>,
    /// At most so many validation views, spread over all of them.
    #[arg(long, default_value_t = 12, value_parser = clap::value_parser!(u16).range(2..=1000))]
    frames: u16,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
}

/// What a parameter's value is multiplied by in each round over all parameters.
const ROUNDS: [[f64; 6]; 2] = [[0.25, 0.5, 0.7, 1.4, 2.0, 4.0], [0.7, 0.8, 0.9, 1.1, 1.25, 1.4]];
/// What of its range is tried where it is 0, which no factor changes.
const SHARES: [f64; 4] = [0.02, 0.05, 0.1, 0.25];

/// Tunes, prints and writes what was found.
///
/// # Errors
/// If the dataset is for another effect or has too few validation views, there is no such parameter, or the
/// method fails.
pub fn run(args: &Args) -> Result<()> {
    let folder = args.dataset.read()?;
    let dataset = Dataset::open(&folder)?;
    let dataset = match &args.scenes {
        Some(scenes) => dataset.with_scenes(scenes),
        None => dataset,
    };
    let effect = dataset.recipe().effect;
    let dials = chosen(methods::dials(effect, &args.method, args.quality)?, args)?;
    if let Some(target) = &dataset.recipe().target {
        note!("the dataset's targets are images of `{target}`, not truth");
    }
    let gpu = Gpu::new()?;
    let open = |changes: &Changes| opened(&gpu, effect, args, changes);
    let fog = dataset.recipe().vary.as_ref().and_then(|vary| vary.fog);
    if fog.is_some_and(|fog| fog.smoke_share > 0.0) {
        methods::through_grids(vec![open(&Changes::default())?], true, |method| method.as_ref())?;
    }
    let views = validation_views(args, &dataset)?;
    let best = tuned(&dials, |changes| similarities(open(changes)?.as_ref(), &views))?;
    let before = timed(open(&Changes::default())?.as_ref(), &views)?;
    let after = timed(open(&best)?.as_ref(), &views)?;
    figures(args, effect, &dials, &best, [before, after], views.len()).write(args.json.as_deref())?;
    say!("{} on {} validation views: {before} as it is", args.method, views.len())?;
    if best.is_empty() {
        return say!("nothing that was tried is better by more than its standard error");
    }
    let (method, quality, set) = (&args.method, args.quality.name(), as_set(&best));
    say!(
        "{after} with\n  deepshade eval --effect {effect} --methods {method} --quality {quality} --set {set}"
    )
}

/// Validation views, spread over all that there are.
///
/// # Errors
/// If there are fewer than two, whose gains would be chance, or one cannot be read.
fn validation_views(args: &Args, dataset: &Dataset) -> Result<Vec<View>> {
    let held_apart = dataset.validation();
    ensure!(
        held_apart.len() > 1,
        "{} has {} validation views; its recipe's `validation_share` says how many are held apart",
        args.dataset,
        held_apart.len()
    );
    let spread = lists::spread(held_apart.len(), args.frames.into());
    let pairs: Vec<usize> = spread.into_iter().map(|index| held_apart[index]).collect();
    let props = dataset.props().context("--scenes says where files are")?;
    View::open(dataset, &props, &pairs)
}

/// What was found as figures: how the method is by default and tuned, and its parameters that are numbers.
fn figures(
    args: &Args,
    effect: Effect,
    dials: &[Dial],
    best: &Changes,
    [before, after]: [Timed; 2],
    views: usize,
) -> Figures {
    let mut figures = Figures::new("tune");
    for (name, Timed { ssim, milliseconds }) in [("default", before), ("tuned", after)] {
        figures.set(&format!("ssim_{name}"), ssim);
        figures.set(&format!("ms_{name}"), milliseconds);
    }
    for dial in dials.iter().filter(|dial| !matches!(dial.values, Values::Named(_))) {
        figures.set(&dial.name.replace('.', "_"), value_in(dial, best));
    }
    figures.detail("effect", json!(effect.name()));
    figures.detail("method", json!(args.method));
    figures.detail("quality", json!(args.quality.name()));
    figures.detail("dataset", json!(args.dataset.to_string()));
    figures.detail("frames", json!(views));
    figures.detail("changes", json!(best));
    figures
}

/// The parameters to be tuned.
fn chosen(dials: Vec<Dial>, args: &Args) -> Result<Vec<Dial>> {
    ensure!(!dials.is_empty(), "`{}` has no parameters", args.method);
    let known = dials.iter().map(|dial| dial.name.as_str()).collect::<Vec<_>>().join(", ");
    for name in &args.parameters {
        let method = &args.method;
        ensure!(
            dials.iter().any(|dial| dial.name == *name),
            "`{method}` has no parameter `{name}`{}; there are: {known}",
            did_you_mean(name, known.split(", "))
        );
    }
    let is_chosen = |dial: &Dial| match args.parameters.is_empty() {
        true => !matches!(dial.values, Values::Whole(_)),
        false => args.parameters.contains(&dial.name),
    };
    let chosen: Vec<Dial> = dials.into_iter().filter(is_chosen).collect();
    ensure!(
        !chosen.is_empty(),
        "`{}` has only whole numbers, which are tuned where --parameters names them: {known}",
        args.method
    );
    Ok(chosen)
}

/// The method with some changes.
fn opened(gpu: &Gpu, effect: Effect, args: &Args, changes: &Changes) -> Result<Box<dyn Method>> {
    let tuning = Tuning { quality: args.quality, changes: changes.clone() };
    let opened = methods::open(
        effect,
        &[&args.method],
        Setup { gpu, runs: Runs::Fastest, model: None, tuning: &tuning },
    )?;
    opened.into_iter().next().with_context(|| format!("`{}` is what others are tuned to", args.method))
}

/// Coordinate descent: the changes whose images are most similar to truth, given how similar those of each
/// view are with some changes. Values with which the method fails are said and passed over.
///
/// # Errors
/// If the method fails as it is.
fn tuned(dials: &[Dial], similarities: impl Fn(&Changes) -> Result<Vec<f64>>) -> Result<Changes> {
    let mut best = Changes::default();
    let mut best_similarities = similarities(&best)?;
    let bar = progress::bar("parameters", ROUNDS.len() * dials.len(), 0);
    for factors in ROUNDS {
        for dial in dials {
            for value in others(dial, value_in(dial, &best), factors) {
                let tried = changed(&best, dial, value);
                bar.set_message(format!("now {} {value}", dial.name));
                bar.tick();
                match similarities(&tried) {
                    Ok(found) if is_better(&found, &best_similarities) => {
                        (best, best_similarities) = (tried, found)
                    }
                    Ok(_) => (),
                    Err(error) => bar.suspend(|| note!("{}: {error:#}", as_set(&tried))),
                }
            }
            bar.inc(1);
        }
    }
    bar.finish_and_clear();
    Ok(best)
}

/// Whether values are greater than others of the same views by more than the standard error of the mean
/// difference.
fn is_better(values: &[f64], others: &[f64]) -> bool {
    let gains: Vec<f64> = values.iter().zip(others).map(|(value, other)| value - other).collect();
    let count = gains.len() as f64;
    let mean = gains.iter().sum::<f64>() / count;
    let variance = gains.iter().map(|gain| (gain - mean).powi(2)).sum::<f64>() / (count - 1.0);
    mean > (variance / count).sqrt()
}

/// Changes with one more, or with one less where it is back to what the quality has.
fn changed(changes: &Changes, dial: &Dial, value: f64) -> Changes {
    let mut changes = changes.clone();
    match value == dial.usual {
        true => changes.0.remove(&dial.name),
        false => changes.0.insert(dial.name.clone(), dial.setting(value)),
    };
    changes
}

/// What a parameter is with some changes.
fn value_in(dial: &Dial, changes: &Changes) -> f64 {
    let changed = changes.0.get(&dial.name).and_then(|setting| dial.number(setting).ok());
    changed.unwrap_or(dial.usual)
}

/// Values that are tried in place of one, each of which the parameter takes: the value times factors, the
/// least, which is often to do without it, and what the quality has.
fn others(dial: &Dial, value: f64, factors: [f64; 6]) -> Vec<f64> {
    let [least, most] = dial.range;
    let scaled = || match value == 0.0 {
        true => SHARES.map(|share| share * most).to_vec(),
        false => factors.map(|factor| factor * value).to_vec(),
    };
    let mut values = match dial.values {
        // With few digits, so that what is found can be written down.
        Values::Real => scaled().into_iter().map(three_digits).collect(),
        Values::Whole(of) => {
            scaled().into_iter().map(|value| (value / f64::from(of)).round() * f64::from(of)).collect()
        }
        Values::Switch | Values::Named(_) => (0..=most as u32).map(f64::from).collect::<Vec<_>>(),
    };
    values.extend([least, dial.usual]);
    values.iter_mut().for_each(|value| *value = value.clamp(least, most));
    values.retain(|other| *other != value);
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

/// The number with three digits that count that is nearest.
fn three_digits(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

/// Changes as `eval --set` takes them.
fn as_set(changes: &Changes) -> String {
    let all: Vec<String> = changes.0.iter().map(|(name, value)| format!("{name}={value}")).collect();
    all.join(",")
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_render::methods::dials::DialValue;

    fn dial(name: &str, values: Values, range: [f64; 2], usual: f64) -> Dial {
        Dial { name: name.to_owned(), text: String::new(), unit: String::new(), range, values, usual }
    }

    #[test]
    fn other_values_are_ones_that_the_parameter_takes() {
        let names = Values::Named(["one", "two", "three"].map(str::to_owned).to_vec());
        let dials = [
            dial("real", Values::Real, [0.0, 3.0], 0.3),
            dial("zero", Values::Real, [0.0, 8.0], 0.0),
            dial("count", Values::Whole(4), [4.0, 16.0], 8.0),
            dial("switch", Values::Switch, [0.0, 1.0], 1.0),
            dial("name", names, [0.0, 2.0], 1.0),
        ];
        let tried = dials.each_ref().map(|dial| others(dial, dial.usual, ROUNDS[0]));
        assert_eq!(tried[0], [0.0, 0.075, 0.15, 0.21, 0.42, 0.6, 1.2]);
        assert_eq!(tried[1], [0.16, 0.4, 0.8, 2.0]);
        assert_eq!(tried[2], [4.0, 12.0, 16.0]);
        assert_eq!((&tried[3][..], &tried[4][..]), (&[0.0][..], &[0.0, 2.0][..]));
        assert_eq!(
            others(&dials[0], 0.6, ROUNDS[1])[..4],
            [0.0, 0.3, 0.42, 0.48],
            "and what it was at first"
        );
        for (dial, values) in dials.iter().zip(tried) {
            for value in values {
                assert_eq!(
                    dial.number(&dial.setting(value)).expect("one that it takes"),
                    value,
                    "{}",
                    dial.name
                );
            }
        }
    }

    #[test]
    fn descent_finds_what_is_best_and_leaves_what_does_not_matter() {
        let dials = [
            dial("width", Values::Real, [0.0, 10.0], 1.0),
            dial("idle", Values::Real, [0.0, 10.0], 1.0),
            dial("soft", Values::Switch, [0.0, 1.0], 0.0),
        ];
        let similarities = |changes: &Changes| {
            let [width, idle, soft] = dials.each_ref().map(|dial| value_in(dial, changes));
            ensure!(idle > 0.0, "it fails so");
            let ssim = 1.0 - 0.1 * (width - 2.8).abs() - if soft == 1.0 { 0.0 } else { 0.1 };
            Ok(vec![ssim, ssim - 0.2, ssim + 0.1])
        };
        let best = tuned(&dials, similarities).expect("tunes");
        let expected =
            [("soft", 1.0), ("width", 2.8)].map(|(name, to)| (name.to_owned(), DialValue::from(to)));
        assert_eq!((best.0.clone(), as_set(&best).as_str()), (expected.into(), "soft=1,width=2.8"));
        let level = |_: &Changes| Ok(vec![0.5, 0.6]);
        assert!(tuned(&dials, level).expect("tunes").is_empty(), "what is no better is left");
        assert!(changed(&best, &dials[2], 0.0).0.keys().eq(["width"]), "back to what it was");
    }

    #[test]
    fn what_may_be_chance_is_no_gain() {
        let before = [0.5, 0.6, 0.7];
        assert!(is_better(&[0.51, 0.61, 0.72], &before));
        assert!(!is_better(&[0.6, 0.58, 0.69], &before), "one view decides");
        assert!(!is_better(&before, &before) && !is_better(&[0.4, 0.5, 0.6], &before));
    }
}
