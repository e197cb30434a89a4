//! Relative mean squared error, the usual measure of Monte Carlo images (Rousselle, Knaus and Zwicker 2011).

use super::mean_over_values;
use deepshade_shaders::Planes;

/// Added to the squared truth, so that dark pixels do not weigh without bound (Rousselle et al. 2011, section
/// 4).
pub const EPSILON: f64 = 0.01;

/// Mean of `(image - truth)^2 / (truth^2 + EPSILON)` over all values. Not symmetric: the second image is the
/// truth.
///
/// # Panics
/// If the images differ in shape.
pub fn relative_mse(image: &Planes, truth: &Planes) -> f64 {
    mean_over_values(image, truth, |image, truth| (image - truth).powi(2) / (truth * truth + EPSILON))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_relative_to_truth() {
        let truth = Planes::from_data(1, 1, 2, vec![0.0, 0.5]);
        let image = Planes::from_data(1, 1, 2, vec![0.25, 0.25]);
        let expected = 0.5 * (0.0625 / EPSILON + 0.0625 / (0.25 + EPSILON));
        assert!((relative_mse(&image, &truth) - expected).abs() < 1e-12);
        assert!((relative_mse(&truth, &image) - expected).abs() > 0.1);
    }
}
