//! Texels from Radiance HDR and OpenEXR files, also damaged ones.

use crate::exr_file::{self, ExrError};
use crate::scene::SceneError;
use glam::Vec3;
use image::{DynamicImage, ImageDecoder, codecs::hdr::HdrDecoder};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// The most texels that a byte of a Radiance file stands for: two bytes repeat one of four values up to 127 times.
const TEXELS_PER_BYTE: u64 = 16;

/// An image in memory.
pub(super) struct Image {
    pub width: usize,
    pub height: usize,
    /// Row by row from the top, RGB.
    pub texels: Vec<Vec3>,
}

/// Reads a file by its ending.
pub(super) fn read(path: &Path) -> Result<Image, SceneError> {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    match ending.as_str() {
        "hdr" => read_hdr(path),
        "exr" => read_exr(path),
        _ => Err(SceneError::invalid(path, "not an environment map that is known here (.hdr, .exr)")),
    }
}

fn read_hdr(path: &Path) -> Result<Image, SceneError> {
    let io = |source| SceneError::Io { path: path.to_owned(), source };
    let damaged = |error: image::ImageError| {
        SceneError::invalid(path, format!("not a usable Radiance HDR image: {error}"))
    };
    let file = File::open(path).map_err(io)?;
    let bytes = file.metadata().map_err(io)?.len();
    let decoder = HdrDecoder::new(BufReader::new(file)).map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    // Before memory is taken for what the header promises.
    super::check_size(width as usize, height as usize).map_err(|what| SceneError::invalid(path, what))?;
    if u64::from(width) * u64::from(height) > bytes * TEXELS_PER_BYTE {
        return Err(SceneError::invalid(
            path,
            format!("promises {width} x {height} texels in {bytes} bytes"),
        ));
    }
    let image = DynamicImage::from_decoder(decoder).map_err(damaged)?.into_rgb32f();
    let texels = image.pixels().map(|pixel| Vec3::from_array(pixel.0)).collect();
    Ok(Image { width: width as usize, height: height as usize, texels })
}

fn read_exr(path: &Path) -> Result<Image, SceneError> {
    let image = exr_file::read(path).and_then(|image| image.colour()).map_err(|error| match error {
        ExrError::Io { path, source } => SceneError::Io { path, source },
        ExrError::Invalid { path, what } => {
            SceneError::Invalid { path, what: format!("not a usable EXR file: {what}") }
        }
        ExrError::MissingChannels { missing, held, .. } => {
            SceneError::invalid(path, format!("no channel {missing}; the file holds {held}"))
        }
        ExrError::NotHalf { .. } => unreachable!("an error of writing"),
    })?;
    let (width, height) = (image.width(), image.height());
    super::check_size(width, height).map_err(|what| SceneError::invalid(path, what))?;
    let texel = |index: usize| Vec3::from_array([0, 1, 2].map(|channel| image.plane(channel)[index]));
    Ok(Image { width, height, texels: (0..width * height).map(texel).collect() })
}
