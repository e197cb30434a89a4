//! `deepshade eval --all`: every network beside what the thesis reports of its own, as a table, figures and a
//! page.

use super::names::{figure_name, name_of, of_network, set_figures};
use super::outcome::EvaluationOutcome;
use super::paper::{Published, published};
use super::results::{self, Entry};
use super::sets::ARTISTS;
use super::{Args, EvaluationInputs, evaluate_methods, page, sets, target};
use crate::figures::{Figures, write_atomically};
use crate::methods::{LEARNED, names_of};
use crate::statistics::MeanInterval;
use crate::{learned, table};
use anyhow::{Context, Result, bail, ensure};
use deepshade_dataset::TestSet;
use deepshade_infer::Model;
use deepshade_shaders::Effect;
use deepshade_shaders::gpu::Gpu;
use serde_json::json;
use std::path::PathBuf;

/// Where networks are.
pub(super) const MODELS: &str = "models";

/// A network with what its evaluation has come to.
pub struct Row {
    /// The name of its folder.
    pub name: String,
    /// What it computes.
    pub effect: Effect,
    /// Number of weights.
    pub weights: usize,
    /// What it was scored against.
    pub target: String,
    /// What the thesis says of it.
    pub published: Option<&'static Published>,
    /// The folders of its test sets.
    pub sets: Vec<PathBuf>,
    /// The scores.
    pub outcome: EvaluationOutcome,
}

/// Evaluates all networks that have a test set, prints and writes the table.
///
/// # Errors
/// If there is none, a network or test set cannot be read, a method fails or a file cannot be written.
pub fn run(args: &Args) -> Result<()> {
    let unknown = |name: &&String| {
        *name != "all" && Effect::ALL.iter().all(|effect| !names_of(*effect).contains(&name.as_str()))
    };
    if let Some(name) = args.methods.iter().find(unknown) {
        bail!("no effect has a method `{name}`; `deepshade methods` lists them");
    }
    if let Some(folder) = &args.page {
        page::make_folder(folder)?;
    }
    let gpu = Gpu::new()?;
    let mut rows = Vec::new();
    for tested in networks(args)? {
        let (weights, sets) = (tested.model.spec.weight_count(), tested.sets.clone());
        let (name, inputs) = tested.inputs(args)?;
        note!("{name}");
        let (effect, target) = (inputs.effect, target(&inputs.sets).to_owned());
        let outcome = evaluate_methods(&inputs, &methods_for(effect, &args.methods), args, &gpu)?;
        let row = Row { published: published(&name), name, effect, sets, weights, target, outcome };
        // At once: all of them take minutes, and whoever interrupts that keeps what was made.
        if let Some(path) = &args.results {
            let network = row.name.replace('-', "_");
            let entry = Entry { network, evaluation: &row.outcome.evaluation, target: &row.target };
            results::add(path, &entry, &gpu)?;
        }
        rows.push(row);
    }
    let mut figures = Figures::new("eval");
    for row in &rows {
        row.set_figures(&mut figures);
    }
    figures.detail("methods", json!(args.methods));
    figures.detail("adapter", json!(gpu.info.name));
    figures.write(args.json.as_deref())?;
    let lines: Vec<Vec<String>> =
        std::iter::once(HEAD.map(str::to_owned).to_vec()).chain(rows.iter().map(line)).collect();
    if let Some(path) = &args.markdown {
        let text = table::markdown(&lines).join("\n") + "\n";
        write_atomically(path, text.as_bytes())?;
    }
    if let Some(folder) = &args.page {
        page::write(folder, &lines, &rows)?;
    }
    say!("{}", table::aligned(&lines))
}

impl Row {
    /// Sets the figures of all its test sets but artists' scenes, the same of these, and by how much the
    /// network is ahead on both: `ssim_<network>`, `paired_<network>`, ... `_artists`.
    fn set_figures(&self, figures: &mut Figures) {
        let network = self.name.replace('-', "_");
        let EvaluationOutcome { evaluation, sets, .. } = &self.outcome;
        set_figures(figures, &network, evaluation);
        let artists = sets.iter().find(|set| set.name == ARTISTS).filter(|_| sets.len() > 1);
        for (name, estimate) in artists.into_iter().flat_map(|set| set.evaluation.estimates()) {
            figures.set(&format!("{}_{ARTISTS}", of_network(&network, name)), estimate.mean);
        }
        for comparison in self.outcome.pairs() {
            let suffix = comparison.suffix.filter(|suffix| suffix.is_empty() || suffix[1..] == *ARTISTS);
            suffix.iter().for_each(|suffix| comparison.pair.set_figures(figures, Some(&network), suffix));
        }
        figures.detail(&self.name, json!(evaluation.parts()));
    }
}

/// Of the methods that are asked for, those of an effect, and its network.
pub(super) fn methods_for(effect: Effect, asked: &[String]) -> Vec<String> {
    if asked.iter().any(|name| name == "all") {
        return vec!["all".to_owned()];
    }
    let known = names_of(effect);
    let is_rival = |name: &&String| *name != LEARNED && known.contains(&name.as_str());
    std::iter::once(LEARNED.to_owned()).chain(asked.iter().filter(is_rival).cloned()).collect()
}

/// A network that has test sets.
pub(super) struct Tested {
    /// The network's folder.
    folder: PathBuf,
    /// The network.
    model: Model,
    /// The folders of its test sets.
    sets: Vec<PathBuf>,
}

impl Tested {
    /// The network's name, and what it is evaluated on.
    ///
    /// # Errors
    /// If a test set cannot be read.
    pub(super) fn inputs(self, args: &Args) -> Result<(String, EvaluationInputs)> {
        let Self { folder, model, sets } = self;
        let effect = model.spec.effect;
        let sets = sets::open(&sets, effect, args.scenes.as_deref())?;
        let network = Some((figure_name(&folder), model));
        Ok((name_of(&folder), EvaluationInputs { effect, network, sets }))
    }
}

/// The networks, each with its test sets; networks without one are named and left out.
pub(super) fn networks(args: &Args) -> Result<Vec<Tested>> {
    let entries = std::fs::read_dir(MODELS).with_context(|| format!("no folder `{MODELS}` here"))?;
    let mut folders: Vec<PathBuf> = entries.map(|entry| Ok(entry?.path())).collect::<Result<_>>()?;
    folders.retain(|folder| folder.join("net.json").is_file());
    folders.sort();
    let mut found = Vec::new();
    for folder in folders {
        let model = learned::network(&folder, None)?;
        let sets = match &args.testsets {
            Some(sets) => vec![sets.join(name_of(&folder))],
            None => sets::folders(&folder, model.spec.effect),
        };
        match sets.iter().find(|set| !TestSet::is_in(set)) {
            None => found.push(Tested { folder, model, sets }),
            Some(set) => note!("{}: left out, there is no test set in {}", folder.display(), set.display()),
        }
    }
    ensure!(!found.is_empty(), "no network in `{MODELS}` has a test set; --testsets says where they are");
    Ok(found)
}

/// What the columns of the table hold.
const HEAD: [&str; 13] = [
    "network",
    "weights",
    "target",
    "frames",
    "SSIM",
    "paper",
    "best rival",
    "its SSIM",
    "nothing done",
    "ceiling",
    "ms",
    "paper's ms",
    "rival's ms",
];

/// A network's line of the table.
fn line(row: &Row) -> Vec<String> {
    let EvaluationOutcome { rivals, evaluation, .. } = &row.outcome;
    let estimates = evaluation.estimates();
    let found = |metric: &str, of: &str| estimates.get(format!("{metric}_{of}").as_str()).copied();
    let ssim = |of: &str| found("ssim", of);
    let analytic = rivals.iter().filter(|rival| rival.name != LEARNED);
    let best = analytic.max_by(|a, b| mean(ssim(&a.name)).total_cmp(&mean(ssim(&b.name))));
    let interval =
        |estimate: Option<MeanInterval>| estimate.map_or(String::new(), |estimate| estimate.to_string());
    let number = |estimate: Option<MeanInterval>, digits: usize| {
        estimate.map_or(String::new(), |estimate| format!("{:.digits$}", estimate.mean))
    };
    let paper = row.published.map_or("-".to_owned(), |paper| format!("{:.3}", paper.ssim));
    vec![
        row.name.clone(),
        row.weights.to_string(),
        row.target.clone(),
        evaluation.frames.to_string(),
        interval(ssim(LEARNED)),
        paper,
        best.map_or("-".to_owned(), |rival| rival.name.replace('_', "-")),
        interval(best.and_then(|rival| ssim(&rival.name))),
        number(ssim(row.effect.definition().doing_nothing.name()), 3),
        number(ssim("ceiling"), 3),
        number(found("ms", LEARNED), 1),
        row.published.map_or("-".to_owned(), |paper| format!("{:.1}", paper.milliseconds)),
        number(best.and_then(|rival| found("ms", &rival.name)), 1),
    ]
}

fn mean(estimate: Option<MeanInterval>) -> f64 {
    estimate.map_or(f64::NEG_INFINITY, |estimate| estimate.mean)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_network_meets_the_rivals_of_its_effect() {
        let asked = ["gtao", "fxaa", "learned"].map(str::to_owned);
        assert_eq!(methods_for(Effect::Ao, &asked), ["learned", "gtao"]);
        assert_eq!(methods_for(Effect::Aa, &asked), ["learned", "fxaa"]);
        assert_eq!(methods_for(Effect::Multi, &asked), ["learned"]);
        assert_eq!(methods_for(Effect::Ao, &["all".to_owned()]), ["all"]);
    }
}
