//! The comparison report: some frames, each of an effect, several methods, each image against truth. One HTML
//! page that needs no server and nothing from elsewhere, with its images beside it as PNG and EXR; the same
//! figures as Markdown.

pub mod colour_map;
pub mod folder;
pub mod images;
mod markdown;
pub mod noise;
mod page;
pub mod record;
mod scatter;
mod summary;
mod times;

use anyhow::{Context, Result, ensure};
use deepshade_render::metrics::{Scores, exposed, exposure};
use deepshade_render::path::Truth;
use deepshade_shaders::effect::DoingNothing;
use deepshade_shaders::{Effect, GBuffer, Planes};
use folder::{Folder, MARKDOWN};
use record::{FrameRecord, TruthRecord};
use std::path::PathBuf;

/// Name of the page.
const PAGE: &str = "index.html";

/// Frames, and what the methods made of them.
pub struct Report {
    /// At least one, those of an effect one after the other.
    pub frames: Vec<FrameRecord>,
    /// How much time analytic methods were given, in words.
    pub quality: String,
    /// What it ran on and with, as name and value.
    pub machine: Vec<(String, String)>,
}

impl Report {
    /// Writes the page and the Markdown file beside the frames' images, deletes images of earlier reports,
    /// and returns the page's path.
    ///
    /// # Errors
    /// If there is no frame, or a file cannot be written or deleted.
    pub fn write(&self, folder: &Folder) -> Result<PathBuf> {
        ensure!(!self.frames.is_empty(), "a comparison without frames");
        let page = page::render(self).context("the comparison page")?;
        folder.keep_only(&self.frames)?;
        folder.write(MARKDOWN, &markdown::text(self))?;
        folder.write(PAGE, &page)
    }

    /// The effects, each once.
    pub fn effects(&self) -> Vec<Effect> {
        let mut effects: Vec<Effect> = self.frames.iter().map(|frame| frame.effect).collect();
        effects.dedup();
        effects
    }

    /// The frames of an effect.
    pub fn frames_of(&self, effect: Effect) -> Vec<&FrameRecord> {
        self.frames.iter().filter(|frame| frame.effect == effect).collect()
    }

    /// The frames of an effect, scene by scene.
    pub fn scenes_of(&self, effect: Effect) -> Vec<(&str, Vec<&FrameRecord>)> {
        let mut scenes: Vec<(&str, Vec<&FrameRecord>)> = Vec::new();
        for frame in self.frames_of(effect) {
            match scenes.iter_mut().find(|(scene, _)| *scene == frame.scene) {
                Some((_, frames)) => frames.push(frame),
                None => scenes.push((&frame.scene, vec![frame])),
            }
        }
        scenes
    }
}

impl TruthRecord {
    /// What is measured of truth of an effect that took so many milliseconds, beside doing nothing with the
    /// frame's g-buffer.
    pub fn new(effect: Effect, truth: &Truth, gbuffer: &GBuffer, milliseconds: f64) -> Self {
        let image = &truth.estimate.mean;
        let exposure = exposure(effect, image);
        let scores = |image: &Planes, truth: &Planes| {
            Scores::new(&exposed(image, exposure), &exposed(truth, exposure))
        };
        let noise = scores(&truth.halves[0], &truth.halves[1]);
        let floor = scores(&effect.doing_nothing(gbuffer), image);
        Self { exposure, milliseconds, noise, floor }
    }
}

/// What tables call the image of whoever computes nothing.
pub fn floor_name(effect: Effect) -> String {
    match effect.definition().doing_nothing {
        DoingNothing::As(_) => "light without the effect".to_owned(),
        one @ (DoingNothing::White | DoingNothing::Black) => format!("{} image", one.name()),
    }
}

#[cfg(test)]
mod tests;
