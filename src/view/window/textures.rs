//! What is seen of the images: textures, and the order in which they lie.

use super::Window;
use crate::view::canvas::CanvasImage;
use crate::view::state::Map;
use eframe::egui::{ColorImage, Context, TextureFilter, TextureOptions};
use std::sync::Arc;

impl Window {
    /// Images in the order in which they are shown: of methods, of truth, of the g-buffer, of
    /// an EXR file.
    pub fn shown(&self) -> Vec<CanvasImage<'_>> {
        let Some(picture) = &self.results.picture else { return Vec::new() };
        let truth = self.truth_of_picture().map(|truth| &truth.image);
        let all = picture.images.iter().chain(truth).chain(&picture.inspected).chain(&self.layers.images);
        let metrics = self.metrics_of_picture();
        let is_measured =
            |name: &str| metrics.is_some_and(|metrics| metrics.images.iter().any(|image| image.name == name));
        let (map, reference) = (self.state.look.map, self.state.reference());
        let methods = &picture.request.show.methods;
        all.filter_map(|image| {
            let name = image.name.as_str();
            let texture = |map| self.results.textures.get(&(name.to_owned(), map));
            let seen = texture(map).filter(|_| is_measured(name));
            // Only methods' images have maps, but for the one that the others are measured against.
            let has_map = map != Map::Image && name != reference && methods.contains(&name);
            let lacks_map = has_map && seen.is_none();
            let texture = seen.or_else(|| texture(Map::Image))?.id();
            Some(CanvasImage { name, values: &image.values, texture, lacks_map })
        })
        .collect()
    }

    /// Shows a picture of an image from now on.
    pub fn set_texture(&mut self, context: &Context, name: &str, map: Map, picture: &Arc<ColorImage>) {
        let options = TextureOptions { magnification: TextureFilter::Nearest, ..TextureOptions::LINEAR };
        match self.results.textures.get_mut(&(name.to_owned(), map)) {
            Some(texture) => texture.set(Arc::clone(picture), options),
            None => {
                let texture = context.load_texture(name, Arc::clone(picture), options);
                self.results.textures.insert((name.to_owned(), map), texture);
            }
        }
    }
}
