//! What moves by itself: the animation.

use super::Window;
use eframe::egui::Context;
use std::time::Instant;

impl Window {
    /// Whether something moves by itself.
    pub(super) fn plays(&self) -> bool {
        self.state.playing && self.subject.as_ref().is_some_and(|subject| subject.goes_on())
    }

    /// Goes on with the animation by the time that has gone, whenever there is room for a picture.
    pub(super) fn play(&mut self, context: &Context) {
        let Some(subject) = self.subject.as_ref().filter(|_| self.plays()) else {
            self.played = None;
            return;
        };
        // An animation begins again when it is over; where surfaces keep light, time goes on.
        let span = subject.animated.span().filter(|_| subject.animated.scene.glow.is_none());
        if self.ordered.is_none() {
            let before = self.played.replace(Instant::now());
            let step = before.map_or(0.0, |before| before.elapsed().as_secs_f32());
            let time = self.state.time + step;
            self.state.time =
                span.map_or(time, |[begin, end]| begin + (time - begin).rem_euclid(end - begin));
            self.moved = Instant::now();
        }
        context.request_repaint();
    }
}
