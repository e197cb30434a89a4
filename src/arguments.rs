//! What command lines hold, read and checked.

use anyhow::{Context, Result, ensure};
use deepshade_shaders::atomic_file;
use glam::Vec3;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

/// How far from the origin a place may be, metres: a thousand kilometres away 32-bit floats are 6 cm apart.
const FARTHEST: f32 = 1e6;

/// Reads a number that must be positive, such as a radius.
pub fn positive(text: &str) -> Result<f32, String> {
    let value: f32 = text.parse().map_err(|_| format!("`{text}` is not a number"))?;
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(format!("{value} is not above 0 and finite"))
    }
}

/// Reads a radius, which may be `inf`.
pub fn reach(text: &str) -> Result<f32, String> {
    if text == "inf" { Ok(f32::INFINITY) } else { positive(text) }
}

/// Reads a name, which cannot be empty.
pub fn name(text: &str) -> Result<String, String> {
    if text.trim().is_empty() { Err("is empty".to_owned()) } else { Ok(text.to_owned()) }
}

/// What reads a number of a range.
pub fn within(range: RangeInclusive<f32>) -> impl Fn(&str) -> Result<f32, String> + Clone {
    move |text| {
        let value: f32 = text.parse().map_err(|_| format!("`{text}` is not a number"))?;
        let (low, high) = (range.start(), range.end());
        if range.contains(&value) { Ok(value) } else { Err(format!("{value} is not within {low} to {high}")) }
    }
}

/// Reads a place, X,Y,Z in metres.
pub fn place(text: &str) -> Result<Vec3, String> {
    let coordinate = |text: &str| within(-FARTHEST..=FARTHEST)(text.trim());
    let coordinates: Vec<f32> = text.split(',').map(coordinate).collect::<Result<_, _>>()?;
    match coordinates[..] {
        [x, y, z] => Ok(Vec3::new(x, y, z)),
        _ => Err(format!("`{text}` is not X,Y,Z")),
    }
}

/// Reads the name of a file to be written, and refuses what could not be: better now than when all work is
/// done.
pub fn written_file(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    atomic_file::check(&path).map_err(|error| error.to_string())?;
    Ok(path)
}

/// Makes a folder ready for a page and what it shows, and refuses one that holds something but no earlier
/// page, which has a mark in it: better now than when all work is done.
///
/// # Errors
/// If so, or if it cannot be made.
pub fn page_folder(folder: &Path, page: &str, mark: &str) -> Result<()> {
    std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    let empty = std::fs::read_dir(folder).map_or(true, |mut entries| entries.next().is_none());
    let ours = std::fs::read_to_string(folder.join(page)).is_ok_and(|page| page.contains(mark));
    ensure!(empty || ours, "{} holds something else: choose a new or an empty folder", folder.display());
    Ok(())
}

/// Reads the name of a PNG file to be written.
pub fn png_file(text: &str) -> Result<PathBuf, String> {
    file_of_kind(text, "png")
}

/// Reads the name of an image to be written, an EXR or a PNG file.
pub fn image_file(text: &str) -> Result<PathBuf, String> {
    file_of_kind(text, "exr")
        .or_else(|_| file_of_kind(text, "png"))
        .map_err(|error| if error.ends_with(".png") { format!("{error} or .exr") } else { error })
}

/// Reads the name of an SVG file to be written.
pub fn svg_file(text: &str) -> Result<PathBuf, String> {
    file_of_kind(text, "svg")
}

/// Reads the name of an HTML file to be written.
pub fn html_file(text: &str) -> Result<PathBuf, String> {
    file_of_kind(text, "html")
}

/// A name without an extension is a device's or the user's own business; another one would say what is not
/// true.
fn file_of_kind(text: &str, kind: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    match path.extension() {
        Some(found) if !found.eq_ignore_ascii_case(kind) => {
            Err(format!("what is written is of the kind .{kind}"))
        }
        _ => written_file(text),
    }
}

/// Edges of images, pixels: in smaller ones SSIM's window does not fit.
pub const EDGES: RangeInclusive<usize> = 16..=8192;

/// Refuses images that are too small to be judged, or too large; each edge by the name that it was stated
/// under.
///
/// # Errors
/// If one is not among [`EDGES`], or as [`check_pixels`].
pub fn check_size(names: [&str; 2], [height, width]: [usize; 2]) -> Result<()> {
    let (least, most) = (EDGES.start(), EDGES.end());
    for (name, edge) in names.into_iter().zip([height, width]) {
        ensure!(EDGES.contains(&edge), "{name}: {edge} is not within {least} to {most}");
    }
    check_pixels(height, width)
}

/// Refuses images whose truth would not fit into memory.
///
/// # Errors
/// If there are more than 2^25 pixels: the eight scramblings of one take 96 bytes, and what comes of them
/// half as much.
pub fn check_pixels(height: usize, width: usize) -> Result<()> {
    const MOST: usize = 1 << 25;
    ensure!(height * width <= MOST, "{width} x {height} pixels are more than {MOST}");
    Ok(())
}

/// Size of an image, written like 768x512.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

impl Size {
    /// Edges longer or shorter by a factor.
    pub fn scaled(self, factor: f32) -> Self {
        let times = |edge: usize| ((edge as f32 * factor).round() as usize).max(1);
        Self { width: times(self.width), height: times(self.height) }
    }
}

impl std::fmt::Display for Size {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}x{}", self.width, self.height)
    }
}

impl std::str::FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let edge = |edge: &str| edge.parse().ok().filter(|edge| EDGES.contains(edge));
        let size = text.split_once('x').and_then(|(width, height)| Some((edge(width)?, edge(height)?)));
        let (width, height) = size.ok_or("expected columns x rows, such as 768x512, each 16 to 8192")?;
        Ok(Self { width, height })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_that_memory_does_not_hold_are_refused() {
        assert!(check_pixels(4096, 8192).is_ok());
        let error = check_pixels(8192, 8192).expect_err("too many").to_string();
        assert!(error.contains("8192 x 8192"), "{error}");
    }

    #[test]
    fn images_that_cannot_be_judged_are_refused_by_the_name_of_their_edge() {
        let size = |height, width| check_size(["height", "width"], [height, width]);
        assert!(size(16, 8192).is_ok());
        for (height, width, said) in [
            (131, 7, "width: 7 is not within 16 to 8192"),
            (9000, 64, "height: 9000 is not within 16 to 8192"),
            (8192, 8192, "8192 x 8192 pixels"),
        ] {
            let error = size(height, width).expect_err(said).to_string();
            assert!(error.contains(said), "{error}");
        }
    }

    #[test]
    fn names_are_not_empty() {
        assert_eq!(name("my paint"), Ok("my paint".to_owned()));
        assert!(name("").is_err() && name(" \t").is_err());
    }

    #[test]
    fn a_radius_is_positive_or_endless() {
        assert_eq!((reach("0.5"), reach("inf")), (Ok(0.5), Ok(f32::INFINITY)));
        assert!(reach("0").is_err() && reach("-inf").is_err() && reach("nan").is_err());
    }

    #[test]
    fn numbers_of_a_range_and_places() {
        let rate = within(0.01..=1000.0);
        assert_eq!((rate("25"), rate("0.01")), (Ok(25.0), Ok(0.01)));
        for wrong in ["1e-9", "1001", "nan", "inf", "-25"] {
            assert!(rate(wrong).expect_err(wrong).ends_with("is not within 0.01 to 1000"), "{wrong}");
        }
        assert_eq!(place("1, -2.5,1e6"), Ok(Vec3::new(1.0, -2.5, 1e6)));
        for (wrong, said) in [
            ("-1e30,0,0", "is not within -1000000 to 1000000"),
            ("0,nan,0", "is not within"),
            ("1,2", "not X,Y,Z"),
            ("1,2,3,4", "not X,Y,Z"),
            ("1,2,x", "`x` is not a number"),
        ] {
            assert!(place(wrong).expect_err(wrong).contains(said), "{wrong}");
        }
    }

    #[test]
    fn sizes_are_columns_by_rows() {
        assert_eq!("768x512".parse(), Ok(Size { width: 768, height: 512 }));
        for wrong in ["768", "768x", "15x16", "x512", "9000x16", "16x-16"] {
            assert!(wrong.parse::<Size>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn files_that_cannot_be_written_are_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name).display().to_string();
        std::fs::write(path("file"), b"x").expect("written");
        assert!(written_file(&path("new.json")).is_ok() && written_file(&path("deep/new.json")).is_ok());
        assert!(written_file(&path("file")).is_ok(), "it is replaced");
        for wrong in ["", "file/new.json", "file/deep/new.json"] {
            let error = written_file(&path(wrong)).expect_err(wrong);
            assert!(!error.contains(atomic_file::TEMPORARY_PREFIX), "{error}");
        }
        assert_eq!(std::fs::read_dir(folder.path()).expect("listed").count(), 1);
    }

    #[test]
    fn files_are_named_for_what_they_hold() {
        assert_eq!(png_file("a/b.PNG"), Ok(PathBuf::from("a/b.PNG")));
        assert_eq!(image_file("/dev/stdout"), Ok(PathBuf::from("/dev/stdout")));
        assert_eq!(image_file("out.EXR"), Ok(PathBuf::from("out.EXR")));
        assert_eq!(image_file("out.png"), Ok(PathBuf::from("out.png")));
        assert_eq!(image_file("out.jpg"), Err("what is written is of the kind .png or .exr".to_owned()));
        assert_eq!(png_file("out.exr"), Err("what is written is of the kind .png".to_owned()));
        assert!(png_file("sheet.jpg").is_err() && svg_file("curve.png").is_err());
        assert_eq!(svg_file("curve.svg"), Ok(PathBuf::from("curve.svg")));
    }
}
