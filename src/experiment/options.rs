//! What the field learned since the thesis, each as an option of the same network on the same data: first weights that pass
//! the light on, a last layer that predicts kernels, a stem that works at half the resolution, masked convolutions.

use super::exam::SIMILARITY;
use super::lab::{Lab, scores};
use super::table::{Row, Table};
use crate::plot::{Line, Plot};
use anyhow::{Context, Result, ensure};
use deepshade_dataset::vary::Textures;
use deepshade_dataset::{Dataset, Vary};
use deepshade_infer::{Colour, Cost, Filter, NetSpec};
use deepshade_shaders::{Effect, GBuffer, Planes};
use deepshade_train::TrainConfig;
use deepshade_train::options::{Kind, Variant};
use std::sync::Arc;
use std::time::Instant;

/// Networks of other shapes than a spec can say.
const KINDS: [(Kind, &str, &str); 2] = [
    (Kind::SpaceToDepth, "space-to-depth", "the paper's at half the resolution, space to depth"),
    (Kind::Masked, "masked", "the paper's, masked convolutions"),
];

/// A network to be compared.
struct Choice {
    /// What its run and its figure are called.
    name: String,
    label: String,
    settings: TrainConfig,
}

/// Trains a network with each option.
///
/// # Errors
/// If data, training or testing fail.
pub fn run(lab: &Lab, effect: Effect) -> Result<Table> {
    let name = format!("options-{effect}");
    let [recipe, test_recipe] = lab.recipes_of(effect, vary(effect)?);
    let exam = lab.exam(&name, &test_recipe)?;
    let settings = lab.settings(&lab.data(&name, &recipe)?)?;
    let (mut rows, mut lines) = (Vec::new(), Vec::new());
    for Choice { name: option, label, settings } in choices(lab, &settings)? {
        let network = lab.network(&format!("{name}-{option}"), &settings)?;
        let (scores, cost) = (scores(&exam, &network)?, multiply_adds(&settings.spec));
        lines.push(Line::dotted(&label, vec![(cost, scores.dssim())]));
        let values = [&scores.similarity()[..], &[scores.l1, scores.flip, cost, network.seconds]].concat();
        rows.push(Row::new(format!("ssim_{}", option.replace('-', "_")), label, &values));
    }
    for (kind, option, label) in KINDS {
        note!("network `{name}-{option}`: {} steps", settings.steps);
        let start = Instant::now();
        let source = Arc::new(Dataset::open(&settings.dataset)?);
        let network = Variant::train(kind, &settings, source)?;
        let seconds = start.elapsed().as_secs_f64();
        let scores = exam.scores(|gbuffer, radius| image(&network, &settings.spec, gbuffer, radius))?;
        let cost = kind.multiply_adds(&settings.spec) * settings.spec.runs() as f64;
        lines.push(Line::dotted(label, vec![(cost, scores.dssim())]));
        let values = [&scores.similarity()[..], &[scores.l1, scores.flip, cost, seconds]].concat();
        rows.push(Row::new(format!("ssim_{}", option.replace('-', "_")), label, &values));
    }
    let trivial = exam.trivial()?;
    let values = [&trivial.similarity()[..], &[trivial.l1, trivial.flip, 0.0]].concat();
    rows.push(Row::new("ssim_trivial", "nothing: the light as it is", &values));
    let more = [("L1", 4), ("FLIP", 4), ("multiply-adds a pixel", 0), ("training s", 1)];
    Ok(Table {
        title: "What was learned since, as options of a network that filters light",
        rows_are: "network",
        columns: [&SIMILARITY[..], &more].concat(),
        rows,
        plot: Plot {
            x: "multiply-adds a pixel of the image, all colours",
            is_logarithmic: true,
            y: "DSSIM on test scenes",
            lines,
            level: None,
        },
    })
}

/// What the effect's own recipes vary.
fn vary(effect: Effect) -> Result<Vary> {
    let filters = Effect::ALL.into_iter().filter(|effect| effect.filters_light());
    ensure!(
        effect.filters_light(),
        "`options` is for effects whose image is a filter of light: {}",
        filters.map(Effect::name).collect::<Vec<_>>().join(", ")
    );
    Ok(Vary {
        materials: true,
        textures: Some(Textures::Procedural(64)),
        light: true,
        lens: matches!(effect, Effect::Dof | Effect::Multi).then_some([1.0, 12.0]),
        motion: (effect == Effect::MotionBlur).then_some([1.0, 24.0]),
        mean_free_path: (effect == Effect::Sss).then_some([0.001, 0.02]),
        ..Vary::default()
    })
}

/// The paper's network and those that differ from it in one thing.
fn choices(lab: &Lab, paper: &TrainConfig) -> Result<Vec<Choice>> {
    let choice = |name: &str, label: &str, spec: NetSpec| Choice {
        name: name.to_owned(),
        label: label.to_owned(),
        settings: TrainConfig { spec, ..paper.clone() },
    };
    let spec = &paper.spec;
    let mut random = choice("random", "the paper's, random first weights", spec.clone());
    random.settings.start = Some(lab.random_start(paper)?);
    let mut choices = vec![random, choice("paper", "the paper's, begun as the identity", spec.clone())];
    let named = |Filter { levels, kernel, black }| {
        let and_black = if black { " and black" } else { "" };
        (
            format!("kernel{kernel}-of{levels}"),
            format!("kernels of {kernel}x{kernel} on {levels} level(s){and_black}"),
        )
    };
    for (kernel, levels) in [(1, spec.levels), (3, spec.levels), (5, 1)] {
        let filter = Filter { levels, kernel, black: false };
        let (name, label) = named(filter);
        if filter.tap_count() > 1 {
            choices.push(choice(&name, &label, NetSpec { filter: Some(filter), ..spec.clone() }));
        }
    }
    let predicting = spec.predicting_kernels().context("a network that filters light")?;
    let all_colours = NetSpec { colour: Colour::Rgb, ..predicting };
    let (name, label) = named(all_colours.filter.context("kernels")?);
    choices.push(choice(&format!("{name}-rgb"), &format!("{label}, all colours at once"), all_colours));
    Ok(choices)
}

/// What a network of another shape makes of a g-buffer.
fn image(network: &Variant, spec: &NetSpec, gbuffer: &GBuffer, radius: f32) -> Result<Planes> {
    let (scaling, seen) = (spec.scaling(gbuffer, radius)?, gbuffer.seen()?);
    let run = |run| Ok(network.image(&spec.input(gbuffer, scaling, run)?, &seen));
    let runs = (0..spec.runs()).map(run).collect::<Result<Vec<_>>>()?;
    let mut image = spec.image(&runs, scaling);
    spec.set_background(gbuffer, &mut image)?;
    Ok(image)
}

/// Multiply-adds a pixel of the effect's image, of all runs.
fn multiply_adds(spec: &NetSpec) -> f64 {
    const EDGE: usize = 256;
    let cost: Cost = spec.costs(EDGE, EDGE).into_iter().sum();
    (cost.multiply_adds * spec.runs() as u64) as f64 / (EDGE * EDGE) as f64
}
