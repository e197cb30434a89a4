//! Images that materials read, from the bytes of PNG, JPEG, BMP, TGA and KTX2 files, within what memory
//! holds. What a header promises is looked at first, of all images of a scene together: a file of some
//! kilobytes may stand for a gigabyte of one colour.

mod ktx2;

use crate::scene::memory;
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};
use rayon::prelude::*;
use std::borrow::Cow;
use std::io::Cursor;
use std::ops::Range;
use std::sync::Arc;

/// Largest edge of an image, texels.
const LARGEST_EDGE: u32 = 16_384;

/// The most texels that a byte of a PNG file stands for: DEFLATE repeats 258 bytes with two bits, and a byte
/// has eight texels of one bit.
const TEXELS_PER_BYTE_PNG: u64 = 8 * 1032;
/// The same of a JPEG file: each block of 8 x 8 takes a bit.
const TEXELS_PER_BYTE_JPEG: u64 = 8 * 64;
/// The same of a BMP file: two bytes repeat a texel 255 times.
const TEXELS_PER_BYTE_BMP: u64 = 128;
/// The same of a TGA file: two bytes repeat a texel 128 times.
const TEXELS_PER_BYTE_TGA: u64 = 64;
/// The same of a KTX2 file: four bytes of Zstandard repeat a byte 131,072 times, and a byte is a texel.
const TEXELS_PER_BYTE_KTX2: u64 = 32_768;
/// What a texel takes while an image is decoded, bytes: as the file has it, up to eight, and twice as we do.
const BYTES_WHILE_DECODED: u64 = 16;
/// What a texel takes then, bytes.
const BYTES_KEPT: u64 = 4;

/// An image as four bytes a texel, row by row from the top left. Copies share them.
#[derive(Clone, Debug)]
pub(super) struct Image {
    pub width: usize,
    pub height: usize,
    pub texels: Arc<[[u8; 4]]>,
}

/// An image that has not been decoded: its bytes can hold what its header promises.
#[derive(Debug)]
pub(super) struct Encoded<'a> {
    bytes: Cow<'a, [u8]>,
    format: Format,
    width: u32,
    height: u32,
}

/// What an image is read by.
#[derive(Clone, Copy, Debug)]
enum Format {
    Common(ImageFormat),
    Ktx2,
}

impl<'a> Encoded<'a> {
    /// Looks at the header of an image; the error says what is wrong with it.
    pub fn new(bytes: impl Into<Cow<'a, [u8]>>) -> Result<Self, String> {
        let bytes = bytes.into();
        let common = |format, texels_per_byte| (Format::Common(format), texels_per_byte);
        let (format, texels_per_byte) = match image::guess_format(&bytes) {
            _ if ktx2::is_ktx2(&bytes) => (Format::Ktx2, TEXELS_PER_BYTE_KTX2),
            Ok(format @ ImageFormat::Png) => common(format, TEXELS_PER_BYTE_PNG),
            Ok(format @ ImageFormat::Jpeg) => common(format, TEXELS_PER_BYTE_JPEG),
            Ok(format @ ImageFormat::Bmp) => common(format, TEXELS_PER_BYTE_BMP),
            _ if is_tga(&bytes) => common(ImageFormat::Tga, TEXELS_PER_BYTE_TGA),
            _ => return Err("is no PNG, JPEG, BMP, TGA or KTX2 image".to_owned()),
        };
        let (width, height) = match format {
            Format::Common(format) => decoder(&bytes, format)?.dimensions(),
            Format::Ktx2 => ktx2::dimensions(&bytes)?,
        };
        if width.max(height) > LARGEST_EDGE {
            return Err(format!("has {width} x {height} texels, more than {LARGEST_EDGE} along an edge"));
        }
        if u64::from(width) * u64::from(height) > bytes.len() as u64 * texels_per_byte {
            return Err(format!("is a damaged image: {width} x {height} texels in {} bytes", bytes.len()));
        }
        Ok(Self { bytes, format, width, height })
    }

    fn texels(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }

    fn decoded(&self) -> Result<Image, String> {
        let (width, height) = (self.width as usize, self.height as usize);
        let bytes = match self.format {
            Format::Common(format) => {
                let image = DynamicImage::from_decoder(decoder(&self.bytes, format)?).map_err(damaged)?;
                image.into_rgba8().into_raw()
            }
            Format::Ktx2 => ktx2::texels(&self.bytes)?,
        };
        let texels: Arc<[_]> = bytes.as_chunks::<4>().0.into();
        if texels.is_empty() {
            return Err("is an image without a texel".to_owned());
        }
        Ok(Image { width, height, texels })
    }
}

/// Whether bytes begin as a TGA file does, which has no mark of its own: a colour map or none, a kind of
/// image that there is, a size, and a depth that there is (Truevision TGA File Format Specification 2.0,
/// "Field 1" to 5).
fn is_tga(bytes: &[u8]) -> bool {
    let Some(header) = bytes.first_chunk::<18>() else { return false };
    let edge = |at: usize| u16::from_le_bytes([header[at], header[at + 1]]);
    header[1] <= 1
        && matches!(header[2], 1..=3 | 9..=11)
        && edge(12) > 0
        && edge(14) > 0
        && matches!(header[16], 8 | 15 | 16 | 24 | 32)
}

fn decoder(bytes: &[u8], format: ImageFormat) -> Result<impl ImageDecoder, String> {
    let mut limits = Limits::default();
    limits.max_image_width = Some(LARGEST_EDGE);
    limits.max_image_height = Some(LARGEST_EDGE);
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    reader.limits(limits);
    reader.into_decoder().map_err(damaged)
}

fn damaged(error: image::ImageError) -> String {
    format!("is a damaged image: {error}")
}

/// Decodes an image; the error says what is wrong with it.
pub(super) fn decode(bytes: &[u8]) -> Result<Image, String> {
    let image = all(&[Encoded::new(bytes)?]).map_err(|(_, what)| what)?.pop();
    Ok(image.expect("one image of one"))
}

/// Decodes images, several at once as far as memory holds what that takes. The error says which image is at
/// fault, and how: nothing is decoded where memory does not hold all of them.
pub(super) fn all(images: &[Encoded<'_>]) -> Result<Vec<Image>, (usize, String)> {
    let texels: Vec<u64> = images.iter().map(Encoded::texels).collect();
    let batches = batches(&texels, memory::available()).map_err(|index| {
        let Encoded { width, height, .. } = images[index];
        let others = if index == 0 { "" } else { "with the images before it " };
        (index, format!("has {width} x {height} texels, {others}more than memory holds"))
    })?;
    let mut decoded = Vec::with_capacity(images.len());
    for batch in batches {
        let images = batch.into_par_iter().map(|index| images[index].decoded().map_err(|what| (index, what)));
        decoded.extend(images.collect::<Result<Vec<_>, _>>()?);
    }
    Ok(decoded)
}

/// Whether memory holds the texels of an image beside what it holds now; the error says that it does not.
pub(super) fn check(width: usize, height: usize) -> Result<(), String> {
    let bytes = (width as u64).saturating_mul(height as u64).saturating_mul(BYTES_WHILE_DECODED);
    if bytes > memory::available() {
        return Err(format!("has {width} x {height} texels, more than memory holds"));
    }
    Ok(())
}

/// Images that are decoded at once, in their order, so that with what is kept of those before them they fit
/// into some bytes; the error is the first that does not fit.
fn batches(texels: &[u64], bytes: u64) -> Result<Vec<Range<usize>>, usize> {
    let mut batches = Vec::new();
    let mut begin = 0;
    let (mut room, mut wanted) = (bytes / BYTES_KEPT, 0);
    for (index, texels) in texels.iter().enumerate() {
        if (wanted + texels) * (BYTES_WHILE_DECODED / BYTES_KEPT) > room {
            if begin < index {
                batches.push(begin..index);
            }
            room -= wanted;
            (begin, wanted) = (index, 0);
            if texels * (BYTES_WHILE_DECODED / BYTES_KEPT) > room {
                return Err(index);
            }
        }
        wanted += texels;
    }
    batches.push(begin..texels.len());
    Ok(batches)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        let flat = image::GrayImage::from_pixel(1024, 1024, image::Luma([7]));
        flat.write_to(&mut bytes, format).expect("encoded");
        bytes.into_inner()
    }

    /// An image of one colour is as small as the format allows: it must not be taken for a promise.
    #[test]
    fn images_that_promise_more_than_their_bytes_hold_are_refused_and_flat_ones_are_not() {
        for (format, place) in [(ImageFormat::Png, 16), (ImageFormat::Jpeg, 0)] {
            let bytes = flat(format);
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
    fn as_many_images_are_decoded_at_once_as_memory_holds() {
        // Where each batch ends.
        let of = |texels: &[u64], bytes| {
            batches(texels, bytes).map(|found| found.iter().map(|batch| batch.end).collect::<Vec<_>>())
        };
        assert_eq!(of(&[10, 10, 10], 480), Ok(vec![3]), "16 bytes a texel");
        assert_eq!(of(&[10, 10, 10], 479), Ok(vec![2, 3]));
        // Kept are 4 bytes a texel: 40 and 40, then 160 for the last.
        assert_eq!(of(&[10, 10, 10], 240), Ok(vec![1, 2, 3]));
        assert_eq!(of(&[10, 10, 10], 239), Err(2));
        assert_eq!(of(&[10, 20], 319), Err(1));
        assert_eq!(of(&[20, 1], 319), Err(0));
        // The largest comes first: most of what it takes is given back before others are decoded.
        assert_eq!(of(&[20, 10], 320), Ok(vec![1, 2]));
        // Flat images of 16384 x 16384 texels, each of which fits alone.
        assert_eq!(of(&[1 << 28; 18], 8 << 30), Err(5));
        assert_eq!(of(&[], 0), Ok(vec![0]));
    }

    #[test]
    fn images_keep_their_order_and_the_damaged_one_is_told() {
        let sound = flat(ImageFormat::Png);
        let mut small = Cursor::new(Vec::new());
        image::GrayImage::new(3, 2).write_to(&mut small, ImageFormat::Png).expect("encoded");
        let small = small.into_inner();
        let encoded = |bytes: &[u8]| Encoded::new(bytes.to_vec()).expect("a sound header");
        let images = all(&[encoded(&sound), encoded(&small)]).expect("sound images");
        assert_eq!([images[0].width, images[1].width], [1024, 3]);
        let (index, what) =
            all(&[encoded(&small), encoded(&sound[..sound.len() - 40])]).expect_err("cut off");
        assert!(index == 1 && what.starts_with("is a damaged image"), "{index}: {what}");
        assert!(check(4, 4).is_ok() && check(usize::MAX, 2).is_err());
    }
}
