//! Reading what a scene file refers to: bytes with a size limit, and images.

use super::SceneError;
use crate::memory;
use image::{DynamicImage, ImageDecoder};
use std::path::{Component, Path, PathBuf};
use std::{fs, io::Cursor};

/// Largest file that is read, bytes.
const LARGEST_FILE: u64 = 4 << 30;

/// Largest edge of an image, texels.
const LARGEST_EDGE: u32 = 16_384;

/// The most texels that a byte of a PNG file stands for: DEFLATE repeats 258 bytes with two bits, and a byte has eight texels
/// of one bit.
const TEXELS_PER_BYTE_PNG: u64 = 8 * 1032;
/// The same of a JPEG file: each block of 8 x 8 takes a bit.
const TEXELS_PER_BYTE_JPEG: u64 = 8 * 64;
/// What a texel takes while an image is decoded, bytes: as the file has it, up to eight, and twice as we do.
const BYTES_PER_TEXEL: u64 = 16;

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
    let (format, texels_per_byte) = match image::guess_format(bytes) {
        Ok(format @ image::ImageFormat::Png) => (format, TEXELS_PER_BYTE_PNG),
        Ok(format @ image::ImageFormat::Jpeg) => (format, TEXELS_PER_BYTE_JPEG),
        _ => return Err("is neither a PNG nor a JPEG image".to_owned()),
    };
    let mut limits = image::Limits::default();
    limits.max_image_width = Some(LARGEST_EDGE);
    limits.max_image_height = Some(LARGEST_EDGE);
    let mut reader = image::ImageReader::with_format(Cursor::new(bytes), format);
    reader.limits(limits);
    let damaged = |error: image::ImageError| format!("is a damaged image: {error}");
    let decoder = reader.into_decoder().map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    // Before memory is taken for what the header promises.
    let promised = u64::from(width) * u64::from(height);
    if promised > bytes.len() as u64 * texels_per_byte {
        return Err(format!("is a damaged image: {width} x {height} texels in {} bytes", bytes.len()));
    }
    if promised * BYTES_PER_TEXEL > memory::available() {
        return Err(format!("has {width} x {height} texels, more than memory holds"));
    }
    let image = DynamicImage::from_decoder(decoder).map_err(damaged)?.into_rgba8();
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

    /// An image of one colour is as small as the format allows: it must not be taken for a promise.
    #[test]
    fn images_that_promise_more_than_their_bytes_hold_are_refused_and_flat_ones_are_not() {
        let flat = image::GrayImage::from_pixel(1024, 1024, image::Luma([7]));
        for (format, place) in [(image::ImageFormat::Png, 16), (image::ImageFormat::Jpeg, 0)] {
            let mut bytes = Cursor::new(Vec::new());
            flat.write_to(&mut bytes, format).expect("encoded");
            let bytes = bytes.into_inner();
            let read = decode(&bytes).expect("a sound image");
            assert_eq!((read.width, read.texels[77]), (1024, [7, 7, 7, 255]), "{} bytes", bytes.len());
            if place > 0 {
                let mut bomb = bytes[..200].to_vec();
                bomb[place..place + 8].copy_from_slice(&[0, 0, 64, 0, 0, 0, 64, 0]);
                let crc = crc(&bomb[12..29]).to_be_bytes();
                bomb[29..33].copy_from_slice(&crc);
                let error = decode(&bomb).expect_err("a bomb");
                assert_eq!(error, "is a damaged image: 16384 x 16384 texels in 200 bytes");
            }
        }
    }

    /// The checksum of a PNG's chunk (PNG specification, annex D).
    fn crc(bytes: &[u8]) -> u32 {
        !bytes.iter().fold(!0u32, |crc, byte| {
            (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
                (crc >> 1) ^ if crc & 1 == 1 { 0xedb8_8320 } else { 0 }
            })
        })
    }

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
