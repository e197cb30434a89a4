//! What is to be said when the window has closed.

use crate::figures::Figures;

/// What came of a window.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Seconds from the beginning to the first picture.
    pub first_picture: Option<f64>,
    /// Pictures that were made.
    pub pictures: u32,
    /// What a script measured, by name.
    pub measured: Vec<(String, f64)>,
    /// How often the window's surface was out of date when it was to be painted on, and how often it was lost.
    pub surfaces: [u32; 2],
    /// Things that could not be done, and were said.
    pub refusals: u32,
    /// Why the script did not come to its end.
    pub failure: Option<String>,
}

impl Outcome {
    /// Sets its figures.
    pub fn set(&self, figures: &mut Figures) {
        if let Some(seconds) = self.first_picture {
            figures.set("seconds_to_first_picture", seconds);
        }
        self.measured.iter().for_each(|(name, value)| figures.set(name, *value));
        figures.set("pictures", f64::from(self.pictures));
        figures.set("refusals", f64::from(self.refusals));
        for (name, count) in ["surfaces_outdated", "surfaces_lost"].into_iter().zip(self.surfaces) {
            figures.set(name, f64::from(count));
        }
    }
}
