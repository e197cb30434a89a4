//! Density grids in Mitsuba's volume files (.vol, version 3), which outside renderers read too.
//!
//! All numbers are little endian: the letters `VOL`, a byte 3, the 32-bit whole numbers 1 (for f32), cells
//! along x, y and z and channels, six f32 of the box (lowest corner, highest corner), then the values, x
//! fastest, then y, then z. Files with other encodings or more than one channel are refused.

use super::{DensityGrid, MediumError};
use crate::scene::Bounds;
use deepshade_shaders::atomic_file;
use glam::Vec3;
use std::path::Path;

/// What every file starts with: the letters and the version.
const MAGIC: [u8; 4] = *b"VOL\x03";

/// Bytes before the first value.
const HEAD: usize = 48;

/// The encoding of f32 values.
const FLOATS: u32 = 1;

impl DensityGrid {
    /// Reads a .vol file, whose grid fills the file's box, or `bounds` where that is given.
    ///
    /// # Errors
    /// If the file is missing, damaged or not of one channel of f32, or as [`DensityGrid::new`].
    pub fn read_vol(path: &Path, bounds: Option<Bounds>) -> Result<Self, MediumError> {
        let io = |source| MediumError::Io { path: path.to_owned(), source };
        let invalid = |what: String| MediumError::File { path: path.to_owned(), what };
        let metadata = std::fs::metadata(path).map_err(io)?;
        let largest = (HEAD + 4 * Self::MOST_CELLS) as u64;
        if !metadata.is_file() || metadata.len() > largest {
            return Err(invalid(format!("is not a plain file of at most {largest} bytes")));
        }
        let bytes = std::fs::read(path).map_err(io)?;
        let (size, stored, values) = parse(&bytes).map_err(invalid)?;
        let grid = Self::new(bounds.unwrap_or(stored), size, values);
        grid.map_err(|error| invalid(error.to_string()))
    }
}

/// Writes a .vol file of some channels: `values` are those of a cell, then of the next along x, then y, then
/// z.
///
/// # Errors
/// If the file cannot be written.
pub fn write_vol(
    path: &Path,
    bounds: Bounds,
    size: [usize; 3],
    channels: usize,
    values: &[f32],
) -> Result<(), MediumError> {
    let [x, y, z] = size.map(|cells| cells as u32);
    let mut bytes = MAGIC.to_vec();
    bytes.extend([FLOATS, x, y, z, channels as u32].iter().flat_map(|number| number.to_le_bytes()));
    let corners = bounds.min.to_array().into_iter().chain(bounds.max.to_array());
    bytes.extend(corners.chain(values.iter().copied()).flat_map(f32::to_le_bytes));
    atomic_file::write(path, &bytes).map_err(|source| MediumError::Io { path: path.to_owned(), source })
}

/// Size, box and values of a file; the error says what is wrong with it.
fn parse(bytes: &[u8]) -> Result<([usize; 3], Bounds, Vec<f32>), String> {
    let Some((head, body)) = bytes.split_at_checked(HEAD).filter(|(head, _)| head.starts_with(&MAGIC)) else {
        return Err("is no .vol file of version 3".to_owned());
    };
    let words = head.as_chunks::<4>().0;
    let number = |word: usize| u32::from_le_bytes(words[word]);
    let corner = |word: usize| Vec3::from([0, 1, 2].map(|axis| f32::from_le_bytes(words[word + axis])));
    if number(1) != FLOATS {
        return Err(format!("has values of encoding {}; only {FLOATS}, f32, is read", number(1)));
    }
    if number(5) != 1 {
        return Err(format!("has {} channels; a density has one", number(5)));
    }
    let size = [2, 3, 4].map(|word| number(word) as usize);
    let cells = DensityGrid::cells(size).map_err(|error| error.to_string())?;
    if body.len() != 4 * cells {
        return Err(format!("has {} bytes of values; {cells} cells take {}", body.len(), 4 * cells));
    }
    let values = body.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
    Ok((size, Bounds { min: corner(6), max: corner(9) }, values))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> DensityGrid {
        let bounds = Bounds { min: Vec3::new(-1.0, 2.0, 0.5), max: Vec3::new(3.0, 5.0, 2.5) };
        DensityGrid::new(bounds, [4, 3, 2], (0..24).map(|i| i as f32 * 0.37).collect()).expect("a grid")
    }

    fn write(grid: &DensityGrid, path: &Path) {
        write_vol(path, grid.bounds(), grid.size(), 1, grid.values()).expect("written");
    }

    #[test]
    fn what_is_written_is_read_again() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.vol");
        write(&grid(), &path);
        assert_eq!(DensityGrid::read_vol(&path, None).expect("read"), grid());
        let other = Bounds { min: Vec3::ZERO, max: Vec3::ONE };
        let placed = DensityGrid::read_vol(&path, Some(other)).expect("read");
        assert_eq!((placed.bounds(), placed.values()), (other, grid().values()));
    }

    /// What is said of a file of which some bytes were replaced and which was then cut or grown to a length.
    fn damaged(at: usize, replaced: &[u8], length: usize) -> String {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("damaged.vol");
        write(&grid(), &path);
        let mut bytes = std::fs::read(&path).expect("bytes");
        bytes[at..at + replaced.len()].copy_from_slice(replaced);
        bytes.resize(length, 0);
        std::fs::write(&path, bytes).expect("written");
        DensityGrid::read_vol(&path, None).expect_err("damaged").to_string()
    }

    #[test]
    fn damaged_files_are_refused() {
        let whole = HEAD + 4 * 24;
        let cases = [
            (damaged(0, b"VOX", whole), "is no .vol file"),
            (damaged(3, &[2], whole), "is no .vol file"),
            (damaged(0, b"VOL", 40), "is no .vol file"),
            (damaged(4, &[3], whole), "encoding 3"),
            (damaged(20, &[3], whole), "3 channels"),
            (damaged(8, &[0], whole), "0 x 3 x 2 cells"),
            (damaged(8, &[255; 12], whole), "4294967295 x 4294967295"),
            (damaged(0, b"VOL", whole - 1), "95 bytes of values; 24 cells take 96"),
            (damaged(0, b"VOL", whole + 1), "97 bytes"),
            (damaged(HEAD + 4, &(-1f32).to_le_bytes(), whole), "density -1 at cell (1, 0, 0)"),
            (damaged(HEAD, &f32::INFINITY.to_le_bytes(), whole), "density inf at cell (0, 0, 0)"),
            (damaged(24, &f32::NAN.to_le_bytes(), whole), "a medium's box"),
        ];
        for (said, expected) in cases {
            assert!(said.contains("damaged.vol: ") && said.contains(expected), "{said}: not {expected}");
        }
    }

    #[test]
    fn folders_and_missing_files_are_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let error = |path: &Path| DensityGrid::read_vol(path, None).expect_err("no file").to_string();
        assert!(error(folder.path()).contains("is not a plain file"));
        assert!(error(&folder.path().join("none.vol")).contains("none.vol: "));
    }

    #[test]
    fn the_bunny_is_read() {
        let data = std::env::var_os("DEEPSHADE_DATA").map_or_else(
            || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/open"),
            std::path::PathBuf::from,
        );
        let path = data.join("volumes/bunny_64.vol");
        if !path.exists() {
            println!("skipped: the test data are absent ({})", path.display());
            return;
        }
        let bunny = DensityGrid::read_vol(&path, None).expect("the bunny");
        assert_eq!((bunny.size(), bunny.largest()), ([64; 3], 1.0));
        assert_eq!(bunny.bounds(), Bounds { min: Vec3::ZERO, max: Vec3::ONE });
        // Its body fills the middle, the corners are empty.
        assert!(bunny.at(Vec3::splat(0.5)) > 0.5 && bunny.at(Vec3::ZERO) == 0.0);
    }
}
