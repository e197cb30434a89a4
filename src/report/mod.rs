//! The comparison report: one effect, some frames, several methods, each image against truth. One HTML page that
//! needs no server and nothing from elsewhere, with its images beside it as PNG and EXR.

pub mod colour_map;
mod earlier;
pub mod images;
mod page;
mod summary;

use crate::figures::write_atomically;
use anyhow::{Context, Result, bail, ensure};
use deepshade_render::method::Clock;
use deepshade_render::methods::Quality;
use deepshade_render::metrics::{Scores, exposed, exposure};
use deepshade_render::path::Truth;
use deepshade_shaders::{Effect, Planes};
use std::path::{Path, PathBuf};

/// One effect, computed for some frames by several methods.
pub struct Comparison {
    /// What was computed.
    pub effect: Effect,
    /// How much time analytic methods were given.
    pub quality: Quality,
    /// What it was computed for; at least one. All frames have the same methods in the same order.
    pub frames: Vec<FrameReport>,
    /// What it ran on and with, as name and value.
    pub machine: Vec<(String, String)>,
}

/// A frame, what the methods made of it, and the truth.
pub struct FrameReport {
    /// What the frame is called on the page.
    pub name: String,
    /// What else is to be known of it, as name and value: size, radius, camera.
    pub facts: Vec<(String, String)>,
    /// Truth, which the scores refer to.
    pub truth: TruthReport,
    /// The methods' images, in the order in which the page lists them.
    pub methods: Vec<MethodReport>,
}

/// Truth of a frame, and what there is to compare with.
pub struct TruthReport {
    /// The truth.
    pub truth: Truth,
    /// What images are multiplied by before they are scored and shown.
    pub exposure: f32,
    /// How far truth's halves are from each other, the `ceiling` of figures.
    pub noise: Scores,
    /// Scores of an image that is [`Effect::background`] everywhere: the floor, by [`floor_name`].
    pub floor: Scores,
    /// Wall clock of rendering it, milliseconds.
    pub milliseconds: f64,
}

/// What an image is called that is an effect's background everywhere.
pub fn floor_name(effect: Effect) -> String {
    format!("{} image", floor_colour(effect))
}

/// The colour of an effect's background.
pub fn floor_colour(effect: Effect) -> &'static str {
    if effect.background() == Some(1.0) { "white" } else { "black" }
}

/// What a method made of a frame.
pub struct MethodReport {
    /// The method's name.
    pub name: String,
    /// Its image, `[channels, height, width]`.
    pub image: Planes,
    /// Its image against truth.
    pub scores: Scores,
    /// Median time of a run, milliseconds.
    pub milliseconds: f64,
    /// Which clock it is from.
    pub clock: Clock,
    /// What it ran on.
    pub device: String,
}

impl TruthReport {
    /// Truth of an effect that took so many milliseconds.
    pub fn new(effect: Effect, truth: Truth, milliseconds: f64) -> Self {
        let exposure = exposure(effect, &truth.estimate.mean);
        let scores = |image: &Planes, truth: &Planes| {
            Scores::new(&exposed(image, exposure), &exposed(truth, exposure))
        };
        let image = &truth.estimate.mean;
        let blank = effect.background().unwrap_or(0.0);
        let blank = Planes::filled(image.channels(), image.height(), image.width(), blank);
        let (noise, floor) = (scores(&truth.halves[0], &truth.halves[1]), scores(&blank, image));
        Self { truth, exposure, noise, floor, milliseconds }
    }

    /// Scores of an image.
    pub fn scores(&self, image: &Planes) -> Scores {
        Scores::new(&exposed(image, self.exposure), &exposed(&self.truth.estimate.mean, self.exposure))
    }
}

impl Comparison {
    /// Writes the page and its images into a folder that [`check_folder`] allows, which is made where it is missing, and
    /// returns the page's path. An earlier page and its images go first and the page is written last, so that it never shows what is not
    /// there or is from another comparison.
    ///
    /// # Errors
    /// If there is no frame, the folder holds something else, or a file cannot be written or deleted.
    pub fn write(&self, folder: &Path) -> Result<PathBuf> {
        ensure!(!self.frames.is_empty(), "a comparison without frames");
        check_folder(folder)?;
        let page = page::render(self).context("the comparison page")?;
        let path = folder.join(PAGE);
        earlier::delete(folder).with_context(|| format!("the earlier comparison in {}", folder.display()))?;
        for (index, frame) in self.frames.iter().enumerate() {
            images::write_frame(&folder.join(frame_folder(index)), self.effect, frame)?;
        }
        write_atomically(&path, page.as_bytes())?;
        Ok(path)
    }

    /// Mean over frames of something each frame has.
    pub fn mean(&self, value: impl Fn(&FrameReport) -> f64) -> f64 {
        self.frames.iter().map(value).sum::<f64>() / self.frames.len() as f64
    }

    /// Mean scores over frames of something each frame has.
    pub fn mean_scores(&self, scores: impl Fn(&FrameReport) -> Scores) -> Scores {
        Scores {
            ssim: self.mean(|frame| scores(frame).ssim),
            psnr: self.mean(|frame| scores(frame).psnr),
            flip: self.mean(|frame| scores(frame).flip),
            relative_mse: self.mean(|frame| scores(frame).relative_mse),
        }
    }
}

/// Refuses a folder that is not for a report: one that holds something, but no earlier report.
///
/// # Errors
/// If so, with what it holds; or if it cannot be read.
pub fn check_folder(folder: &Path) -> Result<()> {
    let foreign = earlier::foreign(folder).with_context(|| folder.display().to_string())?;
    if let Some(name) = foreign {
        bail!(
            "{} holds `{name}` and no report: choose another folder, a new or an empty one",
            folder.display()
        );
    }
    Ok(())
}

/// Name of the page.
const PAGE: &str = "index.html";

/// Name of the folder that holds a frame's images.
fn frame_folder(index: usize) -> String {
    format!("frame-{index:02}")
}

#[cfg(test)]
mod tests;
