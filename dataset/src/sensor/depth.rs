//! Depth of a structured-light sensor: noise along and across the view, steps of disparity, and holes.
//!
//! - Noise: Nguyen, Izadi and Lovell 2012, "Modeling Kinect sensor noise for improved 3D reconstruction and
//!   tracking", equations 1 and 2, by depth and by the angle between normal and view.
//! - Steps: disparity is known to 1/8 pixel (Konolige and Mihelich, "Technical description of Kinect
//!   calibration", in the documentation of ROS).
//! - Base line and range: Khoshelham and Elberink 2012, "Accuracy and resolution of Kinect depth data for
//!   indoor mapping applications".
//! - Holes: where the projector's light does not come, beyond an edge; where a surface is grazed; beyond the
//!   range. Fewer than a sensor has: dark and shining surfaces answer here as all others do.
//!
//! Noise of neighbouring pixels is independent, which that of a Kinect, whose dots are matched in blocks, is
//! not quite. The projector is hidden by what the camera sees, and by nothing else.

use super::normal::gaussian;
use crate::capture::{Intrinsics, surface::highest_step};
use crate::vary::purpose;
use deepshade_shaders::{Attribute, GBuffer, Planes, shows_surface};
use glam::Vec3;
use rayon::prelude::*;
use std::f32::consts::{FRAC_PI_2, FRAC_PI_3};

/// Focal length of the infrared camera, pixels.
const FOCAL: f32 = 585.0;
/// Distance from the camera to the projector, which is on its right, metres.
const BASE_LINE: f32 = 0.075;
/// Steps of disparity in a pixel.
const STEPS: f32 = 8.0;
/// Depths that are measured, metres.
const RANGE: std::ops::RangeInclusive<f32> = 0.5..=5.0;
/// Cosine of the angle, 80 degrees, beyond which nothing comes back; no source has a number for it, this is a
/// choice.
const LEAST_COSINE: f32 = 0.174;

/// Standard deviation of depth along the view, metres, at a depth in metres of surfaces that are not grazed
/// (Nguyen et al. 2012, equation 2).
pub fn axial_noise(depth: f32) -> f32 {
    0.0012 + 0.0019 * (depth - 0.4).powi(2)
}

/// [`axial_noise`] at an angle between normal and view, radians.
fn axial_noise_at(depth: f32, angle: f32) -> f32 {
    let grazing = if angle > FRAC_PI_3 { (angle / (FRAC_PI_2 - angle)).powi(2) } else { 0.0 };
    axial_noise(depth) + 1e-4 / depth.sqrt() * grazing
}

/// Standard deviation across the view, pixels of the infrared camera (equation 1).
fn lateral_noise(angle: f32) -> f32 {
    0.8 + 0.035 * angle / (FRAC_PI_2 - angle)
}

/// The depth that a sensor measures of what is seen, `[1, height, width]`, metres, 0 where it measures none.
/// Of `seen` it reads position, normal and validity.
///
/// # Panics
/// If `seen` lacks one of these.
pub fn measured(seen: &GBuffer, intrinsics: &Intrinsics, seed: u32) -> Planes {
    let (height, width) = (seen.height(), seen.width());
    let answers = answers(seen, intrinsics);
    let depth = |pixel: usize| {
        let words = [u64::from(seed), purpose::SENSOR_DEPTH, pixel as u64];
        let answer = jittered(&answers, [height, width], pixel, intrinsics, words)?;
        let noise = axial_noise_at(answer.depth, answer.angle) * gaussian(words, 0);
        Some(quantised(answer.depth + noise)).filter(|depth| RANGE.contains(depth))
    };
    let depths: Vec<f32> =
        (0..height * width).into_par_iter().map(|pixel| depth(pixel).unwrap_or(0.0)).collect();
    Planes::from_data(1, height, width, depths)
}

/// What comes back from a pixel's surface before there is noise.
#[derive(Clone, Copy, Debug)]
struct DepthReturn {
    /// Metres along the view's axis.
    depth: f32,
    /// Between normal and view, radians.
    angle: f32,
}

/// The answers of all pixels; `None` where nothing comes back.
fn answers(seen: &GBuffer, intrinsics: &Intrinsics) -> Vec<Option<DepthReturn>> {
    let wanted = [Attribute::Position, Attribute::Normal, Attribute::Valid];
    let planes = seen.select(&wanted).expect("a g-buffer of what the sensor reads");
    let vector = |first: usize, pixel: usize| {
        Vec3::from_array(std::array::from_fn(|component| planes.plane(first + component)[pixel]))
    };
    let answer = |pixel: usize| {
        let (position, normal) = (vector(0, pixel), vector(3, pixel));
        let cosine = normal.dot(-position.normalize_or_zero());
        let depth = -position.z;
        let comes_back =
            shows_surface(planes.plane(6)[pixel]) && cosine > LEAST_COSINE && RANGE.contains(&depth);
        comes_back.then(|| DepthReturn { depth, angle: cosine.min(1.0).acos() })
    };
    let mut answers: Vec<Option<DepthReturn>> = (0..seen.height() * seen.width()).map(answer).collect();
    for (row, z) in answers.chunks_mut(seen.width()).zip(planes.plane(2).chunks(seen.width())) {
        shade(row, z, intrinsics);
    }
    answers
}

/// Takes away the answers of a row's pixels that the projector does not shine on. It stands to the right of
/// the camera and sees what is at a column at `column - focal length * base line / depth`: going left, those
/// columns fall unless something nearer was passed, behind which nothing is lit until they fall below its
/// own.
fn shade(answers: &mut [Option<DepthReturn>], z: &[f32], intrinsics: &Intrinsics) {
    let mut least = f32::INFINITY;
    for (x, (answer, z)) in answers.iter_mut().zip(z).enumerate().rev() {
        // Where nothing is seen nothing is in the projector's way.
        if *z >= 0.0 {
            continue;
        }
        let column = x as f32 - intrinsics.fx * BASE_LINE / -z;
        if column > least {
            *answer = None;
        }
        least = least.min(column);
    }
}

/// What answers at a pixel: its own surface or, if the noise across the view is that large, the one beyond an
/// edge. On one surface the noise along the view is all there is.
fn jittered(
    answers: &[Option<DepthReturn>],
    [height, width]: [usize; 2],
    pixel: usize,
    intrinsics: &Intrinsics,
    words: [u64; 3],
) -> Option<DepthReturn> {
    let own = answers[pixel];
    let deviation = lateral_noise(own.map_or(0.0, |own| own.angle)) * intrinsics.fx / FOCAL;
    let moved = |at: usize, most: usize, which: u64| {
        let there = at as f32 + deviation * gaussian(words, which);
        there.round().clamp(0.0, (most - 1) as f32) as usize
    };
    let other = answers[moved(pixel / width, height, 2) * width + moved(pixel % width, width, 1)];
    match (own, other) {
        (Some(own), Some(other)) => {
            let nearer = own.depth.min(other.depth);
            let edge = (own.depth - other.depth).abs() > highest_step(nearer, intrinsics.fx);
            Some(if edge { other } else { own })
        }
        _ => None,
    }
}

/// The depth of the nearest disparity that the sensor tells from others, metres.
fn quantised(depth: f32) -> f32 {
    let steps = (STEPS * FOCAL * BASE_LINE / depth).round();
    STEPS * FOCAL * BASE_LINE / steps
}

#[cfg(test)]
mod tests;
