//! What is seen of the images: textures, and the order in which they lie.

use super::Window;
use crate::render::picture::Exposure;
use crate::view::canvas::Shown;
use crate::view::state::Map;
use eframe::egui::{ColorImage, Context, TextureFilter, TextureOptions};
use std::sync::Arc;

impl Window {
    /// Images in the order in which they are shown: of methods, of truth, of the g-buffer, of
    /// an EXR file.
    pub fn shown(&self) -> Vec<Shown<'_>> {
        let Some(picture) = &self.picture else { return Vec::new() };
        let truth = self.truth_of_picture().map(|truth| &truth.image);
        let all = picture.images.iter().chain(truth).chain(&picture.inspected).chain(&self.developed);
        let verdict = self.verdict_of_picture();
        let is_judged = |name: &str| {
            verdict.is_some_and(|verdict| verdict.judged.iter().any(|judged| judged.name == name))
        };
        let (map, reference) = (self.state.map, self.state.reference());
        let methods = &picture.order.show.methods;
        all.filter_map(|image| {
            let name = image.name.as_str();
            let texture = |map| self.textures.get(&(name.to_owned(), map));
            let seen = texture(map).filter(|_| is_judged(name));
            // What is no method's is no more than shown, and what others are held against, too.
            let has_map = map != Map::Image && name != reference && methods.contains(&name);
            let lacks_map = has_map && seen.is_none();
            let texture = seen.or_else(|| texture(Map::Image))?.id();
            Some(Shown { name, values: &image.values, texture, lacks_map })
        })
        .collect()
    }

    /// Exposes images as suits the first one now, however the first of all was exposed.
    pub fn expose_anew(&mut self) {
        self.state.stops = 0.0;
        let is_seen = self.made.as_ref().is_some_and(|made| !self.shows_else(made));
        let picture = self.picture.as_ref().filter(|_| is_seen);
        let suits = picture.and_then(|picture| {
            Some(Exposure::new(picture.order.show.effect, &picture.images.first()?.values, None))
        });
        self.exposure = suits;
        if !is_seen {
            // What is to be seen is still to come, and finds its own: one that was ordered before has another.
            self.made = None;
            self.ordered.iter_mut().for_each(|ordered| ordered.outdated = true);
        }
    }

    /// Shows a picture of an image from now on.
    pub fn show(&mut self, context: &Context, name: &str, map: Map, picture: &Arc<ColorImage>) {
        let options = TextureOptions { magnification: TextureFilter::Nearest, ..TextureOptions::LINEAR };
        match self.textures.get_mut(&(name.to_owned(), map)) {
            Some(texture) => texture.set(Arc::clone(picture), options),
            None => {
                let texture = context.load_texture(name, Arc::clone(picture), options);
                self.textures.insert((name.to_owned(), map), texture);
            }
        }
    }

    /// Shows an image no more.
    pub fn hide(&mut self, name: &str) {
        self.textures.remove(&(name.to_owned(), Map::Image));
    }
}
