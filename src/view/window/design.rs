//! Key frames of glow: their place is requested, what they ask for is solved and shown, and written.

use super::Window;
use crate::view::design::place::{Asked, Found, Request, Target};
use crate::view::design::written::Written;
use crate::view::design::{self, GlowDesign};
use crate::view::file_worker::FileTask;
use crate::view::saved::free;
use deepshade_glow::paint::Paint;
use deepshade_phosphor::wish::{Answer, WishError};
use deepshade_render::scene::glow::{GlowSurface, PaintTextures};
use deepshade_render::scene::{Glow, Scene};
use glam::Vec3;
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
            spectrum: self.design.spectrum,
            reflected: self.design.reflected,
        };
        if self.design.asked.as_ref() == Some(&asked) {
            return;
        }
        let eye = self.state.controller.map_or(Vec3::ZERO, |controller| controller.camera.position);
        let (subject, time) = (Arc::clone(subject), self.state.time);
        let request = Request { subject, time, eye, asked: asked.clone() };
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
        let material = number.map(|number| before.surfaces[number].paint.material());
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
        let Some(subject) = &self.results.subject else { return };
        let GlowDesign { place: Some(place), wish: Some(wish), states, glow_before, spectrum, .. } =
            &mut self.design
        else {
            return;
        };
        let began = Instant::now();
        let answer = wish.answer(&format!("{}, designed", place.material), *states);
        let milliseconds = 1e3 * began.elapsed().as_secs_f64();
        wish.fit(answer.as_ref().map_or(&[], |answer| &answer.reached));
        let glow = glow_before.as_ref().map(|before| match &answer {
            Ok(answer) => {
                let paint = Paint::new(&answer.design.material, *spectrum);
                paint.map(|paint| {
                    Arc::new(repainted(before, &subject.animated.scene, place.spot.material, paint))
                })
            }
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

/// What glows with another paint of one of a scene's materials. Others that shared its entry keep what they
/// had: several may be called alike.
fn repainted(before: &Glow, scene: &Scene, material: usize, paint: Paint) -> Glow {
    let (names, paints) = (scene.material_names(), before.paints_of(scene));
    let mut glow = before.clone();
    let textures =
        paints[material].map_or_else(PaintTextures::default, |own| before.surfaces[own].textures.clone());
    let name = Some(names[material].clone());
    let Some(entry) = before.surfaces.iter().position(|surface| surface.material == name) else {
        glow.surfaces.push(GlowSurface { material: name, paint, textures });
        return glow;
    };
    let shares = |(other, own): &(usize, Option<usize>)| *other != material && *own == Some(entry);
    let others = paints.into_iter().enumerate().filter(shares);
    let others = others.map(|(other, _)| GlowSurface {
        material: Some(names[other].clone()),
        ..before.surfaces[entry].clone()
    });
    glow.surfaces.extend(others);
    glow.surfaces[entry].paint = paint;
    glow
}

/// Whether nothing was wanted.
const fn is_empty(answer: &Result<Answer, WishError>) -> bool {
    matches!(answer, Err(WishError::NoKeys))
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_render::scene::Material;

    #[test]
    fn one_of_several_materials_called_alike_gets_a_design_of_its_own() {
        let named = |name| Material::matte(name, Vec3::ONE);
        let scene =
            Scene { materials: vec![named("paint"), named("wall"), named("paint")], ..Scene::default() };
        let mut before = Glow::of(&scene).clone();
        let of_all = Paint { name: "all".to_owned(), ..before.surfaces[0].paint.clone() };
        before.surfaces.insert(0, GlowSurface::new(Some("paint"), of_all));
        let designed = Paint { name: "designed".to_owned(), ..before.surfaces[0].paint.clone() };
        for (material, expected) in [
            (0, ["designed", "blue", "all"]),
            (1, ["all", "designed", "all"]),
            (2, ["all", "blue", "designed"]),
        ] {
            let glow = repainted(&before, &scene, material, designed.clone());
            let paints = glow.paints_of(&scene).into_iter();
            let names: Vec<_> =
                paints.map(|paint| glow.surfaces[paint.expect("one")].paint.name.clone()).collect();
            assert_eq!(names, expected);
        }
    }
}
