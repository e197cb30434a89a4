//! Maps of MTL libraries: options, and the name of an image.

use super::files::Files;
use super::map_options::{Options, Placement, is_option, word};
use super::statement::readings;
use std::path::{Path, PathBuf};

/// The longest line that is looked through for the name of a file, bytes.
const LONGEST: usize = 1024;

/// Endings of images that modelling programs write, and that are not read here.
const UNREAD_ENDINGS: [&str; 9] = ["tif", "tiff", "gif", "webp", "dds", "psd", "exr", "hdr", "avif"];

/// An image that a material reads.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Map {
    /// A plain file in the scene's folder.
    pub path: PathBuf,
    pub placement: Placement,
    /// What normals are bent by (`-bm`).
    pub strength: f32,
    /// Whether it holds what the image lacks, as transparency is for opacity.
    pub is_inverse: bool,
    /// Line of the library.
    pub line: usize,
}

impl Map {
    /// The map of a line, none where there is no such file; and what is odd about it.
    pub fn parse(line: usize, rest: &str, files: &Files) -> (Option<Self>, Vec<String>) {
        let map = |(path, mut options): (PathBuf, Options)| {
            if is_unread(&path) {
                let name = path.display();
                options
                    .odd
                    .push(format!("`{name}` is no PNG, JPEG, BMP, TGA or KTX2 image; the map is left out"));
                return (None, options.odd);
            }
            let (placement, strength) = (options.placement, options.strength);
            (Some(Self { path, placement, strength, is_inverse: false, line }), options.odd)
        };
        if rest.len() > LONGEST {
            return (None, vec![format!("a map of more than {LONGEST} bytes is left out")]);
        }
        if let Some(path) = files.named(rest) {
            return map((path, Options::default()));
        }
        let texts: Vec<&str> = readings(rest).collect();
        let named = |name: &str| files.named(name);
        if let Some(found) = texts.iter().find_map(|text| read(text, &named)) {
            return map(found);
        }
        let name = without_options(texts.last().unwrap_or(&rest));
        let called = |name: &str| files.called(name);
        // A comment may have a path in it.
        let Some((path, mut options)) = texts.iter().rev().find_map(|text| read(text, &called)) else {
            let missing = format!("there is no image `{name}` in the scene's folder; the map is left out");
            let empty = "a map without a file is passed over".to_owned();
            return (None, vec![if name.is_empty() { empty } else { missing }]);
        };
        let instead = format!("there is no image `{name}`; `{}` is read in its place", path.display());
        options.odd.insert(0, instead);
        map((path, options))
    }
}

/// Whether a file is an image of a kind that is not read, by its name.
fn is_unread(path: &Path) -> bool {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    UNREAD_ENDINGS.iter().any(|unread| ending.eq_ignore_ascii_case(unread))
}

/// What follows the options at the beginning of a text.
fn without_options(text: &str) -> &str {
    let (mut options, mut rest) = (Options::default(), text);
    while options.take(&mut rest, true) {}
    rest.trim()
}

/// The file in a text by a way to find files, and the options before and behind it. Nobody knows how many
/// words belong to an option that nobody knows: they end where a file's name begins.
fn read(text: &str, find: &dyn Fn(&str) -> Option<PathBuf>) -> Option<(PathBuf, Options)> {
    let (mut options, mut rest, mut is_unknown) = (Options::default(), text.trim(), false);
    while !rest.is_empty() {
        rest = rest.trim_start();
        if options.take(&mut rest, true) {
            continue;
        }
        if let Some((path, behind)) = file_before_options(rest, find) {
            options.take_all(behind);
            return Some((path, options));
        }
        if is_option(rest) {
            is_unknown = true;
            options.pass_over(word(&mut rest));
        } else if is_unknown && !rest.starts_with('#') {
            word(&mut rest);
        } else {
            return None;
        }
    }
    None
}

/// The file that a text is the name of, to its end or to an option behind the name, which comes with it.
fn file_before_options<'a>(
    text: &'a str,
    find: &dyn Fn(&str) -> Option<PathBuf>,
) -> Option<(PathBuf, &'a str)> {
    if let Some(path) = find(text) {
        return Some((path, ""));
    }
    let spaces = text.char_indices().filter(|(_, letter)| letter.is_whitespace());
    let mut ends = spaces.map(|(at, _)| at).filter(|at| is_option(text[*at..].trim_start()));
    ends.find_map(|at| find(&text[..at]).map(|path| (path, &text[at..])))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;

    /// The file that is found among some, and its options.
    fn found(text: &str) -> Option<(String, Options)> {
        let names = ["my wood.png", "7", "-1.png", "-wood.png", "a #1.png", "a.png"];
        let find = |name: &str| names.contains(&name.trim()).then(|| PathBuf::from(name.trim()));
        read(text, &find).map(|(path, options)| (path.display().to_string(), options))
    }

    #[test]
    fn options_are_told_from_names_with_spaces() {
        let text = "-s 2 3 1 -o 0.5 -clamp on -mm 0 1 -bm -0.5 my wood.png";
        let (file, options) = found(text).expect("a map");
        assert_eq!((file.as_str(), options.odd.len(), options.strength), ("my wood.png", 0, -0.5));
        let placement =
            Placement { scale: Vec2::new(2.0, 3.0), offset: Vec2::new(0.5, 0.0), is_clamped: true };
        assert_eq!(options.placement, placement);
        let file = |text: &str| found(text).map(|(file, _)| file);
        assert_eq!(file("-s 2 2 7"), Some("7".to_owned()), "a name that is a number");
        for name in ["-1.png", "-wood.png", "a #1.png"] {
            assert_eq!(file(&format!("-s 2 2 1 {name}")), Some(name.to_owned()));
        }
        assert_eq!([file(""), file("-clamp on"), file("gone.png -s 2")], [None, None, None]);
    }

    #[test]
    fn options_stand_behind_the_name_too() {
        let (file, options) = found("-clamp on my wood.png -s 2 4 1 -o 0.5 0.25").expect("a map");
        let placement =
            Placement { scale: Vec2::new(2.0, 4.0), offset: Vec2::new(0.5, 0.25), is_clamped: true };
        assert_eq!((file.as_str(), options.placement), ("my wood.png", placement));
    }

    #[test]
    fn words_of_an_unknown_option_end_where_a_file_begins() {
        for text in ["-new a.png", "-new 3 a.png", "-new 3 b -s 2 2 1 a.png", "a.png -new 3"] {
            let (file, options) = found(text).expect(text);
            assert_eq!((file.as_str(), options.odd.len()), ("a.png", 1), "{text}");
            assert!(options.odd[0].contains("`-new`"), "{text}: {:?}", options.odd);
            assert_eq!(options.placement.scale, Vec2::splat(if text.contains("-s") { 2.0 } else { 1.0 }));
        }
        for text in ["3 a.png", "-new 3 gone.png # not a.png"] {
            assert!(found(text).is_none(), "{text}");
        }
    }
}
