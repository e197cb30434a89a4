//! `deepshade eval`: an effect's methods, learned and analytic, on a test set, with confidence intervals over scenes.

mod curve;
pub mod names;
mod networks;
mod page;
mod paper;
mod results;
pub mod rivals;
mod score;

use crate::figures::Figures;
use crate::learned;
use crate::methods::{self, LEARNED, TRUTH};
use crate::place::{Folder, Place};
use crate::statistics::Estimate;
use crate::table;
use anyhow::{Result, bail, ensure};
use deepshade_dataset::TestSet;
use deepshade_infer::Model;
use deepshade_render::methods::Quality;
use deepshade_render::methods::dials::{Changes, Tuning};
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{Effect, lists};
use results::Entry;
use rivals::{Rival, rivals, trivial_name};
use score::{Evaluation, evaluate};
use serde_json::json;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Evaluates an effect's methods, learned and analytic, on a test set, or all networks beside the paper's figures.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  deepshade eval --model models/ao --json eval.json\n  \
    deepshade eval --effect gi --methods all --testset testsets/gi --json gi.json\n  \
    deepshade eval --effect ao --methods all --quality low,medium,high,ultra --curve ao.svg\n  \
    deepshade eval --effect gi --methods lpv --set cells=32,iterations=8 --set cells=64,iterations=16 --testset testsets/gi\n  \
    deepshade eval --all --testsets testsets --methods learned,gtao,ssgi,fxaa --json all.json --markdown all.md --page report\n  \
    deepshade eval --model models/gi --testset testsets/gi --results models/results.json\n\nTest sets are made by \
    `deepshade dataset testset`; that of a model that is shipped lies in its folder.")]
pub struct Args {
    /// What is computed; by default what the network computes.
    #[arg(long)]
    effect: Option<Effect>,
    /// Which methods: names, or all, which `screen-truth` is none of. `learned` is one where there is a
    /// network. With --all, each network is held against those of them that its effect has.
    #[arg(long, value_delimiter = ',', default_value = "all")]
    methods: Vec<String>,
    /// How much time analytic methods may take for a better image: one or several of low, medium, high, ultra.
    #[arg(long, value_delimiter = ',', default_value = "high")]
    quality: Vec<Quality>,
    /// What of the methods is set otherwise than their quality has it, NAME=VALUE,NAME=VALUE; `deepshade methods` lists what can
    /// be. Several times for several ways, each of which is evaluated.
    #[arg(long, value_parser = changes)]
    set: Vec<Changes>,
    /// Folder or address of the network; by default models/EFFECT, and models/ao without --effect.
    #[arg(long)]
    model: Option<Place>,
    /// Folder or address of the test set; by default `testset` in the model's folder.
    #[arg(long)]
    testset: Option<Place>,
    /// All networks of the folder `models` that have a test set, beside the figures of the paper's Table 7.1.
    #[arg(long, conflicts_with_all = ["effect", "set", "model", "testset", "curve"])]
    all: bool,
    /// Folder with a test set for each network, under its name; by default the one in the network's folder.
    #[arg(long, requires = "all")]
    testsets: Option<PathBuf>,
    /// Folder that the recipe's scene files are relative to, where it is not the one that the test set remembers.
    #[arg(long)]
    scenes: Option<PathBuf>,
    /// Only so many frames, spread over all of them. FLIP and pictures are of those whose truth is whole, maybe none of these.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    frames: Option<u32>,
    /// Draws error against time, a line a method through its qualities, into this SVG file: relative mean squared error, and
    /// 1 - SSIM.
    #[arg(long, value_parser = crate::arguments::svg_file)]
    curve: Option<PathBuf>,
    /// Writes the table of networks as Markdown.
    #[arg(long, requires = "all")]
    markdown: Option<PathBuf>,
    /// Writes a page into this folder: the table of networks, and their best, median and worst frame in pictures.
    #[arg(long, requires = "all")]
    page: Option<PathBuf>,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
    /// Puts the network's figures, under its folder's name, into this JSON file in place of its older ones, those
    /// of methods that are not asked for too; those of other networks stay.
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
struct Contest {
    effect: Effect,
    /// The network, if there is one, under the name that figures have for it.
    network: Option<(String, Model)>,
    set: TestSet,
    /// Where frames are read from as they are wanted.
    _kept: Vec<Folder>,
}

/// What an evaluation has come to.
struct Judgement {
    rivals: Vec<Rival>,
    evaluation: Evaluation,
}

/// Evaluates, prints the table.
///
/// # Errors
/// If the model or the test set cannot be read, or a method fails.
pub fn run(args: &Args) -> Result<()> {
    args.results.as_deref().map_or(Ok(()), |path| results::check(path, args.json.as_deref()))?;
    if args.all {
        return networks::run(args);
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
    let contest = contest(args)?;
    if args.results.is_some() {
        let is_among = args.methods.iter().any(|name| name == "all" || name == LEARNED);
        ensure!(contest.network.is_some() && is_among, "--results is of networks, and there is none");
    }
    let Judgement { rivals, evaluation } = judge(&contest, &args.methods, args, &gpu)?;
    let (effect, estimates) = (contest.effect, evaluation.estimates());
    let mut figures = Figures::new("eval");
    for (name, estimate) in &estimates {
        figures.set(name, estimate.mean);
    }
    figures.set("frames", evaluation.frames as f64);
    figures.set("scenes", evaluation.scenes as f64);
    if let Some((network, _)) = &contest.network {
        names::set_figures(&mut figures, network, &evaluation);
        figures.detail("network", json!(network));
    }
    let interval = |(name, e): (&&str, &Estimate)| ((*name).to_owned(), json!([e.low, e.high]));
    figures.detail("confidence_95", estimates.iter().map(interval).collect());
    for (by, parts) in evaluation.parts() {
        figures.detail(by, json!(parts));
    }
    figures.detail("effect", json!(effect.name()));
    figures.detail("target", json!(target(&contest.set)));
    figures.detail("adapter", json!(gpu.info.name));
    figures.detail("devices", json!(evaluation.devices));
    figures.write(args.json.as_deref())?;
    if let (Some(path), Some((network, _))) = (&args.results, &contest.network) {
        let entry = Entry { network: network.clone(), evaluation: &evaluation, target: target(&contest.set) };
        results::add(path, &entry, &gpu)?;
    }
    if let Some(path) = &args.curve {
        curve::write(path, effect, &rivals, &estimates)?;
    }
    say!(
        "{effect}: {} frames of {} scenes; means over scenes with 95 % confidence intervals, milliseconds on the device \
         that is named",
        evaluation.frames,
        evaluation.scenes
    )?;
    say!("{}", table(effect, &rivals, &estimates, &evaluation.devices))
}

/// What methods are scored against.
fn target(set: &TestSet) -> &str {
    set.recipe().target.as_deref().unwrap_or(TRUTH)
}

/// Runs methods by name on the frames that the command line asks for.
fn judge(contest: &Contest, names: &[String], args: &Args, gpu: &Gpu) -> Result<Judgement> {
    let Contest { effect, network, set, .. } = contest;
    let model = network.as_ref().map(|(_, model)| model);
    let tunings = tunings(&args.quality, &args.set);
    let mut rivals = rivals(*effect, names, &tunings, gpu, model)?;
    let fog = set.recipe().vary.as_ref().and_then(|vary| vary.fog);
    if fog.is_some_and(|fog| fog.smoke_share > 0.0) {
        let by_name = !names.iter().any(|name| name == "all");
        rivals = methods::through_grids(rivals, by_name, |rival| rival.method.as_ref())?;
    }
    let chosen = spread(set.frames().len(), args.frames.map_or(usize::MAX, |frames| frames as usize));
    ensure!(!chosen.is_empty(), "the test set has no frame");
    if let Some(target) = &set.recipe().target {
        note!("what methods are scored against is not truth but the images of `{target}`");
    }
    let evaluation = evaluate(set, &chosen, *effect, &rivals)?;
    Ok(Judgement { rivals, evaluation })
}

/// Numbers of frames, ascending, that lie evenly among all and end with the last, as those do whose truth is whole.
fn spread(count: usize, wanted: usize) -> Vec<usize> {
    let from_the_end = lists::spread(count, wanted);
    from_the_end.into_iter().rev().map(|index| count - 1 - index).collect()
}

/// What the command line names.
fn contest(args: &Args) -> Result<Contest> {
    let usual = || Place::Folder(learned::usual_folder(args.effect.unwrap_or(Effect::Ao)));
    let place = args.model.clone().unwrap_or_else(usual);
    let folder = place.read()?;
    // A network that is asked for must be there.
    let optional = args.model.is_none() && args.effect.is_some() && !learned::is_network(&folder);
    let model = (!optional).then(|| learned::network(&folder, args.effect)).transpose()?;
    let effect = args.effect.or(model.as_ref().map(|model| model.spec.effect)).unwrap_or(Effect::Ao);
    let beside = || Ok(Folder::of(&folder.join("testset")));
    let testset_folder = args.testset.as_ref().map_or_else(beside, Place::read)?;
    let set = testset(&testset_folder, effect, args)?;
    let name = names::figure_name(Path::new(&place.to_string()));
    Ok(Contest {
        effect,
        network: model.map(|model| (name, model)),
        set,
        _kept: vec![folder, testset_folder],
    })
}

fn testset(folder: &Path, effect: Effect, args: &Args) -> Result<TestSet> {
    ensure!(
        TestSet::is_in(folder),
        "no test set in {0}; `deepshade dataset testset dataset/recipes/{effect}-rivals.toml --out {0}` makes a small one of \
         six scenes, {effect}-test.toml a large one, and --testset says where another is",
        folder.display()
    );
    let set = TestSet::open(folder)?;
    let set = match &args.scenes {
        Some(scenes) => set.with_scenes(scenes),
        None => set,
    };
    let made = set.recipe().effect;
    ensure!(made == effect, "{} is for {made}, not for {effect}", folder.display());
    Ok(set)
}

/// One row a method.
fn table(
    effect: Effect,
    rivals: &[Rival],
    estimates: &BTreeMap<&str, Estimate>,
    devices: &BTreeMap<String, String>,
) -> String {
    let head = ["method", "quality", "SSIM", "PSNR (dB)", "FLIP", "relMSE", "bias", "ms", "on"];
    let row = |name: &str, method: &str, quality: String| {
        let found = |metric: &str| estimates.get(format!("{metric}_{name}").as_str());
        let interval = |metric: &str| found(metric).map_or(String::new(), Estimate::to_string);
        let number = |metric: &str, digits: usize| {
            found(metric).map_or(String::new(), |estimate| format!("{:.digits$}", estimate.mean))
        };
        vec![
            method.to_owned(),
            quality,
            interval("ssim"),
            interval("psnr"),
            interval("flip"),
            number("relmse", 4),
            number("bias", 4),
            number("ms", 2),
            devices.get(name).cloned().unwrap_or_default(),
        ]
    };
    let tuned = |rival: &Rival| {
        let quality = rival.quality.map_or("", Quality::name);
        [quality, &rival.changes.to_string()].join(" ").trim().to_owned()
    };
    let methods = rivals.iter().map(|rival| row(&rival.name, rival.method_name, tuned(rival)));
    let others = [trivial_name(effect), "ceiling"].map(|name| row(name, name, String::new()));
    let rows: Vec<_> = [head.map(str::to_owned).to_vec()].into_iter().chain(methods).chain(others).collect();
    table::aligned(&rows)
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
}
