//! What the window hears from its threads.

use super::{Ordered, Window};
use crate::view::desk::News;
use crate::view::judge::Verdict;
use crate::view::state::Map;
use crate::view::studio::Picture;
use crate::view::subject::Subject;
use eframe::egui::Context;
use std::sync::Arc;

impl Window {
    /// Takes all that has come.
    pub(super) fn hear(&mut self, context: &Context) {
        while let Ok(news) = self.desk.news.try_recv() {
            match news {
                News::Subject(subject) => self.meet(&subject),
                News::Picture(picture) => self.take(context, picture),
                News::Truth(truth) => {
                    self.show(context, &truth.image.name, Map::Image, &truth.image.picture);
                    self.truth = Some(truth);
                }
                News::Judged(verdict) => self.take_verdict(context, verdict),
                News::Layers(choice, developed) => self.take_layers(context, &choice, developed),
                #[cfg(feature = "train")]
                News::Training(training) => self.training = Some(training),
                #[cfg(feature = "train")]
                News::TrainingBegan(effect, folder) => self.training_began(effect, &folder),
                #[cfg(feature = "train")]
                News::TrainingEnded(how) => self.training_ended(how),
                News::Errand(done) => self.take_errand(done),
                News::NoPicture(what) => self.give_up(what),
                News::Refused(what) => self.refuse(what),
            }
        }
    }

    /// Does not ask for what cannot be made again until hands change something, and comes back from a scene that cannot be read.
    fn give_up(&mut self, what: String) {
        // Whether what nobody wants any more can be made is nobody's concern.
        let Some(Ordered { mut order, outdated: false, .. }) = self.ordered.take() else { return };
        if awaits_weights(&what) {
            self.say(what);
        } else {
            self.refuse(what);
        }
        let was_read = self.subject.as_ref().is_some_and(|subject| subject.source == order.show.source);
        if !was_read && order.show.source == self.state.show.source && self.state.go_back() {
            return self.forget();
        }
        // What was not known when it was ordered was learned meanwhile.
        order.camera = order.camera.or(self.state.pilot.map(|pilot| pilot.camera));
        order.lights = order.lights.or_else(|| self.state.lights.clone());
        self.refused = Some(order);
    }

    /// Knows the scene that hands have chosen, and stays where they are in it. One that they have left meanwhile is not met.
    fn meet(&mut self, subject: &Arc<Subject>) {
        let show = &self.state.show;
        if (&subject.source, subject.effect) != (&show.source, show.effect) {
            return;
        }
        let pilot = self.state.pilot.get_or_insert(subject.pilot);
        pilot.camera.lens = subject.pilot.camera.lens;
        self.state.lights = Some(subject.lights(self.state.lights.as_deref()));
        self.subject = Some(Arc::clone(subject));
    }

    fn take(&mut self, context: &Context, picture: Arc<Picture>) {
        let Some(Ordered { since, outdated: false, .. }) = self.ordered.take() else { return };
        let is_new = self.picture.as_ref().is_none_or(|before| before.order.number != picture.order.number);
        if is_new {
            self.rate = 1.0 / since.elapsed().as_secs_f32().max(1e-3);
        }
        self.meet(&picture.subject);
        for image in picture.images.iter().chain(&picture.inspected) {
            self.show(context, &image.name, Map::Image, &image.picture);
        }
        // Only one that the studio has chosen is as suits the image.
        let suits = picture.exposure.filter(|_| picture.order.exposure.is_none());
        self.exposure = self.exposure.or(suits);
        let mut made = picture.order.clone();
        made.camera = Some(picture.camera);
        made.lights = Some(picture.lights.clone());
        made.exposure = picture.exposure;
        self.made = Some(made);
        if self.refused.take().is_some() {
            // It said what the picture waits for.
            self.note = None;
        }
        let seconds = self.began.elapsed().as_secs_f64();
        let mut outcome = self.outcome();
        outcome.pictures += u32::from(is_new);
        outcome.first_picture.get_or_insert(seconds);
        drop(outcome);
        self.picture = Some(picture);
    }

    fn take_verdict(&mut self, context: &Context, verdict: Verdict) {
        for judged in &verdict.judged {
            for (map, picture) in [Map::Difference, Map::Flip].into_iter().zip(&judged.maps) {
                self.show(context, &judged.name, map, picture);
            }
        }
        self.verdict = Some(verdict);
    }
}

/// Whether there is no picture only because a training run has saved no weights yet, which is no fault.
fn awaits_weights(what: &str) -> bool {
    #[cfg(feature = "train")]
    return what.contains(crate::learned::run::NOTHING_YET);
    #[cfg(not(feature = "train"))]
    return {
        let _ = what;
        false
    };
}
