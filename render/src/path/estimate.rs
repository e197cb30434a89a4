//! Images with their variance: means of independent scramblings.
//!
//! Samples of one low-discrepancy sequence are not independent, so their own variance says nothing of their mean's.
//! Independently scrambled sequences are, and the means of `n` of them estimate the variance of their mean with `n - 1`
//! degrees of freedom (Owen 1997).

use super::{Shot, integrator, sampler::PixelSampler};
use deepshade_shaders::{Effect, Planes};
use glam::Vec3;
use rayon::prelude::*;

/// Edge of the squares of pixels that threads take, so that a thread's rays stay near each other.
const TILE: usize = 16;

/// How many samples are taken, and which.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampling {
    /// Samples of a pixel in all; rounded up to a multiple of `scramblings`.
    pub samples: u32,
    /// Independent sequences that they are split over; the variance needs at least two, and eight are good.
    pub scramblings: u32,
    /// Estimates with different seeds are independent.
    pub seed: u32,
}

/// Scramblings of an image whose variance is wanted.
pub const SCRAMBLINGS: u32 = 8;

/// An image and how sure it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// `[effect.channels(), height, width]`; the effect's background where it has one and nothing is seen.
    pub mean: Planes,
    /// Variance of each value of `mean`, estimated from the scramblings; `None` of one scrambling.
    pub variance: Option<Planes>,
    /// Samples of a pixel.
    pub samples: u32,
}

impl Sampling {
    /// All samples in one sequence: the least noise, whose size stays unknown.
    pub const fn one(samples: u32, seed: u32) -> Self {
        Self { samples, scramblings: 1, seed }
    }

    /// Samples in [`SCRAMBLINGS`] sequences.
    pub const fn scrambled(samples: u32, seed: u32) -> Self {
        Self { samples, scramblings: SCRAMBLINGS, seed }
    }
}

/// Truth of an effect.
pub fn render(effect: Effect, shot: &Shot<'_>, sampling: Sampling) -> Estimate {
    render_where(effect, shot, sampling, |_, _| true)
}

/// [`render`] for the pixels (x, y) that are wanted; the others are 0 in `mean` and `variance`.
pub fn render_where(
    effect: Effect,
    shot: &Shot<'_>,
    sampling: Sampling,
    wanted: impl Fn(usize, usize) -> bool + Sync,
) -> Estimate {
    let integrator = integrator(effect, shot);
    let (height, width) = (shot.height, shot.width);
    let scramblings = sampling.scramblings.max(1);
    let each = sampling.samples.div_ceil(scramblings).max(1);
    let pixel = |x: usize, y: usize| {
        let mean_of = |scrambling: u32| {
            let sampler = PixelSampler::new(x, y, sampling.seed).scrambled(scrambling);
            integrator.pixel(shot, x, y, sampler, each)
        };
        mean_and_variance((0..scramblings).map(mean_of))
    };
    let columns = width.div_ceil(TILE);
    let tiles: Vec<Vec<[Vec3; 2]>> = (0..columns * height.div_ceil(TILE))
        .into_par_iter()
        .map(|tile| {
            let (x0, y0) = (tile % columns * TILE, tile / columns * TILE);
            let inside = |i: usize| (x0 + i % TILE, y0 + i / TILE);
            let value = |(x, y)| {
                let known = x < width && y < height && wanted(x, y);
                if known { pixel(x, y) } else { [Vec3::ZERO; 2] }
            };
            (0..TILE * TILE).map(|i| value(inside(i))).collect()
        })
        .collect();
    let plane = |which: usize| {
        Planes::from_fn(effect.channels(), height, width, |c, y, x| {
            tiles[y / TILE * columns + x / TILE][y % TILE * TILE + x % TILE][which][c]
        })
    };
    let variance = (scramblings > 1).then(|| plane(1));
    Estimate { mean: plane(0), variance, samples: each * scramblings }
}

/// The mean of some values and the variance of that mean.
fn mean_and_variance(values: impl Iterator<Item = Vec3>) -> [Vec3; 2] {
    // Welford's update: sums of squares would lose what little the values differ by.
    let (mut count, mut mean, mut squares) = (0.0, Vec3::ZERO, Vec3::ZERO);
    for value in values {
        count += 1.0;
        let before = value - mean;
        mean += before / count;
        squares += before * (value - mean);
    }
    [mean, squares / (count * (count - 1.0f32)).max(1.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variance_of_a_mean_is_that_of_the_values_over_their_number() {
        let values = [1.0, 2.0, 3.0, 6.0].map(Vec3::splat);
        let [mean, variance] = mean_and_variance(values.into_iter());
        // Squared deviations 4 + 1 + 0 + 9, over 3 for the values' variance, over 4 for the mean's.
        assert!((mean.x - 3.0).abs() < 1e-6 && (variance.x - 14.0 / 12.0).abs() < 1e-6);
        let [mean, variance] = mean_and_variance(std::iter::once(Vec3::ONE));
        assert_eq!((mean, variance), (Vec3::ONE, Vec3::ZERO));
    }
}
