//! Figures of a window that has closed.

use crate::figures::Figures;
use std::time::Instant;

/// What came of a window.
#[derive(Clone, Debug)]
pub struct WindowFigures {
    /// When the program began.
    began: Instant,
    /// Seconds from the beginning to the first picture.
    first_picture: Option<f64>,
    /// Pictures that were made.
    pictures: u32,
    /// How often the window's surface was out of date when it was to be painted on, and how often it was
    /// lost.
    pub surfaces: [u32; 2],
    /// Errors that were shown.
    pub refusals: u32,
    /// Why there is no screenshot.
    pub failure: Option<String>,
}

impl WindowFigures {
    /// Of a program that begins now.
    pub fn new() -> Self {
        let began = Instant::now();
        Self { began, first_picture: None, pictures: 0, surfaces: [0; 2], refusals: 0, failure: None }
    }

    /// Counts a picture if it is new.
    pub fn count_picture(&mut self, is_new: bool) {
        self.pictures += u32::from(is_new);
        self.first_picture.get_or_insert(self.began.elapsed().as_secs_f64());
    }

    /// Its figures.
    pub fn figures(&self) -> Figures {
        let mut figures = Figures::new("view");
        if let Some(seconds) = self.first_picture {
            figures.set("seconds_to_first_picture", seconds);
        }
        figures.set("pictures", f64::from(self.pictures));
        figures.set("refusals", f64::from(self.refusals));
        for (name, count) in ["surfaces_outdated", "surfaces_lost"].into_iter().zip(self.surfaces) {
            figures.set(name, f64::from(count));
        }
        figures
    }
}
