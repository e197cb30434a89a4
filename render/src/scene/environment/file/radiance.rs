//! Radiance HDR images. What a header says of exposure and colour correction was multiplied into the pixels,
//! and is divided out again, so that texels are radiance (Ward, "The RADIANCE Picture File Format", in the
//! manual's filefmts). Primaries, view and software mean nothing here.

use super::super::check_size;
use super::Image;
use crate::scene::{SceneError, file};
use glam::Vec3;
use image::{DynamicImage, ImageDecoder, codecs::hdr::HdrDecoder};
use std::io::Read;
use std::path::Path;

/// The most texels that a byte of a file stands for: two bytes repeat one of four values up to 127 times.
const TEXELS_PER_BYTE: u64 = 16;

/// What the first line of a file says, that of Radiance first.
const SIGNATURES: [&[u8]; 2] = [b"#?RADIANCE", b"#?RGBE"];

/// Reads a file.
pub(super) fn read(path: &Path) -> Result<Image, SceneError> {
    let bytes = file::read(path)?;
    decoded(&bytes).map_err(|what| SceneError::invalid(path, what))
}

fn decoded(bytes: &[u8]) -> Result<Image, String> {
    let damaged = |error: image::ImageError| format!("not a usable Radiance HDR image: {error}");
    let (header, order, texels) = header(bytes);
    let decoder = HdrDecoder::new(header.chain(texels)).map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    // Before memory is taken for what the header promises.
    check_size(width as usize, height as usize)?;
    if u64::from(width) * u64::from(height) > bytes.len() as u64 * TEXELS_PER_BYTE {
        return Err(format!("promises {width} x {height} texels in {} bytes", bytes.len()));
    }
    let header = decoder.metadata();
    let exposure = Vec3::splat(header.exposure.unwrap_or(1.0));
    let correction = header.color_correction.map_or(Vec3::ONE, Vec3::from);
    let multiplied = exposure * correction;
    if !(multiplied.is_finite() && multiplied.min_element() > 0.0) {
        return Err(format!("its EXPOSURE and COLORCORR multiply to {multiplied}, not to numbers above 0"));
    }
    let image = DynamicImage::from_decoder(decoder).map_err(damaged)?.into_rgb32f();
    let texels: Vec<Vec3> = image.pixels().map(|pixel| Vec3::from_array(pixel.0) / multiplied).collect();
    Ok(order.unwrap_or(Order::USUAL).image(width as usize, height as usize, &texels))
}

/// How a file's scan lines lie in its image.
#[derive(Clone, Copy)]
struct Order {
    /// Whether a scan line is a column and not a row.
    is_by_column: bool,
    /// Whether columns go from the right to the left.
    is_mirrored: bool,
    /// Whether rows go from the bottom to the top.
    is_upside_down: bool,
}

impl Order {
    /// Rows from the top, each from the left.
    const USUAL: Self = Self { is_by_column: false, is_mirrored: false, is_upside_down: false };

    /// The order and the size, first that along the scan lines' own order, that a line such as `-Y 16 +X 32`
    /// states.
    fn parse(line: &[u8]) -> Option<(Self, [&str; 2])> {
        let words: Vec<&str> = std::str::from_utf8(line).ok()?.split_ascii_whitespace().collect();
        let [first, lines, second, length] = words[..] else { return None };
        let is_by_column = first.ends_with('X');
        let (x, y) = if is_by_column { (first, second) } else { (second, first) };
        let is_known = ["+X", "-X"].contains(&x) && ["+Y", "-Y"].contains(&y);
        let order = Self { is_by_column, is_mirrored: x == "-X", is_upside_down: y == "+Y" };
        is_known.then_some((order, [lines, length]))
    }

    /// The image of scan lines of some length.
    fn image(self, length: usize, lines: usize, texels: &[Vec3]) -> Image {
        let (width, height) = if self.is_by_column { (lines, length) } else { (length, lines) };
        let texel = |at: usize| {
            let (x, y) = (at % width, at / width);
            let x = if self.is_mirrored { width - 1 - x } else { x };
            let y = if self.is_upside_down { height - 1 - y } else { y };
            texels[if self.is_by_column { x * length + y } else { y * length + x }]
        };
        Image { width, height, texels: (0..width * height).map(texel).collect(), cropped: None }
    }
}

/// A file's header as the decoder knows it, with the first signature, line ends of one byte and scan lines
/// that are rows from the top; their order; and what follows. The line of the size, behind an empty one, is
/// the header's last.
fn header(bytes: &[u8]) -> (Vec<u8>, Option<Order>, &[u8]) {
    let (mut header, mut rest, mut was_empty) = (Vec::new(), bytes, false);
    while let Some(end) = rest.iter().position(|byte| *byte == b'\n') {
        let line = rest[..end].trim_ascii_end();
        rest = &rest[end + 1..];
        if let Some((order, [lines, length])) = Order::parse(line).filter(|_| was_empty) {
            header.extend_from_slice(format!("-Y {lines} +X {length}\n").as_bytes());
            return (header, Some(order), rest);
        }
        let is_signature = header.is_empty() && SIGNATURES.contains(&line);
        header.extend_from_slice(if is_signature { SIGNATURES[0] } else { line });
        header.push(b'\n');
        if was_empty {
            break;
        }
        was_empty = line.is_empty();
    }
    (header, None, rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two texels of (1, 0.5, 0.25), below a header.
    fn image(header: &str) -> Result<Vec<Vec3>, String> {
        let texel = [128, 64, 32, 129];
        let bytes = [header.as_bytes(), b"\n-Y 1 +X 2\n", &texel, &texel].concat();
        decoded(&bytes).map(|image| image.texels)
    }

    #[test]
    fn exposure_and_colour_correction_are_divided_out() {
        let texel = Vec3::new(1.0, 0.5, 0.25);
        for (lines, expected) in [
            ("", texel),
            ("EXPOSURE=2\n", texel / 2.0),
            ("EXPOSURE= 2.0\nEXPOSURE=4\n", texel / 8.0),
            ("EXPOSURE=1e-3\n", texel * 1e3),
            ("COLORCORR=1 2 4\n", texel / Vec3::new(1.0, 2.0, 4.0)),
            ("COLORCORR=2 1 1\nEXPOSURE=0.5\nCOLORCORR=1 1 4\n", texel * Vec3::new(1.0, 2.0, 0.5)),
            ("PRIMARIES=0.64 0.33 0.3 0.6 0.15 0.06 0.3127 0.329\nGAMMA=2.2\npfilt -e 3\n", texel),
        ] {
            let header = format!("#?RADIANCE\n{lines}FORMAT=32-bit_rle_rgbe\n");
            let found = image(&header).expect("an image");
            assert!(
                found.iter().all(|found| (*found / expected - 1.0).abs().max_element() < 1e-6),
                "{lines}: {found:?}"
            );
        }
    }

    #[test]
    fn both_signatures_are_known_and_no_other() {
        for signature in ["#?RADIANCE", "#?RGBE", "#?RGBE\r", "#?RADIANCE "] {
            let found = image(&format!("{signature}\n# a comment\nFORMAT=32-bit_rle_rgbe\n"));
            assert_eq!(found.expect(signature), [Vec3::new(1.0, 0.5, 0.25); 2]);
        }
        for signature in ["#?NOTRAD", "RGBE", "#?RGBEX", ""] {
            let error = image(&format!("{signature}\nFORMAT=32-bit_rle_rgbe\n")).expect_err(signature);
            assert!(error.contains("signature"), "{signature}: {error}");
        }
    }

    #[test]
    fn lines_may_end_in_two_bytes_and_texels_hold_them_too() {
        let texel = [13, 10, 13, 129];
        let lines = "#?RADIANCE\r\nEXPOSURE=2\r\nFORMAT=32-bit_rle_rgbe\r\n\r\n-Y 1 +X 2\r\n";
        let found = decoded(&[lines.as_bytes(), &texel, &texel].concat()).expect("an image").texels;
        assert_eq!(found, [Vec3::new(13.0, 10.0, 13.0) / 128.0 / 2.0; 2]);
    }

    #[test]
    fn scan_lines_lie_in_any_of_eight_orders() {
        // Three columns and two rows: the red of each is its number, row by row from the top.
        let lines: [(&str, [u8; 6]); 8] = [
            ("-Y 2 +X 3", [1, 2, 3, 4, 5, 6]),
            ("-Y 2 -X 3", [3, 2, 1, 6, 5, 4]),
            ("+Y 2 +X 3", [4, 5, 6, 1, 2, 3]),
            ("+Y 2 -X 3", [6, 5, 4, 3, 2, 1]),
            ("+X 3 -Y 2", [1, 4, 2, 5, 3, 6]),
            ("+X 3 +Y 2", [4, 1, 5, 2, 6, 3]),
            ("-X 3 -Y 2", [3, 6, 2, 5, 1, 4]),
            ("-X 3 +Y 2", [6, 3, 5, 2, 4, 1]),
        ];
        for (size, texels) in lines {
            let header = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n{size}\n");
            let texels = texels.map(|red| [red, 0, 0, 136]).concat();
            let image = decoded(&[header.as_bytes(), &texels].concat()).expect(size);
            let reds: Vec<f32> = image.texels.iter().map(|texel| texel.x).collect();
            assert_eq!((image.width, image.height), (3, 2), "{size}");
            assert_eq!(reds, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0], "{size}");
        }
    }

    #[test]
    fn an_exposure_that_is_none_is_refused_by_name() {
        for line in ["EXPOSURE=0", "EXPOSURE=-1", "EXPOSURE=inf", "COLORCORR=1 0 1", "EXPOSURE=bright"] {
            let error = image(&format!("#?RADIANCE\n{line}\n")).expect_err(line);
            assert!(error.contains("EXPOSURE") || error.contains("COLORCORR"), "{line}: {error}");
        }
    }
}
