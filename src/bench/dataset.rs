//! `deepshade bench dataset`: training pairs an hour and a core for each effect's recipe, and where the time
//! goes; and views an hour of a stream with all cores.
//!
//! Everything else runs on one thread. Of truth, which takes the time, a seeded share of the tiles is
//! rendered and the time is scaled; rays are timed in a second run of the same, since the stopwatch around
//! them slows it down.

use crate::figures::Figures;
use anyhow::{Context, Result, ensure};
use deepshade_dataset::plan::PlannedScene;
use deepshade_dataset::recipe::Resolution;
use deepshade_dataset::stopwatch::prepared_and_sampled;
use deepshade_dataset::testset::{in_tiles, tile_indices};
use deepshade_dataset::{Props, Recipe, StagedScene, Stream, progress, truth};
use deepshade_render::bvh::clock;
use deepshade_render::exr_file::{self, Layer, Metadata};
use deepshade_render::path::{Sampling, Shot, render};
use deepshade_shaders::{Effect, lists};
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Training pairs an hour and a core for each effect's recipe, and what share of the time is what.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade bench dataset --json dataset.json")]
pub struct Args {
    /// Folder of the recipes, one `<effect>.toml` an effect.
    #[arg(long, default_value = "dataset/recipes")]
    recipes: PathBuf,
    /// Which effects; all by default.
    #[arg(long, value_delimiter = ',')]
    effects: Vec<Effect>,
    /// Pairs of each recipe, of scenes spread over it.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pairs: u16,
    /// One tile of truth in so many is rendered.
    #[arg(long, default_value_t = 32, value_parser = clap::value_parser!(u16).range(1..=64))]
    one_in: u16,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
}

/// Seconds that a pair takes.
#[derive(Clone, Copy, Default)]
struct Seconds {
    /// The pair's part of making or reading its scene, choosing the view, and giving the scene its look.
    scene: f64,
    /// What rays meet, of truth and g-buffer.
    rays: f64,
    /// What comes of it.
    shading: f64,
    /// Compressing the file.
    exr: f64,
}

impl Seconds {
    fn total(self) -> f64 {
        self.scene + self.rays + self.shading + self.exr
    }

    /// Its parts by name.
    fn parts(self) -> [(&'static str, f64); 4] {
        [("scene", self.scene), ("rays", self.rays), ("shading", self.shading), ("exr", self.exr)]
    }
}

/// Measures and prints.
///
/// # Errors
/// If a recipe or one of its scenes cannot be had, or a pair cannot be encoded.
pub fn run(args: &Args) -> Result<()> {
    let effects = if args.effects.is_empty() { Effect::ALL.to_vec() } else { args.effects.clone() };
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().context("a thread")?;
    let bar = progress::bar("effects", effects.len(), 0);
    let mut figures = Figures::new("bench dataset");
    let mut rows = Vec::new();
    for effect in effects {
        bar.set_message(effect.name());
        let path = args.recipes.join(format!("{effect}.toml"));
        let seconds = one_thread.install(|| measured(&path, args))?;
        let id = effect.name().replace('-', "_");
        figures.set(&format!("pairs_per_hour_core_{id}"), 3600.0 / seconds.total());
        for (part, time) in seconds.parts() {
            figures.set(&format!("share_{part}_{id}"), time / seconds.total());
        }
        rows.push((effect, seconds));
        bar.inc(1);
    }
    bar.finish_and_clear();
    let streamed = rows.iter().any(|(effect, _)| *effect == STREAMED).then(|| streamed(&args.recipes));
    let streamed = streamed.transpose()?;
    if let Some(views) = streamed {
        figures.set("views_per_hour_stream", views);
    }
    figures.write(args.json.as_deref())?;
    if let Some(views) = streamed {
        say!(
            "{views:.0} views of a stream an hour: {STREAMED}, {EDGE}x{EDGE}, {SAMPLES} samples, all cores"
        )?;
    }
    say!("pairs an hour and a core, medians of {}; shares of the time", args.pairs)?;
    say!("{:<13} {:>8}  {:>6} {:>6} {:>8} {:>6}", "effect", "pairs/h", "scene", "rays", "shading", "EXR")?;
    rows.into_iter().try_for_each(|(effect, seconds)| {
        let [scene, rays, shading, exr] =
            seconds.parts().map(|(_, time)| format!("{:.0} %", 100.0 * time / seconds.total()));
        let pairs = 3600.0 / seconds.total();
        say!("{:<13} {pairs:>8.1}  {scene:>6} {rays:>6} {shading:>8} {exr:>6}", effect.name())
    })
}

/// The effect whose recipe's stream is timed, with images and samples of these.
const STREAMED: Effect = Effect::Ao;
const EDGE: usize = 256;
const SAMPLES: u32 = 8;
/// Rounds of its families that are timed.
const ROUNDS: usize = 2;

/// Views an hour of the stream of a recipe in a folder, that nobody keeps waiting.
fn streamed(recipes: &Path) -> Result<f64> {
    let mut recipe = Recipe::load(&recipes.join(format!("{STREAMED}.toml")))?;
    recipe.resolution = Resolution { height: EDGE, width: EDGE };
    (recipe.smallest, recipe.samples) = (None, SAMPLES);
    recipe.families.iter_mut().for_each(|family| family.scenes = 1);
    let views = ROUNDS * recipe.families.len() * recipe.views_per_scene;
    let start = Instant::now();
    let stream = Stream::start(&recipe, 0, views)?;
    (0..views).try_for_each(|number| stream.pair(number).map(drop))?;
    Ok(3600.0 * views as f64 / start.elapsed().as_secs_f64())
}

/// Medians over some pairs of a recipe.
fn measured(path: &Path, args: &Args) -> Result<Seconds> {
    let recipe = Recipe::load(path)?;
    let props = Props::load(&recipe)?;
    let plan = recipe.plan()?;
    let scenes = lists::spread(plan.len(), args.pairs.into());
    ensure!(!scenes.is_empty(), "{} has no scene", path.display());
    let pairs: Vec<Seconds> =
        scenes.into_iter().map(|scene| pair(&recipe, &props, &plan[scene], args)).collect::<Result<_>>()?;
    let median = |part: fn(&Seconds) -> f64| lists::median(pairs.iter().map(part).collect());
    Ok(Seconds {
        scene: median(|pair| pair.scene),
        rays: median(|pair| pair.rays),
        shading: median(|pair| pair.shading),
        exr: median(|pair| pair.exr),
    })
}

/// Times the making of a scene's first pair.
fn pair(recipe: &Recipe, props: &Props, scene: &PlannedScene, args: &Args) -> Result<Seconds> {
    let view = &scene.views[0];
    let size @ [height, width] = recipe.size(view.seed);
    let start = Instant::now();
    let staged = StagedScene::load(&scene.scene, recipe, props)?;
    let loading = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let (camera, variation) = staged.drawn(scene.key, view)?;
    let shown = staged.shown(&camera, variation.as_ref())?;
    let staging = start.elapsed().as_secs_f64();

    let tiles = tile_indices(view.seed, height, width, args.one_in.into());
    let in_tiles = in_tiles(&tiles, width);
    let share = (0..height * width).filter(|pixel| in_tiles(pixel % width, pixel / width)).count() as f64
        / (height * width) as f64;
    let radius = staged.radius(&camera, view.seed);
    let shot = Shot::new(&shown, &camera, size, radius);
    let render_gbuffer = || staged.gbuffer(&shown, &camera, view.seed);
    let drawn = twice(&mut || drop(black_box(render_gbuffer())));
    let [prepared, sampled] =
        prepared_and_sampled(recipe.effect, &shot, (recipe.samples, view.seed), &in_tiles, twice);
    let whole = |part: fn(&Timed) -> f64| part(&drawn) + part(&prepared) + part(&sampled) / share;
    let time = whole(|timed| timed.all);
    let rays = whole(|timed| timed.rays).min(time);

    let gbuffer = truth::light_within_half(render_gbuffer());
    // As noisy as the truth is, which makes it as large.
    let target = truth::within_half(render(recipe.effect, &shot, Sampling::one(1, view.seed)).mean);
    let start = Instant::now();
    let layers = [Layer::gbuffer(&gbuffer), Layer::image("target", &target)];
    black_box(exr_file::encode(Path::new("pair.exr"), &layers, &Metadata::new())?);
    let exr = start.elapsed().as_secs_f64();
    let scene = loading / recipe.views_per_scene as f64 + staging;
    Ok(Seconds { scene, rays, shading: time - rays, exr })
}

/// Seconds of some work.
#[derive(Clone, Copy, Debug)]
struct Timed {
    all: f64,
    /// Of its rays, in a second run.
    rays: f64,
}

/// Runs some work twice.
fn twice(work: &mut dyn FnMut()) -> Timed {
    let start = Instant::now();
    work();
    let all = start.elapsed().as_secs_f64();
    let ((), rays) = clock::timed(work);
    Timed { all, rays: rays.time.as_secs_f64() }
}
