//! What designs look like: plots of wanted and reached colours over time, and a strip of pictures.

use super::light::Stage;
use super::{Designed, colour, task::Task};
use crate::figures::write_atomically;
use crate::plot::{CHANNELS, Line, Plot, Style};
use crate::report::images::{shown, write_png};
use anyhow::{Context, Result};
use deepshade_render::metrics::{exposed, exposure};
use deepshade_render::past;
use deepshade_render::path::{self, Sampling, Shot};
use deepshade_render::phosphor::design::Place;
use deepshade_render::phosphor::material::Material;
use deepshade_render::phosphor::rate::Scheme;
use deepshade_render::phosphor::simulation::{Initial, Simulation};
use deepshade_render::scene::{Camera, Glow, Scene};
use deepshade_shaders::{Effect, Planes};
use image::{RgbImage, imageops};
use std::path::Path;
use std::sync::Arc;

/// Pictures of a strip, at most, and samples of a pixel.
const PICTURES: usize = 8;
const SAMPLES: u32 = 4;

/// Draws a plot for each place, counted from 1 as the task has them.
///
/// # Errors
/// If a material makes no sense, or a file cannot be written.
pub fn plots(task: &Task, found: &[Designed], folder: &Path) -> Result<()> {
    let of_material = found.iter().flat_map(|found| (0..found.places.len()).map(move |index| (found, index)));
    for (found, index) in of_material {
        let (place, number) = (&found.places[index], found.numbers[index] + 1);
        let title = format!("Wanted (dots) and reached: {}", found.name);
        let svg = plot(task, place, &found.design.material)?.svg(&title)?;
        write_atomically(&folder.join(format!("place-{number}.svg")), svg.as_bytes())?;
    }
    Ok(())
}

fn plot(task: &Task, place: &Place, material: &Material) -> Result<Plot> {
    let reached = seen(place, material)?;
    let at = |frame: usize| f64::from(task.seconds(frame));
    let lines = CHANNELS.iter().enumerate().flat_map(|(channel, (name, its))| {
        let frames = reached.iter().enumerate();
        let curve = frames.map(|(frame, values)| (at(frame), colour(task, values)[channel])).collect();
        let mut wanted: Vec<_> =
            place.keys.iter().map(|key| (at(key.frame), colour(task, &key.radiance)[channel])).collect();
        wanted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let line = |name: String, points, style| Line { name, points, style, colour: Some(*its) };
        [
            line((*name).to_owned(), curve, Style::Curve),
            line(format!("{name}, wanted"), wanted, Style::Points),
        ]
    });
    Ok(Plot {
        x: "time, s",
        is_logarithmic: false,
        y: "radiance, linear RGB",
        lines: lines.collect(),
        level: None,
    })
}

/// What a place looks like in each frame.
fn seen(place: &Place, material: &Material) -> Result<Vec<Vec<f64>>> {
    let mut run = Simulation::new(material, Scheme::Exact, Initial::Dark)?;
    let frame = |(frame, light): (usize, &Vec<f64>)| {
        let mut seen = run.emission();
        let reflected = place.reflected.get(frame).into_iter().flatten();
        seen.iter_mut().zip(reflected).for_each(|(seen, reflected)| *seen += reflected);
        run.step(light, place.dt)?;
        Ok(seen)
    };
    place.irradiance.iter().enumerate().map(frame).collect()
}

/// Writes pictures of the moments at which something is wanted beside the file that says what glows: what surfaces give back.
///
/// # Errors
/// If the file that says what glows cannot be read or does not fit the scene, or a vertex is nowhere at a moment.
pub fn strip(
    task: &Task,
    (stage, camera): (&Stage, &Camera),
    found: &[Designed],
    glow: &Path,
    size: [usize; 2],
) -> Result<()> {
    let mut frames: Vec<usize> = found
        .iter()
        .flat_map(|found| &found.places)
        .flat_map(|place| &place.keys)
        .map(|key| key.frame)
        .collect();
    frames.sort_unstable();
    frames.dedup();
    let count = frames.len().min(PICTURES);
    let moments = (0..count).map(|index| task.seconds(frames[index * frames.len() / count]));
    let images =
        moments.map(|moment| picture((stage, camera), glow, moment, size)).collect::<Result<Vec<_>>>()?;
    let brightest = images
        .iter()
        .map(|image| exposure(Effect::Phosphor, image))
        .filter(|exposure| exposure.is_finite())
        .fold(f32::INFINITY, f32::min);
    let scale = if brightest.is_finite() { brightest } else { 1.0 };
    let [height, width] = size;
    let mut strip = RgbImage::new((width * count) as u32, height as u32);
    for (index, image) in images.iter().enumerate() {
        imageops::replace(&mut strip, &shown(&exposed(image, scale)), (index * width) as i64, 0);
    }
    write_png(&glow.with_file_name("strip.png"), &strip)
}

fn picture((stage, camera): (&Stage, &Camera), glow: &Path, moment: f32, size: [usize; 2]) -> Result<Planes> {
    let glow = Glow::read(glow, moment)?;
    glow.check(&stage.animated.scene).map_err(anyhow::Error::msg).context("what was designed")?;
    let now = Scene { glow: Some(Arc::new(glow)), ..stage.animated.scene.clone() };
    let scene = past::of_animation(&stage.animated, &now)?;
    let shot = Shot::new(&scene, camera, size, scene.diagonal());
    Ok(path::render(Effect::Phosphor, &shot, Sampling::one(SAMPLES, 1)).mean)
}
