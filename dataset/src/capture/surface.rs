//! From a depth image to what networks read: positions, normals and where there are any.
//!
//! The inverse of the depth of a plane is an affine function of the pixel, whatever the plane's tilt; so the
//! normal comes from the straight line through the inverse depths of a window, by least squares, and is exact
//! for planes. A structured-light sensor measures disparity, which is inverse depth: its noise is alike over
//! the window.
//!
//! The window does not cross depth edges: a pixel belongs to it if it is reached from the middle in steps
//! from neighbour to neighbour, none of which is higher than the sensor's noise and a steep surface explain.

use super::Intrinsics;
use crate::sensor::axial_noise;
use deepshade_shaders::{Attribute, GBuffer, Planes};
use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

/// What a depth image is turned into.
pub const ATTRIBUTES: [Attribute; 3] = [Attribute::Position, Attribute::Normal, Attribute::Valid];
/// Half the angle that a window spans, radians: 12 mm at one metre, which averages a Kinect's noise to about
/// two degrees.
const WINDOW: f32 = 0.0115;
/// Least radius of a window, pixels.
const LEAST_RADIUS: f32 = 2.0;
/// Share of a window's pixels that a normal needs; a window in the image's corner has more.
const LEAST_SHARE: f64 = 0.25;
/// Least variance of these pixels in every direction, pixels squared: three rows have 2 / 3, two have 1 / 4.
const LEAST_SPREAD: f64 = 0.5;
/// Tangent of the steepest tilt, 75 degrees, that is told from an edge.
const STEEPEST: f32 = 3.73;
/// Standard deviations of the sensor's noise in a step that is no edge.
const DEVIATIONS: f32 = 3.0;

/// How much the depths of neighbouring pixels on one surface may differ, metres, at a depth in metres and a
/// focal length in pixels.
pub fn highest_step(depth: f32, focal: f32) -> f32 {
    DEVIATIONS * std::f32::consts::SQRT_2 * axial_noise(depth) + STEEPEST * depth / focal
}

/// The [`ATTRIBUTES`] of a depth image, `[1, height, width]`, metres along the view's axis, 0 where there is
/// none: in camera space, y up, looking down -z, normals facing the camera. Where there is no depth, or too
/// few pixels of the same surface around it, all of them are 0.
pub fn surface(depth: &Planes, intrinsics: &Intrinsics) -> GBuffer {
    let width = depth.width();
    let window = Window::of(intrinsics);
    let pixels: Vec<Option<(Vec3, Vec3)>> = (0..depth.pixels())
        .into_par_iter()
        .map(|pixel| {
            let (x, y) = (pixel % width, pixel / width);
            let normal = window.normal(depth, intrinsics, x, y)?;
            Some((intrinsics.position(x, y, depth.at(0, y, x)), normal))
        })
        .collect();
    let planes = Planes::from_fn(7, depth.height(), width, |channel, y, x| {
        pixels[y * width + x].map_or(0.0, |(position, normal)| match channel {
            0..3 => position[channel],
            3..6 => normal[channel - 3],
            _ => 1.0,
        })
    });
    GBuffer::new(ATTRIBUTES.to_vec(), planes)
}

/// The pixels around one, from the inside to the outside.
struct Window {
    offsets: Vec<Offset>,
    /// [`Intrinsics::fx`].
    focal: f32,
}

/// A pixel of a window.
struct Offset {
    dx: i32,
    dy: i32,
    /// Index of the neighbour from which it is reached.
    from: usize,
}

impl Window {
    fn of(intrinsics: &Intrinsics) -> Self {
        let radius = (WINDOW * intrinsics.fx).round().max(LEAST_RADIUS) as i32;
        let mut offsets = vec![Offset { dx: 0, dy: 0, from: 0 }];
        for ring in 1..=radius {
            for (dx, dy) in (-ring..=ring).flat_map(|dy| (-ring..=ring).map(move |dx| (dx, dy))) {
                if dx.abs().max(dy.abs()) < ring {
                    continue;
                }
                let inwards = |offset: i32| (offset as f32 * (ring - 1) as f32 / ring as f32).round() as i32;
                let (from_x, from_y) = (inwards(dx), inwards(dy));
                let from = offsets.iter().position(|other| other.dx == from_x && other.dy == from_y);
                offsets.push(Offset { dx, dy, from: from.expect("the ring inside comes first") });
            }
        }
        Self { offsets, focal: intrinsics.fx }
    }

    /// The unit normal at a pixel; `None` where nothing is seen, or not enough of the same surface around it.
    fn normal(&self, depth: &Planes, intrinsics: &Intrinsics, x: usize, y: usize) -> Option<Vec3> {
        if depth.at(0, y, x) <= 0.0 {
            return None;
        }
        let mut line = Line::default();
        // Depths of the pixels that were reached; 0 for others.
        let mut reached = vec![0.0; self.offsets.len()];
        for (index, Offset { dx, dy, from }) in self.offsets.iter().enumerate() {
            let (Some(column), Some(row)) =
                (x.checked_add_signed(*dx as isize), y.checked_add_signed(*dy as isize))
            else {
                continue;
            };
            if column >= depth.width() || row >= depth.height() {
                continue;
            }
            let here = depth.at(0, row, column);
            let before = if index == 0 { here } else { reached[*from] };
            if here <= 0.0
                || before <= 0.0
                || (here - before).abs() > highest_step(here.min(before), self.focal)
            {
                continue;
            }
            reached[index] = here;
            line.add(DVec2::new(f64::from(*dx), f64::from(*dy)), 1.0 / f64::from(here));
        }
        let (slope, inverse) = line.fitted(LEAST_SHARE * self.offsets.len() as f64)?;
        // With x and y the pixel and 1 / Z = a x + b y + c, the plane's points fulfil a fx X - b fy Y + (a cx
        // + b cy + c) Z = 1, which makes the left side's factors a normal, away from the camera.
        let Intrinsics { fx, fy, centre } = *intrinsics;
        let to_centre = centre.as_dvec2() - DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
        let along_axis = slope.dot(to_centre) + inverse;
        let normal = DVec3::new(-slope.x * f64::from(fx), slope.y * f64::from(fy), along_axis);
        (inverse > 0.0).then(|| normal.normalize().as_vec3())
    }
}

/// A least-squares plane `value = slope . offset + value at the middle`, being fitted.
#[derive(Default)]
struct Line {
    count: f64,
    offsets: DVec2,
    /// Sums of xx, xy and yy.
    squares: DVec3,
    values: f64,
    products: DVec2,
}

impl Line {
    fn add(&mut self, offset: DVec2, value: f64) {
        self.count += 1.0;
        self.offsets += offset;
        self.squares += DVec3::new(offset.x * offset.x, offset.x * offset.y, offset.y * offset.y);
        self.values += value;
        self.products += offset * value;
    }

    /// Slope and value at the middle, of at least so many points that do not lie on a line.
    fn fitted(&self, least: f64) -> Option<(DVec2, f64)> {
        if self.count < least {
            return None;
        }
        let (mean, value) = (self.offsets / self.count, self.values / self.count);
        let [xx, xy, yy] = (self.squares / self.count
            - DVec3::new(mean.x * mean.x, mean.x * mean.y, mean.y * mean.y))
        .to_array();
        let least_variance = 0.5 * (xx + yy) - (0.25 * (xx - yy) * (xx - yy) + xy * xy).sqrt();
        if least_variance < LEAST_SPREAD {
            return None;
        }
        let right = self.products / self.count - mean * value;
        let slope =
            DVec2::new(yy * right.x - xy * right.y, xx * right.y - xy * right.x) / (xx * yy - xy * xy);
        Some((slope, value - slope.dot(mean)))
    }
}

#[cfg(test)]
mod tests;
