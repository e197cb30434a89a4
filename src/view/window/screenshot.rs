//! `--screenshot`: an image of the window once everything is there, and then its end.

use super::Window;
use crate::view::design;
use eframe::egui::{Context, ViewportCommand};
use std::path::PathBuf;
use std::time::Duration;

/// An image of the window that the command line wants.
pub struct Screenshot {
    path: PathBuf,
    is_requested: bool,
}

impl Screenshot {
    /// One for a file.
    pub const fn new(path: PathBuf) -> Self {
        Self { path, is_requested: false }
    }
}

impl Window {
    /// Whether everything is there that was asked for: images, truth of all its samples, figures, layers of a
    /// file, the place of key frames.
    pub fn is_complete(&self) -> bool {
        let wanted = if self.state.truth { self.state.samples } else { 0 };
        let truth = self.truth_of_picture().map_or(0, |truth| truth.samples);
        let measured = self.reference().is_none_or(|(_, samples)| {
            self.metrics_of_picture().is_some_and(|metrics| metrics.samples >= samples)
        });
        let measured = measured || self.state.show.methods.is_empty();
        let refused = self.glow().is_none_or(|glow| design::refusal(glow).is_some());
        let designed = refused || !self.design.is_waiting();
        self.is_up_to_date() && truth >= wanted && measured && designed && self.is_idle()
    }

    /// Takes the image when everything is there, and closes the window when it is written, or cannot be.
    pub(super) fn follow_screenshot(&mut self, context: &Context) {
        let Some(Screenshot { path, is_requested }) = &self.screenshot else { return };
        context.request_repaint_after(Duration::from_millis(20));
        if self.messages.error.is_some() || (*is_requested && self.is_idle()) {
            self.outcome().failure.clone_from(&self.messages.error);
            self.screenshot = None;
            context.send_viewport_cmd(ViewportCommand::Close);
        } else if !is_requested && self.is_complete() {
            let path = path.clone();
            self.screenshot = Some(Screenshot { path: path.clone(), is_requested: true });
            self.request_screenshot(context, Some(path));
        }
    }
}
