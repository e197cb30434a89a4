//! `deepshade bench passes`: milliseconds of every pass of a method, and of every part of one that has
//! several.

use crate::arguments::Size;
use crate::complete::{Additions, Completed, Wants, complete};
use crate::figures::Figures;
use crate::methods::open_screen;
use crate::radius::{self, Space};
use crate::views::Viewpoint;
use crate::{exposure_time, props};
use anyhow::{Context, Result};
use deepshade_render::bvh::TracedScene;
use deepshade_render::gbuffer;
use deepshade_render::method::{Clock, Frame, Repeats, Shaded};
use deepshade_render::methods::Quality;
use deepshade_render::scene::SceneSource;
use deepshade_render::screen::PassTime;
use deepshade_shaders::Effect;
use deepshade_shaders::gpu::Gpu;
use serde_json::json;
use std::path::PathBuf;

/// How often each pass runs.
const REPEATS: Repeats = Repeats { warm_up: 1, timed: 5 };

/// Measures the passes of a method on a frame.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  deepshade bench passes\n  \
    deepshade bench passes --scene colonnade:1 --effect path --method composed --extinction 0.1 --quality low\n  \
    deepshade bench passes --scene sponza.gltf --effect gi --method surfel --size 1280x720 --json gi.json\n\n\
    In the JSON file ms is of the whole frame at once, ms_PASS of all passes of a shader, ms_PART of a part of a \
    method. On software adapters each pass waits for the one before, so that they add up to more than ms.")]
pub struct Args {
    /// A scene file (.gltf, .glb, .obj, .ply) or a procedural family and a seed, such as stairs:7.
    #[arg(long, default_value = "colonnade:1")]
    scene: SceneSource,
    /// What the method computes.
    #[arg(long, default_value = "path")]
    effect: Effect,
    /// A method that runs in passes; `deepshade methods` lists all.
    #[arg(long, default_value = "composed")]
    method: String,
    /// How much time the method may take for a better image: low, medium, high or ultra.
    #[arg(long, default_value = "medium")]
    quality: Quality,
    /// Columns and rows of the image.
    #[arg(long, default_value = "512x384")]
    size: Size,
    /// How far effects with a radius reach, metres; by default 3 % of the scene's diagonal, and at most a
    /// quarter of the median depth of what is seen.
    #[arg(long, value_parser = crate::arguments::positive)]
    radius: Option<f32>,
    #[command(flatten)]
    props: props::Args,
    #[command(flatten)]
    viewpoint: Viewpoint,
    /// Chooses sampled views and added lights.
    #[arg(long, default_value_t = 0)]
    seed: u32,
    #[command(flatten)]
    additions: Additions,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
}

/// Measures and prints.
///
/// # Errors
/// If the scene cannot be read, there is no such method, or the device fails.
pub fn run(args: &Args) -> Result<()> {
    let gpu = Gpu::new()?;
    let (times, whole) = measured(args, &gpu)?;
    let parts = parts(&times);
    let mut figures = Figures::new("bench passes");
    figures.set("ms", whole.milliseconds);
    let named = times.iter().map(|time| (time.key.as_str(), time.milliseconds));
    for (name, milliseconds) in parts.iter().copied().chain(named) {
        figures.set(&format!("ms_{}", name.replace(['-', '/', '.'], "_")), milliseconds);
    }
    figures.detail("scene", json!(args.scene.to_string()));
    figures.detail("method", json!(args.method));
    figures.detail("quality", json!(args.quality.name()));
    figures.detail("size", json!(args.size.to_string()));
    figures.detail("adapter", json!(gpu.info.name));
    figures.write(args.json.as_deref())?;
    print(args, &gpu, &times, &parts)?;
    let clock = if whole.clock == Clock::Gpu { "the card's clock" } else { "the clock on the wall" };
    say!("{:>12.2} ms  the whole frame at once, by {clock}", whole.milliseconds)
}

/// What the passes take, and the whole frame.
fn measured(args: &Args, gpu: &Gpu) -> Result<(Vec<PassTime<String>>, Shaded)> {
    let method = open_screen(args.effect, &args.method, gpu, args.quality)?;
    let size = [args.size.height, args.size.width];
    let scene = exposure_time::Args::new(None, None).scene(&args.scene, &args.props, args.effect)?;
    let scene = TracedScene::new(scene).with_context(|| format!("scene {}", args.scene))?;
    let view = args.viewpoint.of(&args.scene, &scene, size, args.seed)?;
    let wants = Wants {
        effect: args.effect,
        size,
        additions: &args.additions,
        seed: args.seed,
        learned: None,
        animated: false,
        time: 0.0,
    };
    let Completed { scene, camera, .. } = complete(&scene, &view.camera, &wants)?;
    let radius = radius::wanted(args.radius, None, &[args.effect], Space::seen(&scene, &camera, size));
    let gbuffer = gbuffer::render(&scene, &camera, size[0], size[1], args.effect.attributes());
    let frame = Frame { scene: &scene, camera: &camera, gbuffer: &gbuffer, radius, seed: args.seed };
    Ok((method.pass_times(&frame, REPEATS)?, method.shade_in_passes(&frame, REPEATS)?))
}

/// The parts of a method with their milliseconds; none of a method that is one.
fn parts(times: &[PassTime<String>]) -> Vec<(&str, f64)> {
    let mut parts: Vec<(&str, f64)> = Vec::new();
    for time in times {
        let Some((part, _)) = time.key.split_once('/') else { continue };
        match parts.iter_mut().find(|(known, _)| *known == part) {
            Some((_, sum)) => *sum += time.milliseconds,
            None => parts.push((part, time.milliseconds)),
        }
    }
    parts
}

fn print(args: &Args, gpu: &Gpu, times: &[PassTime<String>], parts: &[(&str, f64)]) -> Result<()> {
    let Args { method, scene, size, .. } = args;
    say!("{method} at {} on {scene}, {size}, {}", args.quality.name(), gpu.info.name)?;
    for PassTime { key, passes, milliseconds } in times {
        let often = if *passes > 1 { format!(", {passes} times") } else { String::new() };
        say!("{milliseconds:>12.2} ms  {key}{often}")?;
    }
    for (part, milliseconds) in parts {
        say!("{milliseconds:>12.2} ms  {part}, all its passes")?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_the_sums_of_their_passes() {
        let time = |key: &str, milliseconds| PassTime { key: key.to_owned(), passes: 1, milliseconds };
        let times = [time("composed.begin", 1.0), time("sky/a", 2.0), time("fog/a", 4.0), time("sky/b", 8.0)];
        assert_eq!(parts(&times), [("sky", 10.0), ("fog", 4.0)]);
        assert!(parts(&times[..1]).is_empty());
    }
}
