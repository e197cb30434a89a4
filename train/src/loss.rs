//! Losses: by how much an image differs from its target.
//!
//! The thesis' is structural dissimilarity over non-overlapping 8x8 tiles (7.3.3). The others came nearer to
//! truth with today's networks; others still were measured and went (the book's studies).
//!
//! SSIM (Wang et al. 2004, equation 13) with a uniform window, biased variance, `C1 = 0.01^2`, `C2 = 0.03^2`
//! and a range of 1, on raw linear output, averaged over tiles and channels; `DSSIM = (1 - SSIM) / 2`.
//!
//! Targets of few samples are noisy, and SSIM takes noise for structure: a tile's variance is that of truth
//! plus that of the noise, so that truth itself scores low, and an image of too much contrast better. Where
//! the noise's variance is known it is taken off. What is left is an estimate, itself noisy, and is kept from
//! falling below what the covariance with the prediction implies (Cauchy-Schwarz), without which SSIM could
//! exceed 1 and images of too little contrast would win. Means and covariance are left as they are: the
//! noise's mean is 0, and it has nothing to do with the prediction.
//!
//! Neither sees a tile that is a hundredth too dark throughout, which eyes do, and FLIP. The mean absolute
//! difference of tiles' means does: a tile's mean has a 64th of the noise's variance, and where truth is the
//! same in every sample, as in the open, it has none.

use burn::tensor::Tensor;
use burn::tensor::module::avg_pool2d;
use burn::tensor::ops::AvgPoolOptions;
use deepshade_shaders::similarity::{C1, C2, TILE};
use serde::{Deserialize, Serialize};

/// Which loss.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Loss {
    /// Structural dissimilarity, as in the thesis.
    #[default]
    Dssim,
    /// Structural dissimilarity plus mean squared difference; differences of more than white count as white.
    DssimL2,
    /// That, plus the mean absolute difference of tiles' means.
    DssimL2Means,
}

/// What an exposed image shows as white. Differences beyond it count as much: else the highlights of a few
/// pixels, hundreds of whites bright, ruled what is learned of all others.
const WHITE: f64 = 1.0;

/// A variance that is nothing beside [`C2`]: keeps flat tiles from dividing 0 by 0.
const FLAT: f64 = 1e-9;

impl std::fmt::Display for Loss {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Dssim => "DSSIM",
            Self::DssimL2 => "DSSIM + L2",
            Self::DssimL2Means => "DSSIM + L2 + L1 of tiles' means",
        })
    }
}

/// What predictions are held against.
#[derive(Clone, Debug)]
pub struct Target {
    /// What is wanted, maybe with noise: `[batch, channels, height, width]`.
    pub image: Tensor<4>,
    /// Variance of the noise of each value of `image`, which is independent of that of other values; 0 where
    /// there is none or it is not known. Shape of `image`.
    pub variance: Tensor<4>,
    /// 1 where the image counts, 0 elsewhere, as where no surface is seen: `[batch, 1, height, width]`.
    pub valid: Tensor<4>,
}

impl Loss {
    /// The loss of predictions, averaged over images and channels: `[1]`.
    ///
    /// Where `valid` is 0 nothing was seen: there a prediction counts as right whatever it is, and has no
    /// gradient. Tiles that are not whole do not count. The noise's variance is taken off that of the
    /// target's tiles, where it is known.
    ///
    /// # Shapes
    /// `prediction` `[batch, channels, height, width]`.
    pub fn of(self, prediction: Tensor<4>, target: Target) -> Tensor<1> {
        let Target { image, variance, valid } = target;
        let difference = (prediction - image.clone()) * valid.clone();
        // What counts as right is the target with its noise, none of which is to be taken off.
        let variance = variance * valid;
        let prediction = image.clone() + difference.clone();
        let dssim = (1.0 - ssim_tiles(prediction, image, variance.clone()).mean()) * 0.5;
        let difference = difference.clamp(-WHITE, WHITE);
        // What noise adds to it is taken off, too.
        let variance = variance.clamp_max(WHITE * WHITE);
        let l2 = || (difference.clone() * difference.clone() - variance.clone()).mean();
        match self {
            Self::Dssim => dssim,
            Self::DssimL2 => dssim + l2(),
            Self::DssimL2Means => dssim + l2() + means(difference.clone()).abs().mean(),
        }
    }
}

/// SSIM of every tile, `[batch, channels, height / 8, width / 8]`, of an image and one of which the variance
/// of its noise is known.
fn ssim_tiles(a: Tensor<4>, b: Tensor<4>, noise: Tensor<4>) -> Tensor<4> {
    let [_, _, height, width] = a.dims();
    let (height, width) = (height / TILE * TILE, width / TILE * TILE);
    let [a, b, noise] = [a, b, noise].map(|image| image.narrow(2, 0, height).narrow(3, 0, width));
    // Differences from the tile's mean, not differences of squares, which lose digits in flat tiles.
    let (mean_a, mean_b) = (means(a.clone()), means(b.clone()));
    let a = a - spread(mean_a.clone());
    let b = b - spread(mean_b.clone());
    let variance_a = means(a.clone() * a.clone());
    let covariance = means(a * b.clone());
    let variances = variance_a.clone() + variance_of_truth(b, noise, variance_a, covariance.clone());
    let product = mean_a.clone() * mean_b.clone();
    let squares = mean_a.clone() * mean_a + mean_b.clone() * mean_b;
    let luminance = (product * 2.0 + C1) / (squares + C1);
    luminance * ((covariance * 2.0 + C2) / (variances + C2))
}

/// An estimate of truth's variance in every tile from deviations `b` of a noisy target from its mean, the
/// variance of its noise, and the variance and covariance of the image that it is held against. No gradient
/// goes through it.
fn variance_of_truth(
    b: Tensor<4>,
    noise: Tensor<4>,
    variance_a: Tensor<4>,
    covariance: Tensor<4>,
) -> Tensor<4> {
    // What independent noise adds to the variance about the mean of as many values.
    let noise = means(noise) * (1.0 - 1.0 / (TILE * TILE) as f64);
    let without_noise = means(b.clone() * b) - noise;
    let covariance = covariance.detach();
    let implied = covariance.clone() * covariance / (variance_a.detach() + FLAT);
    without_noise.max_pair(implied)
}

/// Means of tiles.
fn means(x: Tensor<4>) -> Tensor<4> {
    avg_pool2d(x, AvgPoolOptions::new([TILE; 2]))
}

/// A value a tile as a value a pixel.
fn spread(tiles: Tensor<4>) -> Tensor<4> {
    let [batch, channels, rows, columns] = tiles.dims();
    tiles
        .reshape([batch, channels, rows, 1, columns, 1])
        .expand([batch, channels, rows, TILE, columns, TILE])
        .reshape([batch, channels, rows * TILE, columns * TILE])
}

#[cfg(test)]
mod tests;
