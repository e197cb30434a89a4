//! Colours of vertices, in whichever of two ways a file states them: 0 to 1, or 0 to 255.

use super::warnings::Warnings;
use glam::Vec4;

/// The colours of a file as they are read.
#[derive(Debug, Default)]
pub(super) struct Colours {
    /// Not a number where a vertex has none, and alpha where it has no alpha.
    stated: Vec<Vec4>,
    /// The first line with a component that is not within 0 to 1.
    odd: Option<usize>,
}

impl Colours {
    /// Adds the colour of a vertex.
    pub fn add(&mut self, line: usize, vertex: usize, colour: Vec4) {
        self.stated.resize(vertex, Vec4::NAN);
        self.stated.push(colour);
        let is_odd = |value: &f32| value.is_finite() && !(0.0..=1.0).contains(value);
        if colour.to_array().iter().any(is_odd) {
            self.odd.get_or_insert(line);
        }
    }

    /// The colours of all vertices within 0 to 1, none where the file has none. Alpha is 1 where it is not
    /// stated.
    pub fn of_all(mut self, vertices: usize, warnings: &mut Warnings) -> Vec<Vec4> {
        if self.stated.is_empty() {
            return self.stated;
        }
        self.stated.resize(vertices, Vec4::NAN);
        let is_of_255 = self.odd.is_some() && self.is_of_255();
        if let Some(line) = self.odd {
            let of_255 = "colours of vertices are taken as whole numbers up to 255";
            let clamped = "colours of vertices are brought to 0 to 1 where they are beyond it";
            warnings.add(line, if is_of_255 { of_255 } else { clamped });
        }
        // A file may count colours to 255 and alpha to 1.
        let most_alpha = self.stated.iter().map(|colour| colour.w).fold(0.0, f32::max);
        let scale = if is_of_255 { 1.0 / 255.0 } else { 1.0 };
        let alpha_scale = if most_alpha > 1.0 { scale } else { 1.0 };
        for colour in &mut self.stated {
            let alpha = if colour.w.is_nan() { 1.0 } else { colour.w * alpha_scale };
            let has_colour = colour.truncate().is_finite();
            let within = (*colour * scale).with_w(alpha).clamp(Vec4::ZERO, Vec4::ONE);
            *colour = if has_colour { within } else { Vec4::NAN };
        }
        self.stated
    }

    /// Whether all components are whole numbers up to 255.
    fn is_of_255(&self) -> bool {
        let is_byte = |value: f32| (0.0..=255.0).contains(&value) && value.fract() == 0.0;
        let mut components = self.stated.iter().flat_map(|colour| colour.to_array());
        components.all(|value| value.is_nan() || is_byte(value))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn of(colours: &[Vec4]) -> (Vec<Vec4>, Vec<String>) {
        let (mut all, mut warnings) = (Colours::default(), Warnings::default());
        for (vertex, colour) in colours.iter().enumerate() {
            all.add(vertex + 1, vertex, *colour);
        }
        let settled = all.of_all(colours.len(), &mut warnings);
        (settled, warnings.about(Path::new("a")))
    }

    const NO_ALPHA: f32 = f32::NAN;

    #[test]
    fn whole_numbers_up_to_255_are_divided() {
        let (colours, said) =
            of(&[Vec4::new(1.0, 0.0, 0.0, NO_ALPHA), Vec4::new(255.0, 51.0, 0.0, NO_ALPHA)]);
        let expected = [Vec4::new(1.0 / 255.0, 0.0, 0.0, 1.0), Vec4::new(1.0, 0.2, 0.0, 1.0)];
        assert!(colours.iter().zip(expected).all(|(a, b)| a.abs_diff_eq(b, 1e-6)), "{colours:?}");
        assert_eq!(said, ["a: line 2: colours of vertices are taken as whole numbers up to 255"]);
        let alpha = |alpha: f32| of(&[Vec4::new(255.0, 0.0, 0.0, alpha)]).0[0].w;
        assert!((alpha(51.0) - 0.2).abs() < 1e-6);
        assert_eq!(alpha(1.0), 1.0, "alpha up to 1");
    }

    #[test]
    fn other_colours_are_clamped_where_they_are_beyond_1() {
        for odd in
            [Vec4::new(1.5, 0.5, -1.0, 1.0), Vec4::new(256.0, 0.5, 0.0, 1.0), Vec4::new(2.0, 0.5, 0.0, 1.0)]
        {
            let (colours, said) = of(&[Vec4::ONE, odd]);
            assert_eq!(colours, [Vec4::ONE, Vec4::new(1.0, 0.5, 0.0, 1.0)]);
            assert!(said.len() == 1 && said[0].starts_with("a: line 2: "), "{said:?}");
        }
        let (colours, said) = of(&[Vec4::new(1.0, 0.0, 1.0, NO_ALPHA)]);
        assert_eq!((colours[0], said.len()), (Vec4::new(1.0, 0.0, 1.0, 1.0), 0), "sound colours");
    }
}
