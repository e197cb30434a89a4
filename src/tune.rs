//! `deepshade tune`: hbao's parameters, chosen on the validation views of a dataset, so that it meets the network on
//! equal terms.

use crate::figures::Figures;
use crate::place::Place;
use anyhow::{Context, Result, ensure};
use deepshade_dataset::{Dataset, Props, SceneRecord, StagedScene, progress, truth};
use deepshade_render::bvh::TracedScene;
use deepshade_render::gbuffer;
use deepshade_render::method::{Frame, Method, Repeats};
use deepshade_render::methods::hbao::{Hbao, Parameters};
use deepshade_render::metrics::ssim;
use deepshade_render::scene::Camera;
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{Effect, GBuffer, Planes, lists};
use serde_json::json;
use std::path::PathBuf;
use std::rc::Rc;
use std::sync::Arc;

/// Tunes hbao's parameters on the validation views of a dataset.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade tune --dataset data/ao --frames 12 --json tune.json\n\n\
    It tries scales of the radius, strengths, biases and sharpnesses of the blur, and changes nothing: what it finds goes \
    into `Parameters::default` in render/src/methods/hbao/mod.rs, which `compare` and `eval` run.")]
pub struct Args {
    /// Folder or address of the dataset.
    #[arg(long)]
    dataset: Place,
    /// Folder that the recipe's scene files are relative to, where it is not the one that the dataset remembers.
    #[arg(long)]
    scenes: Option<PathBuf>,
    /// How many validation views, spread over all of them.
    #[arg(long, default_value_t = 12, value_parser = clap::value_parser!(u16).range(1..=1000))]
    frames: u16,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
}

/// A validation view with its truth.
struct View {
    /// Views of a scene share it where nothing varies.
    scene: Arc<TracedScene>,
    camera: Camera,
    gbuffer: GBuffer,
    target: Planes,
    radius: f32,
}

impl View {
    /// The views of some pairs, with the g-buffer in full precision, as methods get it.
    fn open(dataset: &Dataset, props: &Props, pairs: &[usize]) -> Result<Vec<Self>> {
        let attributes = truth::attributes(dataset.recipe().effect);
        // Pairs of a scene follow each other.
        let mut current: Option<(&SceneRecord, Rc<StagedScene<'_>>)> = None;
        let view = |index: &usize| {
            let record = dataset.record(*index);
            let staged = match &current {
                Some((source, scene)) if **source == record.scene => Rc::clone(scene),
                _ => {
                    let scene = StagedScene::load(&record.scene, dataset.recipe(), props);
                    Rc::new(scene.context("--scenes says where scene files are")?)
                }
            };
            current = Some((&record.scene, Rc::clone(&staged)));
            let scene = staged.shown(&record.camera, record.variation.as_ref())?;
            let target = dataset.pair(*index)?.target;
            let (height, width) = (target.height(), target.width());
            let gbuffer = gbuffer::render(&scene, &record.camera, height, width, attributes);
            Ok(Self { scene, camera: record.camera, gbuffer, target, radius: record.radius })
        };
        pairs.iter().map(view).collect()
    }
}

/// A parameter that is tuned: its name, the values tried, and where it goes.
type Axis = (&'static str, &'static [f32], fn(&mut Parameters) -> &mut f32);

/// Coordinate descent goes along these in turn.
const AXES: [Axis; 4] = [
    ("radius_scale", &[0.7, 0.85, 1.0, 1.2, 1.4, 1.7, 2.0], |p| &mut p.radius_scale),
    ("strength", &[0.6, 0.75, 0.9, 1.0, 1.15, 1.3, 1.5, 1.75], |p| &mut p.strength),
    ("bias", &[0.0, 0.03, 0.06, 0.1, 0.15, 0.2, 0.3], |p| &mut p.bias),
    ("blur_sharpness", &[16.0, 32.0, 64.0, 128.0, 256.0, 512.0, 1024.0], |p| &mut p.blur_sharpness),
];

/// Rounds over all axes.
const ROUNDS: usize = 2;

/// Tunes and prints.
///
/// # Errors
/// If the dataset is for another effect or has no validation views, or the GPU fails.
pub fn run(args: &Args) -> Result<()> {
    let folder = args.dataset.read()?;
    let dataset = Dataset::open(&folder)?;
    let dataset = match &args.scenes {
        Some(scenes) => dataset.with_scenes(scenes),
        None => dataset,
    };
    let effect = dataset.recipe().effect;
    ensure!(effect == Effect::Ao, "{} is for {effect}; hbao computes {}", args.dataset, Effect::Ao);
    let held_apart = dataset.validation();
    ensure!(
        !held_apart.is_empty(),
        "{} has no validation views; its recipe's `validation_share` says how many are held apart",
        args.dataset
    );
    let chosen = lists::spread(held_apart.len(), args.frames.into());
    let chosen: Vec<usize> = chosen.into_iter().map(|index| held_apart[index]).collect();
    let props = dataset.props().context("--scenes says where files are")?;
    let views = View::open(&dataset, &props, &chosen)?;
    let gpu = Gpu::new()?;
    let hbao = Hbao::new(&gpu, Parameters::default())?;
    let mut best = Parameters::default();
    let before = mean_ssim(&hbao.with(best), &views)?;
    let mut best_ssim = before;
    let bar = progress::bar("settings", ROUNDS * AXES.iter().map(|axis| axis.1.len()).sum::<usize>(), 0);
    for _ in 0..ROUNDS {
        for (name, values, field) in AXES {
            for value in values {
                let mut tried = best;
                *field(&mut tried) = *value;
                let ssim = mean_ssim(&hbao.with(tried), &views)?;
                bar.set_message(format!("{name} {value}: ssim {ssim:.4}"));
                bar.inc(1);
                if ssim > best_ssim {
                    (best, best_ssim) = (tried, ssim);
                }
            }
        }
    }
    bar.finish_and_clear();
    let mut figures = Figures::new("tune");
    figures.set("ssim_default", before);
    figures.set("ssim_tuned", best_ssim);
    for (name, _, field) in AXES {
        figures.set(name, f64::from(*field(&mut best)));
    }
    figures.detail("frames", json!(views.len()));
    figures.write(args.json.as_deref())?;
    let count = views.len();
    say!("hbao on {count} validation views: ssim {before:.4} by default, {best_ssim:.4} with {best:?}")
}

/// Mean structural similarity of a method to truth.
fn mean_ssim(method: &dyn Method, views: &[View]) -> Result<f64> {
    let mut sum = 0.0;
    for view in views {
        let View { scene, camera, gbuffer, target, radius } = view;
        let frame = Frame { scene, camera, gbuffer, radius: *radius, seed: 0 };
        sum += ssim(&method.shade(&frame, Repeats::ONCE)?.image, target);
    }
    Ok(sum / views.len() as f64)
}
