//! Images as the window shows them.

use crate::render::picture::Exposure;
use crate::report::images::{difference, flip};
use deepshade_render::metrics::exposed;
use deepshade_shaders::{Attribute, Effect, Planes};
use eframe::egui::ColorImage;
use image::{Rgb, RgbImage};
use std::sync::Arc;

/// Values with their picture, as they are handed from thread to thread.
#[derive(Clone)]
pub struct DisplayImage {
    /// What they are: a method's name, or that of truth.
    pub name: String,
    /// Linear values, `[channels, height, width]`.
    pub values: Arc<Planes>,
    /// What is seen of them.
    pub picture: Arc<ColorImage>,
}

impl DisplayImage {
    /// Develops an effect's image.
    pub fn new(name: &str, values: Planes, exposure: Exposure) -> Self {
        let picture = Arc::new(on_screen(&exposure.picture(&values, None)));
        Self { name: name.to_owned(), values: Arc::new(values), picture }
    }

    /// The same values under another exposure.
    pub fn exposed(&self, exposure: Exposure) -> Self {
        let picture = Arc::new(on_screen(&exposure.picture(&self.values, None)));
        Self { picture, ..self.clone() }
    }

    /// Bytes that it takes.
    pub fn size(&self) -> usize {
        size_of_val(self.values.data()) + size_of_val(&self.picture.pixels[..])
    }

    /// An attribute of the g-buffer.
    pub fn of_attribute(attribute: Attribute, values: Planes) -> Self {
        Self::stretched(attribute.name(), values)
    }

    /// Values that are no light, stretched over their own range: the first three channels as colour.
    pub fn stretched(name: &str, values: Planes) -> Self {
        let finite = values.data().iter().copied().filter(|value| value.is_finite());
        let [low, high] =
            finite.fold([f32::MAX, f32::MIN], |[low, high], value| [low.min(value), high.max(value)]);
        let scale = if high > low { 1.0 / (high - low) } else { 1.0 };
        let last = values.channels().min(3) - 1;
        let stretched = Planes::from_fn(3, values.height(), values.width(), |c, y, x| {
            let value = values.at(c.min(last), y, x);
            if value.is_finite() { (value - low) * scale } else { 1.0 }
        });
        let picture = Exposure::Plain.picture(&stretched, None);
        Self { name: name.to_owned(), values: Arc::new(values), picture: Arc::new(on_screen(&picture)) }
    }
}

/// How an image differs from truth, and FLIP, in colours, both under one exposure.
pub fn compared(image: &Planes, truth: &Planes, effect: Effect) -> [ColorImage; 2] {
    let scale = deepshade_render::metrics::exposure(effect, truth);
    let [image, truth] = [image, truth].map(|image| exposed(image, scale));
    [difference(&image, &truth), flip(&image, &truth)].map(|picture| on_screen(&picture))
}

/// What the window shows as a picture for files.
pub fn rgb(image: &ColorImage) -> RgbImage {
    let [width, height] = image.size;
    RgbImage::from_fn(width as u32, height as u32, |x, y| {
        let [red, green, blue, _] = image.pixels[y as usize * width + x as usize].to_array();
        Rgb([red, green, blue])
    })
}

fn on_screen(picture: &RgbImage) -> ColorImage {
    ColorImage::from_rgb([picture.width() as usize, picture.height() as usize], picture.as_raw())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attributes_are_stretched_over_their_range() {
        let values = Planes::from_data(1, 1, 3, vec![-4.0, f32::INFINITY, 12.0]);
        let shown = DisplayImage::of_attribute(Attribute::Depth, values);
        let greys: Vec<[u8; 4]> = shown.picture.pixels.iter().map(|pixel| pixel.to_array()).collect();
        assert_eq!(greys, [[0, 0, 0, 255], [255; 4], [255; 4]]);
        let even = DisplayImage::of_attribute(Attribute::Depth, Planes::filled(1, 1, 1, 3.0));
        assert_eq!(even.picture.pixels[0].to_array(), [0, 0, 0, 255]);
    }

    #[test]
    fn what_equals_truth_differs_nowhere() {
        let truth = Planes::from_fn(3, 8, 8, |c, y, x| 0.1 + 0.1 * ((c + y + x) % 5) as f32);
        let [difference, flip] = compared(&truth, &truth, Effect::Gi);
        assert!(difference.pixels.iter().all(|pixel| *pixel == difference.pixels[0]));
        assert!(flip.pixels.iter().all(|pixel| *pixel == flip.pixels[0]));
        let mut other = truth.clone();
        other.data_mut()[0] += 1.0;
        let [difference, _] = compared(&other, &truth, Effect::Gi);
        assert_ne!(difference.pixels[0], difference.pixels[1]);
    }
}
