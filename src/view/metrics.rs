//! The thread that measures what methods made against truth, or against one of them: figures, and maps of
//! where they differ.

use super::catch_panic::catch_panic;
use super::display_image::{DisplayImage, compared};
use super::method_worker::Show;
use super::request_slot::RequestSlot;
use super::truth::ViewKey;
use super::workers::{SendUpdate, Update};
use crate::report::noise;
use deepshade_render::metrics::{Scores, exposed, exposure};
use deepshade_shaders::Planes;
use eframe::egui::ColorImage;
use std::sync::Arc;

/// What figures are of.
#[derive(Clone, PartialEq)]
pub struct Key {
    /// What the images show.
    pub view_key: ViewKey,
    /// How they were made.
    pub show: Show,
    /// The reference: truth or a method.
    pub against: &'static str,
}

/// Images that are to be measured.
pub struct Request {
    /// What they are.
    pub key: Key,
    /// Samples of truth; 0 of a method.
    pub samples: u32,
    /// The image that they are measured against.
    pub reference: Arc<Planes>,
    /// What methods made.
    pub images: Vec<DisplayImage>,
}

/// Figures and maps.
pub struct Metrics {
    /// Of what.
    pub key: Key,
    /// Samples of the truth that the images were measured against.
    pub samples: u32,
    /// Of each image.
    pub images: Vec<ImageMetrics>,
}

/// Figures and maps of a method's image.
pub struct ImageMetrics {
    /// The method.
    pub name: String,
    /// Its figures.
    pub scores: Scores,
    /// How it differs, and FLIP, in colours.
    pub maps: [Arc<ColorImage>; 2],
}

impl Metrics {
    /// Which methods differ by less than truth does from itself, in a sentence, if some do.
    pub fn within_noise(&self, ceiling: Scores) -> Option<String> {
        let images = self.images.iter();
        let scores: Vec<(&str, f64)> = images.map(|image| (image.name.as_str(), image.scores.ssim)).collect();
        noise::in_words(&scores, ceiling.ssim)
    }
}

/// Measures until the slot is closed.
pub fn run(requests: &RequestSlot<Request>, send: SendUpdate<'_>) {
    while let Some(request) = requests.take() {
        let doing = format!("metrics of {}", request.key.show);
        let measured = catch_panic(&doing, || Ok(metrics(request)));
        send(measured.map_or_else(|error| Update::Error(error.to_string()), Update::Metrics));
    }
}

fn metrics(request: Request) -> Metrics {
    let Request { key, samples, reference, images } = request;
    let effect = key.view_key.effect;
    let scale = exposure(effect, &reference);
    let exposed_reference = exposed(&reference, scale);
    let measure = |image: &DisplayImage| ImageMetrics {
        name: image.name.clone(),
        scores: Scores::new(&exposed(&image.values, scale), &exposed_reference),
        maps: compared(&image.values, &reference, effect).map(Arc::new),
    };
    let images = images.iter().map(measure).collect();
    Metrics { key, samples, images }
}
