//! Images as PNG files.

use deepshade_shaders::Planes;
use std::error::Error;
use std::fs;
use std::path::Path;

/// Writes images, values from 0 to 1, as `scene-name.png` into a folder.
///
/// # Errors
/// If one cannot be written.
pub fn write(folder: &Path, scene: &str, images: &[(&str, Planes)]) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(folder)?;
    for (name, planes) in images {
        let value = |channel: usize, y: u32, x: u32| {
            let value = planes.at(channel.min(planes.channels() - 1), y as usize, x as usize);
            (255.0 * value.clamp(0.0, 1.0)).round() as u8
        };
        let pixel = |x: u32, y: u32| image::Rgb([0, 1, 2].map(|channel| value(channel, y, x)));
        let picture = image::RgbImage::from_fn(planes.width() as u32, planes.height() as u32, pixel);
        picture.save(folder.join(format!("{scene}-{name}.png")))?;
    }
    Ok(())
}
