//! The report's images: what methods made, how it differs from truth, and FLIP.
//!
//! PNG files show linear values, exposed as for their scores and encoded as sRGB, one channel as grey, so that they
//! look on a screen as the values are; EXR files hold the linear values themselves.

use super::{FrameReport, colour_map};
use crate::figures::write_atomically;
use anyhow::{Context, Result};
use deepshade_render::exr_file::{self, Layer, Metadata};
use deepshade_render::metrics::{exposed, flip_map};
use deepshade_render::path::Estimate;
use deepshade_shaders::colour::srgb_byte;
use deepshade_shaders::{Effect, Planes};
use glam::Vec3;
use image::{ImageFormat, Rgb, RgbImage};
use std::{io::Cursor, path::Path};

/// The difference that gets the last colour of the difference map.
pub const DIFFERENCE_RANGE: f32 = 0.25;

/// The three views of an image, as the page calls them: the image, how it differs from truth, and FLIP.
pub const VIEWS: [&str; 3] = ["image", "difference", "flip"];

/// Writes every image of a frame into its folder: `<method>.<view>.png` and `<method>.exr`.
///
/// Truth's difference and FLIP are those between its two halves: its own noise.
///
/// # Errors
/// If a file cannot be written.
pub fn write_frame(folder: &Path, effect: Effect, frame: &FrameReport) -> Result<()> {
    let shown = |image: &Planes| exposed(image, frame.truth.exposure);
    let truth = &frame.truth.truth;
    let Estimate { mean, variance, .. } = &truth.estimate;
    let expected = shown(mean);
    for method in &frame.methods {
        let image = shown(&method.image);
        write_pngs(folder, &method.name, &image, [&image, &expected])?;
        write_exr(folder, frame, &method.name, &[Layer::image(effect.name(), &method.image)])?;
    }
    let [a, b] = [0, 1].map(|half: usize| shown(&truth.halves[half]));
    write_pngs(folder, "truth", &expected, [&a, &b])?;
    let variance = variance.iter().map(|variance| Layer::image("variance", variance).in_full());
    let layers: Vec<Layer<'_>> = [Layer::image(effect.name(), mean)].into_iter().chain(variance).collect();
    write_exr(folder, frame, "truth", &layers)
}

/// Whether a frame's folder has files of that name from [`write_frame`].
pub fn is_ours(name: &str) -> bool {
    name.ends_with(".exr") || VIEWS.iter().any(|view| name.ends_with(&format!(".{view}.png")))
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
fn write_exr(folder: &Path, frame: &FrameReport, method: &str, layers: &[Layer<'_>]) -> Result<()> {
    let mut metadata: Metadata = frame.facts.iter().cloned().collect();
    metadata.insert("frame".to_owned(), frame.name.clone());
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
