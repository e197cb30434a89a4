//! FLIP, the difference that a viewer sees when alternating between two images (Andersson, Nilsson,
//! Akenine-Möller, Oskarsson, Åström and Fairchild 2020), for low dynamic range.
//!
//! Two measures meet: the colour difference of images seen through the eye's contrast sensitivity, and the
//! difference of edges and points, which makes colour differences count more (section 4.3). Grey images are
//! taken as equal red, green and blue. FLIP is defined on sRGB images; these are linear, and encoding them
//! only for FLIP to decode them would change nothing, so values are clamped to [0, 1], as encoding would, and
//! used as they are.

mod colour;
mod filter;

#[cfg(test)]
mod oracle;

use super::assert_same_shape;
use colour::{Lab, Rgb};
use deepshade_shaders::Planes;
use filter::{FeatureFilters, Separable};
use rayon::prelude::*;

/// Pixels in a degree of the field of view: a 0.7 m wide screen of 3840 pixels seen from 0.7 m (section 4).
pub const PIXELS_PER_DEGREE: f32 = 67.0;

/// Exponent that compresses large colour differences (section 4.1.3).
const COLOUR_EXPONENT: f32 = 0.7;
/// Share of the largest colour difference up to which differences are stretched ...
const STRETCHED_SHARE: f32 = 0.4;
/// ... to this share of the result.
const STRETCHED_TO: f32 = 0.95;
/// Exponent of feature differences (section 4.2.2).
const FEATURE_EXPONENT: f32 = 0.5;

/// Mean FLIP of two images, `[1 or 3, height, width]` linear in [0, 1]: 0 where equal, at most 1. Symmetric.
///
/// # Panics
/// If the images differ in shape or have neither one nor three channels.
pub fn flip(a: &Planes, b: &Planes) -> f64 {
    flip_map(a, b).mean()
}

/// FLIP of every pixel, `[1, height, width]`, at [`PIXELS_PER_DEGREE`].
///
/// # Panics
/// If the images differ in shape or have neither one nor three channels.
pub fn flip_map(a: &Planes, b: &Planes) -> Planes {
    flip_map_at(a, b, PIXELS_PER_DEGREE)
}

/// FLIP of every pixel for a viewer who sees so many pixels in a degree.
fn flip_map_at(a: &Planes, b: &Planes, pixels_per_degree: f32) -> Planes {
    assert_same_shape(a, b);
    let (height, width) = (a.height(), a.width());
    let [a, b] = [a, b].map(|image| Appearance::new(image, pixels_per_degree));
    let largest = compressed(colour::largest_difference());
    let mut map = Planes::filled(1, height, width, 0.0);
    map.data_mut().par_iter_mut().enumerate().for_each(|(pixel, value)| {
        let colour = stretched(compressed(a.colour[pixel].difference(b.colour[pixel])), largest);
        let [edge, point] = [0, 1].map(|i| (a.features[pixel][i] - b.features[pixel][i]).abs());
        let feature = (edge.max(point) / 2f32.sqrt()).powf(FEATURE_EXPONENT);
        *value = colour.powf(1.0 - feature);
    });
    map
}

/// What a viewer sees of an image.
struct Appearance {
    /// Colours after the eye's blur.
    colour: Vec<Lab>,
    /// Strength of edge and of point.
    features: Vec<[f32; 2]>,
}

impl Appearance {
    fn new(image: &Planes, pixels_per_degree: f32) -> Self {
        let (height, width) = (image.height(), image.width());
        let opponent: Vec<_> = (0..image.pixels())
            .into_par_iter()
            .map(|pixel| Rgb::read(image, pixel).clamped().to_opponent())
            .collect();
        let plane = |channel: usize| opponent.iter().map(|colour| colour.0[channel]).collect::<Vec<f32>>();
        let planes = [plane(0), plane(1), plane(2)];
        let seen: Vec<_> = planes
            .iter()
            .zip(filter::contrast_sensitivity(pixels_per_degree))
            .map(|(plane, blur)| blur.apply(plane, height, width))
            .collect();
        let colour = (0..image.pixels())
            .into_par_iter()
            .map(|i| colour::Opponent([seen[0][i], seen[1][i], seen[2][i]]).to_rgb().clamped().to_lab())
            .collect();
        let lightness: Vec<f32> = opponent.iter().map(|colour| colour.lightness()).collect();
        Self { colour, features: features(&lightness, height, width, pixels_per_degree) }
    }
}

/// Strength of edge and of point at every pixel of a lightness image in [0, 1] (section 4.2.1).
fn features(lightness: &[f32], height: usize, width: usize, pixels_per_degree: f32) -> Vec<[f32; 2]> {
    let FeatureFilters { smooth, edge, point } = FeatureFilters::new(pixels_per_degree);
    let filtered = |x: &[f32], y: &[f32]| Separable { x, y }.apply(lightness, height, width);
    let (edge_x, edge_y) = (filtered(&edge, &smooth), filtered(&smooth, &edge));
    let (point_x, point_y) = (filtered(&point, &smooth), filtered(&smooth, &point));
    (0..lightness.len())
        .into_par_iter()
        .map(|i| [edge_x[i].hypot(edge_y[i]), point_x[i].hypot(point_y[i])])
        .collect()
}

/// A colour difference with large ones compressed.
fn compressed(difference: f32) -> f32 {
    difference.powf(COLOUR_EXPONENT)
}

/// A compressed difference in [0, 1], small ones stretched (section 4.1.3).
fn stretched(difference: f32, largest: f32) -> f32 {
    let knee = STRETCHED_SHARE * largest;
    if difference < knee {
        STRETCHED_TO * difference / knee
    } else {
        STRETCHED_TO + (1.0 - STRETCHED_TO) * (difference - knee) / (largest - knee)
    }
}
