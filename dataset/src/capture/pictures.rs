//! The images of a capture.

use super::{CaptureCamera, CaptureError};
use deepshade_shaders::Planes;
use deepshade_shaders::colour::LINEAR_OF_SRGB;
use image::{DynamicImage, ImageDecoder, ImageReader};
use std::path::Path;

/// A colour image as radiance, `[3, height, width]`: its sRGB bytes, linear, white being 1.
///
/// # Errors
/// If it is missing, damaged or not of the camera's size.
pub fn colour(path: &Path, camera: &CaptureCamera) -> Result<Planes, CaptureError> {
    let image = decoded(path, camera)?.into_rgb8();
    let [height, width] = camera.size;
    Ok(Planes::from_fn(3, height, width, |channel, y, x| {
        LINEAR_OF_SRGB[image.get_pixel(x as u32, y as u32)[channel] as usize]
    }))
}

/// A depth image, `[1, height, width]`, metres along the view's axis, 0 where there is none.
///
/// # Errors
/// If it is missing, damaged, has not 16 bits a pixel or is not of the camera's size.
pub fn depth(path: &Path, camera: &CaptureCamera) -> Result<Planes, CaptureError> {
    let DynamicImage::ImageLuma16(image) = decoded(path, camera)? else {
        return Err(CaptureError::invalid(path, "is no grey image of 16 bits a pixel, as depth must be"));
    };
    let [height, width] = camera.size;
    let metres = |value: &u16| f32::from(*value) / camera.depth_scale;
    Ok(Planes::from_data(1, height, width, image.as_raw().iter().map(metres).collect()))
}

/// A PNG or JPEG image of the camera's size, which is checked before the pixels are read.
fn decoded(path: &Path, camera: &CaptureCamera) -> Result<DynamicImage, CaptureError> {
    let io = |source| CaptureError::io(path, source);
    let reader = ImageReader::open(path).and_then(ImageReader::with_guessed_format).map_err(io)?;
    let decoder = reader.into_decoder().map_err(|error| damaged(path, &error))?;
    let (found_width, found_height) = decoder.dimensions();
    let [height, width] = camera.size;
    if [found_height as usize, found_width as usize] != [height, width] {
        return Err(CaptureError::Size {
            path: path.to_owned(),
            found: format!("{found_width} x {found_height}"),
            expected: format!("{width} x {height}"),
        });
    }
    DynamicImage::from_decoder(decoder).map_err(|error| damaged(path, &error))
}

fn damaged(path: &Path, error: &image::ImageError) -> CaptureError {
    CaptureError::invalid(path, format!("is a damaged image or none: {error}"))
}
