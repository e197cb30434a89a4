//! What moves by itself: the animation.

use super::Window;
use eframe::egui::Context;
use std::time::Instant;

impl Window {
    /// Whether something moves by itself.
    pub(super) fn plays(&self) -> bool {
        self.state.playing && self.subject.as_ref().is_some_and(|subject| subject.moves_for() > 0.0)
    }

    /// Goes on with the animation by the time that has gone, whenever there is room for a picture.
    pub(super) fn play(&mut self, context: &Context) {
        let span = self.subject.as_ref().and_then(|subject| subject.animated.span());
        let Some([begin, end]) = span.filter(|_| self.plays()) else {
            self.played = None;
            return;
        };
        if self.ordered.is_none() {
            let before = self.played.replace(Instant::now());
            let step = before.map_or(0.0, |before| before.elapsed().as_secs_f32());
            self.state.time = begin + (self.state.time + step - begin).rem_euclid(end - begin);
            self.moved = Instant::now();
        }
        context.request_repaint();
    }
}
