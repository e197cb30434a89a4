//! KTX 2.0 files with Basis Universal images, as KHR_texture_basisu has them: ETC1S by BasisLZ, or UASTC,
//! plain or by Zstandard (Khronos, "KTX File Format Specification", version 2.0). The largest level is read.
//!
//! What the header says of places and sizes is held against the file before the transcoder sees it, which
//! allocates what it is told.

use basisu::{DecodeFlags, TargetFormat, Transcoder};

/// How such a file begins.
const MAGIC: [u8; 12] = *b"\xabKTX 20\xbb\r\n\x1a\n";
/// Bytes before the index of levels.
const HEADER: usize = 80;
/// Bytes of an entry of that index.
const LEVEL: usize = 24;
/// Where the header says how many bytes of keys and values there are.
const KEY_VALUE_LENGTH: std::ops::Range<usize> = 60..64;
/// Colour models of the data format descriptor.
const ETC1S: u8 = 163;
const UASTC: u8 = 166;
/// How levels are packed.
const BASIS_LZ: u32 = 1;
const ZSTANDARD: u32 = 2;
/// Texels along an edge of a block, and bytes of a block of UASTC.
const BLOCK: u64 = 4;
const BLOCK_BYTES: u64 = 16;

/// Whether bytes begin as such a file does.
pub(super) fn is_ktx2(bytes: &[u8]) -> bool {
    bytes.starts_with(&MAGIC)
}

/// Width and height of the largest level; the error says what is wrong with the file.
pub(super) fn dimensions(bytes: &[u8]) -> Result<(u32, u32), String> {
    let file = File(bytes);
    let [format, width, height, depth, layers, faces, levels, packing] =
        [12, 20, 24, 28, 32, 36, 40, 44].map(|at| file.number(at));
    let (width, height) = (width?, height?);
    if depth? != 0 || layers? > 1 || faces? != 1 || width == 0 || height == 0 {
        return Err("is no flat KTX2 image: volumes, cubes and arrays are not read".to_owned());
    }
    let (packing, model) = (packing?, file.colour_model()?);
    if format? != 0 || !matches!((model, packing), (ETC1S, BASIS_LZ) | (UASTC, 0 | ZSTANDARD)) {
        let what = "is a KTX2 image, but not of Basis Universal (ETC1S or UASTC)";
        return Err(format!("{what}: convert it with `basisu -ktx2`, or to PNG"));
    }
    for level in 0..levels?.min(16) as usize {
        file.span(HEADER + level * LEVEL)?;
    }
    file.span(64)?;
    let blocks = u64::from(width).div_ceil(BLOCK) * u64::from(height).div_ceil(BLOCK);
    if packing == ZSTANDARD && file.long(HEADER + 16)? != blocks * BLOCK_BYTES {
        return Err(damaged());
    }
    Ok((width, height))
}

/// The texels of the largest level, row by row from the top left, of a file whose [`dimensions`] are known.
pub(super) fn texels(bytes: &[u8]) -> Result<Vec<u8>, String> {
    // Without keys and values, in which the transcoder (basisu 0.1.0) looks for videos past their end.
    let mut bytes = bytes.to_vec();
    bytes.get_mut(KEY_VALUE_LENGTH).ok_or_else(damaged)?.fill(0);
    let transcoder = Transcoder::new(&bytes).map_err(|_| damaged())?;
    transcoder.transcode(0, TargetFormat::Rgba32, DecodeFlags::NONE).map_err(|_| damaged())
}

fn damaged() -> String {
    "is a damaged image: what its KTX2 header says is not in the file".to_owned()
}

/// The bytes of a file, whose numbers are little-endian.
struct File<'a>(&'a [u8]);

impl File<'_> {
    fn bytes<const N: usize>(&self, at: usize) -> Result<[u8; N], String> {
        self.0.get(at..).and_then(|rest| rest.first_chunk()).copied().ok_or_else(damaged)
    }

    fn number(&self, at: usize) -> Result<u32, String> {
        self.bytes(at).map(u32::from_le_bytes)
    }

    fn long(&self, at: usize) -> Result<u64, String> {
        self.bytes(at).map(u64::from_le_bytes)
    }

    /// Checks that the bytes whose place and number are at a place of the header are in the file.
    fn span(&self, at: usize) -> Result<(), String> {
        let end = self.long(at)?.checked_add(self.long(at + 8)?);
        end.filter(|end| *end <= self.0.len() as u64).map(|_| ()).ok_or_else(damaged)
    }

    /// Of the data format descriptor, whose first 12 bytes are its lengths and versions.
    fn colour_model(&self) -> Result<u8, String> {
        Ok(self.bytes::<1>(self.number(48)? as usize + 12)?[0])
    }
}
