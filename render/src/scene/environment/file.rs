//! Texels from Radiance HDR and OpenEXR files, also damaged ones.

mod radiance;

use crate::exr_file::{self, ExrError, Windows};
use crate::scene::SceneError;
use glam::Vec3;
use std::path::Path;

/// An image in memory.
pub(super) struct Image {
    pub width: usize,
    pub height: usize,
    /// Row by row from the top, RGB.
    pub texels: Vec<Vec3>,
    /// What of the map the file does not hold, if so.
    pub cropped: Option<String>,
}

/// Reads a file by its ending.
pub(super) fn read(path: &Path) -> Result<Image, SceneError> {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    match ending.as_str() {
        "hdr" => radiance::read(path),
        "exr" => read_exr(path),
        _ => Err(SceneError::invalid(path, "not an environment map that is known here (.hdr, .exr)")),
    }
}

fn read_exr(path: &Path) -> Result<Image, SceneError> {
    let (image, windows) = exr_file::read_colour(path).map_err(|error| match error {
        ExrError::Io { path, source } => SceneError::Io { path, source },
        ExrError::Invalid { path, what } => {
            SceneError::Invalid { path, what: format!("not a usable EXR file: {what}") }
        }
        ExrError::MissingChannels { missing, held, .. } => {
            SceneError::invalid(path, format!("no channel {missing}; the file holds {held}"))
        }
        ExrError::Ambiguous { wanted, candidates, .. } => {
            SceneError::invalid(path, format!("`{wanted}` is ambiguous: {candidates}"))
        }
        ExrError::MissingLayer { .. } => unreachable!("no layer is chosen"),
        ExrError::NotHalf { .. } => unreachable!("an error of writing"),
    })?;
    let (width, height) = (image.width(), image.height());
    super::check_size(width, height).map_err(|what| SceneError::invalid(path, what))?;
    let texel = |index: usize| Vec3::from_array([0, 1, 2].map(|channel| image.plane(channel)[index]));
    let texels = (0..width * height).map(texel).collect();
    let is_part = !windows.data.contains(&windows.display);
    let cropped = is_part.then(|| {
        let Windows { data, display } = windows;
        format!(
            "its pixels, {data}, are a part of its display window, {display}; the rest of the map is black"
        )
    });
    Ok(Image { width, height, texels, cropped })
}
