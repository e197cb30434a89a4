//! `deepshade eval --sequence`: how steady methods are beside truth while the camera and things move.

mod moment;
mod steadiness;

use super::names::of_network;
use super::rivals::Rival;
use super::sets::NamedSet;
use super::tables::tuned;
use super::{Args, EvaluationInputs, networks, opened, spread};
use crate::figures::Figures;
use crate::methods::{LEARNED, TRUTH};
use crate::statistics::{MeanInterval, estimate, paired};
use crate::table;
use anyhow::{Context, Result, ensure};
use deepshade_dataset::{SceneRecord, StagedScene, progress};
use deepshade_shaders::gpu::Gpu;
use moment::{Measured, STEP, Sequence, THINGS};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use steadiness::Steadiness;

/// Sequences of a test set where nobody says how many.
const SEQUENCES: usize = 12;

/// A figure of all sequences, by its name; each with the number of its scene.
type Table = BTreeMap<String, Vec<(usize, f64)>>;

/// What is measured of each method: the figure's name, and the head of its column.
const COLUMNS: [[&str; 2]; 3] = [["ssim", "SSIM"], ["flicker", "flicker"], ["ghosts", "ghosts"]];

/// A method whose images are measured: as they are, or mixed with those of the frames before.
struct MeasuredMethod<'a> {
    rival: &'a Rival,
    mixed: bool,
}

/// What was measured of an effect's methods.
struct Outcome {
    values: Table,
    /// The scenes' names.
    scenes: Vec<String>,
}

/// Evaluates methods on sequences of so many frames, prints the table.
///
/// # Errors
/// If a scene or a frame cannot be read, or a method fails.
pub(super) fn run(args: &Args, inputs: &EvaluationInputs, frames: usize, gpu: &Gpu) -> Result<()> {
    let outcome = evaluated(args, inputs, &args.methods, frames, gpu)?;
    let mut figures = Figures::new("eval");
    let mut intervals = Map::new();
    for (name, values) in &outcome.values {
        let MeanInterval { mean, low, high } = estimate(values);
        figures.set(name, mean);
        intervals.insert(name.clone(), json!([low, high]));
    }
    figures.detail("confidence_95", Value::Object(intervals));
    figures.detail("effect", json!(inputs.effect.name()));
    figures.detail("frames_of_a_sequence", json!(frames));
    figures.detail("scenes", json!(outcome.scenes));
    figures.detail("adapter", json!(gpu.info.name));
    figures.write(args.json.as_deref())
}

/// The same of every network that has a test set; the figures are `flicker_<network>`,
/// `flicker_<network>_<rival>`, ...
///
/// # Errors
/// As [`run`], and if there is no network.
pub(super) fn run_all(args: &Args, frames: usize, gpu: &Gpu) -> Result<()> {
    let mut figures = Figures::new("eval");
    for tested in networks::networks(args)? {
        let (name, inputs) = tested.inputs(args)?;
        note!("{name}");
        let methods = networks::methods_for(inputs.effect, &args.methods);
        let outcome = evaluated(args, &inputs, &methods, frames, gpu)?;
        for (figure, values) in &outcome.values {
            figures.set(&of_network(&name.replace('-', "_"), figure), estimate(values).mean);
        }
    }
    figures.detail("frames_of_a_sequence", json!(frames));
    figures.detail("adapter", json!(gpu.info.name));
    figures.write(args.json.as_deref())
}

/// Measures methods on sequences, prints the table.
fn evaluated(
    args: &Args,
    inputs: &EvaluationInputs,
    names: &[String],
    frames: usize,
    gpu: &Gpu,
) -> Result<Outcome> {
    let with_target = inputs.sets.iter().find(|named| named.set.recipe().target.is_some());
    ensure!(with_target.is_none(), "--sequence is measured beside truth, and a test set's target is another");
    let has_timeline =
        |named: &NamedSet| named.set.recipe().vary.as_ref().is_some_and(|vary| vary.timeline.is_some());
    ensure!(
        !inputs.sets.iter().any(has_timeline),
        "--sequence moves things by itself, not as a timeline does"
    );
    let rivals = opened(inputs, names, args, gpu)?;
    let of = Measured { effect: inputs.effect, rivals: &rivals, temporal: args.temporal };
    let outcome = measured(args, inputs, frames, of)?;
    let ghosts = outcome.values.iter().find(|(name, _)| name.starts_with("ghosts_"));
    let with_ghosts = ghosts.map_or(0, |(_, values)| values.len());
    say!(
        "{}: {} sequences of {frames} frames in {} scenes, ghosts of {with_ghosts} of them. Surfaces at the \
         median depth move by {:.1} pixels a frame, three of four things by {} to {} more or as they do while the shutter is open.\nFlicker: \
         root mean square of the change of surfaces that truth does not have; ghosts: of the error beside \
         what moved there one frame ago; both in thousandths of white, 0 is calm. SSIM is to truth of few \
         samples, whose noise lowers it",
        inputs.effect,
        outcome.values[&format!("flicker_{TRUTH}")].len(),
        outcome.scenes.len(),
        STEP[0].hypot(STEP[1]),
        THINGS[0],
        THINGS[1],
    )?;
    say!("{}", printed(&methods(of), &outcome.values))?;
    Ok(outcome)
}

/// Those that are measured, in the order of [`Sequence::steadiness`].
fn methods(of: Measured<'_>) -> Vec<MeasuredMethod<'_>> {
    let all = |mixed| of.rivals.iter().map(move |rival| MeasuredMethod { rival, mixed });
    all(false).chain(all(true).filter(|_| of.temporal)).collect()
}

impl MeasuredMethod<'_> {
    /// Its name in figures.
    fn name(&self) -> String {
        if self.mixed { format!("{}_mixed", self.rival.name) } else { self.rival.name.clone() }
    }
}

/// The figures of all sequences in which a surface stays in sight, and the scenes' names.
fn measured(args: &Args, inputs: &EvaluationInputs, frames: usize, of: Measured<'_>) -> Result<Outcome> {
    let (mut values, mut scenes): (Table, Vec<String>) = Default::default();
    let wanted = args.frames.map_or(SEQUENCES, |frames| frames as usize);
    for set in inputs.sets.iter().map(|named| &named.set) {
        let chosen = spread(set.frames().len(), wanted);
        let props = set.props().context("--scenes says where files are")?;
        let bar = progress::bar("sequences", chosen.len(), 0);
        let mut current: Option<(&SceneRecord, StagedScene<'_>)> = None;
        for index in chosen {
            let record = &set.frames()[index];
            let of_frame =
                || format!("sequence from frame {}; --scenes says where scene files are", record.name);
            let (_, staged) = match current.take() {
                Some(known) if *known.0 == record.scene => current.insert(known),
                _ => {
                    let staged =
                        StagedScene::load(&record.scene, set.recipe(), &props).with_context(of_frame)?;
                    current.insert((&record.scene, staged))
                }
            };
            let scene = &staged.shown(&record.camera, record.variation.as_ref())?;
            bar.inc(1);
            let Some(sequence) = Sequence::new(of, record, staged, scene) else { continue };
            let Some((steady, own)) = sequence.steadiness(frames).with_context(of_frame)? else { continue };
            let name = record.scene.source.to_string();
            let number = scenes.iter().position(|known| *known == name).unwrap_or_else(|| {
                scenes.push(name);
                scenes.len() - 1
            });
            let mut put = |name: String, value| values.entry(name).or_default().push((number, value));
            put(format!("flicker_{TRUTH}"), own);
            for (method, Steadiness { ssim, flicker, ghosts }) in methods(of).iter().zip(steady) {
                let name = method.name();
                put(format!("ssim_{name}"), ssim);
                put(format!("flicker_{name}"), flicker);
                if let Some(ghosts) = ghosts {
                    put(format!("ghosts_{name}"), ghosts);
                }
            }
        }
        bar.finish_and_clear();
    }
    ensure!(!values.is_empty(), "no surface stays in sight in any sequence of the test set");
    Ok(Outcome { values, scenes })
}

/// A row a method, then truth's own change.
fn printed(methods: &[MeasuredMethod<'_>], values: &Table) -> String {
    let text = |interval: MeanInterval, figure: &str, sign: bool| {
        let (scale, digits) = if figure == "ssim" { (1.0, 4) } else { (1e3, 2) };
        let MeanInterval { mean, low, high } = interval;
        let [mean, low, high] = [mean, low, high].map(|value| scale * value);
        match sign {
            true => format!("{mean:+.digits$} [{low:+.digits$}, {high:+.digits$}]"),
            false => format!("{mean:.digits$} [{low:.digits$}, {high:.digits$}]"),
        }
    };
    let of = |figure: &str, method: &str| values.get(&format!("{figure}_{method}"));
    let own = of("flicker", LEARNED);
    let row = |method: &MeasuredMethod<'_>| {
        let name = method.name();
        let kind = if method.mixed { ", mixed with frames before" } else { "" };
        let mut row = vec![format!("{}{kind}", method.rival.method_name), tuned(method.rival)];
        for [figure, _] in COLUMNS {
            row.push(of(figure, &name).map_or_else(String::new, |of| text(estimate(of), figure, false)));
        }
        let less = own.filter(|_| name != LEARNED).zip(of("flicker", &name));
        let less = less.and_then(|(own, of)| paired(own, of));
        let less = less.map_or_else(String::new, |difference| text(difference, "flicker", true));
        row.extend(own.is_some().then_some(less));
        row
    };
    let columns = COLUMNS.map(|[_, head]| head);
    let mut head =
        [&["method", "quality"][..], &columns].concat().into_iter().map(str::to_owned).collect::<Vec<_>>();
    head.extend(own.map(|_| format!("flicker of `{LEARNED}` less it")));
    let truth = [TRUTH, "its own change", ""].map(str::to_owned).into_iter();
    let change = text(estimate(&values[&format!("flicker_{TRUTH}")]), "flicker", false);
    let rest = 1 + usize::from(own.is_some());
    let truth: Vec<String> = truth.chain([change]).chain(vec![String::new(); rest]).collect();
    let rows: Vec<_> = [head].into_iter().chain(methods.iter().map(row)).chain([truth]).collect();
    table::aligned(&rows)
}
