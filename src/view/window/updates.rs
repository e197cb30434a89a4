//! What the workers send.

use super::Window;
use super::requests::Pending;
use crate::view::method_worker::{MethodFrame, Request};
use crate::view::metrics::Metrics;
use crate::view::state::Map;
use crate::view::subject::PreparedScene;
use crate::view::workers::Update;
use eframe::egui::Context;
use std::sync::Arc;

impl Window {
    /// Takes all that has come.
    pub(super) fn take_updates(&mut self, context: &Context) {
        while let Ok(update) = self.workers.updates.try_recv() {
            match update {
                Update::PreparedScene(subject) => self.take_subject(&subject),
                Update::Picture(picture) => self.take_picture(context, picture),
                Update::Truth(truth) => {
                    self.set_texture(context, &truth.image.name, Map::Image, &truth.image.picture);
                    self.results.truth = Some(truth);
                }
                Update::Metrics(metrics) => self.take_metrics(context, metrics),
                #[cfg(feature = "train")]
                Update::TrainingRun(run) => self.training.run = Some(run),
                #[cfg(feature = "train")]
                Update::TrainingBegan(effect, folder) => self.training_began(effect, &folder),
                #[cfg(feature = "train")]
                Update::TrainingEnded(how) => self.training_ended(how),
                Update::Screenshot(image, path) => self.take_screenshot(image, path),
                Update::Place(found) => self.take_place(found),
                Update::File(done) => self.take_file(context, done),
                Update::NoPicture(error) => self.take_failure(error),
                Update::Error(error) => self.set_error(error),
            }
        }
    }

    /// Does not request what cannot be made again until the user changes something, and comes back from a
    /// scene that cannot be read.
    fn take_failure(&mut self, error: String) {
        // A failure of what is not wanted any more is not told.
        let Some(Pending { mut request, outdated: false, .. }) = self.requests.pending.take() else { return };
        if awaits_weights(&error) {
            self.messages.set_note(error);
        } else {
            self.set_error(error);
        }
        let subject = self.results.subject.as_ref();
        let was_read = subject.is_some_and(|subject| subject.source == request.show.source);
        if !was_read && request.show.source == self.state.show.source && self.state.go_back() {
            return self.forget();
        }
        // What was not known when it was requested was learned meanwhile.
        request.camera = request.camera.or(self.state.controller.map(|controller| controller.camera));
        request.lights = request.lights.or_else(|| self.state.lights.clone());
        self.requests.failed = Some(request);
    }

    /// Takes the scene that the user has chosen, and stays where they are in it. One that they have left
    /// meanwhile is ignored.
    fn take_subject(&mut self, subject: &Arc<PreparedScene>) {
        let show = &self.state.show;
        if (&subject.source, subject.effect) != (&show.source, show.effect) {
            return;
        }
        let controller = self.state.controller.get_or_insert(subject.controller);
        controller.camera.lens = subject.controller.camera.lens;
        self.state.lights = Some(subject.lights(self.state.lights.as_deref()));
        self.results.subject = Some(Arc::clone(subject));
    }

    fn take_picture(&mut self, context: &Context, picture: Arc<MethodFrame>) {
        let Some(Pending { since, outdated: false, .. }) = self.requests.pending.take() else { return };
        let before = self.results.picture.as_ref();
        let is_new = before.is_none_or(|before| before.request.number != picture.request.number);
        if is_new {
            self.results.rate = 1.0 / since.elapsed().as_secs_f32().max(1e-3);
        }
        self.take_subject(&picture.subject);
        for image in picture.images.iter().chain(&picture.inspected) {
            self.set_texture(context, &image.name, Map::Image, &image.picture);
        }
        // Only an exposure that nobody has requested is as suits the image.
        let suits = picture.exposure.filter(|_| picture.request.exposure.is_none());
        self.requests.exposure = self.requests.exposure.or(suits);
        self.requests.made = Some(Request {
            camera: Some(picture.camera),
            lights: Some(picture.lights.clone()),
            exposure: picture.exposure,
            ..picture.request.clone()
        });
        if self.requests.failed.take().is_some() {
            // It said what the picture waits for.
            self.messages.note = None;
        }
        self.outcome().count_picture(is_new);
        self.results.picture = Some(picture);
    }

    fn take_metrics(&mut self, context: &Context, metrics: Metrics) {
        for image in &metrics.images {
            for (map, picture) in [Map::Difference, Map::Flip].into_iter().zip(&image.maps) {
                self.set_texture(context, &image.name, map, picture);
            }
        }
        self.results.metrics = Some(metrics);
    }
}

/// Whether there is no picture only because a training run has saved no weights yet, which is no fault.
fn awaits_weights(error: &str) -> bool {
    #[cfg(feature = "train")]
    return error.contains(crate::learned::run::NOTHING_YET);
    #[cfg(not(feature = "train"))]
    return {
        let _ = error;
        false
    };
}
