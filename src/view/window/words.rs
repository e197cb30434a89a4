//! What the window says: what was done and what cannot be, for as long as it takes to read.

use super::Window;
use eframe::egui::Context;
use std::time::{Duration, Instant};

/// For how long something that was said can be read.
const READ: Duration = Duration::from_secs(20);

impl Window {
    /// Says that something cannot be done.
    pub fn refuse(&mut self, what: String) {
        self.outcome().refusals += 1;
        self.unheard.push(what.clone());
        self.message = Some(what);
        self.said = Instant::now();
    }

    /// What could not be done last, or what else was said.
    pub fn said(&self) -> Option<&str> {
        self.message.as_deref().or(self.note.as_deref())
    }

    /// Says that something was done that nothing else shows.
    pub(super) fn say(&mut self, what: String) {
        self.note = Some(what);
        self.said = Instant::now();
    }

    /// Takes back what was said long ago, but not why there is no picture.
    pub(super) fn fade(&mut self, context: &Context) {
        if (self.message.is_none() && self.note.is_none()) || self.is_refused() {
            return;
        }
        match READ.checked_sub(self.said.elapsed()) {
            Some(left) => context.request_repaint_after(left),
            None => (self.message, self.note) = (None, None),
        }
    }
}
