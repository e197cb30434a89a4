//! The thread that holds what methods made against truth, or against one of them: figures, and maps of where they differ.

use super::caught::caught;
use super::desk::News;
use super::mailbox::Mailbox;
use super::pictures::{Developed, compared};
use super::studio::Show;
use super::truth::Sight;
use crate::report::noise;
use deepshade_render::metrics::{Scores, exposed, exposure};
use deepshade_shaders::Planes;
use eframe::egui::ColorImage;
use std::sync::Arc;

/// Images that are to be judged.
pub struct Case {
    /// What they show.
    pub sight: Sight,
    /// How they were made.
    pub show: Show,
    /// What they are held against: truth or a method.
    pub against: &'static str,
    /// Samples of truth; 0 of a method.
    pub samples: u32,
    /// The image that they are held against.
    pub reference: Arc<Planes>,
    /// What methods made.
    pub images: Vec<Developed>,
}

/// What is to be said of them.
pub struct Verdict {
    /// What was seen.
    pub sight: Sight,
    /// How the images were made.
    pub show: Show,
    /// What they were held against.
    pub against: &'static str,
    /// Samples of the truth that they were held against.
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
    /// How it differs, and FLIP, in colours.
    pub maps: [Arc<ColorImage>; 2],
}

impl Verdict {
    /// Which methods differ by less than truth does from itself, in a sentence, if some do.
    pub fn within_noise(&self, ceiling: Scores) -> Option<String> {
        let scores: Vec<(&str, f64)> =
            self.judged.iter().map(|judged| (judged.name.as_str(), judged.scores.ssim)).collect();
        noise::in_words(&scores, ceiling.ssim)
    }
}

/// Judges until the mailbox is closed.
pub fn run(cases: &Mailbox<Case>, tell: &dyn Fn(News)) {
    while let Some(case) = cases.take() {
        let doing = format!("judging {}", case.show);
        tell(
            caught(&doing, || Ok(judge(case)))
                .map_or_else(|error| News::Refused(error.to_string()), News::Judged),
        );
    }
}

fn judge(case: Case) -> Verdict {
    let effect = case.sight.effect;
    let scale = exposure(effect, &case.reference);
    let reference = exposed(&case.reference, scale);
    let judged = case.images.iter().map(|image| Judged {
        name: image.name.clone(),
        scores: Scores::new(&exposed(&image.values, scale), &reference),
        maps: compared(&image.values, &case.reference, effect).map(Arc::new),
    });
    let judged = judged.collect();
    let Case { sight, show, against, samples, .. } = case;
    Verdict { sight, show, against, samples, judged }
}
