//! What the window wants of its threads: a picture, truth of it, and what is to be said of both.

use super::{Ordered, STILL, Window};
use crate::view::judge::Case;
use crate::view::layers::Choice;
use crate::view::studio::{Order, Show};
use crate::view::truth::{self, Sight};
use std::sync::Arc;
use std::time::Instant;

impl Window {
    /// What is wanted now.
    fn order(&self, number: u32) -> Order {
        Order {
            show: self.state.show.clone(),
            camera: self.state.pilot.map(|pilot| pilot.camera),
            time: self.state.time,
            lights: self.state.lights.clone(),
            exposure: self.exposure.map(|exposure| exposure.brighter(self.state.stops)),
            number,
        }
    }

    /// Whether what is wanted now is something else than an order.
    pub(super) fn differs(&self, other: &Order) -> bool {
        let exposure = self.order(other.number).exposure;
        self.shows_else(other) || exposure.is_some_and(|exposure| Some(exposure) != other.exposure)
    }

    /// As [`Self::differs`], and not only in its exposure.
    pub(super) fn shows_else(&self, other: &Order) -> bool {
        let order = self.order(other.number);
        (&order.show, order.camera, order.time, &order.lights)
            != (&other.show, other.camera, other.time, &other.lights)
    }

    /// Whether what is wanted now looks upon something else than an order: truth does not hear of methods and brightness.
    fn looks_elsewhere(&self, other: &Order) -> bool {
        let order = self.order(other.number);
        let place =
            |show: &Show| (show.source.clone(), show.scenes_opened, show.effect, show.radius, show.size);
        (place(&order.show), order.camera, order.time, &order.lights)
            != (place(&other.show), other.camera, other.time, &other.lights)
    }

    /// Orders what is wanted: one at a time, so that none is overtaken for ever while somebody moves.
    pub(super) fn order_picture(&mut self) {
        // Mixing with frames before goes on while nothing moves.
        if self.ordered.is_some() || self.is_refused() || (self.is_as_wanted() && !self.state.show.temporal) {
            return;
        }
        let is_exposed_anew =
            !self.state.show.temporal && self.made.as_ref().is_some_and(|made| !self.shows_else(made));
        let number =
            self.picture.as_ref().map_or(0, |picture| picture.order.number + u32::from(!is_exposed_anew));
        let order = self.order(number);
        self.desk.studio.put(order.clone());
        self.ordered = Some(Ordered { order, since: Instant::now(), outdated: false });
    }

    pub(super) fn sight(&self) -> Option<Sight> {
        let picture = self.picture.as_ref()?;
        Some(Sight {
            source: picture.subject.source.clone(),
            effect: picture.subject.effect,
            contents: picture.subject.contents.clone(),
            subject: Arc::downgrade(&picture.subject),
            camera: picture.camera,
            time: picture.order.time,
            lights: picture.lights.clone(),
            radius: picture.radius,
            size: picture.order.show.size,
        })
    }

    /// Orders truth of what stands still, and lets it rest where something moves.
    pub(super) fn order_truth(&mut self) {
        let (Some(sight), Some(picture)) = (self.sight(), &self.picture) else { return };
        let seen = self.made.as_ref().is_some_and(|made| !self.looks_elsewhere(made));
        let still = seen && self.moved.elapsed() > STILL && !self.plays();
        let samples = if still && self.state.truth { self.state.samples } else { 0 };
        let resting = self.asked.as_ref().is_none_or(|asked| asked.samples == 0);
        let (exposure, stops, seed) = (picture.exposure, self.state.stops, self.state.args.seed);
        let order = truth::Order { sight, exposure, stops, samples, seed };
        if self.asked.as_ref() == Some(&order) || (samples == 0 && resting) {
            return;
        }
        self.desk.truth.put(order.clone());
        self.asked = Some(order);
    }

    /// Has layers of an EXR file developed.
    pub fn order_development(&self, choice: Choice) {
        self.desk.darkroom.put(choice);
    }

    /// Has the methods' images judged, where truth is known better than when they were judged last.
    pub(super) fn order_verdict(&mut self) {
        let (Some(sight), Some(picture), Some((reference, samples))) =
            (self.sight(), &self.picture, self.reference())
        else {
            return;
        };
        let against = self.state.reference();
        let what = (picture.order.number, against, samples);
        if self.judged == Some(what) || picture.images.is_empty() {
            return;
        }
        let others = picture.images.iter().filter(|image| image.name != against);
        self.desk.judge.put(Case {
            sight,
            show: picture.order.show.clone(),
            against,
            samples,
            reference: Arc::clone(&reference.values),
            images: others.cloned().collect(),
        });
        self.judged = Some(what);
    }
}
