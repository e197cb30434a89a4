//! Options of maps: how an image is placed, and what of it is left out.

use glam::{Affine2, Vec2, Vec3};

/// How an image lies on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placement {
    /// Of texture coordinates with `v` up (`-s`).
    pub scale: Vec2,
    /// Added to them then (`-o`).
    pub offset: Vec2,
    /// Whether the image ends at its edges (`-clamp on`).
    pub is_clamped: bool,
}

impl Default for Placement {
    fn default() -> Self {
        Self { scale: Vec2::ONE, offset: Vec2::ZERO, is_clamped: false }
    }
}

impl Placement {
    /// Its transform of coordinates with `v` down, as textures have them here.
    pub fn transform(&self) -> Affine2 {
        let down = Vec2::new(self.offset.x, 1.0 - self.scale.y - self.offset.y);
        Affine2::from_scale_angle_translation(self.scale, 0.0, down)
    }
}

/// The options of a map.
#[derive(Debug)]
pub(super) struct Options {
    pub placement: Placement,
    /// What normals are bent by (`-bm`).
    pub strength: f32,
    /// What is to be said of options that are left out.
    pub odd: Vec<String>,
}

impl Default for Options {
    fn default() -> Self {
        Self { placement: Placement::default(), strength: 1.0, odd: Vec::new() }
    }
}

impl Options {
    /// Takes the option that a text begins with off it; false where it begins with none that is known.
    pub fn take(&mut self, text: &mut &str, is_name_behind: bool) -> bool {
        let mut rest = *text;
        let option = word(&mut rest);
        let Placement { scale, offset, is_clamped } = &mut self.placement;
        let is_applied = match option {
            "-s" => {
                *scale = numbers(&mut rest, scale.extend(1.0), is_name_behind).truncate();
                true
            }
            "-o" => {
                *offset = numbers(&mut rest, offset.extend(0.0), is_name_behind).truncate();
                true
            }
            "-clamp" => {
                *is_clamped = word(&mut rest).eq_ignore_ascii_case("on");
                true
            }
            "-bm" => {
                self.strength = word(&mut rest).parse().unwrap_or(self.strength);
                true
            }
            // They smooth or resize an image, which shows in no pixel but in the way it is kept.
            "-blendu" | "-blendv" | "-texres" => {
                word(&mut rest);
                true
            }
            // Those that are left out may state what is so without them.
            "-t" => numbers(&mut rest, Vec3::ZERO, is_name_behind) == Vec3::ZERO,
            "-mm" => [word(&mut rest), word(&mut rest)].map(str::parse::<f32>) == [Ok(0.0), Ok(1.0)],
            "-boost" => word(&mut rest).parse::<f32>() == Ok(0.0),
            "-cc" => word(&mut rest).eq_ignore_ascii_case("off"),
            "-imfchan" | "-type" => {
                word(&mut rest);
                false
            }
            _ => return false,
        };
        if !is_applied {
            self.odd.push(format!("`{option}` of a map is left out, though it changes the picture"));
        }
        *text = rest;
        true
    }

    /// Takes the options that a text consists of.
    pub fn take_all(&mut self, text: &str) {
        let mut rest = text;
        while !rest.trim_start().is_empty() {
            if !self.take(&mut rest, false) {
                let unknown = word(&mut rest);
                if is_option(unknown) {
                    self.pass_over(unknown);
                }
            }
        }
    }

    /// Says of an option that it is unknown.
    pub fn pass_over(&mut self, option: &str) {
        self.odd.push(format!("the option `{option}` is passed over"));
    }
}

/// Whether a text begins with an option: a minus and a letter.
pub(super) fn is_option(text: &str) -> bool {
    text.strip_prefix('-').is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_alphabetic()))
}

/// Takes the next word off a text.
pub(super) fn word<'a>(text: &mut &'a str) -> &'a str {
    let (word, rest) = text.trim_start().split_once(char::is_whitespace).unwrap_or((text.trim_start(), ""));
    *text = rest;
    word
}

/// Takes one to three numbers off a text, of which the third is the depth of a solid texture. Where a file's
/// name follows them it may be a number, too.
fn numbers(text: &mut &str, unless_stated: Vec3, is_name_behind: bool) -> Vec3 {
    let mut numbers = unless_stated;
    for i in 0..3 {
        let mut rest = *text;
        let Some(number) = word(&mut rest).parse().ok().filter(|number: &f32| number.is_finite()) else {
            break;
        };
        if is_name_behind && i > 0 && rest.trim().is_empty() {
            break;
        }
        *text = rest;
        numbers[i] = number;
    }
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Options {
        let mut options = Options::default();
        options.take_all(text);
        options
    }

    #[test]
    fn transforms_are_those_of_coordinates_with_v_up() {
        let placement = of("-s 2 4 -o 0.25 0.5").placement;
        assert_eq!((placement.scale, placement.offset), (Vec2::new(2.0, 4.0), Vec2::new(0.25, 0.5)));
        let up = Vec2::new(0.3, 0.2);
        let expected = up * placement.scale + placement.offset;
        let down = placement.transform().transform_point2(Vec2::new(up.x, 1.0 - up.y));
        assert!((down - Vec2::new(expected.x, 1.0 - expected.y)).length() < 1e-6, "{down}");
        assert_eq!(Placement::default().transform(), Affine2::IDENTITY);
    }

    #[test]
    fn options_that_change_the_picture_are_said() {
        for text in ["-mm 0.2 0.8", "-cc on", "-boost 2", "-imfchan r", "-t 0 0 1", "-type sphere"] {
            let (option, said) = (text.split(' ').next().unwrap_or_default(), of(text).odd);
            assert!(said.len() == 1 && said[0].contains(option), "{text}: {said:?}");
        }
        let silent = "-mm 0 1 -cc off -boost 0 -t 0 0 0 -texres 64 -blendu off -blendv on -clamp on -bm 2";
        assert_eq!(of(silent).odd, Vec::<String>::new());
        assert_eq!(of("-new 3").odd, ["the option `-new` is passed over"]);
    }
}
