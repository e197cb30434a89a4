//! The paper's augmentation: a pair rotated by quarter turns and mirrored is another sound pair, once vectors
//! in camera space turn with the image (thesis 7.3.1).

use crate::Pair;
use deepshade_shaders::{Attribute, AttributeKind, Effect, GBuffer, Planes};
use std::f32::consts::PI;

/// One of the eight symmetries of the square: a mirroring of left and right or none, then quarter turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Symmetry {
    mirrored: bool,
    quarter_turns: u8,
}

impl Symmetry {
    /// Leaves everything as it is.
    pub const IDENTITY: Self = Self::new(false, 0);

    /// All eight; the identity is the first.
    pub const ALL: [Self; 8] = [
        Self::IDENTITY,
        Self::new(false, 1),
        Self::new(false, 2),
        Self::new(false, 3),
        Self::new(true, 0),
        Self::new(true, 1),
        Self::new(true, 2),
        Self::new(true, 3),
    ];

    /// Those that leave pairs of an effect sound: all, but none where light comes from where the camera says,
    /// as in the look of photographs (thesis 7.4), which a rolled camera would not have seen so.
    pub const fn of(effect: Effect) -> &'static [Self] {
        if effect.definition().turns { &Self::ALL } else { &[Self::IDENTITY] }
    }

    /// Left and right exchanged, if `mirrored`, and then so many quarter turns counter-clockwise.
    pub const fn new(mirrored: bool, quarter_turns: u8) -> Self {
        Self { mirrored, quarter_turns: quarter_turns % 4 }
    }

    /// Rows of the matrix that takes a point of the image plane, x to the right and y up, to where it goes.
    pub const fn matrix(self) -> [[i32; 2]; 2] {
        let x = if self.mirrored { -1 } else { 1 };
        match self.quarter_turns {
            0 => [[x, 0], [0, 1]],
            1 => [[0, -1], [x, 0]],
            2 => [[-x, 0], [0, -1]],
            _ => [[0, 1], [-x, 0]],
        }
    }

    /// Whether rows become columns.
    pub const fn swaps_axes(self) -> bool {
        self.quarter_turns % 2 == 1
    }

    /// Moves the pixels of an image; values stay as they are.
    pub fn move_pixels(self, image: &Planes) -> Planes {
        let (old_height, old_width) = (image.height(), image.width());
        let (height, width) =
            if self.swaps_axes() { (old_width, old_height) } else { (old_height, old_width) };
        let [[a, b], [c, d]] = self.matrix();
        Planes::from_fn(image.channels(), height, width, |channel, y, x| {
            // Twice the distance from the middle, so that it is whole; the inverse of the matrix is its
            // transpose.
            let right = 2 * x as i32 - (width as i32 - 1);
            let up = (height as i32 - 1) - 2 * y as i32;
            let (from_right, from_up) = (a * right + c * up, b * right + d * up);
            let from_x = (from_right + old_width as i32 - 1) / 2;
            let from_y = (old_height as i32 - 1 - from_up) / 2;
            image.at(channel, from_y as usize, from_x as usize)
        })
    }

    /// Turns and mirrors a g-buffer: pixels move, and vectors in camera space and movements in the image
    /// turn.
    pub fn apply(self, gbuffer: &GBuffer) -> GBuffer {
        let mut planes = self.move_pixels(gbuffer.planes());
        let mut first = 0;
        for attribute in gbuffer.attributes() {
            self.turn_values(&mut planes, first, *attribute);
            first += attribute.width();
        }
        GBuffer::new(gbuffer.attributes().to_vec(), planes)
    }

    /// Turns the values of an attribute whose planes start at `first`.
    fn turn_values(self, planes: &mut Planes, first: usize, attribute: Attribute) {
        match attribute.kind() {
            AttributeKind::WorldVector
            | AttributeKind::Colour
            | AttributeKind::Scalar
            | AttributeKind::Scales => {}
            AttributeKind::CameraVector => {
                for pixel in 0..planes.pixels() {
                    let turned = self.turn([planes.plane(first)[pixel], planes.plane(first + 1)[pixel]]);
                    planes.plane_mut(first)[pixel] = turned[0];
                    planes.plane_mut(first + 1)[pixel] = turned[1];
                }
            }
            AttributeKind::DoubledAngle => {
                for pixel in 0..planes.pixels() {
                    let doubled = [planes.plane(first)[pixel], planes.plane(first + 1)[pixel]];
                    let turned = self.turn_doubled(doubled);
                    planes.plane_mut(first)[pixel] = turned[0];
                    planes.plane_mut(first + 1)[pixel] = turned[1];
                }
            }
            AttributeKind::Motion => {
                for angle in planes.plane_mut(first) {
                    let [x, y] = self.turn([angle.cos(), angle.sin()]);
                    let turned = y.atan2(x).rem_euclid(PI);
                    // Rounding may give pi itself, which is the direction 0.
                    *angle = if turned < PI { turned } else { 0.0 };
                }
            }
        }
    }

    /// A vector at twice the angle of a direction, of the direction turned: by quarters of a turn it is
    /// turned by halves, and what mirrors the direction mirrors it at the x axis.
    fn turn_doubled(self, [x, y]: [f32; 2]) -> [f32; 2] {
        let turned = if self.swaps_axes() { -1.0 } else { 1.0 };
        [turned * x, if self.mirrored { -turned * y } else { turned * y }]
    }

    fn turn(self, [x, y]: [f32; 2]) -> [f32; 2] {
        self.matrix().map(|[from_x, from_y]| from_x as f32 * x + from_y as f32 * y)
    }
}

/// A pair as if it had been rendered by a camera that was rolled or mirrored.
pub fn augment(pair: &Pair, symmetry: Symmetry) -> Pair {
    if symmetry == Symmetry::IDENTITY {
        return pair.clone();
    }
    Pair {
        gbuffer: symmetry.apply(&pair.gbuffer),
        target: symmetry.move_pixels(&pair.target),
        variance: pair.variance.as_ref().map(|variance| symmetry.move_pixels(variance)),
        radius: pair.radius,
    }
}

#[cfg(test)]
mod tests;
