//! `deepshade eval`: an effect's methods, learned and analytic, on a test set, with confidence intervals over
//! scenes.

mod curve;
pub mod names;
mod networks;
mod outcome;
mod page;
mod paired;
mod paper;
mod results;
pub mod rivals;
mod score;
mod sequence;
mod sets;
mod tables;

use crate::complete::sky;
use crate::figures::Figures;
use crate::learned;
use crate::location::Location;
use crate::methods::{self, LEARNED, Runs, TRUTH};
use anyhow::{Result, bail, ensure};
use curve::Curves;
use deepshade_infer::Model;
use deepshade_render::method::Repeats;
use deepshade_render::methods::Quality;
use deepshade_render::methods::dials::{Changes, Tuning};
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{Effect, lists};
use outcome::{EvaluationOutcome, Scored};
use results::Entry;
use rivals::{Rival, rivals};
use score::evaluate;
use serde_json::json;
use sets::NamedSet;
use std::path::{Path, PathBuf};

/// Evaluates an effect's methods, learned and analytic, on a test set, or all networks beside the paper's
/// figures.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  deepshade eval --model models/ao --json eval.json\n  \
    deepshade eval --effect gi --methods all --testset testsets/gi --json gi.json\n  \
    deepshade eval --effect ao --methods all --quality low,medium,high,ultra --curve ao.svg\n  \
    deepshade eval --effect gi --methods lpv --set cells=32,iterations=8 --set cells=64,iterations=16 --testset testsets/gi\n  \
    deepshade eval --all --testsets testsets --methods learned,gtao,ssgi,fxaa --json all.json --markdown all.md --page report\n  \
    deepshade eval --model models/gi --testset testsets/gi --results models/results.json\n  \
    deepshade eval --model models/ao --methods learned,gtao --sequence 4 --frames 8\n\nTest sets are made by \
    `deepshade dataset testset`; that of a model that is shipped lies in its folder, \
    or several, `testset-NAME`.\n\n\
    Figures in the JSON file: METRIC_METHOD (ssim_learned, ssim_gtao, ssim_gtao_low, ...), of one of several \
    test sets METRIC_METHOD_NAME; where NAME is also a quality's, as in testset-medium, what has qualities \
    has its own before that: ssim_gtao_high_medium. With --sequence ssim_METHOD, flicker_METHOD, \
    ghosts_METHOD, of images that are mixed with frames before METHOD_mixed, and truth's own change \
    flicker_truth. paired_METRIC is how far the network is above the best, \
    by SSIM, of the methods that take no longer on the same device, or above the fastest where all take \
    longer, frame by frame (where no method ran on that device, above the best of all); paired_METRIC_low \
    and _high are the ends of its 95 % interval; details.paired_against says which \
    method that is. scenes_below_trivial counts the scenes in which the network is worse than the image of \
    whoever does nothing.")]
pub struct Args {
    /// What is computed; by default what the network computes.
    #[arg(long)]
    effect: Option<Effect>,
    /// Which methods: names, or all, which `screen-truth` is none of. `learned` is one where there is a
    /// network. With --all, each network is held against those of them that its effect has.
    #[arg(long, value_delimiter = ',', default_value = "all")]
    methods: Vec<String>,
    /// How much time analytic methods may take for a better image: one or several of low, medium, high,
    /// ultra; of several high is always one. By default all where a network is evaluated, so that its rivals
    /// are at their best, else high.
    #[arg(long, value_delimiter = ',')]
    quality: Vec<Quality>,
    /// What of the methods is set otherwise than their quality has it, NAME=VALUE,NAME=VALUE;
    /// `deepshade methods` lists what can be. Several times for several ways, each of which is evaluated.
    #[arg(long, value_parser = changes)]
    set: Vec<Changes>,
    /// Folder, address or name of the network; by default models/EFFECT, else the program's own of that name,
    /// and without --effect that of ao.
    #[arg(long, value_parser = crate::learned::place)]
    model: Option<Location>,
    /// Folder or address of the test set; by default all in the model's folder, `testset` and `testset-NAME`,
    /// or in models/EFFECT where no model is named, each by itself and, but for `testset-artists`, together.
    /// A model without one has those of the model beside it that bears the name of the effect.
    #[arg(long)]
    testset: Option<Location>,
    /// All networks of the folder `models` that have a test set, beside the figures of the paper's Table 7.1.
    /// All frames, methods and qualities take hours: --frames 8 --quality high gives a first look, --methods
    /// names those that count.
    #[arg(long, conflicts_with_all = ["effect", "set", "model", "testset", "curve"])]
    all: bool,
    /// Folder with a test set for each network, under its name; by default the one in the network's folder.
    #[arg(long, requires = "all")]
    testsets: Option<PathBuf>,
    /// Folder that the recipe's scene files are relative to, where it is not the one that the test set
    /// remembers. Of several test sets those whose files are not there are passed over.
    #[arg(long)]
    scenes: Option<PathBuf>,
    /// Only so many frames, spread over all of them. FLIP and pictures are of those whose truth is whole,
    /// maybe none of these.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    frames: Option<u32>,
    /// Measures how steady methods are, in place of their error: from each of the --frames, by default 12,
    /// the camera goes aside and things move in a sequence of so many frames. The change of what is seen of
    /// surfaces is held against truth's own, and errors behind what moves are counted. Truth of all of them
    /// is rendered, which takes seconds a frame.
    #[arg(long, value_parser = clap::value_parser!(u32).range(2..=64))]
    #[arg(conflicts_with_all = ["curve", "results", "markdown", "page"])]
    sequence: Option<u32>,
    /// With --sequence also measures each method mixed with the frames before, as `render --temporal` does.
    #[arg(long, requires = "sequence")]
    temporal: bool,
    /// Draws error against time, a line a method through its qualities, into this SVG file: relative mean
    /// squared error, and 1 - SSIM.
    #[arg(long, value_parser = crate::arguments::svg_file)]
    curve: Option<PathBuf>,
    /// Writes the table of networks as Markdown.
    #[arg(long, requires = "all")]
    markdown: Option<PathBuf>,
    /// Writes a page into this folder: the table of networks, error against time of each effect, networks
    /// less their rivals, and their best, median and worst frame in pictures.
    #[arg(long, requires = "all")]
    page: Option<PathBuf>,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
    /// Puts the network's figures, under its folder's name, into this JSON file in place of its older ones,
    /// those of methods that are not asked for too; those of other networks stay.
    #[arg(long, value_parser = crate::arguments::written_file, conflicts_with = "frames")]
    results: Option<PathBuf>,
}

/// What is set by hand, as the command line says it.
fn changes(text: &str) -> Result<Changes, String> {
    let mut changes = Changes::default();
    for part in text.split(',') {
        let (name, value) = part.split_once('=').ok_or_else(|| format!("`{part}` is not NAME=VALUE"))?;
        let name = name.trim();
        if changes.0.insert(name.to_owned(), value.trim().into()).is_some() {
            return Err(format!("`{name}` is set twice"));
        }
    }
    Ok(changes)
}

/// The qualities of analytic methods: those that are asked for, else all where a network is held against
/// them, so that they are at their best. Of several the default one is always among them: figures have it
/// under plain names.
fn qualities(asked: &[Quality], network: bool) -> Vec<Quality> {
    let mut qualities = match asked {
        [] if network => Quality::ALL.to_vec(),
        [] => vec![Quality::default()],
        asked => asked.to_vec(),
    };
    qualities.sort_unstable();
    qualities.dedup();
    if qualities.len() > 1 && !qualities.contains(&Quality::default()) {
        qualities.push(Quality::default());
    }
    qualities
}

/// Each quality with each of what is set, or as it is: all once, however often they are asked for.
fn tunings(qualities: &[Quality], set: &[Changes]) -> Vec<Tuning> {
    let mut qualities = qualities.to_vec();
    qualities.sort_unstable();
    qualities.dedup();
    let usual = [Changes::default()];
    let ways = if set.is_empty() { &usual[..] } else { set };
    let mut tunings: Vec<Tuning> = Vec::new();
    for quality in qualities {
        for changes in ways {
            let tuning = Tuning { quality, changes: changes.clone() };
            if !tunings.contains(&tuning) {
                tunings.push(tuning);
            }
        }
    }
    tunings
}

/// Who is evaluated, and on what.
struct EvaluationInputs {
    effect: Effect,
    /// The network, if there is one, under the name that figures have for it.
    network: Option<(String, Model)>,
    /// At least one.
    sets: Vec<NamedSet>,
}

/// Evaluates, prints the tables.
///
/// # Errors
/// If the model or the test set cannot be read, or a method fails.
pub fn run(args: &Args) -> Result<()> {
    args.results.as_deref().map_or(Ok(()), |path| results::check(path, args.json.as_deref()))?;
    if args.all {
        return match args.sequence {
            Some(frames) => sequence::run_all(args, frames as usize, &Gpu::new()?),
            None => networks::run(args),
        };
    }
    // The parser lets them pass beside what `--all` excludes.
    let of_all = [
        ("--testsets", args.testsets.is_some()),
        ("--markdown", args.markdown.is_some()),
        ("--page", args.page.is_some()),
    ];
    if let Some((option, _)) = of_all.into_iter().find(|(_, given)| *given) {
        bail!("{option} means nothing without --all");
    }
    let gpu = Gpu::new()?;
    let inputs = inputs(args)?;
    if args.results.is_some() {
        let is_among = is_learned_among(&args.methods);
        ensure!(inputs.network.is_some() && is_among, "--results is of networks, and there is none");
    }
    if let Some(frames) = args.sequence {
        return sequence::run(args, &inputs, frames as usize, &gpu);
    }
    let outcome = evaluate_methods(&inputs, &args.methods, args, &gpu)?;
    let (effect, evaluation) = (inputs.effect, &outcome.evaluation);
    let mut figures = Figures::new("eval");
    outcome.set_figures(&mut figures, effect);
    if let Some((network, _)) = &inputs.network {
        names::set_figures(&mut figures, network, evaluation);
        figures.detail("network", json!(network));
    }
    figures.detail("effect", json!(effect.name()));
    figures.detail("target", json!(target(&inputs.sets)));
    figures.detail("adapter", json!(gpu.info.name));
    figures.write(args.json.as_deref())?;
    if let (Some(path), Some((network, _))) = (&args.results, &inputs.network) {
        let entry = Entry { network: network.clone(), evaluation, target: target(&inputs.sets) };
        results::add(path, &entry, &gpu)?;
    }
    if let Some(path) = &args.curve {
        let network = inputs.network.as_ref().map_or(LEARNED, |(network, _)| network);
        curve::write(path, effect, Curves { network, rivals: &outcome.rivals, evaluation })?;
    }
    tables::print(effect, &outcome)
}

/// What methods are scored against, in the first set.
fn target(sets: &[NamedSet]) -> &str {
    sets.first().and_then(|set| set.set.recipe().target.as_deref()).unwrap_or(TRUTH)
}

/// Runs methods by name on the frames that the command line asks for.
fn evaluate_methods(
    inputs: &EvaluationInputs,
    names: &[String],
    args: &Args,
    gpu: &Gpu,
) -> Result<EvaluationOutcome> {
    let rivals = opened(inputs, names, args, gpu)?;
    let mut scored = Vec::new();
    for named in &inputs.sets {
        let (set, title) = (&named.set, named.title().to_owned());
        let chosen = spread(set.frames().len(), args.frames.map_or(usize::MAX, |frames| frames as usize));
        ensure!(!chosen.is_empty(), "the test set has no frame");
        if let Some(target) = &set.recipe().target {
            note!("what methods are scored against is not truth but the images of `{target}`");
        }
        let mut evaluation = evaluate(set, &chosen, inputs.effect, &rivals, repeats(gpu))?;
        evaluation.all_on_processor = gpu.is_software();
        scored.push(Scored { name: named.name.clone(), title, evaluation });
    }
    Ok(EvaluationOutcome::new(rivals, scored))
}

/// The methods of these names as all sets want them. A set under another sky than the network's is noted.
fn opened(inputs: &EvaluationInputs, names: &[String], args: &Args, gpu: &Gpu) -> Result<Vec<Rival>> {
    let EvaluationInputs { effect, network, sets } = inputs;
    let model = network.as_ref().map(|(_, model)| model);
    let is_learned = model.is_some() && is_learned_among(names);
    let tunings = tunings(&qualities(&args.quality, is_learned), &args.set);
    let mut rivals = rivals(*effect, names, &tunings, (gpu, Runs::Fastest), model)?;
    let fog = |set: &NamedSet| set.set.recipe().vary.as_ref().and_then(|vary| vary.fog);
    if sets.iter().filter_map(fog).any(|fog| fog.smoke_share > 0.0) {
        let by_name = !names.iter().any(|name| name == "all");
        rivals = methods::through_grids(rivals, by_name, |rival| rival.method.as_ref())?;
    }
    let environment = model.and_then(|model| model.spec.environment.as_ref());
    if let Some(known) = environment.filter(|_| is_learned) {
        for named in sets.iter().filter(|named| sky::of_recipe(named.set.recipe()).as_ref() != Some(known)) {
            note!("test set {}: {}", named.title(), sky::said_of_another(known));
        }
    }
    Ok(rivals)
}

/// How often methods run on a frame, of which the median time counts: the mean over the frames is what tables
/// have, and on a software adapter a run takes seconds.
fn repeats(gpu: &Gpu) -> Repeats {
    Repeats { warm_up: 1, timed: if gpu.is_software() { 1 } else { 3 } }
}

/// Whether names of methods ask for the network.
fn is_learned_among(names: &[String]) -> bool {
    names.iter().any(|name| name == "all" || name == LEARNED)
}

/// Numbers of frames, ascending, that lie evenly among all and end with the last, as those do whose truth is
/// whole.
fn spread(count: usize, wanted: usize) -> Vec<usize> {
    let from_the_end = lists::spread(count, wanted);
    from_the_end.into_iter().rev().map(|index| count - 1 - index).collect()
}

/// What the command line names.
fn inputs(args: &Args) -> Result<EvaluationInputs> {
    let usual = || Location::Folder(learned::usual_folder(args.effect.unwrap_or(Effect::Ao)));
    let location = args.model.clone().unwrap_or_else(usual);
    let folder = location.read()?;
    // A network that is asked for must be there.
    let optional = args.model.is_none() && args.effect.is_some() && !learned::is_network(&folder);
    let model = (!optional).then(|| learned::network(&folder, args.effect)).transpose()?;
    let effect = args.effect.or(model.as_ref().map(|model| model.spec.effect)).unwrap_or(Effect::Ao);
    let folders = match (&args.testset, &args.model) {
        (Some(testset), _) => vec![testset.read()?],
        (None, Some(_)) => sets::folders(&folder, effect),
        // Networks may be part of the program, test sets are not.
        (None, None) => sets::folders(&Path::new(networks::MODELS).join(effect.name()), effect),
    };
    let sets = sets::open(&folders, effect, args.scenes.as_deref())?;
    let name = names::figure_name(Path::new(&location.to_string()));
    Ok(EvaluationInputs { effect, network: model.map(|model| (name, model)), sets })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_frames_have_those_whose_truth_is_whole_among_them() {
        assert_eq!(spread(200, 8), [24, 49, 74, 99, 124, 149, 174, 199]);
        assert!(spread(200, 8).iter().all(|frame| spread(200, 40).contains(frame)));
        assert_eq!((spread(3, usize::MAX), spread(3, 1)), (vec![0, 1, 2], vec![2]));
    }

    #[test]
    fn what_is_set_is_read_and_each_way_is_taken_once() {
        let [few, same, many] =
            ["cells=32, scheme.lobes=two-bands", "scheme.lobes=two-bands,cells=32.0", "cells=64"]
                .map(|text| changes(text).expect(text));
        assert_eq!(few.to_string(), "cells 32, scheme.lobes two-bands");
        assert_eq!(changes("jitter=false"), changes("jitter=0"));
        let refused = |text: &str| changes(text).expect_err(text);
        assert_eq!(refused("cells=32,cells=64"), "`cells` is set twice");
        assert_eq!(refused("cells"), "`cells` is not NAME=VALUE");
        let all = tunings(&[Quality::High, Quality::Low, Quality::High], &[few.clone(), same, many.clone()]);
        let tuned = |quality, changes: &Changes| Tuning { quality, changes: changes.clone() };
        let [low, high] = [Quality::Low, Quality::High];
        assert_eq!(all, [tuned(low, &few), tuned(low, &many), tuned(high, &few), tuned(high, &many)]);
        assert_eq!(tunings(&[high], &[]), [Tuning::from(high)]);
    }

    #[test]
    fn a_network_s_rivals_are_at_their_best_and_at_the_default_quality() {
        use Quality::{High, Low, Medium, Ultra};
        assert_eq!(qualities(&[], true), [Low, Medium, High, Ultra]);
        assert_eq!(qualities(&[], false), [High]);
        assert_eq!(qualities(&[Low], true), [Low], "what is asked for");
        assert_eq!(qualities(&[Ultra, Low], false), [Low, Ultra, High], "for the plain names");
        assert_eq!(qualities(&[High, Low, High], true), [Low, High]);
    }
}
