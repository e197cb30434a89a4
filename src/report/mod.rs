//! The comparison report: one effect, some frames, several methods, each image against truth. One HTML page that
//! needs no server and nothing from elsewhere, with its images beside it as PNG and EXR.

pub mod colour_map;
mod earlier;
pub mod images;
mod page;
mod summary;

use crate::figures::write_atomically;
use anyhow::{Context, Result, ensure};
use deepshade_render::{method::Clock, metrics::Scores};
use deepshade_shaders::{Effect, Planes};
use std::path::{Path, PathBuf};

/// One effect, computed for some frames by several methods.
pub struct Comparison {
    /// What was computed.
    pub effect: Effect,
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
    pub truth: Truth,
    /// The methods' images, in the order in which the page lists them.
    pub methods: Vec<MethodReport>,
}

/// Truth of a frame, as two independent halves, so that its own noise is known.
pub struct Truth {
    /// Two independent renderings, `[channels, height, width]`.
    pub halves: [Planes; 2],
    /// Their mean, which is taken for the truth.
    pub image: Planes,
    /// How far the halves are from each other, the `ceiling` of figures. It is a lower bound of what a perfect image
    /// scores: that is measured against the mean of the halves, which has less noise than either.
    pub noise: Scores,
    /// Scores of an image that is [`Effect::background`] everywhere, white for ambient occlusion: the floor.
    pub white: Scores,
    /// Wall clock of both halves together, milliseconds.
    pub milliseconds: f64,
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
}

impl Truth {
    /// Truth as the mean of two renderings that took `milliseconds` together.
    ///
    /// # Panics
    /// If the halves differ in shape.
    pub fn new(effect: Effect, halves: [Planes; 2], milliseconds: f64) -> Self {
        let [a, b] = &halves;
        let mut image = a.clone();
        image.data_mut().iter_mut().zip(b.data()).for_each(|(a, b)| *a = 0.5 * (*a + b));
        let noise = Scores::new(a, b);
        let blank = Planes::filled(a.channels(), a.height(), a.width(), effect.background().unwrap_or(0.0));
        let white = Scores::new(&blank, &image);
        Self { halves, image, noise, white, milliseconds }
    }
}

impl Comparison {
    /// Writes the page and its images into a folder, which is made where it is missing, and returns the page's
    /// path. An earlier page and its images go first and the page is written last, so that it never shows what is not
    /// there or is from another comparison.
    ///
    /// # Errors
    /// If there is no frame, or a file cannot be written or deleted.
    pub fn write(&self, folder: &Path) -> Result<PathBuf> {
        ensure!(!self.frames.is_empty(), "a comparison without frames");
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

/// Name of the page.
const PAGE: &str = "index.html";

/// Name of the folder that holds a frame's images.
fn frame_folder(index: usize) -> String {
    format!("frame-{index:02}")
}

#[cfg(test)]
mod tests;
