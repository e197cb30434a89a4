//! What the user opens and saves.

use super::Window;
use crate::learned;
use crate::output::message;
use crate::view::file_worker::{FileResult, FileTask};
use crate::view::saved::{Snapshot, free};
use crate::view::workers::Update;
use deepshade_render::scene::SceneSource;
use eframe::egui::{ColorImage, Context, ScreenshotCallback, ViewportCommand};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Files that are written and read.
#[derive(Default)]
pub struct Files {
    /// The folder for what is saved without a name; empty for the current one.
    pub folder: PathBuf,
    /// Tasks that are not done yet.
    pub pending: usize,
}

impl Window {
    /// Opens what was dropped onto the window.
    pub fn open(&mut self, path: &Path) {
        if learned::is_network(path) {
            return match self.state.open_model(path) {
                Ok(()) => self.changed(),
                Err(error) => self.set_error(message(&error)),
            };
        }
        if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("exr")) {
            return self.send(FileTask::Open(path.to_owned()));
        }
        match path.display().to_string().parse::<SceneSource>() {
            Ok(source) => self.open_scene(source),
            Err(error) => self.set_error(format!("{}: {error}", path.display())),
        }
    }

    /// Shows another scene, or the same one as its files are now, under the lights that the user has moved.
    fn open_scene(&mut self, source: SceneSource) {
        let subject = self.results.subject.as_ref();
        let was_read = subject.is_some_and(|subject| subject.source == self.state.show.source);
        self.state.open(source, was_read);
        self.design.leave();
        if let Some(subject) = subject {
            self.state.lights = subject.moved(self.state.lights.take());
        }
        self.opened();
    }

    /// Saves what is shown now into a folder that is free, and says where, once it is done.
    pub fn save(&mut self) {
        match Snapshot::of(self) {
            Some(snapshot) => {
                let folder = free(&self.files.folder, "view", "");
                self.send(FileTask::Save(Box::new(snapshot), folder));
            }
            None => self.set_error("there is no picture yet".to_owned()),
        }
    }

    /// Has an image of the whole window written, as soon as it is painted, into a file, or into one that is
    /// free.
    pub fn request_screenshot(&mut self, context: &Context, path: Option<PathBuf>) {
        let sender = self.workers.sender.clone();
        let callback = ScreenshotCallback::new(move |image| sender.send(Update::Screenshot(image, path)));
        context.send_viewport_cmd(ViewportCommand::Screenshot(callback));
        context.request_repaint();
        self.files.pending += 1;
    }

    /// Whether no task is left, and all layers are seen as they are chosen.
    pub fn is_idle(&self) -> bool {
        self.files.pending == 0 && self.choice_of_layers() == self.layers.seen
    }

    /// Has a task done.
    pub fn send(&mut self, task: FileTask) {
        let sent = self.workers.files.as_ref().is_some_and(|files| files.send(task).is_ok());
        self.files.pending += usize::from(sent);
    }

    /// Writes an image of the window that was painted.
    pub(super) fn take_screenshot(&mut self, image: Arc<ColorImage>, path: Option<PathBuf>) {
        self.files.pending -= 1;
        let path = path.unwrap_or_else(|| free(&self.files.folder, "window", ".png"));
        self.send(FileTask::Screenshot(image, path));
    }

    /// Takes what came of a task.
    pub(super) fn take_file(&mut self, context: &Context, done: Result<FileResult, String>) {
        self.files.pending -= 1;
        match done {
            Ok(FileResult::Silent) => {}
            Ok(FileResult::Note(note)) => self.messages.set_note(note),
            Ok(FileResult::Opened(opened)) => self.take_opened(opened),
            Ok(FileResult::Layers(choice, images)) => self.take_layers(context, *choice, images),
            Err(error) => {
                self.stop_recording();
                self.set_error(error);
            }
        }
    }
}
