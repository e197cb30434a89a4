//! `deepshade dataset`: makes, checks and shows training pairs, and makes test sets.

use crate::figures::Figures;
use crate::learned::{self, Learned};
use crate::location::Location;
use crate::methods::{self, LEARNED};
use anyhow::{Context, Result, bail};
use deepshade_dataset::progress::in_words;
use deepshade_dataset::target;
use deepshade_dataset::{
    Dataset, Recipe, Shard, Summary, TargetMethod, TestSet, contact_sheet, generate_by, generate_shard,
    merge, test_sheet, verify,
};
use deepshade_render::method::{Frame, Method, MethodError, Repeats, Shaded};
use deepshade_render::scene::Scene;
use deepshade_render::scene::procedural::Split;
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{Effect, lists};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// What to do with a dataset.
#[derive(clap::Subcommand)]
pub enum Verb {
    /// Makes the pairs of a recipe, or those that are still missing.
    Generate(Generate),
    /// Puts the shards of a dataset together.
    Merge(Merge),
    /// Checks every file of a dataset against its manifest.
    Verify(Verify),
    /// Draws every channel and the target of some pairs, or of some frames of a test set, into one picture.
    Show(Show),
    /// Makes a test set for `eval`: truth with many samples on a share of the tiles.
    Testset(Testset),
}

/// A recipe and where its scenes are.
#[derive(clap::Args)]
pub struct RecipeArgs {
    /// The recipe, a TOML file.
    recipe: PathBuf,
    /// Folder that the scene files of the recipe, and of its `test_recipes`, are relative to, where it is not
    /// the recipe's own.
    #[arg(long)]
    scenes: Option<PathBuf>,
}

impl RecipeArgs {
    fn load(&self) -> Result<Recipe> {
        Ok(match &self.scenes {
            Some(scenes) => Recipe::load_with_scenes(&self.recipe, scenes)?,
            None => Recipe::load(&self.recipe)?,
        })
    }
}

/// Makes the pairs of a recipe, or those that are still missing.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  deepshade dataset generate dataset/recipes/ao.toml --out data/ao\n  \
    deepshade dataset generate dataset/recipes/ao.toml --shard 2/5 --out data/ao-2\n\n\
    Shards may be made on any machines of one kind, in any order; `deepshade dataset merge` puts them together to the bytes \
    that one run makes.")]
pub struct Generate {
    #[command(flatten)]
    recipe: RecipeArgs,
    /// Folder of the dataset, or of the shard, or an address such as s3://bucket/ao.
    #[arg(long)]
    out: Location,
    /// Makes one part alone, such as 2/5: the second of five.
    #[arg(long)]
    shard: Option<Shard>,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
}

/// Puts the shards of a dataset together.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade dataset merge data/ao-1 data/ao-2 data/ao-3 --out data/ao\n\n\
    Every file is checked; a shard that is missing, unfinished, damaged or of other data is named. Interrupted, the same \
    command goes on.")]
pub struct Merge {
    /// Folders or addresses of all shards, in any order.
    #[arg(required = true)]
    shards: Vec<Location>,
    /// Folder or address of the dataset.
    #[arg(long)]
    out: Location,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
}

/// Checks every file of a dataset against its manifest.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade dataset verify data/ao")]
pub struct Verify {
    /// Folder or address of the dataset, or of a shard, which is checked against its own list.
    dataset: Location,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
}

/// Draws every channel and the target of some pairs, or of some frames of a test set, into one picture.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade dataset show data/ao --out sheet.png\n\n\
                  Frames of a test set are rendered again but for their truth, whose tiles are shown on black where the \
                  set holds no whole image.")]
pub struct Show {
    /// Folder or address of the dataset or of the test set.
    dataset: Location,
    /// Folder that the scene files of a test set are relative to, where it is not the one that the set says.
    #[arg(long)]
    scenes: Option<PathBuf>,
    /// The picture, a PNG file.
    #[arg(long, value_parser = crate::arguments::png_file)]
    out: PathBuf,
    /// How many pairs or frames, spread over all.
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u16).range(1..=64))]
    pairs: u16,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
}

/// Makes a test set for `eval`: truth with many samples on a share of the tiles.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  deepshade dataset testset dataset/recipes/ao-test.toml --out models/ao/testset\n  \
                  deepshade dataset testset dataset/recipes/ao-real.toml --scenes scenes --out testset\n\n\
                  The recipe is one with `split = \"test\"` and a table `tiles`."
)]
pub struct Testset {
    #[command(flatten)]
    recipe: RecipeArgs,
    /// Folder or address of the test set.
    #[arg(long)]
    out: Location,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
}

/// Does it.
///
/// # Errors
/// If the recipe or a file is at fault, or a dataset does not pass its check.
pub fn run(verb: &Verb) -> Result<()> {
    match verb {
        Verb::Generate(args) => generate_pairs(args),
        Verb::Merge(args) => merge_places(&args.shards, &args.out, args.json.as_deref()),
        Verb::Verify(args) => verify_pairs(args),
        Verb::Show(args) => show_pairs(args),
        Verb::Testset(args) => make_testset(args),
    }
}

/// The method whose images a recipe aims at, as good as it gets; `None` where that is truth.
fn target_method(recipe: &Recipe) -> Result<Option<Box<dyn Method + Sync>>> {
    let Some(name) = &recipe.target else { return Ok(None) };
    let open = || -> Result<Box<dyn Method + Sync>> {
        let gpu = Gpu::new()?;
        if name == LEARNED {
            let model = learned::network(&learned::usual_folder(recipe.effect), Some(recipe.effect))?;
            return Ok(Box::new(OneAtATime(Mutex::new(Learned::new(&gpu, &model)?))));
        }
        Ok(Box::new(methods::open_screen(recipe.effect, name, &gpu, target::QUALITY)?))
    };
    open().with_context(|| format!("`target` of recipe {}", recipe.path.display())).map(Some)
}

/// A network for several threads, of which one at a time runs it.
struct OneAtATime(Mutex<Learned>);

impl Method for OneAtATime {
    fn name(&self) -> &'static str {
        LEARNED
    }

    fn effect(&self) -> Effect {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).effect()
    }

    fn shade(&self, frame: &Frame<'_>, repeats: Repeats) -> Result<Shaded, MethodError> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).shade(frame, repeats)
    }
}

/// Makes the pairs of a recipe, or of one of its shards, at a place.
///
/// # Errors
/// If the recipe or a scene is at fault, or the place is in use, holds other data or cannot be written.
pub fn made(recipe: &Recipe, location: &Location, shard: Option<Shard>) -> Result<Summary> {
    let method = target_method(recipe)?;
    let method = method.as_deref().map(|method| method as TargetMethod<'_>);
    let out = location.begin()?;
    let summary = match shard {
        Some(shard) => generate_shard(recipe, out.out(), method, shard)?,
        None => generate_by(recipe, out.out(), method)?,
    };
    out.finish()?;
    Ok(summary)
}

/// Says what of a recipe's scene files is passed over, before hours go by on them.
///
/// # Errors
/// If a file is missing or damaged.
pub fn warn_of_files(recipe: &Recipe) -> Result<()> {
    for file in &recipe.files {
        let scene = Scene::load(&recipe.folder.join(file), 0.0)?;
        scene.warnings.iter().for_each(|warning| note!("{warning}"));
    }
    Ok(())
}

fn generate_pairs(args: &Generate) -> Result<()> {
    let recipe = args.recipe.load()?;
    // Pairs to test with, or for others to train with, may all be of one part.
    if recipe.split == Split::Train && recipe.validation_share == 0.0 {
        note!(
            "{}: `validation_share` is 0, so that no pair is held apart: `deepshade train` will refuse these data",
            recipe.path.display()
        );
    }
    warn_of_files(&recipe)?;
    let start = Instant::now();
    let summary = made(&recipe, &args.out, args.shard)?;
    let seconds = start.elapsed().as_secs_f64();
    let mut figures = Figures::new("dataset generate");
    figures.set("pairs", summary.pairs as f64);
    figures.set("rendered", summary.rendered as f64);
    figures.set("bytes", summary.bytes as f64);
    figures.set("seconds", seconds);
    figures.detail("recipe", json!(args.recipe.recipe));
    figures.write(args.json.as_deref())?;
    say!(
        "{} pairs in {}, {} of them rendered now in {seconds:.0} s, {:.1} MB",
        summary.pairs,
        args.out,
        summary.rendered,
        summary.bytes as f64 / 1e6
    )
}

/// Puts the shards of a dataset together.
///
/// # Errors
/// If one is missing, unfinished, damaged or of other data, or a place cannot be read or written.
pub fn merge_places(shards: &[Location], out: &Location, json: Option<&Path>) -> Result<()> {
    let folders = shards.iter().map(Location::read).collect::<Result<Vec<_>>>()?;
    let work = out.begin()?;
    let pairs = merge(&folders, work.out())?;
    work.finish()?;
    let mut figures = Figures::new("dataset merge");
    figures.set("pairs", pairs as f64);
    figures.set("shards", shards.len() as f64);
    figures.write(json)?;
    say!("{pairs} pairs of {} shards in {out}", shards.len())
}

fn verify_pairs(args: &Verify) -> Result<()> {
    let report = verify(&args.dataset.read()?)?;
    let mut figures = Figures::new("dataset verify");
    figures.set("pairs", report.pairs as f64);
    figures.set("faults", report.faults.len() as f64);
    figures.detail("faults", serde_json::to_value(&report.faults).context("faults as JSON")?);
    figures.write(args.json.as_deref())?;
    if report.faults.is_empty() {
        return say!("{}: {} pairs, all sound", args.dataset, report.pairs);
    }
    // Whether anybody reads them or not, faults make the check fail.
    let _ = report.faults.iter().try_for_each(|fault| say!("{}: {}", fault.file, fault.what));
    bail!("{}: {} of {} pairs or files at fault", args.dataset, report.faults.len(), report.pairs)
}

fn show_pairs(args: &Show) -> Result<()> {
    let wanted = args.pairs.into();
    let folder = args.dataset.read()?;
    let (pairs, shown) = if TestSet::is_in(&folder) {
        let set = TestSet::open(&folder)?;
        let set = args.scenes.iter().fold(set, |set, folder| set.with_scenes(folder));
        let frames = lists::spread(set.frames().len(), wanted);
        test_sheet(&set, &frames, &args.out)?;
        (set.frames().len(), frames.len())
    } else {
        let dataset = Dataset::open(&folder)?;
        let pairs = lists::spread(dataset.len(), wanted);
        contact_sheet(&dataset, &pairs, &args.out)?;
        (dataset.len(), pairs.len())
    };
    let mut figures = Figures::new("dataset show");
    figures.set("pairs", pairs as f64);
    figures.set("shown", shown as f64);
    figures.write(args.json.as_deref())?;
    say!("{}", args.out.display())
}

fn make_testset(args: &Testset) -> Result<()> {
    let recipe = args.recipe.load()?;
    warn_of_files(&recipe)?;
    // A method's images take next to no time.
    let expected = match recipe.target {
        Some(_) => Duration::ZERO,
        None => TestSet::estimate(&recipe)?,
    };
    note!("{} will take about {} from nothing", args.out, in_words(expected));
    let start = Instant::now();
    let method = target_method(&recipe)?;
    let out = args.out.begin()?;
    let set =
        TestSet::generate_by(&recipe, out.out(), method.as_deref().map(|method| method as TargetMethod<'_>))?;
    out.finish()?;
    let taken = start.elapsed();
    let hours = |duration: Duration| duration.as_secs_f64() / 3600.0;
    let mut figures = Figures::new("dataset testset");
    figures.set("frames", set.frames().len() as f64);
    figures.set("hours", hours(taken));
    figures.set("hours_expected", hours(expected));
    figures.detail("recipe", json!(args.recipe.recipe));
    figures.write(args.json.as_deref())?;
    say!("{} frames in {}, made in {}", set.frames().len(), args.out, in_words(taken))
}
