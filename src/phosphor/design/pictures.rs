//! Plots of what is wanted of places and what is reached, over time.

use super::{Designed, colour, task::Task};
use crate::figures::write_atomically;
use crate::plot::{CHANNELS, Line, Plot, Style};
use anyhow::Result;
use deepshade_glow::material::Material;
use deepshade_phosphor::design::TargetPoint;
use deepshade_phosphor::simulation::Simulation;
use std::path::Path;

/// Draws a plot for each place, counted from 1 as the task has them.
///
/// # Errors
/// If a material makes no sense, or a file cannot be written.
pub fn plots(task: &Task, found: &[Designed], folder: &Path) -> Result<()> {
    let of_material = found.iter().flat_map(|found| (0..found.places.len()).map(move |index| (found, index)));
    for (found, index) in of_material {
        let (place, number) = (&found.places[index], found.numbers[index] + 1);
        let svg = plot(task, place, &found.design.material)?.svg(&title(task, number, &found.name))?;
        write_atomically(&folder.join(format!("place-{number}.svg")), svg.as_bytes())?;
    }
    Ok(())
}

/// What tells a place's plot from those of others.
fn title(task: &Task, number: usize, material: &str) -> String {
    format!("Place {number} at {}, {material}: wanted (dots) and reached", task.places[number - 1].at)
}

fn plot(task: &Task, place: &TargetPoint, material: &Material) -> Result<Plot> {
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
fn seen(place: &TargetPoint, material: &Material) -> Result<Vec<Vec<f64>>> {
    let mut run = Simulation::dark(material);
    let frame = |(frame, light): (usize, &Vec<f64>)| {
        let mut seen = run.emission();
        let reflected = place.reflected.get(frame).into_iter().flatten();
        seen.iter_mut().zip(reflected).for_each(|(seen, reflected)| *seen += reflected);
        run.step(light, place.dt)?;
        Ok(seen)
    };
    place.irradiance.iter().enumerate().map(frame).collect()
}
