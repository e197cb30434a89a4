//! How fast errors fall with the number of samples.

use super::comparison::Comparison;

/// Samples that means are of.
const SAMPLES: [u32; 5] = [16, 64, 256, 1024, 4096];
/// Independent sequences, in groups each of which a slope is fitted to.
const REPLICATES: u32 = 16;
const GROUPS: u32 = 8;
/// Of random numbers.
const SLOWEST: f64 = -0.5;

/// Asserts that errors fall at least as fast as one over the root of the number of samples, within three
/// standard errors of the fitted slope, and that this is not so against a truth that is 2 % brighter. `mean`
/// is that of so many samples of an independent sequence.
pub fn prove_slope(name: &str, truth: f64, mean: impl Fn(u32, u32) -> f32) {
    let means: Vec<[f64; SAMPLES.len()]> = (0..GROUPS * REPLICATES)
        .map(|replicate| SAMPLES.map(|samples| f64::from(mean(replicate, samples))))
        .collect();
    for (truth, control) in [(truth, false), (1.02 * truth, true)] {
        let slopes: Vec<f64> = means.chunks(REPLICATES as usize).map(|group| fitted(group, truth)).collect();
        let count = slopes.len() as f64;
        let value = slopes.iter().sum::<f64>() / count;
        let squares: f64 = slopes.iter().map(|slope| (slope - value).powi(2)).sum();
        let error = (squares / (count * (count - 1.0))).sqrt();
        let within = value <= SLOWEST + 3.0 * error;
        Comparison { name, value, expected: SLOWEST, standard_error: Some(error), within, control }
            .record_and_assert();
    }
}

/// Exponent of the number of samples in the error of a group's means.
fn fitted(group: &[[f64; SAMPLES.len()]], truth: f64) -> f64 {
    let error = |i: usize| {
        let squares = group.iter().map(|means| (means[i] - truth).powi(2));
        (squares.sum::<f64>() / group.len() as f64).sqrt()
    };
    let points = SAMPLES.iter().enumerate().map(|(i, samples)| (f64::from(*samples).ln(), error(i).ln()));
    least_squares(&points.collect::<Vec<_>>())
}

/// Slope of the line through points (x, y) of least squares.
pub fn least_squares(points: &[(f64, f64)]) -> f64 {
    let count = points.len() as f64;
    let [x, y] =
        [points.iter().map(|p| p.0).sum::<f64>() / count, points.iter().map(|p| p.1).sum::<f64>() / count];
    let across: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    across / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}
