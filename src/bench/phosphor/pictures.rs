//! The room after its lamp has gone out, as in the thesis' Figure 8.15: all light path traced, and side by side what surfaces
//! give back by truth, by states in a frame loop, and by moments of the past.

use super::cornell::{BRIGHT, OFF};
use super::subject::Subject;
use crate::arguments::Size;
use crate::report::images::{shown, write_png};
use anyhow::{Context, Result};
use deepshade_render::methods::Quality;
use deepshade_render::methods::phosphor::glassner::{Glassner, Parameters as Moments};
use deepshade_render::methods::phosphor::{Parameters, RateEquation};
use deepshade_render::metrics::{exposed, exposure};
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{Effect, Planes};
use image::{RgbImage, imageops};
use std::path::{Path, PathBuf};

/// Seconds after the lamp has gone out, and how files name them.
const AFTER: [(f32, &str); 3] = [(-0.1, "lit"), (0.1, "after-0.1s"), (60.0, "after-60s")];
/// Samples of a pixel of all light.
const SAMPLES: u32 = 256;
/// Seconds between frames.
const STEP: f32 = 0.5;

/// Writes them into a folder, and gives their names.
///
/// # Errors
/// If the device fails or a file cannot be written.
pub fn write(gpu: &Gpu, folder: &Path, size: Size, rivals: [u32; 2]) -> Result<Vec<PathBuf>> {
    std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    let mut subject = Subject::new(gpu, size, BRIGHT, false, vec![[0.0, OFF]])?;
    let states = subject.plan(&RateEquation::new(gpu, Parameters::of(Quality::High))?)?;
    let [few, many] = rivals.map(|samples| subject.plan(&Glassner::new(gpu, Moments { samples })?));
    let (few, many) = (few?, many?);
    let (mut names, mut now) = (Vec::new(), 0.0);
    for (after, name) in AFTER {
        let moment = OFF + after;
        while now + STEP < moment {
            subject.make(now, &[&states])?;
            now += STEP;
        }
        subject.make(moment, &[&states, &few, &many])?;
        now = moment;
        let truth = subject.truth(Effect::Phosphor, moment, 8)?;
        let everything = subject.truth(Effect::Path, moment, SAMPLES)?;
        let scale = exposure(Effect::Phosphor, &truth);
        let of_light = exposure(Effect::Path, &everything);
        let kept = [truth, subject.image(&states)?, subject.image(&few)?, subject.image(&many)?];
        let kept = kept.iter().map(|image| exposed(image, scale));
        let images: Vec<Planes> = std::iter::once(exposed(&everything, of_light)).chain(kept).collect();
        let path = folder.join(format!("{name}.png"));
        write_png(&path, &side_by_side(&images, size))?;
        names.push(path);
    }
    Ok(names)
}

fn side_by_side(images: &[Planes], Size { width, height }: Size) -> RgbImage {
    let mut all = RgbImage::new((images.len() * width) as u32, height as u32);
    for (index, image) in images.iter().enumerate() {
        imageops::replace(&mut all, &shown(image), (index * width) as i64, 0);
    }
    all
}
