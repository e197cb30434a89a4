//! The filters of FLIP, all separable: the eye's contrast sensitivity (section 4.1.1) and the derivatives
//! that find edges and points (section 4.2.1). Borders are replicated.

use rayon::prelude::*;
use std::f32::consts::PI;

/// A Gaussian of the contrast sensitivity in the frequency domain: amplitude and width (Table 1).
#[derive(Clone, Copy)]
struct Sensitivity {
    amplitude: f32,
    width: f32,
}

const LIGHTNESS: [Sensitivity; 1] = [Sensitivity { amplitude: 1.0, width: 0.0047 }];
const RED_GREEN: [Sensitivity; 1] = [Sensitivity { amplitude: 1.0, width: 0.0053 }];
const BLUE_YELLOW: [Sensitivity; 2] =
    [Sensitivity { amplitude: 34.1, width: 0.04 }, Sensitivity { amplitude: 13.5, width: 0.025 }];
/// The widest of all; it decides the radius of every filter.
const WIDEST: f32 = 0.04;
/// Standard deviation of the edge and point filters, degrees: half of an edge's perceived width, 0.082.
const FEATURE_DEVIATION: f32 = 0.5 * 0.082;

/// A weighted sum of blurs that are each the same in x and y and sum to 1.
pub struct Blur(Vec<(f32, Vec<f32>)>);

impl Blur {
    /// The blurred plane, `[height, width]`.
    pub fn apply(&self, plane: &[f32], height: usize, width: usize) -> Vec<f32> {
        let mut sum = vec![0.0; plane.len()];
        for (share, kernel) in &self.0 {
            let part = Separable { x: kernel, y: kernel }.apply(plane, height, width);
            sum.iter_mut().zip(part).for_each(|(sum, part)| *sum += share * part);
        }
        sum
    }
}

/// The blurs of lightness, red-green and blue-yellow for a viewer who sees so many pixels in a degree.
pub fn contrast_sensitivity(pixels_per_degree: f32) -> [Blur; 3] {
    let radius = (3.0 * (WIDEST / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as i32;
    [&LIGHTNESS[..], &RED_GREEN, &BLUE_YELLOW].map(|gaussians| blur(gaussians, radius, pixels_per_degree))
}

/// The blur of a sum of Gaussians, normalised as a whole.
fn blur(gaussians: &[Sensitivity], radius: i32, pixels_per_degree: f32) -> Blur {
    let weighted: Vec<(f32, Vec<f32>)> = gaussians
        .iter()
        .map(|Sensitivity { amplitude, width }| {
            let kernel = sampled(radius, |x| {
                let degrees = x / pixels_per_degree;
                (-PI * PI * degrees * degrees / width).exp()
            });
            let sum: f32 = kernel.iter().sum();
            let weight = amplitude * (PI / width).sqrt() * sum * sum;
            (weight, kernel.iter().map(|value| value / sum).collect())
        })
        .collect();
    let total: f32 = weighted.iter().map(|(weight, _)| weight).sum();
    Blur(weighted.into_iter().map(|(weight, kernel)| (weight / total, kernel)).collect())
}

/// Kernels that find edges and points: a Gaussian and its first two derivatives.
pub struct FeatureFilters {
    /// The Gaussian, of sum 1.
    pub smooth: Vec<f32>,
    /// First derivative; its positive weights sum to 1, its negative ones to -1.
    pub edge: Vec<f32>,
    /// Second derivative, normalised like the first.
    pub point: Vec<f32>,
}

impl FeatureFilters {
    /// The filters for a viewer who sees so many pixels in a degree.
    pub fn new(pixels_per_degree: f32) -> Self {
        let deviation = FEATURE_DEVIATION * pixels_per_degree;
        let radius = (3.0 * deviation).ceil() as i32;
        let gaussian = |x: f32| (-x * x / (2.0 * deviation * deviation)).exp();
        Self {
            smooth: balanced(sampled(radius, gaussian)),
            edge: balanced(sampled(radius, |x| -x * gaussian(x))),
            point: balanced(sampled(radius, |x| (x * x / (deviation * deviation) - 1.0) * gaussian(x))),
        }
    }
}

/// A function at the whole numbers from `-radius` to `radius`.
fn sampled(radius: i32, value: impl Fn(f32) -> f32) -> Vec<f32> {
    (-radius..=radius).map(|x| value(x as f32)).collect()
}

/// A kernel whose positive weights are scaled to sum to 1 and whose negative weights to -1.
fn balanced(mut kernel: Vec<f32>) -> Vec<f32> {
    let positive: f32 = kernel.iter().filter(|weight| **weight > 0.0).sum();
    let negative: f32 = -kernel.iter().filter(|weight| **weight < 0.0).sum::<f32>();
    for weight in &mut kernel {
        *weight /= if *weight > 0.0 { positive } else { negative.max(f32::MIN_POSITIVE) };
    }
    kernel
}

/// A filter that is the product of one in x and one in y, each of odd length.
pub struct Separable<'a> {
    /// Weights along a row.
    pub x: &'a [f32],
    /// Weights along a column.
    pub y: &'a [f32],
}

impl Separable<'_> {
    /// The filtered plane, `[height, width]`; pixels outside have the value of the nearest inside.
    pub fn apply(&self, plane: &[f32], height: usize, width: usize) -> Vec<f32> {
        let mut rows = vec![0.0; plane.len()];
        rows.par_chunks_mut(width).zip(plane.par_chunks(width)).for_each(|(out, row)| {
            let padded = padded(row, self.x.len() / 2);
            for (offset, weight) in self.x.iter().enumerate() {
                accumulate(out, *weight, &padded[offset..offset + width]);
            }
        });
        let mut result = vec![0.0; plane.len()];
        let radius = self.y.len() / 2;
        result.par_chunks_mut(width).enumerate().for_each(|(y, out)| {
            for (offset, weight) in self.y.iter().enumerate() {
                let from = (y + offset).saturating_sub(radius).min(height - 1);
                accumulate(out, *weight, &rows[from * width..(from + 1) * width]);
            }
        });
        result
    }
}

/// A row with its first and last value repeated outwards.
fn padded(row: &[f32], radius: usize) -> Vec<f32> {
    let edge = |value: Option<&f32>| vec![value.copied().unwrap_or_default(); radius];
    [edge(row.first()), row.to_vec(), edge(row.last())].concat()
}

/// Adds a multiple of a row to another.
fn accumulate(sum: &mut [f32], weight: f32, row: &[f32]) {
    sum.iter_mut().zip(row).for_each(|(sum, value)| *sum += weight * value);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_blur_keeps_a_constant_and_is_symmetric() {
        for blur in contrast_sensitivity(67.0) {
            let flat = blur.apply(&[0.5; 12 * 9], 12, 9);
            assert!(flat.iter().all(|value| (value - 0.5).abs() < 1e-6));
            assert!(blur.0.iter().all(|(_, kernel)| kernel.len() == 21));
        }
    }

    #[test]
    fn derivatives_ignore_a_constant_and_measure_a_step() {
        let filters = FeatureFilters::new(67.0);
        let plane: Vec<f32> = (0..40 * 40).map(|i| f32::from(u8::from(i % 40 >= 20))).collect();
        let edge = Separable { x: &filters.edge, y: &filters.smooth }.apply(&plane, 40, 40);
        assert!((edge[20 * 40 + 19].abs() - 1.0).abs() < 1e-5, "a whole step: {}", edge[20 * 40 + 19]);
        assert!(edge[20 * 40].abs() < 1e-6);
        let across = Separable { x: &filters.smooth, y: &filters.edge }.apply(&plane, 40, 40);
        assert!(across.iter().all(|value| value.abs() < 1e-6));
    }

    #[test]
    fn x_and_y_are_not_confused() {
        let mut plane = vec![0.0; 5 * 7];
        plane[2 * 7 + 3] = 1.0;
        let result = Separable { x: &[1.0, 0.0, 0.0], y: &[0.0, 1.0, 0.0] }.apply(&plane, 5, 7);
        assert_eq!(result.iter().position(|value| *value == 1.0), Some(2 * 7 + 4));
    }
}
