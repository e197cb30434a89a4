//! What the window says: notes and errors, for as long as it takes to read them.

use super::Window;
use eframe::egui::Context;
use std::time::{Duration, Instant};

/// For how long a message can be read.
const READ: Duration = Duration::from_secs(20);

/// What is said above the choices.
#[derive(Default)]
pub struct Messages {
    /// What could not be done last.
    pub error: Option<String>,
    /// What was done last that nothing else shows.
    pub note: Option<String>,
    /// Since when.
    since: Option<Instant>,
}

impl Messages {
    /// Says that something was done.
    pub fn set_note(&mut self, note: String) {
        (self.note, self.since) = (Some(note), Some(Instant::now()));
    }

    /// The error, or else the note.
    pub fn first(&self) -> Option<&str> {
        self.error.as_deref().or(self.note.as_deref())
    }
}

impl Window {
    /// Says that something cannot be done.
    pub fn set_error(&mut self, error: String) {
        self.outcome().refusals += 1;
        (self.messages.error, self.messages.since) = (Some(error), Some(Instant::now()));
    }

    /// Removes old messages, but not why there is no picture.
    pub(super) fn fade_messages(&mut self, context: &Context) {
        let Some(since) = self.messages.since.filter(|_| !self.is_refused()) else { return };
        match READ.checked_sub(since.elapsed()) {
            Some(left) => context.request_repaint_after(left),
            None => self.messages = Messages::default(),
        }
    }
}
