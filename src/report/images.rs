//! The report's images: what methods made, how it differs from truth, and FLIP.
//!
//! PNG files show linear values, exposed as for their scores and encoded as sRGB, one channel as grey, so
//! that they look on a screen as the values are; EXR files hold the linear values themselves.

use super::colour_map;
use super::record::TRUTH;
use crate::figures::write_atomically;
use anyhow::{Context, Result};
use deepshade_render::exr_file::{self, Layer, Metadata};
use deepshade_render::metrics::{Scores, exposed, flip_map};
use deepshade_render::path::{Estimate, Truth};
use deepshade_shaders::colour::srgb_byte;
use deepshade_shaders::{Effect, Planes};
use glam::Vec3;
use image::{ImageFormat, Rgb, RgbImage};
use std::{io::Cursor, path::Path};

/// The difference that gets the last colour of the difference map.
pub const DIFFERENCE_RANGE: f32 = 0.25;

/// The three views of an image, as the page calls them: the image, how it differs from truth, and FLIP.
pub const VIEWS: [&str; 3] = ["image", "difference", "flip"];

/// Truth, and by how much light is scaled before images are scored and shown.
pub struct ExposedTruth<'a> {
    /// What is computed.
    pub effect: Effect,
    /// Truth, `[effect.channels(), height, width]`.
    pub image: &'a Planes,
    /// What images are multiplied by.
    pub exposure: f32,
}

impl ExposedTruth<'_> {
    /// Scores of an image against it.
    pub fn scores(&self, image: &Planes) -> Scores {
        Scores::new(&exposed(image, self.exposure), &exposed(self.image, self.exposure))
    }
}

/// Writes truth into its frame's folder: its three views as PNG files, and its values, of which none is lost,
/// as an EXR file. Its difference and FLIP are those between its two halves: its own noise.
///
/// # Errors
/// If a file cannot be written.
pub fn write_truth(
    folder: &Path,
    effect: Effect,
    truth: &Truth,
    exposure: f32,
    facts: &Metadata,
) -> Result<()> {
    let shown = |image: &Planes| exposed(image, exposure);
    let Estimate { mean, variance, .. } = &truth.estimate;
    let [a, b] = [0, 1].map(|half: usize| shown(&truth.halves[half]));
    write_pngs(folder, TRUTH, &shown(mean), [&a, &b])?;
    let layers = variance.iter().map(|variance| Layer::image("variance", variance));
    let layers = [Layer::image(effect.name(), mean)].into_iter().chain(layers).map(Layer::in_full);
    write_exr(folder, facts, TRUTH, &layers.collect::<Vec<_>>())
}

/// Truth as [`write_truth`] wrote it.
///
/// # Errors
/// If the file is missing or damaged.
pub fn read_truth(folder: &Path, effect: Effect) -> Result<Planes> {
    Ok(exr_file::read(&folder.join(format!("{TRUTH}.exr")))?.image(effect.name(), effect.channels())?)
}

/// Writes a method's image into its frame's folder: `<file>.<view>.png` and `<file>.exr`.
///
/// # Errors
/// If a file cannot be written.
pub fn write_image(
    folder: &Path,
    file: &str,
    image: &Planes,
    truth: &ExposedTruth<'_>,
    facts: &Metadata,
) -> Result<()> {
    let shown = exposed(image, truth.exposure);
    write_pngs(folder, file, &shown, [&shown, &exposed(truth.image, truth.exposure)])?;
    write_exr(folder, facts, file, &[Layer::image(truth.effect.name(), image)])
}

/// Whether all files of an image are in a frame's folder.
pub fn are_there(folder: &Path, file: &str) -> bool {
    let pngs = VIEWS.iter().map(|view| format!("{file}.{view}.png"));
    pngs.chain([format!("{file}.exr")]).all(|name| folder.join(name).is_file())
}

/// What the image is called whose file has this name, if it is one of ours.
pub fn stem(name: &str) -> Option<&str> {
    let png = VIEWS.iter().find_map(|view| name.strip_suffix(&format!(".{view}.png")));
    png.or_else(|| name.strip_suffix(".exr"))
}

/// Writes the three views of an image, the second and third of a pair.
fn write_pngs(folder: &Path, name: &str, image: &Planes, [wrong, right]: [&Planes; 2]) -> Result<()> {
    let views = [shown(image), difference(wrong, right), flip(wrong, right)];
    for (view, picture) in VIEWS.iter().zip(&views) {
        write_png(&folder.join(format!("{name}.{view}.png")), picture)?;
    }
    Ok(())
}

/// Writes a method's values, with the frame's facts as text.
fn write_exr(folder: &Path, facts: &Metadata, method: &str, layers: &[Layer<'_>]) -> Result<()> {
    let mut metadata = facts.clone();
    metadata.insert("method".to_owned(), method.to_owned());
    let path = folder.join(format!("{method}.exr"));
    Ok(exr_file::write(&path, layers, &metadata)?)
}

/// An image as seen: one channel as grey, three as colour.
pub fn shown(image: &Planes) -> RgbImage {
    let colour = image.channels() == 3;
    painted(image, |pixel| {
        let channel = |c: usize| image.plane(c)[pixel];
        if colour { Vec3::new(channel(0), channel(1), channel(2)) } else { Vec3::splat(channel(0)) }
    })
}

/// The signed difference of two images, mean over channels, in colours.
pub fn difference(image: &Planes, truth: &Planes) -> RgbImage {
    let channels = image.channels();
    painted(image, |pixel| {
        let sum: f32 = (0..channels).map(|c| image.plane(c)[pixel] - truth.plane(c)[pixel]).sum();
        colour_map::diverging(sum / channels as f32 / DIFFERENCE_RANGE)
    })
}

/// FLIP of two images, in colours.
pub fn flip(image: &Planes, truth: &Planes) -> RgbImage {
    let map = flip_map(image, truth);
    painted(&map, |pixel| colour_map::sequential(map.data()[pixel]))
}

/// A picture of an image's size from a linear colour for each pixel.
pub fn painted(image: &Planes, colour: impl Fn(usize) -> Vec3) -> RgbImage {
    let width = image.width();
    RgbImage::from_fn(width as u32, image.height() as u32, |x, y| {
        Rgb(colour(y as usize * width + x as usize).to_array().map(srgb_byte))
    })
}

/// Writes a picture, whole or not at all.
pub fn write_png(path: &Path, picture: &RgbImage) -> Result<()> {
    let mut bytes = Vec::new();
    picture
        .write_to(&mut Cursor::new(&mut bytes), ImageFormat::Png)
        .with_context(|| format!("{}", path.display()))?;
    write_atomically(path, &bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_values_are_shown_as_srgb() {
        let picture = shown(&Planes::from_data(1, 1, 3, vec![0.0, 0.214_041_14, 2.0]));
        let greys: Vec<[u8; 3]> = picture.pixels().map(|pixel| pixel.0).collect();
        assert_eq!(greys, [[0; 3], [128; 3], [255; 3]]);
        let colour = shown(&Planes::from_data(3, 1, 1, vec![1.0, 0.0, 0.214_041_14]));
        assert_eq!(colour.get_pixel(0, 0).0, [255, 0, 128]);
    }

    #[test]
    fn darker_is_blue_lighter_is_orange_and_equal_is_dark() {
        let truth = Planes::filled(1, 1, 3, 0.5);
        let picture = difference(&Planes::from_data(1, 1, 3, vec![0.4, 0.5, 0.6]), &truth);
        let [below, equal, above] = [0, 1, 2].map(|x| picture.get_pixel(x, 0).0);
        assert!(below[2] > below[0] && above[0] > above[2]);
        assert!(equal.iter().all(|value| *value < 16), "{equal:?}");
    }

    #[test]
    fn rows_stay_rows() {
        let picture = shown(&Planes::from_fn(1, 2, 3, |_, y, x| if (y, x) == (1, 2) { 1.0 } else { 0.0 }));
        assert_eq!((picture.width(), picture.height()), (3, 2));
        assert_eq!(picture.get_pixel(2, 1).0, [255; 3]);
    }
}
