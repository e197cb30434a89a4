//! A strip of pictures of what was designed, at the moments at which something is wanted.

use super::{Designed, light::SwitchedScene, task::Task};
use crate::report::images::{shown, write_png};
use anyhow::{Context, Result};
use deepshade_dataset::font;
use deepshade_render::metrics::{exposed, exposure};
use deepshade_render::past;
use deepshade_render::path::{self, Sampling, Shot};
use deepshade_render::scene::{Camera, Glow, Scene};
use deepshade_shaders::{Effect, Planes};
use image::{Rgb, RgbImage, imageops};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// Pictures of a strip, at most, and samples of a pixel.
const PICTURES: usize = 8;
const SAMPLES: u32 = 4;
/// Places that a label names, at most.
const LISTED: usize = 6;
/// Height of a line of text and what is left free around one, pixels.
const LINE: usize = 13;
const GAP: usize = 3;
const BACKGROUND: Rgb<u8> = Rgb([32; 3]);
const INK: Rgb<u8> = Rgb([255; 3]);

/// Writes pictures of the moments at which something is wanted beside the file that says what glows: what
/// surfaces give back, with the moment and the places where it is wanted below each.
///
/// # Errors
/// If the file that says what glows cannot be read or does not fit the scene, or a vertex is nowhere at a
/// moment.
pub fn write(
    task: &Task,
    (switched, camera): (&SwitchedScene, &Camera),
    found: &[Designed],
    glow: &Path,
    size: [usize; 2],
) -> Result<()> {
    let moments: Vec<(usize, Vec<usize>)> = moments(found).into_iter().collect();
    let count = moments.len().min(PICTURES);
    let chosen: Vec<_> = (0..count).map(|index| &moments[index * moments.len() / count]).collect();
    let picture = |(frame, _): &&(usize, _)| picture((switched, camera), glow, task.seconds(*frame), size);
    let images = chosen.iter().map(picture).collect::<Result<Vec<_>>>()?;
    let brightest = images
        .iter()
        .map(|image| exposure(Effect::Phosphor, image))
        .filter(|exposure| exposure.is_finite())
        .fold(f32::INFINITY, f32::min);
    let scale = if brightest.is_finite() { brightest } else { 1.0 };
    let labels = chosen.iter().map(|(frame, places)| label(task.seconds(*frame), places));
    let pictures: Vec<(RgbImage, String)> =
        images.iter().map(|image| shown(&exposed(image, scale))).zip(labels).collect();
    write_png(&glow.with_file_name("strip.png"), &side_by_side(&pictures))
}

/// The frames at which something is wanted, with the places where, counted from 1.
pub fn moments(found: &[Designed]) -> BTreeMap<usize, Vec<usize>> {
    let mut moments = BTreeMap::<usize, Vec<usize>>::new();
    for (place, number) in found.iter().flat_map(|found| found.places.iter().zip(&found.numbers)) {
        place.keys.iter().for_each(|key| moments.entry(key.frame).or_default().push(number + 1));
    }
    moments.values_mut().for_each(|places| places.sort_unstable());
    moments
}

fn label(seconds: f32, places: &[usize]) -> String {
    let seconds = (1000.0 * seconds).round() / 1000.0;
    let numbers = places.iter().take(LISTED).map(usize::to_string).collect::<Vec<_>>().join(", ");
    let noun = if places.len() == 1 { "place" } else { "places" };
    match places.len().saturating_sub(LISTED) {
        0 => format!("{seconds} s: {noun} {numbers}"),
        more => format!("{seconds} s: {noun} {numbers} and {more} more"),
    }
}

/// Pictures of one size, each above its label.
fn side_by_side(pictures: &[(RgbImage, String)]) -> RgbImage {
    let [mut cell, mut height] = [0, 0];
    for (picture, label) in pictures {
        cell = cell.max(picture.width() as usize).max(2 * GAP + font::ADVANCE * label.len());
        height = height.max(picture.height() as usize);
    }
    let mut strip = RgbImage::from_pixel((cell * pictures.len()) as u32, (height + LINE) as u32, BACKGROUND);
    for (index, (picture, label)) in pictures.iter().enumerate() {
        imageops::replace(&mut strip, picture, (index * cell) as i64, 0);
        for [x, y] in font::pixels(label) {
            strip.put_pixel((index * cell + GAP + x) as u32, (height + GAP + y) as u32, INK);
        }
    }
    strip
}

fn picture(
    (switched, camera): (&SwitchedScene, &Camera),
    glow: &Path,
    moment: f32,
    size: [usize; 2],
) -> Result<Planes> {
    let glow = Glow::read(glow, moment)?;
    glow.check(&switched.animated.scene).map_err(anyhow::Error::msg).context("what was designed")?;
    let now = Scene { glow: Some(Arc::new(glow)), ..switched.animated.scene.clone() };
    let scene = past::of_animation(&switched.animated, &now)?;
    let shot = Shot::new(&scene, camera, size, scene.diagonal());
    Ok(path::render(Effect::Phosphor, &shot, Sampling::one(SAMPLES, 1)).mean)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_short() {
        assert_eq!(label(1.0 / 3.0, &[1, 2, 3, 4, 5, 6]), "0.333 s: places 1, 2, 3, 4, 5, 6");
        let many: Vec<usize> = (1..=57).collect();
        assert_eq!(label(2.0, &many), "2 s: places 1, 2, 3, 4, 5, 6 and 51 more");
    }

    #[test]
    fn each_picture_has_its_label_below_it() {
        let picture = |red: u8| RgbImage::from_pixel(40, 10, Rgb([red, 0, 0]));
        let labels = [label(5.5, &[1]), label(15.0, &[1, 12])];
        assert_eq!(labels, ["5.5 s: place 1", "15 s: places 1, 12"]);
        let [first, second] = labels.clone();
        let strip = side_by_side(&[(picture(100), first), (picture(200), second)]);
        let cell = 6 + 6 * 18;
        assert_eq!(strip.dimensions(), (2 * cell, 23));
        assert_eq!(
            [0, 39, 40, cell, cell + 39].map(|x| strip.get_pixel(x, 5).0[0]),
            [100, 100, 32, 200, 200]
        );
        let ink = |from: u32| {
            let inked = |(x, y): (u32, u32)| (*strip.get_pixel(x, y) == INK).then_some([x - from, y]);
            (from..from + cell)
                .flat_map(|x| (0..23).map(move |y| (x, y)))
                .filter_map(inked)
                .collect::<Vec<_>>()
        };
        for (from, label) in [(0, &labels[0]), (cell, &labels[1])] {
            let mut expected: Vec<[u32; 2]> =
                font::pixels(label).map(|[x, y]| [x as u32 + 3, y as u32 + 13]).collect();
            expected.sort_unstable();
            assert_eq!(ink(from), expected, "{label}");
        }
    }
}
