//! The comparison report: some frames, each of an effect, several methods, each image against truth. One HTML page that
//! needs no server and nothing from elsewhere, with its images beside it as PNG and EXR; the same figures as Markdown.

pub mod colour_map;
pub mod folder;
pub mod images;
mod markdown;
pub mod noise;
mod page;
mod pareto;
pub mod record;
mod scatter;
mod summary;
mod times;

use anyhow::{Context, Result, ensure};
use deepshade_render::metrics::{Scores, exposed, exposure};
use deepshade_render::path::Truth;
use deepshade_shaders::{Effect, Planes};
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
    /// Writes the page and the Markdown file beside the frames' images, deletes images of earlier reports, and returns the
    /// page's path.
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
    /// What is measured of truth of an effect that took so many milliseconds.
    pub fn new(effect: Effect, truth: &Truth, milliseconds: f64) -> Self {
        let image = &truth.estimate.mean;
        let exposure = exposure(effect, image);
        let scores = |image: &Planes, truth: &Planes| {
            Scores::new(&exposed(image, exposure), &exposed(truth, exposure))
        };
        let blank = effect.background().unwrap_or(0.0);
        let blank = Planes::filled(image.channels(), image.height(), image.width(), blank);
        let (noise, floor) = (scores(&truth.halves[0], &truth.halves[1]), scores(&blank, image));
        Self { exposure, milliseconds, noise, floor }
    }
}

/// What an image is called that is an effect's background everywhere.
pub fn floor_name(effect: Effect) -> String {
    format!("{} image", floor_colour(effect))
}

/// The colour of an effect's background.
pub fn floor_colour(effect: Effect) -> &'static str {
    if effect.background() == Some(1.0) { "white" } else { "black" }
}

/// An effect in words.
pub const fn title(effect: Effect) -> &'static str {
    match effect {
        Effect::Ao => "Ambient occlusion",
        Effect::Do => "Directional occlusion",
        Effect::Gi => "Diffuse indirect light",
        Effect::Glossy => "Indirect light in glossy surfaces",
        Effect::Ibl => "Image-based lighting",
        Effect::Sss => "Subsurface scattering in screen space",
        Effect::Subsurface => "Subsurface scattering",
        Effect::Dof => "Depth of field",
        Effect::MotionBlur => "Motion blur",
        Effect::Aa => "Anti-aliasing",
        Effect::Multi => "Ambient occlusion and depth of field",
        Effect::FogDirect => "Fog, light scattered once",
        Effect::FogIndirect => "Fog, light from surfaces",
        Effect::FogMultiple => "Fog, light scattered many times",
        Effect::Phosphor => "Phosphorescence",
        Effect::PhosphorGi => "Diffuse light of phosphorescence",
        Effect::Path => "All light",
        Effect::Real => "The look of photographs",
    }
}

#[cfg(test)]
mod tests;
