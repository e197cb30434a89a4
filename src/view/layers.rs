//! An EXR file beside the methods: its layers as pictures.

use super::display_image::DisplayImage;
use super::file_worker::FileTask;
use super::state::Map;
use super::window::Window;
use crate::output::message;
use crate::render::picture::Exposure;
use anyhow::{Context as _, Result, ensure};
use deepshade_render::exr_file::{self, ExrImage};
use deepshade_shaders::{Attribute, Effect, Planes};
use eframe::egui::{Context, Ui};
use std::path::Path;
use std::sync::Arc;

/// Layers that are shown beside the choices at once.
const LISTED: usize = 64;

/// A file that was opened.
#[derive(Clone)]
pub struct Opened {
    /// What it is called, without its folder.
    pub name: String,
    /// Its layers.
    pub layers: Vec<String>,
    image: Arc<ExrImage>,
}

impl PartialEq for Opened {
    /// A file that was read at another time is another one.
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.image, &other.image)
    }
}

/// The EXR file beside the methods.
#[derive(Default)]
pub struct FileLayers {
    /// It.
    pub opened: Option<Opened>,
    /// Which of its layers are to be seen.
    pub chosen: Vec<String>,
    /// Images of these.
    pub images: Vec<DisplayImage>,
    /// The choice that these are of.
    pub seen: Option<Choice>,
    /// Whether images of another one are being made.
    pending: bool,
}

/// Which layers are to be seen, and how they are exposed.
#[derive(Clone, PartialEq)]
pub struct Choice {
    /// The file.
    pub opened: Opened,
    /// Their names.
    pub layers: Vec<String>,
    /// As the methods' images are; by default as suits each.
    pub exposure: Option<Exposure>,
    /// How much brighter, stops.
    pub stops: f32,
}

impl Opened {
    /// Reads a file.
    ///
    /// # Errors
    /// If it cannot be read, or shows nothing.
    pub fn read(path: &Path) -> Result<Self> {
        let image = exr_file::read(path)?;
        let layers = image.layers();
        ensure!(!layers.is_empty(), "{}: it has no layer", path.display());
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Self { name, layers, image: Arc::new(image) })
    }

    /// What is seen of it first: a picture rather than what lies beside one.
    pub fn first(&self) -> Vec<String> {
        let is_picture = |layer: &&String| attribute(layer).is_none();
        let first = self.layers.iter().find(is_picture).or(self.layers.first());
        first.into_iter().cloned().collect()
    }
}

impl Choice {
    /// Images of the layers.
    ///
    /// # Errors
    /// If the file lacks one.
    pub fn images(&self) -> Result<Vec<DisplayImage>> {
        let Opened { name, image, .. } = &self.opened;
        let picture = |layer: &String| {
            let values = image.layer(layer).with_context(|| format!("{name}: layer {layer}"))?;
            let name = format!("{name}: {layer}");
            Ok(match exposure(layer, &values, self.exposure, self.stops) {
                Some(exposure) => DisplayImage::new(&name, values, exposure),
                None => DisplayImage::stretched(&name, values),
            })
        };
        self.layers.iter().map(picture).collect()
    }
}

/// How a layer is exposed, as the methods' images are or as suits it, and so many stops brighter; not at all
/// where it is no picture but is stretched over its own range.
fn exposure(layer: &str, values: &Planes, of_methods: Option<Exposure>, stops: f32) -> Option<Exposure> {
    let highest = values.data().iter().copied().filter(|value| value.is_finite()).fold(0.0, f32::max);
    let is_lone = values.channels() == 1;
    if attribute(layer).is_some()
        || (is_lone && highest > 1.0)
        || values.data().iter().any(|value| *value < 0.0)
    {
        return None;
    }
    match of_methods {
        Some(exposure @ Exposure::Tone { .. }) if !is_lone => Some(exposure),
        _ if highest <= 1.0 => Some(Exposure::Plain.brighter(stops)),
        _ => Some(Exposure::new(Effect::Path, values, None).brighter(stops)),
    }
}

/// The attribute of a g-buffer that a layer is, if any, whatever stands before its name.
fn attribute(layer: &str) -> Option<Attribute> {
    let name = layer.rsplit('.').next().unwrap_or(layer);
    Attribute::ALL.into_iter().find(|attribute| attribute.name().eq_ignore_ascii_case(name))
}

/// Shows which layers there are.
pub fn show(ui: &mut Ui, window: &mut Window) {
    let Some(opened) = window.layers.opened.clone() else { return };
    ui.separator();
    ui.horizontal_wrapped(|ui| {
        ui.strong(&opened.name);
        if ui.small_button("close").on_hover_text("looks at the methods alone again").clicked() {
            window.replace_layers(FileLayers::default());
        }
    });
    let chosen = &mut window.layers.chosen;
    ui.horizontal_wrapped(|ui| {
        for layer in opened.layers.iter().take(LISTED) {
            let index = chosen.iter().position(|other| other == layer);
            let hint = "whether this layer of the file is seen beside the images";
            if ui.selectable_label(index.is_some(), layer).on_hover_text(hint).clicked() {
                match index {
                    Some(index) => drop(chosen.remove(index)),
                    None => chosen.push(layer.clone()),
                }
            }
        }
    });
}

impl Window {
    fn replace_layers(&mut self, layers: FileLayers) {
        let pending = self.layers.pending;
        for image in std::mem::replace(&mut self.layers, FileLayers { pending, ..layers }).images {
            self.results.textures.remove(&(image.name, Map::Image));
        }
    }

    /// Takes a file that was read.
    pub fn take_opened(&mut self, opened: Opened) {
        let (chosen, opened) = (opened.first(), Some(opened));
        self.replace_layers(FileLayers { opened, chosen, ..FileLayers::default() });
    }

    /// Which layers are to be seen of the file that is open, and how.
    pub fn choice_of_layers(&self) -> Option<Choice> {
        let opened = self.layers.opened.clone()?;
        let exposure = self.results.picture.as_ref().and_then(|picture| picture.exposure);
        Some(Choice { opened, layers: self.layers.chosen.clone(), exposure, stops: self.state.look.stops })
    }

    /// Requests the layers that are to be seen, one choice at a time, where those that are seen are others or
    /// otherwise exposed.
    pub fn request_layers(&mut self) {
        let choice = self.choice_of_layers().filter(|choice| self.layers.seen.as_ref() != Some(choice));
        if let Some(choice) = choice.filter(|_| !self.layers.pending) {
            self.layers.pending = true;
            self.send(FileTask::Layers(Box::new(choice)));
        }
    }

    /// Takes images of layers, or why there are none. The user may have opened another file meanwhile, or
    /// closed it.
    pub fn take_layers(&mut self, context: &Context, choice: Choice, images: Result<Vec<DisplayImage>>) {
        self.layers.pending = false;
        if self.layers.opened.as_ref() != Some(&choice.opened) {
            return;
        }
        let images = images.unwrap_or_else(|error| {
            self.set_error(message(&error));
            Vec::new()
        });
        let FileLayers { opened, chosen, .. } = &self.layers;
        let (opened, chosen) = (opened.clone(), chosen.clone());
        self.replace_layers(FileLayers { opened, chosen, images, seen: Some(choice), pending: false });
        for image in self.layers.images.clone() {
            self.set_texture(context, &image.name, Map::Image, &image.picture);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_exposed_and_what_lies_beside_them_is_stretched() {
        let tone = Exposure::Tone { middle: 0.5, white: 4.0 };
        let [dim, bright] = [0.5, 8.0].map(|value| Planes::filled(3, 2, 2, value));
        assert_eq!(exposure("RGB", &bright, Some(tone), 0.0), Some(tone), "as the methods' images");
        assert_eq!(exposure("RGB", &dim, Some(Exposure::Plain), 0.0), Some(Exposure::Plain));
        assert!(matches!(exposure("RGB", &bright, None, 0.0), Some(Exposure::Tone { .. })));
        assert_eq!(exposure("view.normal", &dim, Some(tone), 0.0), None);
        assert_eq!(exposure("Z", &Planes::filled(1, 2, 2, 30.0), Some(tone), 0.0), None);
        assert_eq!(exposure("target.ao", &Planes::filled(1, 2, 2, 0.7), None, 0.0), Some(Exposure::Plain));
    }

    #[test]
    fn layers_are_read_and_one_that_is_missing_is_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("layers.exr");
        let values = Planes::filled(1, 2, 3, 0.25);
        let layers = ["ao", "depth"].map(|name| exr_file::Layer::image(name, &values).in_full());
        exr_file::write(&path, &layers, &exr_file::Metadata::default()).expect("written");
        let opened = Opened::read(&path).expect("a file");
        assert!(opened == opened.clone() && opened != Opened::read(&path).expect("a file"));
        let layers = opened.first();
        let choice = Choice { opened, layers, exposure: None, stops: 0.0 };
        assert_eq!(choice.images().expect("an image")[0].name, "layers.exr: ao");
        let missing = Choice { layers: vec!["shadow".to_owned()], ..choice };
        assert!(missing.images().err().expect("no layer").to_string().contains("shadow"));
    }
}
