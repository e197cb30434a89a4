//! Maps of MTL libraries: options, then the name of an image.

use glam::{Affine2, Vec2};

/// An image that a material reads.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Map {
    /// As the file has it, maybe with spaces.
    pub file: String,
    /// Of texture coordinates with `v` up (`-s`).
    pub scale: Vec2,
    /// Added to them then (`-o`).
    pub offset: Vec2,
    /// Whether the image ends at its edges (`-clamp on`).
    pub is_clamped: bool,
    /// What normals are bent by (`-bm`).
    pub strength: f32,
}

impl Map {
    /// A map, none where no file is named; and what is odd about it.
    pub fn parse(text: &str) -> (Option<Self>, Option<String>) {
        let mut map = Self {
            file: String::new(),
            scale: Vec2::ONE,
            offset: Vec2::ZERO,
            is_clamped: false,
            strength: 1.0,
        };
        let (mut rest, mut odd) = (text, None);
        while let Some((option, after)) = option(rest) {
            rest = after;
            match option {
                "-s" => map.scale = numbers(&mut rest, map.scale),
                "-o" => map.offset = numbers(&mut rest, map.offset),
                "-t" => drop(numbers(&mut rest, Vec2::ZERO)),
                "-clamp" => map.is_clamped = word(&mut rest).eq_ignore_ascii_case("on"),
                "-bm" => map.strength = word(&mut rest).parse().unwrap_or(map.strength),
                "-blendu" | "-blendv" | "-boost" | "-cc" | "-imfchan" | "-texres" | "-type" => {
                    word(&mut rest);
                }
                "-mm" => {
                    word(&mut rest);
                    word(&mut rest);
                }
                unknown => odd = Some(format!("the option `{unknown}` is passed over")),
            }
        }
        map.file = rest.trim().trim_matches('"').to_owned();
        if map.file.is_empty() {
            return (None, Some("a map without a file is passed over".to_owned()));
        }
        (Some(map), odd)
    }

    /// Its transform of coordinates with `v` down, as textures have them here.
    pub fn transform(&self) -> Affine2 {
        let down = Vec2::new(self.offset.x, 1.0 - self.scale.y - self.offset.y);
        Affine2::from_scale_angle_translation(self.scale, 0.0, down)
    }
}

/// The option that a text begins with: a minus and a letter.
fn option(text: &str) -> Option<(&str, &str)> {
    let text = text.trim_start();
    let is_option =
        text.strip_prefix('-').is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_alphabetic()));
    is_option.then(|| text.split_once(char::is_whitespace).unwrap_or((text, "")))
}

/// Takes the next word off a text.
fn word<'a>(text: &mut &'a str) -> &'a str {
    let (word, rest) = text.trim_start().split_once(char::is_whitespace).unwrap_or((text.trim_start(), ""));
    *text = rest;
    word
}

/// Takes one to three numbers off a text, of which the third is the depth of a solid texture. What follows
/// them is a file's name, which may be a number, too.
fn numbers(text: &mut &str, unless_stated: Vec2) -> Vec2 {
    let mut numbers = unless_stated;
    for i in 0..3 {
        let mut rest = *text;
        let Some(number) = word(&mut rest).parse().ok().filter(|number: &f32| number.is_finite()) else {
            break;
        };
        if i > 0 && rest.trim().is_empty() {
            break;
        }
        *text = rest;
        if i < 2 {
            numbers[i] = number;
        }
    }
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_told_from_names_with_spaces() {
        let (map, odd) = Map::parse("-s 2 3 1 -o 0.5 -clamp on -mm 0 1 -imfchan m -bm -0.5 my wood.png");
        let map = map.expect("a map");
        assert_eq!((map.file.as_str(), odd), ("my wood.png", None));
        assert_eq!((map.scale, map.offset), (Vec2::new(2.0, 3.0), Vec2::new(0.5, 0.0)));
        assert!(map.is_clamped && map.strength == -0.5);
        let file = |text: &str| Map::parse(text).0.map(|map| map.file);
        assert_eq!(file("-s 2 2 7"), Some("7".to_owned()), "a name that is a number");
        assert_eq!(file("\"a b.png\""), Some("a b.png".to_owned()));
        assert_eq!(file("-1.png"), Some("-1.png".to_owned()));
        assert_eq!([file(""), file("-clamp on"), file("-s 1 1 1 ")], [None, None, Some("1".to_owned())]);
        assert!(Map::parse("-new a.png").1.is_some_and(|odd| odd.contains("`-new`")));
    }

    #[test]
    fn transforms_are_those_of_coordinates_with_v_up() {
        let map = Map::parse("-s 2 4 -o 0.25 0.5 a.png").0.expect("a map");
        let up = Vec2::new(0.3, 0.2);
        let expected = up * map.scale + map.offset;
        let down = map.transform().transform_point2(Vec2::new(up.x, 1.0 - up.y));
        assert!((down - Vec2::new(expected.x, 1.0 - expected.y)).length() < 1e-6, "{down}");
        assert_eq!(Map::parse("a.png").0.expect("a map").transform(), Affine2::IDENTITY);
    }
}
