//! What moves by itself: the animation.

use super::Window;
use eframe::egui::Context;
use std::time::Instant;

impl Window {
    /// From when to when time goes on by itself in the scene, seconds.
    pub fn timeline(&self) -> Option<[f32; 2]> {
        self.subject.as_ref()?.timeline()
    }

    /// Whether something moves by itself.
    pub(super) fn plays(&self) -> bool {
        self.state.playing && self.timeline().is_some()
    }

    /// Goes on with the animation by the time that has gone, whenever there is room for a picture.
    pub(super) fn play(&mut self, context: &Context) {
        let Some([begin, end]) = self.timeline().filter(|_| self.state.playing) else {
            self.played = None;
            return;
        };
        if self.ordered.is_none() {
            let before = self.played.replace(Instant::now());
            let step = before.map_or(0.0, |before| before.elapsed().as_secs_f32());
            let time = self.state.time + step;
            // An animation begins again when it is over.
            let over = if end.is_finite() { (time - begin).rem_euclid(end - begin) } else { time - begin };
            self.state.time = begin + over.max(0.0);
            self.moved = Instant::now();
        }
        context.request_repaint();
    }
}
