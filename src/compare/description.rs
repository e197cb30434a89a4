//! A comparison as a whole, whether a TOML file or the command line says what it is, and the file that it
//! writes.

use super::run::ComparisonRun;
use super::values::MethodChoice;
use crate::arguments::check_size;
use crate::complete::listeners;
use crate::methods;
use crate::views::{Choice, View, Viewpoint};
use anyhow::{Context, Result, anyhow, bail, ensure};
use deepshade_dataset::Radius;
use deepshade_render::sampler::MAX_SAMPLES;
use deepshade_shaders::Effect;
use deepshade_shaders::effect::EffectSetting;
use deepshade_shaders::names::with_meant;
use std::fmt::Debug;
use std::path::{Component, Path, PathBuf};

/// The first line of files that comparisons write.
pub const HEAD: &str = "# What `deepshade compare` made the page beside this file from; again:";

/// What is compared: runs that state all that has a default.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// At least one.
    pub runs: Vec<ComparisonRun>,
}

/// What a file says, its paths relative to where the program runs.
///
/// # Errors
/// If it cannot be read, or a key or a value is none, with its line.
pub fn read(path: &Path) -> Result<ComparisonRun> {
    let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
    let run = toml::from_str(&text).map_err(|error| anyhow!(with_meant(&error.to_string())));
    let mut run: ComparisonRun = run.with_context(|| path.display().to_string())?;
    let folder = path.parent().unwrap_or(Path::new(""));
    run.map_paths(&|path| folder.join(path));
    Ok(run)
}

impl Comparison {
    /// What a file says, if there is one, with what the command line says of each run in place of what the
    /// file does.
    ///
    /// # Errors
    /// If a value is out of its range or means nothing, with its key.
    pub fn new(file: Option<ComparisonRun>, line: impl Fn(&ComparisonRun) -> ComparisonRun) -> Result<Self> {
        let mut stated = Vec::new();
        leaves(file.unwrap_or_default(), &ComparisonRun::default(), &mut stated);
        let runs: Vec<ComparisonRun> =
            stated.into_iter().map(|run| line(&run).in_place_of(&run).filled()).collect();
        let several = runs.len() > 1;
        for (index, run) in runs.iter().enumerate() {
            let place = || if several { format!("run {}", index + 1) } else { "comparison".to_owned() };
            check(run).with_context(place)?;
        }
        Ok(Self { runs })
    }

    /// All effects, each once, in the order in which runs name them.
    pub fn effects(&self) -> Vec<Effect> {
        distinct(self.runs.iter().flat_map(|run| run.effects().iter().copied()))
    }

    /// The TOML file, in a folder that its paths are relative to, with a head that says where it is from.
    ///
    /// # Errors
    /// If a file that it names is gone.
    pub fn to_toml(&self, folder: &Path) -> Result<String> {
        let text = self.keys(folder)?;
        Ok(format!("{HEAD}\n#   deepshade compare --config compare.toml --out FOLDER\n{text}"))
    }

    /// The keys of [`Comparison::to_toml`].
    ///
    /// # Errors
    /// As it.
    pub fn keys(&self, folder: &Path) -> Result<String> {
        let mut whole = match &self.runs[..] {
            [one] => one.clone(),
            several => ComparisonRun { runs: several.to_vec(), ..ComparisonRun::default() },
        };
        let folder = folder.canonicalize().with_context(|| folder.display().to_string())?;
        whole.map_paths(&|path| relative(path, &folder));
        toml::to_string(&whole).context("the comparison as TOML")
    }
}

/// What is there more than once, once.
pub fn distinct<T: PartialEq>(all: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut kept = Vec::new();
    for one in all {
        if !kept.contains(&one) {
            kept.push(one);
        }
    }
    kept
}

/// The runs that stand in a run, or itself, with what they leave out.
fn leaves(mut run: ComparisonRun, outer: &ComparisonRun, found: &mut Vec<ComparisonRun>) {
    let inner = std::mem::take(&mut run.runs);
    let whole = run.over(outer);
    if inner.is_empty() {
        found.push(whole);
    } else {
        inner.into_iter().for_each(|run| leaves(run, &whole, found));
    }
}

/// Whether a run can be: what is found out without a scene and without a device.
fn check(run: &ComparisonRun) -> Result<()> {
    ensure!(!run.scenes().is_empty(), "`scenes` names none");
    ensure!(!run.effects().is_empty(), "`effects` names none");
    ensure!(!run.qualities().is_empty(), "`qualities` names none");
    once("scenes", run.scenes())?;
    once("effects", run.effects())?;
    once("qualities", run.qualities())?;
    check_size(["`resolution.height`", "`resolution.width`"], run.size())?;
    let samples = run.goal().samples;
    ensure!((1..=MAX_SAMPLES).contains(&samples), "`samples`: {samples} is not within 1 to {MAX_SAMPLES}");
    let radius = run.radius.map(|radius| match radius {
        Radius::Diagonal(share) => Ok(share),
        Radius::Metres(metres) => Ok(metres),
        Radius::Pixels(_) | Radius::MetresBetween(_) => {
            bail!("`radius`: all images of a comparison have one, as `diagonal` or `metres` says")
        }
    });
    let radius = radius.transpose()?;
    for (key, value) in
        [("error", run.error), ("radius", radius), ("aperture", run.aperture), ("focus", run.focus)]
    {
        let sound = value.is_none_or(|value| value > 0.0 && value.is_finite());
        ensure!(sound, "`{key}`: {} is not above 0 and finite", value.unwrap_or_default());
    }
    for (key, value) in [("time", run.time), ("shutter", run.shutter)] {
        ensure!(value.is_none_or(f32::is_finite), "`{key}` is not finite");
    }
    if let Some(Choice::Stated(views)) = &run.views {
        ensure!(!views.is_empty(), "`views` names none");
        views.iter().try_for_each(Viewpoint::check).context("`views`")?;
    }
    let effects = run.effects();
    listeners::check_any(effects, EffectSetting::Radius, &[("--radius", run.radius.is_some())])?;
    listeners::check_any(effects, EffectSetting::Shutter, &[("--shutter", run.shutter.is_some())])?;
    run.additions().check_any(effects)?;
    check_methods(run)
}

/// Whether nothing is named twice.
fn once<T: PartialEq + Debug>(key: &str, values: &[T]) -> Result<()> {
    let twice = values.iter().enumerate().find(|(index, value)| values[..*index].contains(value));
    twice.map_or(Ok(()), |(_, value)| bail!("`{key}` names {value:?} twice"))
}

/// Whether one of the effects at least has each method.
fn check_methods(run: &ComparisonRun) -> Result<()> {
    for (index, method) in run.methods().iter().enumerate() {
        let name = method.name.as_str();
        let known = run.effects().iter().any(|effect| methods::names_of(*effect).contains(&name));
        if !known {
            let of = |effect: &Effect| methods::unknown(*effect, name);
            bail!("{}", run.effects().iter().map(of).collect::<Vec<_>>().join("; "));
        }
        let before = &run.methods()[..index];
        let is_same = |other: &MethodChoice| {
            (&other.name, &other.model, &other.parameters)
                == (&method.name, &method.model, &method.parameters)
        };
        let twice = before.iter().any(is_same);
        ensure!(!twice, "method `{name}` is asked for twice");
        if let Some(qualities) = &method.qualities {
            ensure!(!qualities.is_empty(), "method `{name}`: `qualities` names none");
            once("qualities", qualities).with_context(|| format!("method `{name}`"))?;
        }
        let learned = name == methods::LEARNED;
        ensure!(learned || method.model.is_none(), "method `{name}` has no `model`: it is no network");
        ensure!(!learned || method.qualities.is_none(), "method `{name}` has no `qualities`");
    }
    let learned = run.methods().is_empty() || run.learns();
    ensure!(
        learned || run.model.is_none(),
        "`model` means nothing without the method `{}`",
        methods::LEARNED
    );
    Ok(())
}

/// The way from a folder to a file; the whole path where there is none, as from one drive to another, and as
/// it is where nothing is there.
fn relative(path: &Path, folder: &Path) -> PathBuf {
    let Ok(whole) = path.canonicalize() else { return path.to_owned() };
    let shared = whole.components().zip(folder.components()).take_while(|(a, b)| a == b).count();
    if shared == 0 {
        return whole;
    }
    let up = folder.components().skip(shared).map(|_| Component::ParentDir);
    up.chain(whole.components().skip(shared)).collect()
}

/// What a view is called beside its scene's name.
pub fn short_name(view: &View, scene: &str) -> String {
    let rest = view.name.strip_prefix(scene).map(|rest| rest.trim_start_matches([',', ' ']));
    rest.filter(|rest| !rest.is_empty()).unwrap_or(&view.name).to_owned()
}
