//! Images enlarged until their pixels are seen: by how much, and where they lie in the window then.

use eframe::egui::{self, Pos2, Rect, pos2};
use glam::Vec2;

/// The most that images are enlarged.
const MOST: f32 = 64.0;

/// How images are enlarged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Zoom {
    factor: f32,
    /// What of an image is in the middle, as shares of its width and height.
    centre: Vec2,
}

/// Where an image lies in the window.
#[derive(Clone, Copy, Debug)]
pub struct ImageRect {
    /// Where it is seen, in part or as a whole.
    pub seen: Rect,
    /// Where all of it would lie.
    pub whole: Rect,
}

impl Default for Zoom {
    fn default() -> Self {
        Self { factor: 1.0, centre: Vec2::splat(0.5) }
    }
}

impl Zoom {
    /// Whether images are larger than the window shows.
    pub fn is_in(self) -> bool {
        self.factor > 1.0
    }

    /// Where an image lies that is seen in a part of the window.
    pub fn place(self, seen: Rect) -> ImageRect {
        let size = seen.size() * self.factor;
        let corner = seen.center() - egui::vec2(self.centre.x * size.x, self.centre.y * size.y);
        ImageRect { seen, whole: Rect::from_min_size(corner, size) }
    }

    /// Enlarges by a factor, and leaves what is under the pointer where it is.
    pub fn about(&mut self, place: ImageRect, pointer: Pos2, factor: f32) {
        if factor == 1.0 {
            return;
        }
        let before = self.factor;
        let point = place.share(pointer);
        let point = Vec2::new(point.x, point.y);
        self.factor = (before * factor).clamp(1.0, MOST);
        self.centre = point + (self.centre - point) * (before / self.factor);
        self.fill();
    }

    /// Moves the image by points of the window.
    pub fn pan(&mut self, place: ImageRect, by: egui::Vec2) {
        self.centre -= Vec2::new(by.x / place.whole.width(), by.y / place.whole.height());
        self.fill();
    }

    /// Nothing is seen beside the image.
    fn fill(&mut self) {
        let margin = 0.5 / self.factor;
        self.centre = self.centre.clamp(Vec2::splat(margin), Vec2::splat(1.0 - margin));
    }
}

impl ImageRect {
    /// Which part of the image is at a place of the window, as shares of its width and height.
    pub fn share(self, at: Pos2) -> Pos2 {
        let from = at - self.whole.min;
        pos2(from.x / self.whole.width(), from.y / self.whole.height())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SEEN: Rect = Rect { min: pos2(100.0, 50.0), max: pos2(500.0, 350.0) };

    #[test]
    fn what_is_under_the_pointer_stays_there() {
        let mut zoom = Zoom::default();
        assert_eq!(zoom.place(SEEN).whole, SEEN);
        let pointer = pos2(220.0, 180.0);
        let before = zoom.place(SEEN).share(pointer);
        zoom.about(zoom.place(SEEN), pointer, 8.0);
        let place = zoom.place(SEEN);
        assert!(zoom.is_in() && place.share(pointer).distance(before) < 1e-5);
        assert!((place.whole.width() - 3200.0).abs() < 1e-2);
        zoom.pan(place, egui::vec2(16.0, -8.0));
        assert!(zoom.place(SEEN).share(pointer + egui::vec2(16.0, -8.0)).distance(before) < 1e-5);
        zoom.about(zoom.place(SEEN), pointer, 1e-3);
        assert_eq!(zoom, Zoom::default());
    }

    #[test]
    fn images_fill_the_window_however_they_are_moved() {
        for by in [egui::vec2(-1e4, 0.0), egui::vec2(1e4, 1e4), egui::vec2(3.0, -700.0)] {
            let mut zoom = Zoom::default();
            zoom.about(zoom.place(SEEN), SEEN.center(), 5.0);
            zoom.pan(zoom.place(SEEN), by);
            let whole = zoom.place(SEEN).whole;
            assert!(whole.expand(0.01).contains_rect(SEEN), "{by}: {whole:?}");
        }
        let mut zoom = Zoom::default();
        zoom.about(zoom.place(SEEN), SEEN.center(), 1e9);
        assert!(zoom.place(SEEN).whole.width() <= 400.0 * MOST + 1.0);
    }
}
