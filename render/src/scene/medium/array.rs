//! Numbers of a grid in a file: NumPy's arrays (`.npy`) and raw numbers, which everything else can write.

use super::{DensityGrid, MediumError};
use npyz::{Deserialize as FromNpy, NpyFile, Order};
use serde::Deserialize;
use std::io::Cursor;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Where densities are, and how.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Array {
    /// A NumPy array (.npy) or a file of raw numbers, little endian, in the folder of the file that names it
    /// or below.
    pub file: PathBuf,
    /// What each index of the array goes along, the slowest first.
    #[serde(default)]
    pub axes: Axes,
    /// Density of the number 1, and of the largest of whole numbers.
    #[serde(default = "one")]
    pub scale: f32,
    /// Cells along x, y and z of raw numbers; an array says itself.
    pub cells: Option<[usize; 3]>,
    /// What raw numbers are; an array says itself.
    pub numbers: Option<Numbers>,
}

fn one() -> f32 {
    1.0
}

/// The axes of an array's indices, the slowest first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Axes {
    /// As images are: `array[z][y][x]`.
    #[default]
    Zyx,
    /// As points are: `array[x][y][z]`.
    Xyz,
}

/// Kinds of raw numbers. Whole ones are shares of the largest of their kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Numbers {
    /// Whole, a byte.
    U8,
    /// Whole, two bytes.
    U16,
    /// IEEE 754, two bytes.
    F16,
    /// IEEE 754, four bytes.
    F32,
    /// IEEE 754, eight bytes.
    F64,
}

/// Brackets that are opened in the header of an array of numbers: those of its dictionary and of its shape.
const MOST_BRACKETS: usize = 2;

/// Numbers along x, y and z, x fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct Cells {
    /// Along x, y and z.
    pub size: [usize; 3],
    /// x fastest, then y, then z.
    pub values: Vec<f32>,
}

impl Array {
    /// The densities in its file, which is at a path.
    ///
    /// # Errors
    /// If the file cannot be read, is damaged or of another size than is said, or something is said of an
    /// array that says it itself, or not said of raw numbers.
    pub fn read(&self, path: &Path) -> Result<Cells, MediumError> {
        let bytes = bytes(path)?;
        let is_npy = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("npy"));
        let read = if is_npy { self.of_npy(&bytes) } else { self.of_raw(&bytes) };
        let mut cells = read.map_err(|what| MediumError::File { path: path.to_owned(), what })?;
        cells.values.iter_mut().for_each(|value| *value *= self.scale);
        Ok(cells)
    }

    fn of_npy(&self, bytes: &[u8]) -> Result<Cells, String> {
        if self.cells.is_some() || self.numbers.is_some() {
            return Err("is an array that says itself what `cells` and `numbers` are".to_owned());
        }
        check_header(bytes)?;
        let file = NpyFile::new(Cursor::new(bytes)).map_err(|error| format!("is no array: {error}"))?;
        let shape: Vec<usize> = file.shape().iter().map(|length| *length as usize).collect();
        let Ok(lengths) = <[usize; 3]>::try_from(shape) else {
            return Err(format!("has {} axes; a grid has three", file.shape().len()));
        };
        DensityGrid::cells(lengths).map_err(|error| error.to_string())?;
        // Of the other order the first index is the fastest: as if all axes were named the other way round.
        let (lengths, axes) = match (file.order(), self.axes) {
            (Order::C, axes) => (lengths, axes),
            (Order::Fortran, Axes::Zyx) => (reversed(lengths), Axes::Xyz),
            (Order::Fortran, Axes::Xyz) => (reversed(lengths), Axes::Zyx),
        };
        Ok(along(axes, lengths, &numbers_of(file)?))
    }

    fn of_raw(&self, bytes: &[u8]) -> Result<Cells, String> {
        let (Some(size), Some(numbers)) = (self.cells, self.numbers) else {
            return Err("is no .npy file: raw numbers need `cells` and `numbers`".to_owned());
        };
        let cells = DensityGrid::cells(size).map_err(|error| error.to_string())?;
        if bytes.len() != cells * numbers.bytes() {
            let [wanted, found] = [cells * numbers.bytes(), bytes.len()];
            return Err(format!("has {found} bytes; {cells} cells of {numbers:?} take {wanted}"));
        }
        let lengths = if self.axes == Axes::Zyx { reversed(size) } else { size };
        Ok(along(self.axes, lengths, &numbers.read(bytes)))
    }
}

impl Numbers {
    const fn bytes(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 | Self::F16 => 2,
            Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    fn read(self, bytes: &[u8]) -> Vec<f32> {
        let two = || bytes.as_chunks::<2>().0.iter();
        match self {
            Self::U8 => bytes.iter().map(|byte| share(*byte)).collect(),
            Self::U16 => two().map(|bytes| share_of_two(u16::from_le_bytes(*bytes))).collect(),
            Self::F16 => two().map(|bytes| half::f16::from_le_bytes(*bytes).to_f32()).collect(),
            Self::F32 => bytes.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect(),
            Self::F64 => bytes.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes) as f32).collect(),
        }
    }
}

fn share(byte: u8) -> f32 {
    f32::from(byte) / f32::from(u8::MAX)
}

fn share_of_two(number: u16) -> f32 {
    f32::from(number) / f32::from(u16::MAX)
}

/// Refuses headers of .npy files for which their reader takes memory before it reads, or time without end:
/// brackets in brackets take it twice as long each.
fn check_header(file: &[u8]) -> Result<(), String> {
    let Some(header) = header(file) else { return Ok(()) };
    let text = file.get(header).ok_or("is no array: it ends within its header")?;
    let opened = text.iter().filter(|byte| b"([{".contains(byte)).count();
    if opened > MOST_BRACKETS {
        return Err("is no array of numbers: its header has brackets of more than a shape".to_owned());
    }
    Ok(())
}

/// Where a .npy file says that its header is: after its length, of two bytes in the first version of the
/// format, four in others.
fn header(file: &[u8]) -> Option<Range<usize>> {
    let begin = if *file.get(6)? == 1 { 10 } else { 12 };
    let length = file.get(8..begin)?.iter().rev().fold(0, |sum, byte| sum << 8 | usize::from(*byte));
    Some(begin..begin.saturating_add(length))
}

type Npy<'a> = NpyFile<Cursor<&'a [u8]>>;

/// The numbers of an array, in the file's order.
fn numbers_of(file: Npy<'_>) -> Result<Vec<f32>, String> {
    let kind = file.dtype().descr();
    of_kind(file, |number: f32| number)
        .or_else(|file| of_kind(*file, |number: f64| number as f32))
        .or_else(|file| of_kind(*file, half::f16::to_f32))
        .or_else(|file| of_kind(*file, share))
        .or_else(|file| of_kind(*file, share_of_two))
        .unwrap_or_else(|_| Err(format!("has numbers of kind {kind}; u1, u2, f2, f4 and f8 are read")))
}

/// The numbers of an array if they are of a kind; else the file again.
fn of_kind<T: FromNpy>(
    file: Npy<'_>,
    number: impl Fn(T) -> f32,
) -> Result<Result<Vec<f32>, String>, Box<Npy<'_>>> {
    let data = file.try_data::<T>().map_err(Box::new)?;
    let numbers = data.map(|value| value.map(&number)).collect::<Result<Vec<f32>, _>>();
    Ok(numbers.map_err(|error| format!("is cut off or damaged: {error}")))
}

fn reversed([a, b, c]: [usize; 3]) -> [usize; 3] {
    [c, b, a]
}

/// Numbers of an array with such lengths, the slowest first, along x, y and z.
fn along(axes: Axes, lengths: [usize; 3], numbers: &[f32]) -> Cells {
    match axes {
        Axes::Zyx => Cells { size: reversed(lengths), values: numbers.to_vec() },
        Axes::Xyz => {
            let [x, y, z] = lengths;
            let at = |index: usize| numbers[(index % x * y + index / x % y) * z + index / (x * y)];
            Cells { size: lengths, values: (0..x * y * z).map(at).collect() }
        }
    }
}

/// A file's bytes, of at most as many as the largest grid of the widest numbers has.
fn bytes(path: &Path) -> Result<Vec<u8>, MediumError> {
    let io = |source| MediumError::Io { path: path.to_owned(), source };
    let metadata = std::fs::metadata(path).map_err(io)?;
    let largest = (8 * DensityGrid::MOST_CELLS + 65_536) as u64;
    if !metadata.is_file() || metadata.len() > largest {
        let what = format!("is not a plain file of at most {largest} bytes");
        return Err(MediumError::File { path: path.to_owned(), what });
    }
    std::fs::read(path).map_err(io)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2 cells along x, 3 along y, 4 along z, numbered x fastest.
    const SIZE: [usize; 3] = [2, 3, 4];

    fn array(file: &str) -> Array {
        Array { file: file.into(), axes: Axes::Zyx, scale: 1.0, cells: None, numbers: None }
    }

    fn raw(numbers: Numbers) -> Array {
        Array { cells: Some(SIZE), numbers: Some(numbers), ..array("a.raw") }
    }

    /// What is read of a file with these bytes.
    fn read(array: &Array, bytes: &[u8]) -> Result<Cells, String> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join(&array.file);
        std::fs::write(&path, bytes).expect("written");
        array.read(&path).map_err(|error| error.to_string())
    }

    /// A NumPy array as version 1.0 of the format lays it out.
    fn npy(kind: &str, fortran: bool, shape: &str, numbers: &[u8]) -> Vec<u8> {
        let order = if fortran { "True" } else { "False" };
        let mut head = format!("{{'descr': '{kind}', 'fortran_order': {order}, 'shape': ({shape}), }}");
        while (head.len() + 11) % 64 != 0 {
            head.push(' ');
        }
        head.push('\n');
        let length = (head.len() as u16).to_le_bytes();
        [b"\x93NUMPY\x01\x00", &length[..], head.as_bytes(), numbers].concat()
    }

    fn bytes_of(numbers: impl Iterator<Item = usize>) -> Vec<u8> {
        numbers.flat_map(|number| (number as f32).to_le_bytes()).collect()
    }

    fn in_order() -> Cells {
        Cells { size: SIZE, values: (0..24u8).map(f32::from).collect() }
    }

    /// Where the cells stand in an array `[x][y][z]`.
    fn z_fastest() -> impl Iterator<Item = usize> {
        (0..24).map(|index| index / 12 + 2 * (index / 4 % 3) + 6 * (index % 4))
    }

    #[test]
    fn arrays_of_both_axes_and_orders_are_the_same_grid() {
        let xyz = Array { axes: Axes::Xyz, ..array("a.npy") };
        let zyx = array("a.npy");
        let (images, points) = (bytes_of(0..24), bytes_of(z_fastest()));
        for (array, file) in [
            (&zyx, npy("<f4", false, "4, 3, 2", &images)),
            (&zyx, npy("<f4", true, "4, 3, 2", &points)),
            (&xyz, npy("<f4", false, "2, 3, 4", &points)),
            (&xyz, npy("<f4", true, "2, 3, 4", &images)),
        ] {
            assert_eq!(read(array, &file), Ok(in_order()));
        }
        assert_eq!(read(&Array { axes: Axes::Xyz, ..raw(Numbers::F32) }, &points), Ok(in_order()));
        assert_eq!(read(&raw(Numbers::F32), &images), Ok(in_order()));
    }

    #[test]
    fn headers_that_are_read_for_ever_and_beyond_their_end_are_refused() {
        let bytes = bytes_of(0..24);
        let nested = read(&array("a.npy"), &npy(&"[".repeat(60), false, "4, 3, 2", &bytes));
        assert!(
            nested.as_ref().is_err_and(|error| error.contains("brackets of more than a shape")),
            "{nested:?}"
        );
        let whole = npy("<f4", false, "4, 3, 2", &bytes);
        let cut = read(&array("a.npy"), &whole[..100]);
        assert!(cut.as_ref().is_err_and(|error| error.contains("it ends within its header")), "{cut:?}");
    }

    #[test]
    fn numbers_of_all_kinds_are_read() {
        let kinds: [(Numbers, &str, Vec<u8>, f32); 5] = [
            (Numbers::U8, "|u1", (0..24).collect(), 1.0 / 255.0),
            (Numbers::U16, "<u2", (0..24u16).flat_map(u16::to_le_bytes).collect(), 1.0 / 65_535.0),
            (Numbers::F16, "<f2", (0..24u8).flat_map(|i| half::f16::from(i).to_le_bytes()).collect(), 1.0),
            (Numbers::F32, "<f4", bytes_of(0..24), 1.0),
            (Numbers::F64, "<f8", (0..24u8).flat_map(|i| f64::from(i).to_le_bytes()).collect(), 1.0),
        ];
        for (numbers, kind, bytes, unit) in kinds {
            let found = read(&Array { scale: 3.0, ..raw(numbers) }, &bytes).expect("numbers");
            let same = read(&Array { scale: 3.0, ..array("a.npy") }, &npy(kind, false, "4, 3, 2", &bytes));
            assert_eq!(same.as_ref(), Ok(&found), "{kind}");
            for (index, value) in found.values.iter().enumerate() {
                assert!((value - 3.0 * unit * index as f32).abs() < 1e-5, "{kind}: {value} at {index}");
            }
        }
    }

    #[test]
    fn damaged_and_other_files_are_refused() {
        let numbers = bytes_of(0..24);
        let sound = npy("<f4", false, "4, 3, 2", &numbers);
        let npy_cases = [
            (npy("<f4", false, "24,", &numbers), "has 1 axes"),
            (npy("<c8", false, "4, 3, 1", &numbers), "kind '<c8'"),
            (npy("<f4", false, "0, 3, 2", &[]), "0 x 3 x 2 cells"),
            (npy("<f4", false, "99999999, 99999999, 2", &numbers), "99999999 x 99999999 x 2 cells"),
            (sound[..sound.len() - 1].to_vec(), "cut off"),
            (sound[..20].to_vec(), "is no array"),
            (b"NUMPY".to_vec(), "is no array"),
            (vec![], "is no array"),
        ];
        for (bytes, expected) in npy_cases {
            let said = read(&array("a.npy"), &bytes).expect_err(expected);
            assert!(said.contains("a.npy: ") && said.contains(expected), "{said}: not {expected}");
        }
        let raw_cases = [
            (raw(Numbers::F32), 95, "has 95 bytes; 24 cells of F32 take 96"),
            (raw(Numbers::F64), 96, "take 192"),
            (Array { cells: None, ..raw(Numbers::F32) }, 96, "need `cells` and `numbers`"),
            (Array { numbers: None, ..raw(Numbers::F32) }, 96, "need `cells` and `numbers`"),
            (Array { cells: Some([usize::MAX; 3]), ..raw(Numbers::U8) }, 96, "cells"),
            (Array { file: "a.npy".into(), ..raw(Numbers::U8) }, 96, "says itself"),
        ];
        for (array, length, expected) in raw_cases {
            let said = read(&array, &numbers[..length]).expect_err(expected);
            assert!(said.contains(expected), "{said}: not {expected}");
        }
        let missing = array("none.npy").read(Path::new("none.npy")).expect_err("no file").to_string();
        assert!(missing.contains("none.npy: "), "{missing}");
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::create_dir(folder.path().join("a.npy")).expect("a folder");
        let said = array("a.npy").read(&folder.path().join("a.npy")).expect_err("a folder").to_string();
        assert!(said.contains("not a plain file"), "{said}");
    }
}
