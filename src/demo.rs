//! `deepshade demo`: the whole chain. The shipped network beside its analytic rival and truth, on scenes of
//! families that it was not trained on; then data, a short training, export and a check of another one, on
//! the spot.

use crate::compare::{
    self, ComparedMethods, ComparedView, Comparison, ComparisonRun, ComparisonSettings, Digest, Head,
    MethodChoice,
};
use crate::figures::Figures;
use crate::location::Location;
use crate::methods;
use crate::radius::{self, Space};
use crate::report::Report;
use crate::report::folder::{self, DESCRIPTION, Folder};
use crate::report::record::FrameRecord;
use crate::views::{Choice, View, Viewpoint};
use anyhow::{Context, Result};
use deepshade_dataset::recipe::Resolution;
use deepshade_dataset::views::sample_view;
use deepshade_infer::Model;
use deepshade_render::bvh::TracedScene;
use deepshade_render::method::Repeats;
use deepshade_render::methods::Quality;
use deepshade_render::path::Goal;
use deepshade_render::scene::procedural::{Family, Split};
use deepshade_render::scene::{Camera, SceneSource};
use deepshade_shaders::gpu::Gpu;
use glam::Vec3;
use std::path::PathBuf;
use std::time::Instant;

/// The whole chain on scenes never seen in training: data, training, export, running, comparing.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade demo --out demo")]
pub struct Args {
    /// Folder of everything that the demo makes.
    #[arg(long, default_value = "target/demo")]
    out: PathBuf,
    /// Folder, address or name of the network.
    #[arg(long, default_value = "models/ao", value_parser = crate::learned::place)]
    model: Location,
    #[cfg(feature = "train")]
    /// The recipe that the short training's data are made from.
    #[arg(long, default_value = "dataset/recipes/ao-small.toml")]
    recipe: PathBuf,
    #[cfg(feature = "train")]
    /// Folder that the scene files of the recipe, and of its `test_recipes`, are relative to, where it is not
    /// the recipe's own.
    #[arg(long)]
    scenes: Option<PathBuf>,
    #[cfg(feature = "train")]
    /// How long the short training takes, minutes.
    #[arg(long, default_value_t = 2.0, value_parser = crate::train::minutes)]
    minutes: f64,
    /// Samples a pixel of truth, rounded up to a multiple of 8.
    #[arg(long, default_value_t = 512, value_parser = clap::value_parser!(u32).range(1..=65_536))]
    samples: u32,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
}

/// Chooses the scenes, which no recipe of the project contains.
const SEED: u32 = 20_170;

/// The network and its rivals that know only the screen: what a processor makes in seconds.
const METHODS: [&str; 3] = [methods::LEARNED, "gtao", "hbao"];

/// Goes through the chain and prints the table and the path of the page.
///
/// # Errors
/// If a part of the chain fails; it is named.
pub fn run(args: &Args) -> Result<()> {
    let start = Instant::now();
    folder::check(&args.out)?;
    let gpu = Gpu::new()?;
    let model = Model::load(&args.model.read()?)?;
    note!("1. {} beside gtao, hbao and truth, on scenes of families it was not trained on", args.model);
    let folder = Folder::open(&args.out)?;
    let report = compare_on_test_scenes(args, &gpu, &model, &folder)?;
    let page = report.write(&folder)?;
    let mut figures = Figures::new("demo");
    report.set_figures(&mut figures);
    #[cfg(feature = "train")]
    short_training::run(args, &gpu, &mut figures)?;
    figures.set("seconds", start.elapsed().as_secs_f64());
    figures.write(args.json.as_deref())?;
    say!("\n{report}{}", page.display())
}

/// One frame of each family that is for testing only.
fn compare_on_test_scenes(args: &Args, gpu: &Gpu, model: &Model, folder: &Folder) -> Result<Report> {
    let (effect, height) = (model.spec.effect, model.spec.reach.height);
    let methods = METHODS.map(MethodChoice::named).to_vec();
    let mut run = ComparisonRun {
        effects: Some(vec![effect]),
        methods: Some(methods),
        qualities: Some(vec![Quality::High]),
        model: Some(args.model.clone()),
        ..ComparisonRun::default()
    };
    let compared = ComparedMethods::open(&mut run, gpu)?;
    let machine = compare::machine(gpu);
    let maker = compare::maker(&machine)?;
    let families = || Family::ALL.into_iter().filter(|family| family.split() == Split::Test);
    let stages = families().map(|family| {
        let scene = TracedScene::new(family.scene(u64::from(SEED)))?;
        let camera = sample_view(&scene, [height, height], SEED, u64::from(SEED), 0)?;
        Ok((family, scene, camera))
    });
    let stages = stages.collect::<Result<Vec<_>>>()?;
    let cameras = stages.iter().map(|(family, _, camera)| (*family, camera));
    folder.write(DESCRIPTION, &description(&run, height, args.samples, cameras).to_toml(&folder.path)?)?;
    let mut frames = Vec::new();
    for (family, scene, camera) in stages {
        let view = View { name: family.name().to_owned(), camera };
        note!("   {}, {} triangles", view.name, scene.scene().triangle_count());
        let space = Space::seen(&scene, &view.camera, [height, height]);
        let settings = ComparisonSettings {
            effect,
            height,
            width: height,
            radius: radius::wanted(None, Some(model.spec.reach), &[effect], space),
            goal: Goal::samples(args.samples),
            seed: SEED,
            repeats: Repeats { warm_up: 1, timed: 3 },
        };
        let head = head(&maker, &view, settings, &compared, folder);
        let methods = compared.of(effect).collect();
        let subject = ComparedView { scene: &scene, view: &view, settings, methods, facts: Vec::new() };
        frames.push(compare::make(folder, &head, &subject, &|_| ()).with_context(|| view.name.clone())?);
    }
    Ok(Report { frames, quality: Quality::High.name().to_owned(), machine })
}

/// The comparison that the demo is, for those who would have it again with other methods or scenes.
fn description<'a>(
    run: &ComparisonRun,
    height: usize,
    samples: u32,
    cameras: impl Iterator<Item = (Family, &'a Camera)>,
) -> Comparison {
    let runs = cameras.map(|(family, camera)| {
        let target = camera.position + camera.rotation * Vec3::NEG_Z;
        ComparisonRun {
            scenes: Some(vec![SceneSource::Procedural(family, u64::from(SEED))]),
            views: Some(Choice::Stated(vec![Viewpoint::looking(camera.position, target)])),
            resolution: Some(Resolution { height, width: height }),
            samples: Some(samples),
            seed: Some(SEED),
            ..run.clone()
        }
    });
    Comparison { runs: runs.collect() }
}

/// What a frame is called, and what of it an earlier demo left.
fn head(
    maker: &str,
    view: &View,
    settings: ComparisonSettings,
    compared: &ComparedMethods,
    folder: &Folder,
) -> Head {
    let mut digest = Digest::default();
    digest.say(&(maker, &view.name, view.camera, settings));
    let (key, name) = (digest.finish(), view.name.clone());
    let folder_name = compare::folder_name(&name);
    let wanted: Vec<_> = compared.of(settings.effect).map(|one| compare::wanted(&key, one)).collect();
    let kept = FrameRecord::kept(&folder.path, &folder_name, &key, &wanted);
    Head { key, scene: name.clone(), view: name.clone(), name, folder: folder_name, wanted, kept }
}

/// A training run short enough to watch: from a recipe to a network that runs in WGSL.
#[cfg(feature = "train")]
mod short_training {
    use super::{Args, Figures, Gpu, Model, Repeats};
    use crate::learned::Learned;
    use crate::methods::LEARNED;
    use anyhow::{Result, ensure};
    use deepshade_dataset::{Dataset, Origin, Recipe, generate};
    use deepshade_infer::parity::Comparison as Agreement;
    use deepshade_infer::{forward, reference};
    use deepshade_render::method::{Frame, Method};
    use deepshade_render::metrics::ssim;
    use deepshade_shaders::Planes;
    use deepshade_train::TrainConfig;
    use std::path::PathBuf;

    /// Small steps, since two minutes have few.
    const BATCH: usize = 2;
    const CROP: usize = 128;

    pub fn run(args: &Args, gpu: &Gpu, figures: &mut Figures) -> Result<()> {
        note!("2. training data from {}", args.recipe.display());
        let recipe = match &args.scenes {
            Some(scenes) => Recipe::load_with_scenes(&args.recipe, scenes)?,
            None => Recipe::load(&args.recipe)?,
        };
        let folder = folder(args, &recipe)?;
        let [data, run, model] = ["data", "run", "model"].map(|name| folder.join(name));
        let summary = generate(&recipe, &data)?;
        note!("   {} pairs, {:.0} MB", summary.pairs, summary.bytes as f64 / 1e6);

        note!("3. training for {} minutes", args.minutes);
        let dataset = Dataset::open(&data)?;
        let config = TrainConfig {
            batch: BATCH,
            crop: CROP,
            validate_every: 100,
            ..crate::train::usual_config(dataset.recipe(), &data)?
        };
        let steps = crate::train::fitting_steps(&config, args.minutes)?;
        let config = TrainConfig { steps, ..config };
        // A run of an earlier demo would be resumed; the demo starts afresh.
        deepshade_train::discard(&run)?;
        let outcome = deepshade_train::train(&config, &run)?;
        note!("   {} steps, {:.1} images a second", outcome.progress.step, outcome.images_per_second);

        note!("4. export, and the exported network in WGSL and on the CPU against the reference");
        let facts = crate::export::facts(&config.spec, dataset.manifest(), Vec::new());
        let model: Model = deepshade_train::export(&run, &model, &facts)?;
        check(&dataset, gpu, &model, figures)
    }

    /// The folder of what a recipe gives: data of another recipe, or of another version of them, have one of
    /// their own.
    fn folder(args: &Args, recipe: &Recipe) -> Result<PathBuf> {
        let origin = Origin::new(recipe, &recipe.plan()?, &args.out)?;
        let stem = args.recipe.file_stem().unwrap_or_default().to_string_lossy();
        let version = format!("{}-{}", env!("CARGO_PKG_VERSION"), origin.data_version);
        Ok(args.out.join(format!("{stem}-{version}-{:.8}", origin.recipe_hash)))
    }

    /// Runs the network on a view held apart from its training.
    fn check(dataset: &Dataset, gpu: &Gpu, model: &Model, figures: &mut Figures) -> Result<()> {
        let index = dataset.validation()[0];
        let (pair, record) = (dataset.pair(index)?, dataset.record(index));
        let input = Learned::input(&model.spec, &pair.gbuffer, pair.radius)?;
        let mut expected = reference::forward(&model.spec, &model.weights, &input);
        model.spec.set_background(&pair.gbuffer, &mut expected)?;
        let scene = record.scene.load(&dataset.recipe().folder)?;
        let frame = Frame {
            scene: &scene,
            camera: &record.camera,
            gbuffer: &pair.gbuffer,
            radius: pair.radius,
            seed: 0,
        };
        let shaded = Learned::new(gpu, model)?.shade(&frame, Repeats::ONCE)?;
        let mut wgsl = forward::run(gpu, model, &input)?;
        model.spec.set_background(&pair.gbuffer, &mut wgsl)?;
        let mut max_abs = 0.0f32;
        for (form, image) in [(LEARNED, &shaded.image), ("WGSL", &wgsl)] {
            let agreement = Agreement::new(&expected, image);
            ensure!(agreement.agrees(), "{form} and the reference differ by {}", agreement.max_abs);
            max_abs = max_abs.max(agreement.max_abs);
        }
        let white = Planes::filled(expected.channels(), expected.height(), expected.width(), 1.0);
        let (learned, white) = (ssim(&shaded.image, &pair.target), ssim(&white, &pair.target));
        note!("   they differ by at most {max_abs:.1e}");
        note!("   on a view held apart: SSIM {learned:.3}, a white image {white:.3}");
        figures.set("short_training_ssim", learned);
        figures.set("short_training_ssim_white", white);
        figures.set("short_training_max_abs", f64::from(max_abs));
        Ok(())
    }
}
