//! The thread that holds what methods made against truth: figures, and maps of where they differ.

use super::News;
use super::mailbox::Mailbox;
use super::pictures::{Developed, compared};
use deepshade_render::metrics::{Scores, exposed, exposure};
use deepshade_shaders::{Effect, Planes};
use eframe::egui::ColorImage;
use std::sync::Arc;

/// Images that are to be judged.
pub struct Case {
    /// The picture's number.
    pub number: u32,
    /// Samples of truth.
    pub samples: u32,
    /// What they show.
    pub effect: Effect,
    /// What they are held against.
    pub truth: Arc<Planes>,
    /// What methods made.
    pub images: Vec<Developed>,
}

/// What is to be said of them.
pub struct Verdict {
    /// The picture's number.
    pub number: u32,
    /// Samples of the truth that it was held against.
    pub samples: u32,
    /// Of each image.
    pub judged: Vec<Judged>,
}

/// What is to be said of a method's image.
pub struct Judged {
    /// The method.
    pub name: String,
    /// Its figures.
    pub scores: Scores,
    /// How it differs from truth, and FLIP, in colours.
    pub maps: [Arc<ColorImage>; 2],
}

/// Judges until the mailbox is closed.
pub fn run(cases: &Mailbox<Case>, tell: &dyn Fn(News)) {
    while let Some(case) = cases.take() {
        tell(News::Judged(judge(&case)));
    }
}

fn judge(case: &Case) -> Verdict {
    let scale = exposure(case.effect, &case.truth);
    let truth = exposed(&case.truth, scale);
    let judged = case.images.iter().map(|image| Judged {
        name: image.name.clone(),
        scores: Scores::new(&exposed(&image.values, scale), &truth),
        maps: compared(&image.values, &case.truth, case.effect).map(Arc::new),
    });
    Verdict { number: case.number, samples: case.samples, judged: judged.collect() }
}
