//! Where a file says that no surface is seen, without saying it in the layer `valid`.
//!
//! Renderers write a number there that no surface has. Blender writes a depth of 1e10, others 1e12, 1e30 or
//! infinity, and half floats hold none beyond 65,504. That is then the largest one.

use deepshade_shaders::{Attribute, Planes};

/// No scene is so large, whatever its unit: in millimetres this is a thousand kilometres.
const BEYOND_ALL: f32 = 1e9;

/// The largest half float. A surface has exactly this depth only by chance, and then at one pixel.
const LARGEST_HALF: f32 = 65_504.0;

/// Sets all channels to 0 wherever one of them is not finite, or a length is one that no surface has.
pub fn clear(planes: &mut Planes, attributes: &[Attribute]) {
    let attribute_of = |attribute: &Attribute| vec![*attribute; attribute.width()];
    let attributes: Vec<Attribute> = attributes.iter().flat_map(attribute_of).collect();
    let says_nothing = |planes: &Planes, pixel: usize| {
        let mut values = attributes.iter().enumerate().map(|(c, a)| (*a, planes.plane(c)[pixel]));
        values.any(|(attribute, value)| !value.is_finite() || is_length(attribute) && is_beyond(value))
    };
    let nothing: Vec<usize> = (0..planes.pixels()).filter(|pixel| says_nothing(planes, *pixel)).collect();
    for channel in 0..planes.channels() {
        for pixel in &nothing {
            planes.plane_mut(channel)[*pixel] = 0.0;
        }
    }
}

/// Whether an attribute says how far away something is.
const fn is_length(attribute: Attribute) -> bool {
    matches!(
        attribute,
        Attribute::Position | Attribute::Depth | Attribute::FocalDistance | Attribute::Blurriness
    )
}

fn is_beyond(length: f32) -> bool {
    length.abs() >= BEYOND_ALL || length.abs() == LARGEST_HALF
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_that_no_surface_has_show_nothing() {
        let attributes = [Attribute::Depth, Attribute::Light];
        let depths = [1e10, 65_504.0, -65_504.0, 1e30, f32::INFINITY, f32::NAN, 1e5, 65_472.0, 3.0];
        let value = |c: usize, _: usize, x: usize| if c == 0 { depths[x] } else { 65_504.0 };
        let mut planes = Planes::from_fn(4, 1, depths.len(), value);
        clear(&mut planes, &attributes);
        let seen = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        for (x, seen) in seen.iter().enumerate() {
            let expected = if *seen > 0.0 { [depths[x], 65_504.0] } else { [0.0; 2] };
            assert_eq!([planes.at(0, 0, x), planes.at(3, 0, x)], expected, "{}", depths[x]);
        }
    }
}
