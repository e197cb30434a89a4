//! What is seen of the images: textures, and the order in which they lie.

use super::Window;
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
        let seen = |name: &str| {
            let map = self.textures.get(&(name.to_owned(), self.state.map)).filter(|_| is_judged(name));
            map.or_else(|| self.textures.get(&(name.to_owned(), Map::Image)))
        };
        all.filter_map(|image| {
            Some(Shown { name: &image.name, values: &image.values, texture: seen(&image.name)?.id() })
        })
        .collect()
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
