//! An EXR file beside the methods: its layers as pictures.

use super::clerk::Errand;
use super::pictures::Developed;
use super::window::Window;
use crate::render::picture::Exposure;
use anyhow::{Context, Result, ensure};
use deepshade_render::exr_file::{self, ExrImage};
use deepshade_shaders::{Attribute, Effect, Planes};
use eframe::egui::Ui;
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

/// Which layers are to be seen, and how they are exposed.
#[derive(Clone, PartialEq)]
pub struct Choice {
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

    /// Pictures of some layers.
    ///
    /// # Errors
    /// If it does not have one.
    pub fn developed(&self, choice: &Choice) -> Result<Vec<Developed>> {
        let picture = |layer: &String| {
            let values = self.image.layer(layer).with_context(|| format!("layer {layer}"))?;
            let name = format!("{}: {layer}", self.name);
            Ok(match exposure(layer, &values, choice) {
                Some(exposure) => Developed::new(&name, values, exposure),
                None => Developed::stretched(&name, values),
            })
        };
        choice.layers.iter().map(picture).collect()
    }
}

/// How a layer is exposed; not at all where it is no picture but is stretched over its own range.
fn exposure(layer: &str, values: &Planes, choice: &Choice) -> Option<Exposure> {
    let highest = values.data().iter().copied().filter(|value| value.is_finite()).fold(0.0, f32::max);
    let is_lone = values.channels() == 1;
    if attribute(layer).is_some()
        || (is_lone && highest > 1.0)
        || values.data().iter().any(|value| *value < 0.0)
    {
        return None;
    }
    match choice.exposure {
        Some(exposure @ Exposure::Tone { .. }) if !is_lone => Some(exposure),
        _ if highest <= 1.0 => Some(Exposure::Plain.brighter(choice.stops)),
        _ => Some(Exposure::new(Effect::Path, values, None).brighter(choice.stops)),
    }
}

/// The attribute of a g-buffer that a layer is, if any, whatever stands before its name.
fn attribute(layer: &str) -> Option<Attribute> {
    let name = layer.rsplit('.').next().unwrap_or(layer);
    Attribute::ALL.into_iter().find(|attribute| attribute.name().eq_ignore_ascii_case(name))
}

/// Shows which layers there are.
pub fn show(ui: &mut Ui, window: &mut Window) {
    let Some(opened) = window.opened.clone() else { return };
    ui.separator();
    ui.horizontal(|ui| {
        ui.strong(&opened.name);
        if ui.small_button("close").clicked() {
            window.close_layers();
        }
    });
    ui.horizontal_wrapped(|ui| {
        for layer in opened.layers.iter().take(LISTED) {
            let chosen = window.layers.contains(layer);
            if ui.selectable_label(chosen, layer).clicked() {
                match chosen {
                    true => window.layers.retain(|other| other != layer),
                    false => window.layers.push(layer.clone()),
                }
            }
        }
    });
}

impl Window {
    /// Shows exactly these layers of the file that is open.
    ///
    /// # Errors
    /// If there is no file, or it has no such layer; those that it has are listed.
    pub fn choose_layers(&mut self, layers: &[String]) -> Result<()> {
        let opened = self.opened.as_ref().context("no EXR file is open")?;
        for layer in layers {
            let there = opened.layers.join(", ");
            ensure!(
                opened.layers.contains(layer),
                "{} has no layer `{layer}`; there are {there}",
                opened.name
            );
        }
        self.layers = layers.to_vec();
        Ok(())
    }

    /// Looks at the methods alone again.
    pub fn close_layers(&mut self) {
        (self.opened, self.developing) = (None, None);
        self.layers.clear();
        self.put_away_layers();
    }

    /// Forgets the pictures of layers.
    pub fn put_away_layers(&mut self) {
        for picture in std::mem::take(&mut self.developed) {
            self.hide(&picture.name);
        }
    }

    /// Takes a file that was read.
    pub fn take_opened(&mut self, opened: Opened) {
        self.close_layers();
        self.layers = opened.first();
        self.opened = Some(opened);
    }

    /// Which layers are to be seen of the file that is open, and how.
    pub fn choice_of_layers(&self) -> Option<Choice> {
        self.opened.as_ref()?;
        let exposure = self.picture.as_ref().and_then(|picture| picture.exposure);
        Some(Choice { layers: self.layers.clone(), exposure, stops: self.state.stops })
    }

    /// Has the layers developed that are to be seen, where those that are seen are others or otherwise exposed.
    pub fn order_layers(&mut self) {
        let (Some(choice), Some(opened)) = (self.choice_of_layers(), &self.opened) else { return };
        if self.developing.as_ref() != Some(&choice) {
            let errand = Errand::Develop(opened.clone(), choice.clone());
            self.developing = Some(choice);
            self.send(errand);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_exposed_and_what_lies_beside_them_is_stretched() {
        let tone = Exposure::Tone { middle: 0.5, white: 4.0 };
        let choice = |exposure| Choice { layers: Vec::new(), exposure, stops: 0.0 };
        let [dim, bright] = [0.5, 8.0].map(|value| Planes::filled(3, 2, 2, value));
        assert_eq!(exposure("RGB", &bright, &choice(Some(tone))), Some(tone), "as the methods' images");
        assert_eq!(exposure("RGB", &dim, &choice(Some(Exposure::Plain))), Some(Exposure::Plain));
        assert!(matches!(exposure("RGB", &bright, &choice(None)), Some(Exposure::Tone { .. })));
        assert_eq!(exposure("view.normal", &dim, &choice(Some(tone))), None);
        assert_eq!(exposure("Z", &Planes::filled(1, 2, 2, 30.0), &choice(Some(tone))), None);
        assert_eq!(
            exposure("target.ao", &Planes::filled(1, 2, 2, 0.7), &choice(None)),
            Some(Exposure::Plain)
        );
    }
}
