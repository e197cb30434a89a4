//! What moves by itself: the animation.

use super::Window;
use eframe::egui::Context;
use std::time::Instant;

impl Window {
    /// From when to when time goes on by itself in the scene, seconds.
    pub fn timeline(&self) -> Option<[f32; 2]> {
        self.results.subject.as_ref()?.timeline()
    }

    /// Whether something moves by itself.
    pub(super) fn plays(&self) -> bool {
        self.state.playing && self.timeline().is_some()
    }

    /// Advances the animation by the time that has gone, whenever a picture can be requested.
    pub(super) fn advance_animation(&mut self, context: &Context) {
        let Some([begin, end]) = self.timeline().filter(|_| self.state.playing) else {
            self.requests.animated = None;
            return;
        };
        if self.requests.pending.is_none() {
            let before = self.requests.animated.replace(Instant::now());
            let step = before.map_or(0.0, |before| before.elapsed().as_secs_f32());
            let time = self.state.time + step;
            // An animation begins again when it is over.
            let over = if end.is_finite() { (time - begin).rem_euclid(end - begin) } else { time - begin };
            self.state.time = begin + over.max(0.0);
            self.requests.moved = Some(Instant::now());
        }
        context.request_repaint();
    }
}
