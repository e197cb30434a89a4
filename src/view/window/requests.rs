//! What the window requests from its workers: a picture, truth of it, and figures of both.

use super::Window;
use crate::render::picture::Exposure;
use crate::view::method_worker::{Request, Show};
use crate::view::metrics;
use crate::view::truth::{self, ViewKey};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// For how long nothing must have moved before truth begins.
const STILL: Duration = Duration::from_millis(250);

/// What is being made, and what was last.
#[derive(Default)]
pub struct Requests {
    /// When the camera, a light or the animation moved last.
    pub moved: Option<Instant>,
    /// When the animation was advanced last, while it plays.
    pub animated: Option<Instant>,
    /// The exposure that suits the first picture.
    pub exposure: Option<Exposure>,
    /// The picture that is being made.
    pub pending: Option<Pending>,
    /// What the newest picture was requested as.
    pub made: Option<Request>,
    /// The picture that could not be made last.
    pub failed: Option<Request>,
    truth: Option<truth::Request>,
    /// The picture's number, what it is measured against, and truth's samples.
    metrics: Option<(u32, &'static str, u32)>,
}

/// A picture that is being made.
pub struct Pending {
    /// What was requested.
    pub request: Request,
    /// When.
    pub since: Instant,
    /// The user has chosen another scene or effect meanwhile: the picture is not wanted any more.
    pub outdated: bool,
}

impl Requests {
    /// Whether nothing has moved for a while.
    pub fn is_still(&self) -> bool {
        self.moved.is_none_or(|moved| moved.elapsed() > STILL)
    }

    /// Forgets what was made of another scene or effect.
    pub fn forget(&mut self) {
        (self.exposure, self.made, self.failed) = (None, None, None);
        self.pending.iter_mut().for_each(|pending| pending.outdated = true);
        self.moved = Some(Instant::now());
    }
}

impl Window {
    /// Whether the newest picture is what the user wants, and no other one is being made.
    pub fn is_up_to_date(&self) -> bool {
        self.requests.pending.is_none() && self.is_as_wanted()
    }

    /// Whether the newest picture is what the user wants.
    pub fn is_as_wanted(&self) -> bool {
        self.requests.made.as_ref().is_some_and(|made| !self.differs(made))
    }

    /// Whether what the user wants cannot be made.
    pub fn is_refused(&self) -> bool {
        let failed = self.requests.failed.as_ref();
        self.requests.pending.is_none() && failed.is_some_and(|failed| !self.differs(failed))
    }

    /// What is wanted now.
    fn request(&self, number: u32) -> Request {
        Request {
            show: self.state.show.clone(),
            camera: self.state.controller.map(|controller| controller.camera),
            time: self.state.time,
            lights: self.state.lights.clone(),
            exposure: self.requests.exposure.map(|exposure| exposure.brighter(self.state.look.stops)),
            number,
        }
    }

    /// Whether what is wanted now is something else than a request.
    fn differs(&self, other: &Request) -> bool {
        let exposure = self.request(other.number).exposure;
        self.shows_else(other) || exposure.is_some_and(|exposure| Some(exposure) != other.exposure)
    }

    /// As [`Self::differs`], and not only in its exposure.
    pub(super) fn shows_else(&self, other: &Request) -> bool {
        let request = self.request(other.number);
        (&request.show, request.camera, request.time, &request.lights)
            != (&other.show, other.camera, other.time, &other.lights)
    }

    /// Whether what is wanted now has another truth: that does not depend on methods and brightness.
    fn has_other_truth(&self, other: &Request) -> bool {
        let request = self.request(other.number);
        let place = |show: &Show| {
            let scene = (show.source.clone(), show.scenes_opened, show.glow.clone());
            (scene, show.effect, show.radius, show.size)
        };
        (place(&request.show), request.camera, request.time, &request.lights)
            != (place(&other.show), other.camera, other.time, &other.lights)
    }

    /// Requests the picture that is wanted: one at a time, so that each is shown while the camera moves.
    pub(super) fn request_picture(&mut self) {
        let temporal = self.state.show.temporal;
        // Mixing with frames before goes on while nothing moves.
        if self.requests.pending.is_some() || self.is_refused() || (self.is_as_wanted() && !temporal) {
            return;
        }
        let made = self.requests.made.as_ref();
        let is_exposed_anew = !temporal && made.is_some_and(|made| !self.shows_else(made));
        let number = self
            .results
            .picture
            .as_ref()
            .map_or(0, |picture| picture.request.number + u32::from(!is_exposed_anew));
        let request = self.request(number);
        self.workers.methods.put(request.clone());
        self.requests.pending = Some(Pending { request, since: Instant::now(), outdated: false });
    }

    pub(super) fn view_key(&self) -> Option<ViewKey> {
        let picture = self.results.picture.as_ref()?;
        Some(ViewKey {
            source: picture.subject.source.clone(),
            effect: picture.subject.effect,
            scenes_opened: picture.request.show.scenes_opened,
            glow: picture.request.show.glow.clone(),
            subject: Arc::downgrade(&picture.subject),
            camera: picture.camera,
            time: picture.request.time,
            lights: picture.lights.clone(),
            radius: picture.radius,
            size: picture.request.show.size,
        })
    }

    /// Requests truth of what stands still, and stops it where something moves.
    pub(super) fn request_truth(&mut self) {
        let (Some(view_key), Some(picture)) = (self.view_key(), &self.results.picture) else { return };
        let seen = self.requests.made.as_ref().is_some_and(|made| !self.has_other_truth(made));
        let still = seen && self.requests.is_still() && !self.plays();
        let samples = if still && self.state.truth { self.state.samples } else { 0 };
        let stopped = self.requests.truth.as_ref().is_none_or(|before| before.samples == 0);
        let (exposure, stops, seed) = (picture.exposure, self.state.look.stops, self.state.args.seed);
        let request = truth::Request { view_key, exposure, stops, samples, seed };
        if self.requests.truth.as_ref() == Some(&request) || (samples == 0 && stopped) {
            return;
        }
        self.workers.truth.put(request.clone());
        self.requests.truth = Some(request);
    }

    /// Has the methods' images measured, where truth has more samples than when they were measured last.
    pub(super) fn request_metrics(&mut self) {
        let (Some(key), Some(picture), Some((reference, samples))) =
            (self.metrics_key(), &self.results.picture, self.reference())
        else {
            return;
        };
        let what = (picture.request.number, key.against, samples);
        if self.requests.metrics == Some(what) || picture.images.is_empty() {
            return;
        }
        let images = picture.images.iter().filter(|image| image.name != key.against).cloned().collect();
        let reference = Arc::clone(&reference.values);
        self.workers.metrics.put(metrics::Request { key, samples, reference, images });
        self.requests.metrics = Some(what);
    }

    /// Exposes images as suits the first one now, however the first of all was exposed.
    pub fn expose_anew(&mut self) {
        self.state.look.stops = 0.0;
        let is_seen = self.requests.made.as_ref().is_some_and(|made| !self.shows_else(made));
        let picture = self.results.picture.as_ref().filter(|_| is_seen);
        self.requests.exposure = picture.and_then(|picture| {
            Some(Exposure::new(picture.request.show.effect, &picture.images.first()?.values, None))
        });
        if !is_seen {
            // What is to be seen is still to come, and finds its own: one that was requested before has
            // another.
            self.requests.made = None;
            self.requests.pending.iter_mut().for_each(|pending| pending.outdated = true);
        }
    }
}
