//! `deepshade export`: from a training run to a model folder.

mod check;
mod folder;
mod translated;
mod wgsl;

use crate::complete::sky;
use crate::eval::names::of_network;
use crate::figures::{Figures, write_atomically};
use crate::learned::estimator;
use crate::location::Location;
use anyhow::{Context, Result, ensure};
use deepshade_dataset::recipe::FieldOfView;
use deepshade_dataset::vary::Surroundings;
use deepshade_dataset::{Manifest, Radius, Recipe, stream};
use deepshade_infer::forward::Precision;
use deepshade_infer::model::SPEC;
use deepshade_infer::{AnalyticEstimate, Model, NetSpec};
use deepshade_render::scene::camera::FIELD_OF_VIEW;
use deepshade_shaders::Effect;
use deepshade_shaders::effect::EffectSetting;
use deepshade_train::TrainConfig;
use deepshade_train::export::{CARD_FILE, Facts, export, measured, onnx};
use serde_json::Value;
use std::path::{Path, PathBuf};
use translated::{Language, translated};

/// Licence of exported weights, the program's own.
const LICENCE: &str = "MIT OR Apache-2.0";

/// Turns a training run into a model folder: weights, spec, ONNX file, card, and an image to check runtimes
/// with; or a model, one that the program brings too, into WGSL files for any engine or a folder of its own;
/// or an ONNX file in half floats; or writes what was measured into a model's card.
#[derive(clap::Args)]
#[command(group(clap::ArgGroup::new("source").required(true).args(["run", "model"])))]
#[command(group(clap::ArgGroup::new("made").multiple(true).args(["out", "wgsl", "metrics", "onnx_half"])))]
#[command(after_help = "Examples:\n  \
    deepshade export --run runs/ao --out models/ao --metrics eval.json\n  \
    deepshade export --model models/ao --wgsl shaders/ao\n  \
    deepshade export --model models/ao --wgsl shaders/ao --also hlsl\n  \
    deepshade export --model models/ao --metrics eval.json\n  \
    deepshade export --model models/ao --onnx-half ao-f16.onnx\n  \
    deepshade export --model ao --out models/ao    # the program's own, as files\n\n\
    --wgsl writes a compute shader for every pass from a g-buffer to the image, packed weights, \
    network.json with the passes and what they bind, a frame to check with, and HOST.md, which says what a \
    host must do.")]
pub struct Args {
    /// Folder or address of the training run.
    #[arg(long, requires = "out")]
    run: Option<Location>,
    /// Folder or address of the model to be written. Of --model it is a copy of spec and weights, which takes
    /// no other network's place.
    #[arg(long)]
    out: Option<Location>,
    /// Folder, address or name of a model that is there.
    #[arg(long, requires = "made", value_parser = crate::learned::place)]
    model: Option<Location>,
    /// Folder for WGSL files, which are replaced.
    #[arg(long)]
    wgsl: Option<PathBuf>,
    /// The shaders of --wgsl in another language, too.
    #[arg(long, requires = "wgsl")]
    also: Option<Language>,
    /// Feature maps of the WGSL files in half floats.
    #[arg(long, requires = "wgsl")]
    half: bool,
    /// An ONNX file in half floats, whose input and output are 32-bit floats still.
    #[arg(long, value_name = "FILE", value_parser = crate::arguments::written_file)]
    onnx_half: Option<PathBuf>,
    /// Folder or address of the dataset that the run was trained on, where it has moved since.
    #[arg(long)]
    dataset: Option<Location>,
    /// What `deepshade eval --json` wrote about this network, for the card; with --model, for that of the
    /// folder that is there.
    #[arg(long)]
    metrics: Option<PathBuf>,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
}

/// Writes the folder and says what it holds.
///
/// # Errors
/// If the run or its dataset's manifest cannot be read, that manifest is not the one that the run was trained
/// with, the run has no network to export, or the folder cannot be written.
pub fn run(args: &Args) -> Result<()> {
    let (name, model) = match (&args.run, &args.out, &args.model) {
        (Some(run), Some(out), _) => {
            let work = out.begin()?;
            let model = exported(args, &run.read()?, &work)?;
            work.finish()?;
            (out, model)
        }
        (_, out, Some(location)) => {
            let both = out.is_some() && args.metrics.is_some();
            ensure!(!both, "--metrics goes into the card of --model: it does not go with --out");
            let model = Model::load(&location.read()?)?;
            args.metrics.as_deref().map_or(Ok(()), |file| measure(location, &model, file))?;
            out.as_ref().map_or(Ok(()), |out| copied(&model, out))?;
            (out.as_ref().unwrap_or(location), model)
        }
        _ => anyhow::bail!("--run with --out, or --model with --out, --wgsl, --metrics or --onnx-half"),
    };
    if let Some(folder) = &args.wgsl {
        let precision = if args.half { Precision::F16 } else { Precision::F32 };
        let files = wgsl::files(&model, precision)?;
        let more = args.also.map(|language| translated(&files, language)).transpose()?;
        folder::replace(folder, &[files, more.unwrap_or_default()].concat())?;
    }
    args.onnx_half.as_deref().map_or(Ok(()), |file| write_half(&model, file))?;
    let weights = model.spec.weight_count();
    let mut figures = Figures::new("export");
    figures.set("weights", weights as f64);
    figures.write(args.json.as_deref())?;
    say!("{name}: {}, {weights} weights", model.spec.effect)?;
    args.wgsl.as_ref().map_or(Ok(()), |folder| say!("{}: see HOST.md there", folder.display()))
}

/// Writes a model that is there to a place that has none.
fn copied(model: &Model, out: &Location) -> Result<()> {
    ensure!(!out.holds(SPEC)?, "{out} holds a network already: --out names a place for another one");
    let work = out.begin()?;
    model.save(&work)?;
    work.finish()
}

/// Writes the ONNX file of a model in half floats.
fn write_half(model: &Model, file: &Path) -> Result<()> {
    let half = onnx::halved(&onnx::encode(model)).with_context(|| file.display().to_string())?;
    write_atomically(file, &half)
}

/// Writes results into the card of a model that is there.
fn measure(location: &Location, model: &Model, file: &Path) -> Result<()> {
    let Location::Folder(folder) = location else {
        anyhow::bail!("{location}: the card of a model in a store is not changed, that of a folder is")
    };
    let path = folder.join(CARD_FILE);
    let card = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let card = measured(&card, &metrics(file, model.spec.effect)?)
        .with_context(|| format!("{}: not a card", path.display()))?;
    write_atomically(&path, card.as_bytes())
}

/// The model of a training run, written to its folder.
fn exported(args: &Args, run: &Path, out: &Path) -> Result<Model> {
    let config = TrainConfig::load(run)?;
    if config.stream.is_some() {
        return exported_of_stream(args, &config, run, out);
    }
    let context = "the card names the training data; --dataset says where they are now";
    let moved = args.dataset.as_ref().map(Location::read).transpose().context(context)?;
    let dataset = moved.as_deref().unwrap_or(&config.dataset);
    let manifest = Manifest::load(dataset).context(context)?;
    ensure!(
        Manifest::file_hash(dataset)? == config.data_hash,
        "{}: not the data that {} was trained on",
        dataset.display(),
        run.display()
    );
    let facts = facts(&config.spec, &manifest, wanted_metrics(args, manifest.origin.recipe.effect)?);
    Ok(export(run, out, &facts)?)
}

/// The model of a run on a stream, whose recipe is asked for in place of data.
fn exported_of_stream(args: &Args, config: &TrainConfig, run: &Path, out: &Path) -> Result<Model> {
    let recipe =
        Recipe::load(&config.dataset).context("the card names the recipe that the run was trained on")?;
    ensure!(
        stream::hash(&recipe) == config.data_hash,
        "{}: not the recipe that {} was trained on",
        config.dataset.display(),
        run.display()
    );
    let file = config.dataset.file_name().unwrap_or_default().to_string_lossy();
    let frames = "views rendered while it trained".to_owned();
    let facts = facts_of(&config.spec, &recipe, &file, &frames, wanted_metrics(args, recipe.effect)?);
    Ok(export(run, out, &facts)?)
}

/// What the command line brings of results.
fn wanted_metrics(args: &Args, effect: Effect) -> Result<Vec<(String, String)>> {
    let metrics = args.metrics.as_deref().map(|file| metrics(file, effect));
    Ok(metrics.transpose()?.unwrap_or_default())
}

/// What the card says about the data, and about what the network cannot do.
pub fn facts(spec: &NetSpec, manifest: &Manifest, metrics: Vec<(String, String)>) -> Facts {
    let recipe = &manifest.origin.recipe;
    let frames = format!("{} frames of {} scenes", manifest.pairs.len(), recipe.scene_count());
    facts_of(spec, recipe, &manifest.origin.recipe_file, &frames, metrics)
}

/// The same, of a recipe in a file and of what was made of it.
fn facts_of(
    spec: &NetSpec,
    recipe: &Recipe,
    file: &str,
    frames: &str,
    metrics: Vec<(String, String)>,
) -> Facts {
    let (height, width) = (recipe.resolution.height, recipe.resolution.width);
    let target = match &recipe.target {
        Some(method) => format!("images of `{method}`"),
        None => {
            let most = if recipe.error.is_some() { "at most " } else { "" };
            let noise = if recipe.knows_variance() { " whose noise is known" } else { "" };
            format!("truth of {most}{} samples a pixel{noise}", recipe.samples)
        }
    };
    Facts {
        recipe: format!(
            "`{file}`: {frames}, {width} x {height}, {target}, seed {} ({})",
            recipe.seed,
            scenes(recipe)
        ),
        metrics,
        limits: limits(spec, recipe),
        licence: LICENCE.to_owned(),
        environment: sky::of_recipe(recipe),
    }
}

/// Where scenes are from: families alone by their names; beside files or captures, how many there are of
/// each.
fn scenes(recipe: &Recipe) -> String {
    let counted = |count: usize, one: &str| match count {
        0 => None,
        1 => Some(format!("1 {one}")),
        _ => Some(format!("{count} {one}s")),
    };
    let others = [counted(recipe.files.len(), "file"), counted(recipe.captures.len(), "capture")];
    let alone = others.iter().all(Option::is_none);
    let families = recipe.families.iter().map(|family| match alone {
        true => family.name.clone(),
        false => format!("{} of {}", family.scenes, family.name),
    });
    families.chain(others.into_iter().flatten()).collect::<Vec<_>>().join(", ")
}

/// What a network cannot do: what none can that sees one frame of a screen, and what the data keep from this
/// one.
fn limits(spec: &NetSpec, recipe: &Recipe) -> Vec<String> {
    let field_of_view = recipe.field_of_view.unwrap_or(FieldOfView::Fixed(FIELD_OF_VIEW));
    let beyond = |estimate: &&AnalyticEstimate| {
        estimator(spec, estimate).is_ok_and(|estimator| estimator.looks_beyond())
    };
    let mut limits = vec![
        match spec.estimates.iter().find(beyond) {
            Some(AnalyticEstimate { method, .. }) => format!(
                "It sees what the camera sees; of what lies outside the image or behind other surfaces it knows \
                 what `{method}` tells."
            ),
            None => {
                "It sees what the camera sees: what lies outside the image or behind other surfaces does \
                     nothing."
                    .to_owned()
            }
        },
        format!(
            "It was trained on perspective views with a vertical field of view of {field_of_view} degrees."
        ),
        "Frames are independent; nothing keeps them steady over time.".to_owned(),
    ];
    // A network that was shown all radii is as good at any of them.
    let one_radius = matches!(recipe.radius, Radius::Diagonal(_) | Radius::Metres(_));
    limits.extend(match recipe.effect {
        effect if effect.listens_to(EffectSetting::Radius) => one_radius.then_some(
            "Its radius is fixed; other radii work by scaling lengths and get worse the further they are from \
             the trained one.",
        ),
        Effect::Aa => Some("The paper's table gives this network 1.2 k weights, which its text does not lead to: it gives 609."),
        Effect::Ibl => Some("The paper's table gives this network 3.9 k weights, which its text does not lead to: it gives 4,503."),
        Effect::Real => Some(
            "It was trained on a synthetic capture, not on photographs: what the paper reports of its own, learned from \
             thousands of photographs of one room, cannot be held against it.",
        ),
        _ => None,
    }.map(str::to_owned));
    if let Some(target) = &recipe.target {
        limits.push(format!("It imitates `{target}`, a screen-space method, and its mistakes, not truth."));
    }
    let environment = recipe.vary.as_ref().and_then(|vary| vary.environment.as_ref());
    limits.extend(environment.map(limit_of_environment));
    limits
}

/// What a network does not know of environments.
fn limit_of_environment(environment: &Surroundings) -> String {
    let by_heart =
        |which| format!("It knows one environment by heart, {which}; under any other it is wrong.");
    match environment {
        Surroundings::Sky(seed) => by_heart(format!("the clear sky of seed {seed}")),
        Surroundings::File(path) => by_heart(path.display().to_string()),
        Surroundings::Skies(_) => "It was trained under clear skies alone.".to_owned(),
    }
}

/// Figures that `eval` wrote about a network of an effect as the card's table, but for those that are there a
/// second time under the network's name.
fn metrics(path: &Path, effect: Effect) -> Result<Vec<(String, String)>> {
    let read = || -> Result<Vec<(String, String)>> {
        let json: Value = serde_json::from_slice(&std::fs::read(path)?)?;
        let (figures, details) = (json["figures"].as_object().context("has no `figures`")?, &json["details"]);
        let network = details["network"].as_str().context("is not of one network")?;
        let of = details["effect"].as_str().unwrap_or_default();
        ensure!(of == effect.name(), "is of a network for {of}, not for {effect}");
        let repeated: Vec<String> = figures.keys().map(|figure| of_network(network, figure)).collect();
        let figures = figures.iter().filter(|(name, _)| !repeated.contains(name));
        // Milliseconds say nothing without what they were taken on.
        let devices = details["devices"].as_object().into_iter().flatten();
        let devices = devices
            .filter_map(|(method, device)| Some((format!("device_{method}"), device.as_str()?.to_owned())));
        let worse =
            worse_than_nothing(details).map(|scenes| ("worse than doing nothing in".to_owned(), scenes));
        let figures = figures.map(|(name, value)| (name.clone(), rounded(value)));
        Ok(worse.into_iter().chain(devices).chain(figures).collect())
    };
    read().with_context(|| path.display().to_string())
}

/// The scenes in which the network is worse than doing nothing; none where there is no such scene.
fn worse_than_nothing(details: &Value) -> Option<String> {
    let scenes: Vec<&str> =
        details["scenes_below_trivial"].as_array()?.iter().filter_map(Value::as_str).collect();
    (!scenes.is_empty()).then(|| scenes.join(", "))
}

fn rounded(value: &Value) -> String {
    match value.as_f64() {
        Some(number) if number.fract() == 0.0 => format!("{number:.0}"),
        Some(number) => format!("{number:.4}"),
        None => value.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn scenes_are_named_by_where_they_are_from() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("dataset/recipes/ao-tiny.toml");
        let mut recipe = Recipe::load(&path).expect("a recipe");
        assert_eq!(scenes(&recipe), "room, still-life");
        recipe.files = vec!["a.obj".into(); 3];
        assert_eq!(scenes(&recipe), "2 of room, 2 of still-life, 3 files");
        recipe.families.clear();
        recipe.files.clear();
        recipe.captures = vec!["desk".into()];
        assert_eq!(scenes(&recipe), "1 capture");
    }

    #[test]
    fn figures_become_rows() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("eval.json");
        let written = |effect: &str| {
            let figures = json!({
                "ssim_learned": 0.71234567, "ssim_aov": 0.5, "frames": 200.0, "ssim_ao": 0.7, "ssim_ao_aov": 0.5,
            });
            let details = json!({ "network": "ao", "effect": effect, "devices": { "learned": "A card" },
                "scenes_below_trivial": ["cave:1", "a.glb (artists)"] });
            let text = json!({ "figures": figures, "details": details }).to_string();
            std::fs::write(&path, text).expect("written");
            metrics(&path, Effect::Ao)
        };
        let rows = written("ao").expect("reads");
        let expected = [
            ("worse than doing nothing in", "cave:1, a.glb (artists)"),
            ("device_learned", "A card"),
            ("frames", "200"),
            ("ssim_aov", "0.5000"),
            ("ssim_learned", "0.7123"),
        ];
        assert_eq!(rows, expected.map(|(name, value)| (name.to_owned(), value.to_owned())));
        let error = format!("{:#}", written("gi").expect_err("another's"));
        assert!(error.ends_with("eval.json: is of a network for gi, not for ao"), "{error}");
        std::fs::write(&path, r#"{"figures": {}}"#).expect("written");
        let error = format!("{:#}", metrics(&path, Effect::Ao).expect_err("of all"));
        assert!(error.ends_with("eval.json: is not of one network"), "{error}");
        std::fs::write(&path, "{}").expect("written");
        let error = metrics(&path, Effect::Ao).expect_err("no figures");
        assert!(format!("{error:#}").ends_with("eval.json: has no `figures`"), "{error:#}");
    }
}
