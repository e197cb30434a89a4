//! What hands open and save.

use super::Window;
use crate::learned;
use crate::output::message;
use crate::view::clerk::{Done, Errand};
use crate::view::saved::Moment;
use deepshade_render::scene::SceneSource;
use eframe::egui::{Context, ScreenshotCallback, ViewportCommand};
use std::path::{Path, PathBuf};
use std::sync::{Arc, PoisonError};

impl Window {
    /// Opens what was dropped onto the window.
    pub fn open(&mut self, path: &Path) {
        if learned::is_network(path) {
            return match self.state.open_model(path) {
                Ok(()) => self.changed(),
                Err(error) => self.refuse(message(&error)),
            };
        }
        if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("exr")) {
            return self.send(Errand::Open(path.to_owned()));
        }
        match path.display().to_string().parse::<SceneSource>() {
            Ok(source) => self.open_scene(source),
            Err(error) => self.refuse(format!("{}: {error}", path.display())),
        }
    }

    /// Shows another scene, or the same one as its files are now, under the lights that hands have moved.
    pub fn open_scene(&mut self, source: SceneSource) {
        let was_read = self.subject.as_ref().is_some_and(|subject| subject.source == self.state.show.source);
        self.state.open(source, was_read);
        if let Some(subject) = &self.subject {
            self.state.lights = subject.moved(self.state.lights.take());
        }
        self.opened();
    }

    /// Saves what is shown now into a folder, or into one that is free, and says where, once it is done.
    pub fn save(&mut self, folder: Option<PathBuf>) {
        match Moment::of(self) {
            Some(moment) => self.send(Errand::Save(Box::new(moment), folder)),
            None => self.refuse("there is no picture yet".to_owned()),
        }
    }

    /// Has a picture of the whole window written, as soon as it is painted, into a file, or into one that is free.
    pub fn shoot(&mut self, context: &Context, path: Option<PathBuf>) {
        let (taken, waker) = (Arc::clone(&self.taken), context.clone());
        let callback = ScreenshotCallback::new(move |image| {
            taken.lock().unwrap_or_else(PoisonError::into_inner).push((image, path));
            waker.request_repaint();
        });
        context.send_viewport_cmd(ViewportCommand::Screenshot(callback));
        context.request_repaint();
        self.shots += 1;
    }

    /// Has those written that are there.
    pub(super) fn write_shots(&mut self) {
        let taken = std::mem::take(&mut *self.taken.lock().unwrap_or_else(PoisonError::into_inner));
        for (image, path) in taken {
            self.shots -= 1;
            self.send(Errand::Shot(image, path));
        }
    }

    /// Whether all errands are run, none is left to be sent, and all layers are seen as they are chosen.
    pub fn is_idle(&self) -> bool {
        self.errands + self.shots == 0 && !self.develops && self.choice_of_layers() == self.developing
    }

    /// Has an errand run.
    pub fn send(&mut self, errand: Errand) {
        let sent = self.desk.clerk.as_ref().is_some_and(|clerk| clerk.send(errand).is_ok());
        self.errands += usize::from(sent);
    }

    /// Takes what came of an errand.
    pub(super) fn take_errand(&mut self, done: Result<Done, String>) {
        self.errands -= 1;
        match done {
            Ok(Done::Quietly) => {}
            Ok(Done::Said(note)) => self.say(note),
            Ok(Done::Opened(opened)) => self.take_opened(opened),
            Err(what) => {
                self.stop_recording();
                self.refuse(what);
            }
        }
    }
}
