//! Bevy's own ambient occlusion and a network's beside path-traced truth of the same frames, and how far the
//! network's passes inside Bevy are from deepshade's own image of the frame. The same of depth of field,
//! beside what a lens shows.
//!
//! `cargo run --example measure -- --program target/release/deepshade --json figures.json --out pictures`
//!
//! `--program` is deepshade's program, which makes its own image of Bevy's g-buffer. `--scene` is a family
//! and a seed or a glTF file, with the camera's place and what it looks at: `hall.gltf@-9,1.6,0,0,1.2,0`. It
//! may be given several times. Without `--json` the figures are printed alone, without `--out` no pictures
//! are written.

#[allow(dead_code, reason = "the tests use the rest of it")]
#[path = "../tests/support/mod.rs"]
mod support;

#[path = "measure/depth_of_field.rs"]
mod depth_of_field;

use bevy::math::Vec3;
use bevy::pbr::{ScreenSpaceAmbientOcclusion, ScreenSpaceAmbientOcclusionQualityLevel as BevysQuality};
use bevy::render::camera::TemporalJitter;
use deepshade_bevy::{LearnedAmbientOcclusion, Quality};
use deepshade_render::scene::SceneSource;
use deepshade_shaders::{Effect, Planes};
use std::collections::BTreeMap;
use std::error::Error;
use std::path::{Path, PathBuf};
use support::frame::{Frame, View, differences, scores};
use support::headless::Headless;
use support::own::Program;
use support::{clock, pictures};

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// Scenes of families that no network was trained on, each of some metres, with a view.
const SCENES: [(&str, View); 4] = [
    ("playground:1", [[2.4, 1.5, 2.6], [-0.3, 0.6, 0.0]]),
    ("drapery:1", [[1.3, 1.4, 1.9], [-0.2, 0.7, -0.9]]),
    ("cave:1", [[0.2, 0.2, 0.2], [2.0, -0.4, 1.0]]),
    ("bridge:1", [[2.5, 1.6, 3.0], [0.0, 0.2, 0.0]]),
];
/// Rows and columns that suit a software adapter.
const SIZE: [usize; 2] = [192, 256];
/// The radius that Bevy's occlusion has by default, half of XeGTAO's 0.5 times 1.457, which its passes are
/// made for: they average depths with it whatever the radius is.
const RADIUS: f32 = 0.5 * 1.457;
/// Samples of a pixel of truth.
const SAMPLES: u32 = 512;
/// Frames whose mean stands for temporal anti-aliasing, which Bevy wants with its occlusion: as many as its
/// noise has before it comes again.
const FRAMES: usize = 64;

/// As many samples as its bitmask has bits for, where levels of quality have at most three a side.
const MANY_SAMPLES: BevysQuality = BevysQuality::Custom { slice_count: 9, samples_per_slice_side: 16 };

/// What is measured of each scene.
type Figures = BTreeMap<&'static str, f64>;

struct Arguments {
    program: PathBuf,
    scenes: Vec<(SceneSource, View)>,
    json: Option<PathBuf>,
    out: Option<PathBuf>,
}

fn main() -> Result<()> {
    let arguments = arguments(std::env::args().skip(1))?;
    let folder = tempfile::tempdir()?;
    let mut of_scenes: BTreeMap<String, Figures> = BTreeMap::new();
    for (source, view) in &arguments.scenes {
        let found = measured(source, *view, folder.path(), &arguments)?;
        println!("{source}");
        found.iter().for_each(|(name, value)| println!("  {name} {value:.4}"));
        of_scenes.insert(source.to_string(), found);
    }
    let all = summary(of_scenes.values());
    println!("all");
    all.iter().for_each(|(name, value)| println!("  {name} {value:.4}"));
    if let Some(json) = &arguments.json {
        let text = serde_json::to_string_pretty(&serde_json::json!({ "figures": all, "scenes": of_scenes }))?;
        std::fs::write(json, text + "\n")?;
    }
    Ok(())
}

/// A scene's figures.
fn measured(source: &SceneSource, view: View, folder: &Path, arguments: &Arguments) -> Result<Figures> {
    let own = folder.join("scene.glb");
    let file = match source {
        SceneSource::File(path) => std::path::absolute(path)?,
        SceneSource::Procedural(..) => own,
    };
    let frame = Frame::new(source, &file, view, SIZE)?;
    let truth = frame.truth(RADIUS, SAMPLES);
    let (assets, name) = (file.parent().unwrap_or(folder), file.file_name().unwrap_or_default());
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let app = || Headless::new(&models, assets, &name.to_string_lossy(), &frame.camera, SIZE);
    let mut bevy = app()?;
    let program = Program { program: &arguments.program, folder };
    let mut figures = Figures::new();
    let mut images = vec![("none", bevy.picture()?)];

    let mut gbuffer = None;
    let names = [
        (Quality::Low, "ssim_bevy_learned_small", "mean_abs_bevy_learned_small", "ms_bevy_learned_small"),
        (Quality::High, "ssim_bevy_learned", "mean_abs_bevy_learned", "ms_bevy_learned"),
    ];
    let mut max_abs = 0.0f64;
    for (quality, ssim, mean_abs, ms) in names {
        bevy.learned(LearnedAmbientOcclusion { quality, radius: RADIUS });
        if let Some(failure) = bevy.failures().first() {
            return Err(failure.clone().into());
        }
        let made = bevy.openness()?.ok_or("no texture")?;
        let seen = bevy.gbuffer::<LearnedAmbientOcclusion>()?;
        let by_program = program.image(&models.join(quality.folder()), Effect::Ao, &seen, RADIUS)?;
        let [largest, stray] = differences(&made, &by_program, 2e-3);
        max_abs = max_abs.max(largest);
        figures.insert(if quality == Quality::High { "stray_bevy" } else { "stray_bevy_small" }, stray);
        let [similarity, difference] = scores(&made, &truth, &seen.seen()?);
        figures.extend([
            (ssim, similarity),
            (mean_abs, difference),
            (ms, clock::learned::<LearnedAmbientOcclusion>(&mut bevy)?),
        ]);
        if quality == Quality::High {
            images.extend([("learned", bevy.picture()?), ("learned-openness", made)]);
        }
        gbuffer = Some(seen);
    }
    figures.insert("max_abs_bevy", max_abs);
    let seen = gbuffer.ok_or("no g-buffer")?.seen()?;

    let names = [
        (MANY_SAMPLES, "ssim_bevy_ssao_custom", "mean_abs_bevy_ssao_custom", "ms_bevy_ssao_custom"),
        (BevysQuality::Ultra, "ssim_bevy_ssao", "mean_abs_bevy_ssao", "ms_bevy_ssao"),
    ];
    for (quality_level, ssim, mean_abs, ms) in names {
        bevy.bevys(ScreenSpaceAmbientOcclusion { quality_level, radius: RADIUS, ..Default::default() });
        let made = bevy.openness()?.ok_or("no texture")?;
        let [similarity, difference] = scores(&made, &truth, &seen);
        figures.extend([(ssim, similarity), (mean_abs, difference), (ms, clock::bevys(&mut bevy)?)]);
        if quality_level == BevysQuality::Ultra {
            images.extend([("ssao", bevy.picture()?), ("ssao-openness", made)]);
        }
    }
    let mean = mean_of_frames(&mut bevy)?;
    let [similarity, difference] = scores(&mean, &truth, &seen);
    figures.extend([("ssim_bevy_ssao_64", similarity), ("mean_abs_bevy_ssao_64", difference)]);
    images.extend([("ssao-64-openness", mean), ("truth-openness", truth)]);
    drop(bevy);

    let [eye, target] = view.map(Vec3::from_array);
    let of_lens = depth_of_field::measured(&frame, eye.distance(target), &mut app()?, &models, &program)?;
    figures.extend(of_lens.0);
    images.extend(of_lens.1);
    if let Some(out) = &arguments.out {
        pictures::write(out, &source.to_string().replace([':', '/', '.'], "-"), &images)?;
    }
    Ok(figures)
}

/// The mean of Bevy's occlusion over the frames of its noise, seen from the same place.
fn mean_of_frames(bevy: &mut Headless) -> Result<Planes> {
    bevy.with(TemporalJitter::default());
    let mut sum = vec![0.0f32; SIZE[0] * SIZE[1]];
    for _ in 0..FRAMES {
        bevy.draw(1);
        let made = bevy.openness()?.ok_or("no texture")?;
        sum.iter_mut().zip(made.data()).for_each(|(sum, value)| *sum += value / FRAMES as f32);
    }
    bevy.without::<TemporalJitter>();
    Ok(Planes::from_data(1, SIZE[0], SIZE[1], sum))
}

/// Means over the scenes; of the largest differences the largest.
fn summary<'a>(scenes: impl Iterator<Item = &'a Figures> + Clone) -> Figures {
    let count = scenes.clone().count() as f64;
    let mut all = Figures::new();
    for (name, value) in scenes.flatten() {
        let so_far = all.entry(*name).or_insert(0.0);
        *so_far = if name.starts_with("max_abs") { so_far.max(*value) } else { *so_far + value / count };
    }
    all
}

/// `SCENE@X,Y,Z,X,Y,Z`.
fn scene(text: &str) -> Result<(SceneSource, View)> {
    let form = || format!("{text}: SCENE@X,Y,Z,X,Y,Z is wanted, the camera's place and what it looks at");
    let (name, numbers) = text.split_once('@').ok_or_else(form)?;
    let numbers: Vec<f32> = numbers.split(',').map(str::parse).collect::<std::result::Result<_, _>>()?;
    let [x, y, z, to_x, to_y, to_z] = numbers[..] else { return Err(form().into()) };
    Ok((name.parse()?, [[x, y, z], [to_x, to_y, to_z]]))
}

fn arguments(words: impl Iterator<Item = String>) -> Result<Arguments> {
    let (mut program, mut scenes, mut json, mut out) = (None, Vec::new(), None, None);
    let mut words = words;
    while let Some(option) = words.next() {
        let value = words.next().ok_or_else(|| format!("{option} wants a value"))?;
        match option.as_str() {
            "--program" => program = Some(PathBuf::from(value)),
            "--scene" => scenes.push(scene(&value)?),
            "--json" => json = Some(PathBuf::from(value)),
            "--out" => out = Some(PathBuf::from(value)),
            _ => return Err(format!("{option}: --program, --scene, --json and --out are known").into()),
        }
    }
    if scenes.is_empty() {
        for (name, view) in SCENES {
            scenes.push((name.parse()?, view));
        }
    }
    let program =
        program.ok_or("--program is missing: deepshade's program, such as target/release/deepshade")?;
    Ok(Arguments { program, scenes, json, out })
}
