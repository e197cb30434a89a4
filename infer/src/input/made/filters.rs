//! What filters of light go by, in pixels: how far a lens blurs, and how far things move.

use deepshade_shaders::{Attribute, GBuffer, MissingAttribute, Planes};

/// What pixels are counted by: circles and movements have some dozens of them.
const EIGHT_PIXELS: f32 = 8.0;
/// The largest circle, in eights of pixels: a surface right before the lens has one without end.
const MOST_EIGHTS: f32 = 8.0;

/// [`Attribute::SignedCircle`]
pub fn signed_circles(gbuffer: &GBuffer, seen: &[bool]) -> Result<Vec<f32>, MissingAttribute> {
    let of = gbuffer.select(&[Attribute::Blurriness, Attribute::Depth])?;
    let circle = |[blurriness, depth]: [f32; 2]| {
        (blurriness / (depth * EIGHT_PIXELS)).clamp(-MOST_EIGHTS, MOST_EIGHTS)
    };
    Ok(where_seen(&of, seen, circle))
}

/// [`Attribute::Movement`]
pub fn movements(gbuffer: &GBuffer, seen: &[bool]) -> Result<Vec<f32>, MissingAttribute> {
    let of = gbuffer.select(&[Attribute::Motion])?;
    let component = |axis: usize| {
        move |[direction, length]: [f32; 2]| {
            let (sine, cosine) = (2.0 * direction).sin_cos();
            length / EIGHT_PIXELS * [cosine, sine][axis]
        }
    };
    Ok([0, 1].map(|axis| where_seen(&of, seen, component(axis))).concat())
}

/// A plane of what two planes come to at each pixel; 0 where nothing is seen.
fn where_seen(of: &Planes, seen: &[bool], value: impl Fn([f32; 2]) -> f32) -> Vec<f32> {
    let pixels = of.plane(0).iter().zip(of.plane(1)).zip(seen);
    pixels.map(|((first, second), seen)| if *seen { value([*first, *second]) } else { 0.0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::super::with_made;
    use super::*;
    use std::f32::consts::PI;

    /// What is made of a row of pixels that are all seen, but for the last.
    fn made(attribute: Attribute, of: [Attribute; 2], rows: [[f32; 4]; 2]) -> Planes {
        let attributes = match of[0] == of[1] {
            true => vec![of[0], Attribute::Valid],
            false => vec![of[0], of[1], Attribute::Valid],
        };
        let data = [&rows[0][..], &rows[1], &[1.0, 1.0, 1.0, 0.0]].concat();
        let gbuffer = GBuffer::new(attributes, Planes::from_data(3, 1, 4, data));
        let with = with_made(&gbuffer, &[attribute], 1.0).expect("all is there");
        with.select(&[attribute]).expect("it was made")
    }

    #[test]
    fn circles_keep_their_sign_and_end() {
        let of = [Attribute::Blurriness, Attribute::Depth];
        let circles = made(Attribute::SignedCircle, of, [[16.0, -16.0, -1e6, 16.0], [2.0, 4.0, 1e-3, 1.0]]);
        assert_eq!(circles.data(), [1.0, -0.5, -8.0, 0.0]);
    }

    #[test]
    fn there_and_back_are_one_movement_and_its_seam_is_closed() {
        let of = [Attribute::Motion; 2];
        let rows = [[0.0, PI - 1e-6, 0.5 * PI, 1.0], [8.0, 8.0, 4.0, 8.0]];
        let movements = made(Attribute::Movement, of, rows);
        let at = |x: usize| [movements.at(0, 0, x), movements.at(1, 0, x)];
        let near = |a: [f32; 2], b: [f32; 2]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-5);
        assert!(near(at(0), [1.0, 0.0]) && near(at(1), at(0)) && near(at(2), [-0.5, 0.0]));
        assert_eq!(at(3), [0.0; 2], "nothing is seen");
    }
}
