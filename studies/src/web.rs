//! `deepshade-studies web`: what the page shows where a browser has no WebGPU, made on this machine by the
//! same code. With it the values that the browser's images are held against.

use anyhow::{Context, Result};
use clap::builder::RangedU64ValueParser;
use deepshade::shared::figures::{machine, write_atomically};
use deepshade::shared::learned;
use deepshade::shared::methods::{LEARNED, TRUTH};
use deepshade::shared::pictures::{Exposure, write_png};
use deepshade::shared::web::{PageRequest, ShownScene, TracedView, scores};
use deepshade_infer::Model;
use deepshade_render::path::estimate::SCRAMBLINGS;
use deepshade_render::scene::SceneSource;
use deepshade_render::scene::procedural::Family;
use deepshade_shaders::gpu::{self, Gpu};
use deepshade_shaders::{Effect, Planes};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// What the page begins with, and what is recorded. Networks are shown on families that they were not trained
/// on.
const RECORDED: [Recorded; 7] = [
    Recorded::new(Effect::Ao, &["hbao", LEARNED], Family::Playground, 3, 2),
    Recorded::new(Effect::Do, &["ssdo", LEARNED], Family::Drapery, 2, 2),
    Recorded::new(Effect::Gi, &["ssgi", "lpv"], Family::StillLife, 1, 2),
    Recorded::new(Effect::Dof, &["ring-gather", LEARNED], Family::Drapery, 2, 2),
    Recorded::new(Effect::Sss, &["separable", LEARNED], Family::Drapery, 2, 1),
    Recorded::new(Effect::FogDirect, &["gpu-march", "froxel"], Family::Colonnade, 5, 1),
    Recorded { fog: Some(0.1), ..Recorded::new(Effect::Path, &["composed"], Family::Colonnade, 1, 3) },
];

/// A comparison that is recorded: an effect by two methods, or by one beside truth.
#[derive(Clone, Copy)]
struct Recorded {
    effect: Effect,
    methods: &'static [&'static str],
    family: Family,
    seed: u64,
    view: usize,
    /// Extinction, per metre.
    fog: Option<f64>,
}

/// Records what the web page shows where a browser has no WebGPU; `cargo xtask web` calls this.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade-studies web --out target/recorded")]
pub struct Args {
    /// The folder; `recorded.json` in it lists the pictures.
    #[arg(long)]
    out: PathBuf,
    /// Folder of the trained networks, one folder an effect.
    #[arg(long, default_value = "models")]
    models: PathBuf,
    /// Rows and columns of the images.
    #[arg(long, default_value_t = 384, value_parser = RangedU64ValueParser::<usize>::new().range(16..=2048))]
    size: usize,
    /// Samples of a pixel of truth; 0 leaves it out.
    #[arg(long, default_value_t = 256, value_parser = clap::value_parser!(u32).range(0..=65_536))]
    samples: u32,
    /// Only the comparison of this effect.
    #[arg(long)]
    only: Option<Effect>,
    /// Writes the images' values, too, as 32-bit floats: `[channels, height, width]`, least significant byte
    /// first.
    #[arg(long)]
    values: bool,
}

/// Runs the verb.
///
/// # Errors
/// If there is no device, a network cannot be read, or a file not be written.
pub fn run(args: &Args) -> Result<()> {
    let gpu = Gpu::new()?;
    let wanted = RECORDED.iter().filter(|one| args.only.is_none_or(|only| only == one.effect));
    let mut recorded = Vec::new();
    for one in wanted {
        let Recorded { effect, methods, .. } = one;
        let wish = one.request(args.size);
        note!("{effect} of {}: {}", wish.scene, methods.join(", "));
        recorded.push(record(args, &gpu, &wish).with_context(|| format!("{effect} of {}", wish.scene))?);
    }
    let list = json!({ "recorded": recorded, "device": gpu.info.name, "machine": machine() });
    let list = serde_json::to_string_pretty(&list)?;
    write_atomically(&args.out.join("recorded.json"), list.as_bytes())?;
    say!("{} comparisons in {}", recorded.len(), args.out.display())
}

impl Recorded {
    const fn new(
        effect: Effect,
        methods: &'static [&'static str],
        family: Family,
        seed: u64,
        view: usize,
    ) -> Self {
        Self { effect, methods, family, seed, view, fog: None }
    }

    /// What the page is asked for, of a square image.
    fn request(&self, size: usize) -> PageRequest {
        PageRequest {
            scene: SceneSource::Procedural(self.family, self.seed),
            view: self.view,
            effect: self.effect,
            methods: self.methods.iter().map(|name| (*name).to_owned()).collect(),
            size: [size; 2],
            fog: self.fog,
        }
    }
}

fn record(args: &Args, gpu: &Gpu, wish: &PageRequest) -> Result<Value> {
    let effect = wish.effect;
    let learned = wish.methods.iter().any(|name| name == LEARNED);
    let model = learned.then(|| learned::network(&args.models.join(effect.name()), Some(effect)));
    let model: Option<Model> = model.transpose()?;
    let mut shown_scene = ShownScene::new(gpu, wish, model.as_ref())?;
    let camera = shown_scene.animated_view.camera;
    let mut times = None;
    // What is compiled in the first frame is no part of a frame, and a clock tells of frames before.
    let frames = if shown_scene.live.tells_later() { 8 } else { 2 };
    for _ in 0..frames {
        times = gpu::wait(shown_scene.make(0.0, &camera))??.or(times);
    }
    let passes = shown_scene.live.passes();
    let images = (0..shown_scene.names.len())
        .map(|index| Ok((shown_scene.names[index], shown_scene.live.image(index)?)));
    let mut images: Vec<(&str, Planes)> = images.collect::<Result<_>>()?;
    let truth = (args.samples > 0).then(|| {
        let traced_view = TracedView::new(wish, &shown_scene.animated_view, 0.0, shown_scene.radius)?;
        Ok::<_, anyhow::Error>(traced_view.refine(&camera, None, args.samples.div_ceil(SCRAMBLINGS)).0)
    });
    let truth = truth.transpose()?;
    let exposure = Exposure::new(effect, &images[0].1, None);
    let of_images = truth.as_ref().map(|truth| {
        let of_images = images
            .iter()
            .map(|(name, image)| ((*name).to_owned(), json!(scores(effect, image, &truth.mean))));
        of_images.collect::<serde_json::Map<_, _>>()
    });
    images.extend(truth.as_ref().map(|truth| (TRUTH, truth.mean.clone())));
    let files = images.iter().map(|(name, image)| {
        let file = format!("{effect}-{name}");
        write_png(&args.out.join(format!("{file}.png")), &exposure.picture(image, None))?;
        if args.values {
            write_values(&args.out.join(format!("{file}.f32")), image)?;
        }
        Ok(((*name).to_owned(), json!(file)))
    });
    let files = files.collect::<Result<serde_json::Map<_, _>>>()?;
    Ok(json!({
        "wish": wish,
        "files": files,
        "scores": of_images,
        "samples": truth.map(|truth| truth.samples),
        "passes": passes,
        "milliseconds": times,
        "exposure": exposure.to_string(),
        "added": shown_scene.animated_view.added,
    }))
}

fn write_values(path: &Path, image: &Planes) -> Result<()> {
    let bytes: Vec<u8> = image.data().iter().flat_map(|value| value.to_le_bytes()).collect();
    write_atomically(path, &bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade::shared::methods::screen_names;
    use deepshade_render::scene::procedural::Split;
    use deepshade_shaders::effect::EffectSetting;

    fn models() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../models")
    }

    #[test]
    fn what_is_recorded_is_there_and_networks_are_shown_on_families_of_tests() {
        for Recorded { effect, methods, family, fog, .. } in RECORDED {
            assert!(fog.is_none() || effect.listens_to(EffectSetting::Medium), "fog is nothing to {effect}");
            let screen = screen_names(effect);
            for name in methods {
                assert!(*name == LEARNED || screen.contains(name), "{effect} has no {name}");
            }
            let model = models().join(effect.name());
            let learned = methods.contains(&LEARNED);
            assert!(!learned || learned::is_network(&model), "{effect} has no network");
            assert!(!learned || family.split() == Split::Test, "{} trained the network", family.name());
        }
    }

    #[test]
    fn a_comparison_is_recorded_with_figures_and_values() {
        let folder = tempfile::tempdir().expect("a folder");
        let args = Args {
            out: folder.path().to_owned(),
            models: models(),
            size: 40,
            samples: 8,
            only: Some(Effect::Ao),
            values: true,
        };
        run(&args).expect("recorded");
        let list = std::fs::read(folder.path().join("recorded.json")).expect("a list");
        let list: Value = serde_json::from_slice(&list).expect("JSON");
        let one = &list["recorded"][0];
        assert_eq!((&one["wish"]["effect"], &one["samples"]), (&json!("ao"), &json!(8)));
        for name in ["hbao", LEARNED] {
            let ssim = one["scores"][name]["ssim"].as_f64().expect("a score");
            assert!(ssim > 0.2 && ssim < 1.0, "{name}: {ssim}");
            let values = std::fs::read(folder.path().join(format!("ao-{name}.f32"))).expect("values");
            assert_eq!(values.len(), 40 * 40 * 4);
            assert!(folder.path().join(format!("ao-{name}.png")).is_file());
        }
    }
}
