//! `deepshade compare`: methods against truth, for any set of effects, methods, scenes and views, which the
//! command line says or a TOML file.

mod compared_methods;
mod description;
mod key;
mod make;
mod plan;
mod run;
#[cfg(test)]
mod tests;
mod values;

pub use compared_methods::ComparedMethods;
pub use description::Comparison;
pub use key::{Digest, file_digest, maker};
pub use make::{ComparedView, ComparisonSettings, Head, make, wanted};
pub use plan::folder_name;
pub use run::ComparisonRun;
pub use values::MethodChoice;

use crate::arguments::positive;
use crate::complete::Additions;
use crate::exposure_time;
use crate::figures::{self, Figures};
use crate::location::Location;
use crate::props;
use crate::report::Report;
use crate::report::folder::{self, DESCRIPTION, Folder};
use crate::report::record::FrameRecord;
use crate::samples;
use crate::views::{self, View};
use anyhow::{Context, Result};
use clap::builder::RangedU64ValueParser;
use deepshade_dataset::Radius;
use deepshade_dataset::progress;
use deepshade_dataset::recipe::Resolution;
use deepshade_render::method::Repeats;
use deepshade_render::methods::Quality;
use deepshade_render::scene::SceneSource;
use deepshade_shaders::Effect;
use deepshade_shaders::effect::EffectSetting;
use deepshade_shaders::gpu::Gpu;
use description::distinct;
use make::OUTSIDE;
use plan::{Planned, SceneCache, completed, plan};
use serde_json::json;
use std::cell::Cell;
use std::path::PathBuf;

/// Methods are timed as the median of so many runs: of fewer where the adapter is software, where one takes
/// seconds.
fn repeats(gpu: &Gpu) -> Repeats {
    if gpu.is_software() { Repeats { warm_up: 1, timed: 3 } } else { Repeats { warm_up: 2, timed: 11 } }
}

/// Compares methods on scenes: images, errors, milliseconds and a page to look at.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  deepshade compare --scene stairs:7 --out report\n  \
    deepshade compare --scene sponza.gltf --views 3 --methods learned,hbao,truth --out report\n  \
    deepshade compare --scene sponza.gltf --put fox.gltf@-5,0,0,0.01,60 --eye -9,1.6,0 --look-at 0,1.2,0 --out report\n  \
    deepshade compare --scene room:7 --scene stairs:7 --effect ao,gi --quality low,high --out report\n  \
    deepshade compare --config comparison.toml --out report\n\n\
    Every run writes compare.toml into its folder: what --config takes, with the folders of networks and every default stated \
    that is the same for all scenes and effects. The rest follows from each: its views, radius, light, lens, fog and shutter. \
    Images that are there from an earlier run, made by the same program from the same things, are not made again.\n\n\
    A file for --config, of which all but the first line may be left out (more keys: the options' names with underscores):\n  \
    scenes = [\"room:7\", \"sponza.gltf\"]\n  \
    effects = [\"ao\", \"gi\"]\n  \
    methods = [\"surfel\", { name = \"gtao\", qualities = [\"low\", \"ultra\"] }]\n  \
    views = 2    # sampled ones; or [{ camera = \"left\" }, { eye = [-9, 1.6, 0], look_at = [0, 1.2, 0] }]\n\n  \
    [[runs]]     # one or several, if not all is the same for all scenes\n  \
    radius = { metres = 0.5 }")]
pub struct Args {
    /// A comparison's TOML file. Options beside it take the place of what it says.
    #[arg(long)]
    config: Option<PathBuf>,
    /// A scene file (.gltf, .glb, .obj, .ply) or a procedural family and a seed, such as stairs:7. May be
    /// given several times.
    #[arg(long, required_unless_present = "config")]
    scene: Vec<SceneSource>,
    /// What is computed, one effect or several; ao by default.
    #[arg(long, value_delimiter = ',')]
    effect: Vec<Effect>,
    /// Which methods, each for those of the effects that have it; by default all that compute the effects,
    /// `learned` only where there is a network, and neither `aov`, which takes minutes where the radius is
    /// large, nor `screen-truth`, which is for studies. Truth is always rendered, since the others are
    /// measured against it.
    #[arg(long, value_delimiter = ',')]
    methods: Vec<String>,
    /// How much time analytic methods may take for a better image: one or several of low, medium, high,
    /// ultra; high by default.
    #[arg(long, value_delimiter = ',')]
    quality: Vec<Quality>,
    /// Folder of the page and its images.
    #[arg(long)]
    out: PathBuf,
    /// Folder, address or name of the network of `learned`; by default models/EFFECT, else the program's own.
    #[arg(long, value_parser = crate::learned::place)]
    model: Option<Location>,
    /// Rows of the images; 512 by default.
    #[arg(long, value_parser = RangedU64ValueParser::<usize>::new().range(16..=8192))]
    height: Option<usize>,
    /// Columns of the images; 512 by default.
    #[arg(long, value_parser = RangedU64ValueParser::<usize>::new().range(16..=8192))]
    width: Option<usize>,
    /// How far the effect reaches, metres. By default a share of the scene's diagonal, that of the network of
    /// `learned` or else 3 %, and at most a quarter of the median depth of what is seen: each view has its
    /// own.
    #[arg(long, value_parser = positive)]
    radius: Option<f32>,
    #[command(flatten)]
    props: props::Args,
    #[command(flatten)]
    views: views::Args,
    #[command(flatten)]
    samples: samples::Args,
    #[command(flatten)]
    time: exposure_time::Args,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
    #[command(flatten)]
    additions: Additions,
}

impl Args {
    /// What the options state, beside what a file says of a run.
    fn stated(&self, file: &ComparisonRun) -> ComparisonRun {
        let size = file.size();
        let resolution = (self.height.is_some() || self.width.is_some()).then(|| Resolution {
            height: self.height.unwrap_or(size[0]),
            width: self.width.unwrap_or(size[1]),
        });
        let run = ComparisonRun {
            scenes: some(&self.scene),
            effects: some(&self.effect),
            methods: some(&self.methods).map(|names| names.into_iter().map(MethodChoice::named).collect()),
            qualities: some(&self.quality),
            model: self.model.clone(),
            put: some(self.props.all()),
            resolution,
            radius: self.radius.map(Radius::Metres),
            ..ComparisonRun::default()
        };
        run.with_options(&self.additions, &self.views, self.samples, self.time)
    }
}

/// A list, if anything is in it.
fn some<T: Clone>(list: &[T]) -> Option<Vec<T>> {
    (!list.is_empty()).then(|| list.to_vec())
}

/// Compares, writes the page, prints the tables.
///
/// # Errors
/// If what is asked for cannot be, or a part of it fails.
pub fn run(args: &Args) -> Result<()> {
    folder::check(&args.out)?;
    let file = args.config.as_deref().map(description::read).transpose()?;
    let mut comparison = Comparison::new(file, |run| args.stated(run))?;
    let gpu = Gpu::new()?;
    let machine = machine(&gpu);
    let by_name: Vec<bool> = comparison.runs.iter().map(|run| run.methods.is_some()).collect();
    let compared_by_run = comparison.runs.iter_mut().map(|run| ComparedMethods::open(run, &gpu));
    let mut compared_by_run = compared_by_run.collect::<Result<Vec<_>>>()?;
    let (mut scene_cache, maker) = (SceneCache::default(), maker(&machine)?);
    let making = (maker.as_str(), repeats(&gpu), args.out.as_path());
    let planned = plan(&comparison, &mut compared_by_run, &mut scene_cache, &by_name, making)?;
    for (run, compared) in comparison.runs.iter_mut().zip(&compared_by_run) {
        compared.state(run);
    }
    let folder = Folder::open(&args.out)?;
    folder.write(DESCRIPTION, &comparison.to_toml(&args.out)?)?;
    let mut frames = make_all(&comparison, &compared_by_run, &planned, &mut scene_cache, &folder)?;
    if let Some(warning) = outside(&frames) {
        note!("{warning}");
    }
    let effects = comparison.effects();
    frames.sort_by_key(|frame| effects.iter().position(|effect| *effect == frame.effect));
    let report = Report { frames, quality: quality(&comparison), machine };
    let page = report.write(&folder)?;
    figures(&report, &comparison, &planned)?.write(args.json.as_deref())?;
    say!("{report}{}", page.display())
}

/// Makes every frame's images that are not there.
fn make_all(
    comparison: &Comparison,
    compared_by_run: &[ComparedMethods],
    planned: &[Planned],
    scene_cache: &mut SceneCache,
    folder: &Folder,
) -> Result<Vec<FrameRecord>> {
    let whole = planned.iter().filter(|frame| frame.head.is_whole()).count();
    if whole > 0 {
        note!("{whole} of {} frames are there from an earlier run", planned.len());
    }
    let all = planned.iter().map(|frame| 1 + frame.head.wanted.len()).sum();
    let there = planned.iter().flat_map(|frame| &frame.head.kept).map(|kept| 1 + kept.images.len()).sum();
    let (bar, begun) = (progress::bar("images", all, there), Cell::new(there));
    let mut frames = Vec::new();
    for Planned { run, scene_request, view, settings, added, head, .. } in planned {
        if let Some(kept) = head.kept.as_ref().filter(|_| head.is_whole()) {
            let record = head.renamed(kept.clone());
            record.write(&folder.path)?;
            frames.push(record);
            continue;
        }
        let (effect, compared) = (settings.effect, &compared_by_run[*run]);
        let run = &comparison.runs[*run];
        let mut completed = completed(run, compared, scene_cache.get(scene_request)?, view, effect)?;
        if completed.scene.scene().glow.is_some() {
            completed.scene = scene_request.remembered(completed.scene)?;
        }
        let medium = || ("medium".to_owned(), run.additions().heard_by(effect).medium_in_words());
        let medium = effect.listens_to(EffectSetting::Medium).then(medium);
        let added = added.iter().map(|added| ("added".to_owned(), added.clone()));
        let subject = ComparedView {
            scene: &completed.scene,
            view: &View { camera: completed.camera, ..view.clone() },
            settings: *settings,
            methods: compared.of(effect).collect(),
            facts: medium.into_iter().chain(added).collect(),
        };
        let at = |what: &str| {
            bar.set_position(begun.replace(begun.get() + 1) as u64);
            bar.set_message(format!("{}, {effect}: {what}", head.name));
        };
        frames.push(make(folder, head, &subject, &at).with_context(|| format!("{}, {effect}", head.name))?);
    }
    bar.finish_and_clear();
    Ok(frames)
}

/// What is to be said of frames that are unlike those that networks were trained on, once for all of them.
fn outside(frames: &[FrameRecord]) -> Option<String> {
    let of = |frame: &&FrameRecord| frame.facts.iter().any(|(name, _)| name == OUTSIDE);
    let count = frames.iter().filter(of).count();
    let first = frames.iter().find(of)?;
    let (_, warning) = first.facts.iter().find(|(name, _)| name == OUTSIDE)?;
    Some(format!("{count} of {} frames, such as {}: {warning}", frames.len(), first.name))
}

/// The qualities of all methods, in words.
fn quality(comparison: &Comparison) -> String {
    let own = |run: &ComparisonRun| {
        let of = |method: &MethodChoice| method.qualities.clone().unwrap_or(run.qualities().to_vec());
        run.methods().iter().flat_map(of).collect::<Vec<_>>()
    };
    let mut qualities = distinct(comparison.runs.iter().flat_map(own));
    qualities.sort_unstable();
    qualities.iter().map(|quality| quality.name()).collect::<Vec<_>>().join(", ")
}

/// What scripts ask for.
fn figures(report: &Report, comparison: &Comparison, planned: &[Planned]) -> Result<Figures> {
    let mut figures = Figures::new("compare");
    report.set_figures(&mut figures);
    let radii = distinct(report.frames.iter().filter_map(|frame| frame.radius));
    if let [radius] = radii[..] {
        figures.set("radius", f64::from(radius));
    }
    let runs = &comparison.runs;
    let words = |of: &dyn Fn(&ComparisonRun) -> Vec<String>| distinct(runs.iter().flat_map(of)).join(", ");
    figures.detail("added", json!(planned.first().map(|first| &first.added)));
    if comparison.effects().iter().any(|effect| effect.listens_to(EffectSetting::Medium)) {
        figures.detail("medium", words(&|run| vec![run.additions().medium_in_words()]).into());
    }
    figures.detail("scene", words(&|run| run.scenes().iter().map(ToString::to_string).collect()).into());
    figures.detail("quality", quality(comparison).into());
    figures.detail("put", words(&|run| vec![run.props().to_string()]).into());
    let described = runs.iter().map(toml::Table::try_from).collect::<Result<Vec<_>, _>>();
    figures.detail("runs", json!(described.context("the comparison as TOML")?));
    Ok(figures)
}

/// What everything ran on, as the report shows it.
pub fn machine(gpu: &Gpu) -> Vec<(String, String)> {
    let info = &gpu.info;
    let driver = [&info.driver, &info.driver_info].map(String::as_str).join(" ");
    let adapter = ("adapter".to_owned(), format!("{}, {}, {}", info.name, info.backend, driver.trim()));
    let text = |value: &serde_json::Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    let machine = figures::machine();
    let rest = machine.as_object().into_iter().flatten().map(|(name, value)| (name.clone(), text(value)));
    [adapter].into_iter().chain(rest).collect()
}
