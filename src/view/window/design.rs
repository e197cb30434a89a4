//! Key frames of glow: their place is requested, what they ask for is solved and shown, and written.

use super::Window;
use crate::view::design::place::{Asked, Found, Request, Target};
use crate::view::design::written::Written;
use crate::view::design::{self, GlowDesign};
use crate::view::file_worker::FileTask;
use crate::view::saved::free;
use deepshade_glow::paint::Paint;
use deepshade_phosphor::wish::{Answer, WishError};
use deepshade_render::scene::Glow;
use std::sync::Arc;
use std::time::Instant;

impl Window {
    /// What keeps light in the scene that is shown, if anything does.
    pub fn glow(&self) -> Option<&Arc<Glow>> {
        // Until a scene that was opened is there, the one before is none to design for.
        let subject = self.results.subject.as_ref().filter(|it| it.source == self.state.show.source)?;
        let own = subject.animated.scene.glow.as_ref()?;
        Some(self.state.show.glow.as_ref().unwrap_or(own))
    }

    /// Chooses the place that key frames are of; those of another place are left, what was found for them
    /// stays.
    pub fn choose_place(&mut self, target: Target) {
        self.design.target = Some(target);
    }

    /// Requests the chosen place and its light, where these are not known under these lights.
    pub(super) fn request_place(&mut self) {
        let (Some(target), Some(subject)) = (&self.design.target, &self.results.subject) else { return };
        let Some(glow) = self.glow().filter(|glow| design::refusal(glow).is_none()) else { return };
        let asked = Asked {
            target: target.clone(),
            lights: subject.lights(self.state.lights.as_deref()),
            seconds: self.design.seconds_of(glow),
        };
        if self.design.asked.as_ref() == Some(&asked) {
            return;
        }
        let request = Request { subject: Arc::clone(subject), time: self.state.time, asked: asked.clone() };
        self.workers.place.put(request);
        self.design.asked = Some(asked);
    }

    /// Takes a place, unless another one is wanted meanwhile.
    pub(super) fn take_place(&mut self, found: Result<Box<Found>, (Box<Asked>, String)>) {
        let asked: &Asked = match &found {
            Ok(found) => &found.asked,
            Err((asked, _)) => asked,
        };
        if self.design.asked.as_ref() != Some(asked) {
            return;
        }
        let Found { mut asked, place, light } = match found {
            Ok(found) => *found,
            Err((_, error)) => {
                // The place before stays, if there is one.
                let before = self.design.place.as_ref();
                self.design.target = before.map(|place| Target::Spot(place.spot.clone()));
                self.design.asked = None;
                return self.set_error(error);
            }
        };
        let (Some(subject), Some(glow)) = (&self.results.subject, self.glow().cloned()) else { return };
        let is_new = self.design.place.as_ref().is_none_or(|before| before.spot != place.spot);
        let before = self.design.glow_before.as_ref().filter(|_| !is_new).unwrap_or(&glow);
        let number = before.paints_of(&subject.animated.scene).get(place.spot.material).copied().flatten();
        let material = number.map(|number| before.surfaces[number].1.material());
        asked.target = Target::Spot(place.spot.clone());
        (self.design.target, self.design.asked) = (Some(asked.target.clone()), Some(asked));
        if is_new {
            self.design.glow_before = Some(glow);
        }
        self.design.take(place, light, material.as_ref());
        self.solve();
    }

    /// Finds the material that comes closest to the key frames, and shows it.
    pub fn solve(&mut self) {
        let GlowDesign { place: Some(place), wish: Some(wish), states, glow_before, .. } = &mut self.design
        else {
            return;
        };
        let began = Instant::now();
        let answer = wish.answer(&format!("{}, designed", place.material), *states);
        let milliseconds = 1e3 * began.elapsed().as_secs_f64();
        wish.fit(answer.as_ref().map_or(&[], |answer| &answer.reached));
        let glow = glow_before.as_ref().map(|before| match &answer {
            Ok(answer) => repainted(before, &place.material, answer),
            Err(_) => Ok(Arc::clone(before)),
        });
        self.design.answer = Some((answer, milliseconds)).filter(|(answer, _)| !is_empty(answer));
        match glow {
            Some(Ok(glow)) if self.glow() != Some(&glow) => {
                self.state.show.glow = Some(glow);
                self.requests.moved = Some(Instant::now());
            }
            Some(Err(error)) => self.set_error(error),
            _ => {}
        }
    }

    /// Has the key frames and what was found written, into the folder that the user names, or into one that
    /// is free.
    pub fn write_design(&mut self) {
        let Some(written) = Written::of(self) else { return };
        let named = self.design.folder.trim();
        let folder = match named {
            "" => free(&self.files.folder, "design", ""),
            named => self.files.folder.join(named),
        };
        self.send(FileTask::Design(Box::new(written), folder));
    }
}

/// What glows with a material as it was found.
fn repainted(before: &Glow, material: &str, answer: &Answer) -> Result<Arc<Glow>, String> {
    let paint = Paint::new(&answer.design.material, None)?;
    let mut glow = before.clone();
    match glow.surfaces.iter_mut().find(|(name, _)| name.as_deref() == Some(material)) {
        Some((_, own)) => *own = paint,
        None => glow.surfaces.push((Some(material.to_owned()), paint)),
    }
    Ok(Arc::new(glow))
}

/// Whether nothing was wanted.
const fn is_empty(answer: &Result<Answer, WishError>) -> bool {
    matches!(answer, Err(WishError::NoKeys))
}
