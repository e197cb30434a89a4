//! Reading what a scene file refers to: bytes with a size limit, and images.

use super::SceneError;
use crate::memory;
use std::path::{Component, Path, PathBuf};
use std::{fs, io::Cursor};

/// Largest file that is read, bytes.
const LARGEST_FILE: u64 = 4 << 30;

/// Largest edge of an image, texels.
const LARGEST_EDGE: u32 = 16_384;

/// An image as four bytes a texel, row by row from the top left.
#[derive(Clone, Debug)]
pub(super) struct Image {
    pub width: usize,
    pub height: usize,
    pub texels: Vec<[u8; 4]>,
}

/// The bytes of a plain file. Devices and pipes, which may never end, are refused, as is what memory does not hold.
pub(super) fn read(path: &Path) -> Result<Vec<u8>, SceneError> {
    let io = |source| SceneError::Io { path: path.to_owned(), source };
    let metadata = fs::metadata(path).map_err(io)?;
    if !metadata.is_file() {
        return Err(SceneError::invalid(path, "is not a plain file"));
    }
    if metadata.len() > LARGEST_FILE.min(memory::available()) {
        return Err(SceneError::invalid(path, format!("has {} bytes, more than are read", metadata.len())));
    }
    fs::read(path).map_err(io)
}

/// Where a file is that a scene in `folder` names, in a file of its own that lies in the folder `below`. Names do not lead out of the
/// scene's folder, since a scene may come from anybody; what shall be read from elsewhere, a link in the folder may stand for.
pub(super) fn beside(folder: &Path, below: &Path, name: &str) -> Result<PathBuf, String> {
    let mut inside = below.to_owned();
    for component in Path::new(name).components() {
        match component {
            Component::Normal(part) => inside.push(part),
            Component::CurDir => {}
            Component::ParentDir if inside.pop() => {}
            _ => {
                return Err(format!(
                    "`{name}` is not in the scene's folder, and nothing else is read; a link there may stand for it"
                ));
            }
        }
    }
    Ok(folder.join(inside))
}

/// Decodes a PNG or JPEG image; the error says what is wrong with it.
pub(super) fn decode(bytes: &[u8]) -> Result<Image, String> {
    let format = match image::guess_format(bytes) {
        Ok(format @ (image::ImageFormat::Png | image::ImageFormat::Jpeg)) => format,
        _ => return Err("is neither a PNG nor a JPEG image".to_owned()),
    };
    let mut limits = image::Limits::default();
    limits.max_image_width = Some(LARGEST_EDGE);
    limits.max_image_height = Some(LARGEST_EDGE);
    let mut reader = image::ImageReader::with_format(Cursor::new(bytes), format);
    reader.limits(limits);
    let image = reader.decode().map_err(|error| format!("is a damaged image: {error}"))?.into_rgba8();
    let (width, height) = (image.width() as usize, image.height() as usize);
    let texels = image.into_raw().as_chunks::<4>().0.to_vec();
    if texels.is_empty() {
        return Err("is an image without a texel".to_owned());
    }
    Ok(Image { width, height, texels })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_do_not_lead_out_of_a_scenes_folder() {
        let found = |below: &str, name: &str| beside(Path::new("scenes/hall"), Path::new(below), name);
        assert_eq!(found("", "a.png"), Ok(PathBuf::from("scenes/hall/a.png")));
        assert_eq!(found("", "./textures/../b.bin"), Ok(PathBuf::from("scenes/hall/b.bin")));
        assert_eq!(found("materials", "../textures/a.png"), Ok(PathBuf::from("scenes/hall/textures/a.png")));
        for (below, name) in
            [("", "../a.png"), ("", "/etc/passwd"), ("", "a/../../b.png"), ("materials", "../../a.png")]
        {
            let error = found(below, name).expect_err("outside");
            assert!(error.starts_with(&format!("`{name}` is not in the scene's folder")), "{error}");
        }
    }
}
