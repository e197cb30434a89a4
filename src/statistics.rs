//! Means with confidence intervals. Frames of a scene resemble each other, so scenes, not frames, are what is
//! drawn: the interval is a bootstrap over scene means (Efron 1979).

use deepshade_shaders::split_mix::{STEP, finalised};
use std::collections::BTreeMap;

/// A mean and the interval that holds it with 95 % confidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanInterval {
    /// Mean over scenes.
    pub mean: f64,
    /// 2.5th percentile of the resampled means.
    pub low: f64,
    /// 97.5th percentile.
    pub high: f64,
}

impl std::fmt::Display for MeanInterval {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:.3} [{:.3}, {:.3}]", self.mean, self.low, self.high)
    }
}

/// Times that the scenes are drawn anew.
const RESAMPLES: usize = 2000;

/// The mean over scenes of the mean over each scene's frames, with its interval. `values` are (scene, value)
/// pairs.
///
/// # Panics
/// If there is no value.
pub fn estimate(values: &[(usize, f64)]) -> MeanInterval {
    let means: Vec<f64> = scene_means(values).into_values().collect();
    assert!(!means.is_empty(), "at least one value");
    let mut resampled: Vec<f64> =
        (0..RESAMPLES as u64).map(|resample| resampled_mean(&means, resample)).collect();
    resampled.sort_by(f64::total_cmp);
    let percentile = |share: f64| resampled[(share * (RESAMPLES - 1) as f64).round() as usize];
    MeanInterval { mean: mean(&means), low: percentile(0.025), high: percentile(0.975) }
}

/// The estimate of what one series is above another, frame by frame: what makes a scene hard for both does
/// not widen the interval. None where they are not of the same frames, or of none.
pub fn paired(values: &[(usize, f64)], others: &[(usize, f64)]) -> Option<MeanInterval> {
    let scenes = |values: &[(usize, f64)]| values.iter().map(|(scene, _)| *scene).collect::<Vec<_>>();
    let same = !values.is_empty() && scenes(values) == scenes(others);
    let difference = |((scene, value), (_, other)): (&(usize, f64), &(usize, f64))| (*scene, value - other);
    same.then(|| estimate(&values.iter().zip(others).map(difference).collect::<Vec<_>>()))
}

/// The mean of each scene's values.
pub fn scene_means(values: &[(usize, f64)]) -> BTreeMap<usize, f64> {
    let mut sums = BTreeMap::<usize, (f64, f64)>::new();
    for (scene, value) in values {
        let sum = sums.entry(*scene).or_default();
        *sum = (sum.0 + value, sum.1 + 1.0);
    }
    sums.into_iter().map(|(scene, (sum, count))| (scene, sum / count)).collect()
}

/// The mean of as many scenes as there are, each drawn at random.
fn resampled_mean(means: &[f64], resample: u64) -> f64 {
    let draw =
        |i: u64| means[(finalised((resample << 32 | i).wrapping_add(STEP)) % means.len() as u64) as usize];
    (0..means.len() as u64).map(draw).sum::<f64>() / means.len() as f64
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_weigh_alike_however_many_frames_they_have() {
        let estimate = estimate(&[(0, 0.0), (0, 0.0), (0, 0.0), (1, 1.0)]);
        assert_eq!(estimate.mean, 0.5);
    }

    #[test]
    fn the_interval_is_that_of_the_mean() {
        // 100 scenes alternating 0 and 1: the mean's standard deviation is 0.05.
        let values: Vec<(usize, f64)> = (0..100).map(|scene| (scene, (scene % 2) as f64)).collect();
        let estimate = estimate(&values);
        assert!((estimate.low - (0.5 - 0.098)).abs() < 0.02, "{estimate}");
        assert!((estimate.high - (0.5 + 0.098)).abs() < 0.02, "{estimate}");
    }

    #[test]
    fn differences_are_of_the_same_frames() {
        // Two frames of scene 0 differ by 0.1 and 0.3, the one of scene 4 by -0.4.
        let own = [(0, 0.5), (0, 0.9), (4, 0.1)];
        let other = [(0, 0.4), (0, 0.6), (4, 0.5)];
        let difference = paired(&own, &other).expect("the same frames");
        assert!((difference.mean + 0.1).abs() < 1e-12, "{difference}");
        assert!(
            (difference.low + 0.4).abs() < 1e-12 && (difference.high - 0.2).abs() < 1e-12,
            "{difference}"
        );
        assert_eq!(paired(&own, &other[..2]), None);
        assert_eq!(paired(&own, &[(0, 0.4), (4, 0.6), (4, 0.5)]), None, "frames of other scenes");
        assert_eq!(paired(&[], &[]), None);
    }

    #[test]
    fn what_makes_scenes_hard_for_both_does_not_widen_the_interval() {
        let own: Vec<(usize, f64)> = (0..40).map(|scene| (scene, 0.02 * scene as f64)).collect();
        let other: Vec<(usize, f64)> = own.iter().map(|(scene, value)| (*scene, value - 0.01)).collect();
        let difference = paired(&own, &other).expect("the same frames");
        assert!(difference.low > 0.0099 && difference.high < 0.0101, "{difference}");
        assert!(estimate(&own).low < estimate(&other).high, "which intervals of their own do not tell");
        let none = paired(&own, &own).expect("the same frames");
        assert_eq!((none.low, none.mean, none.high), (0.0, 0.0, 0.0));
    }

    #[test]
    fn one_scene_has_no_spread() {
        let estimate = estimate(&[(3, 0.25)]);
        assert_eq!((estimate.low, estimate.high), (0.25, 0.25));
    }
}
