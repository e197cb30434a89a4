//! An EXR file beside the methods: its layers as pictures.

use super::caught::caught;
use super::desk::News;
use super::mailbox::Mailbox;
use super::pictures::Developed;
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
    /// Pictures of the layers.
    ///
    /// # Errors
    /// If the file lacks one.
    fn developed(&self) -> Result<Vec<Developed>> {
        let Opened { name, image, .. } = &self.opened;
        let picture = |layer: &String| {
            let values = image.layer(layer).with_context(|| format!("{name}: layer {layer}"))?;
            let name = format!("{name}: {layer}");
            Ok(match exposure(layer, &values, self.exposure, self.stops) {
                Some(exposure) => Developed::new(&name, values, exposure),
                None => Developed::stretched(&name, values),
            })
        };
        self.layers.iter().map(picture).collect()
    }
}

/// Develops the newest choice until the mailbox is closed.
pub fn run(orders: &Mailbox<Choice>, tell: &dyn Fn(News)) {
    while let Some(choice) = orders.take() {
        let developed = caught("layers of an EXR file", || choice.developed());
        tell(News::Layers(choice, developed.map_err(|error| message(&error))));
    }
}

/// How a layer is exposed, as the methods' images are or as suits it, and so many stops brighter; not at all where it is no picture but
/// is stretched over its own range.
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
    let Some(opened) = window.opened.clone() else { return };
    ui.separator();
    ui.horizontal_wrapped(|ui| {
        ui.strong(&opened.name);
        if ui.small_button("close").on_hover_text("looks at the methods alone again").clicked() {
            window.close_layers();
        }
    });
    ui.horizontal_wrapped(|ui| {
        for layer in opened.layers.iter().take(LISTED) {
            let chosen = window.layers.contains(layer);
            let hint = "whether this layer of the file is seen beside the images";
            if ui.selectable_label(chosen, layer).on_hover_text(hint).clicked() {
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
        (self.opened, self.developing, self.develops) = (None, None, false);
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
        let opened = self.opened.clone()?;
        let exposure = self.picture.as_ref().and_then(|picture| picture.exposure);
        Some(Choice { opened, layers: self.layers.clone(), exposure, stops: self.state.stops })
    }

    /// Has the layers developed that are to be seen, where those that are seen are others or otherwise exposed.
    pub fn order_layers(&mut self) {
        let Some(choice) = self.choice_of_layers().filter(|choice| self.developing.as_ref() != Some(choice))
        else {
            return;
        };
        self.order_development(choice.clone());
        (self.developing, self.develops) = (Some(choice), true);
    }

    /// Takes pictures of layers. Hands may have chosen others meanwhile, or closed the file.
    pub fn take_layers(
        &mut self,
        context: &Context,
        choice: &Choice,
        developed: Result<Vec<Developed>, String>,
    ) {
        let Some(wanted) = self.developing.as_ref().filter(|wanted| wanted.opened == choice.opened) else {
            return;
        };
        self.develops &= wanted != choice;
        if wanted.layers != choice.layers {
            return;
        }
        match developed {
            Ok(pictures) => {
                self.put_away_layers();
                pictures.iter().for_each(|it| self.show(context, &it.name, Map::Image, &it.picture));
                self.developed = pictures;
            }
            Err(what) => self.refuse(what),
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
    fn of_many_choices_the_newest_is_developed() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("layers.exr");
        let values = Planes::filled(1, 2, 3, 0.25);
        let layers = ["ao", "depth"].map(|name| exr_file::Layer::image(name, &values).in_full());
        exr_file::write(&path, &layers, &exr_file::Metadata::default()).expect("written");
        let opened = Opened::read(&path).expect("a file");
        assert!(opened == opened.clone() && opened != Opened::read(&path).expect("a file"));
        let choice = |layer: &str, stops| Choice {
            opened: opened.clone(),
            layers: vec![layer.to_owned()],
            exposure: None,
            stops,
        };
        let orders = Mailbox::default();
        (0..100u8).for_each(|stops| orders.put(choice("ao", f32::from(stops) / 100.0)));
        let told = std::cell::RefCell::new(Vec::new());
        let tell = |news| {
            if let News::Layers(choice, developed) = news {
                told.borrow_mut().push((choice, developed.map(|pictures| pictures.len())));
            }
            // One that fails is told of, too, and is the last.
            match told.borrow().len() {
                1 => orders.put(choice("shadow", 0.0)),
                _ => orders.close(),
            }
        };
        run(&orders, &tell);
        let told = told.into_inner();
        assert!(told.len() == 2 && told[0].0 == choice("ao", 0.99) && told[0].1 == Ok(1));
        assert!(told[1].1.as_ref().is_err_and(|what| what.contains("shadow")), "{:?}", told[1].1);
    }
}
