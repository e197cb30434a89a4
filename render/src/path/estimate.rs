//! Images with their variance: means of independent scramblings.
//!
//! Samples of one low-discrepancy sequence are not independent, so their own variance says nothing of their
//! mean's. Independently scrambled sequences are, and the means of `n` of them estimate the variance of their
//! mean with `n - 1` degrees of freedom (Owen 1997).

use super::{Refinement, Shot};
use crate::metrics::{self, relative_mse::EPSILON};
use deepshade_shaders::{Effect, Planes};
use glam::Vec3;

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

impl Estimate {
    /// Mean square of the image's own error, relative to its squared values as [`relative_mse`] is to
    /// truth's, under an [exposure]; `None` of one scrambling, NaN where a value is no number.
    ///
    /// [`relative_mse`]: crate::metrics::relative_mse()
    /// [exposure]: crate::metrics::exposure()
    pub fn noise_relmse(&self, exposure: f32) -> Option<f64> {
        let variance = self.variance.as_ref()?;
        let scale = f64::from(exposure).powi(2);
        let pairs = variance.data().iter().zip(self.mean.data());
        let relative = pairs.map(|(variance, mean)| {
            scale * f64::from(*variance) / (scale * f64::from(*mean).powi(2) + EPSILON)
        });
        Some(relative.sum::<f64>() / variance.data().len() as f64)
    }

    /// The mean of independent images of one shape, made of so many samples of a pixel in all, and its
    /// variance where there are several.
    ///
    /// # Panics
    /// If there is no image, or they differ in shape.
    pub fn of(images: &[Planes], samples: u32) -> Self {
        let first = images.first().expect("an image");
        assert!(images.iter().all(|image| image.same_shape(first)), "images of one shape");
        let at = |i: usize| images.iter().map(|image| Vec3::splat(image.data()[i])).collect::<Vec<_>>();
        let values: Vec<[Vec3; 2]> = (0..first.data().len()).map(|i| mean_and_variance(&at(i))).collect();
        let image = |which: usize| {
            let data = values.iter().map(|value| value[which].x).collect();
            Planes::from_data(first.channels(), first.height(), first.width(), data)
        };
        Self { mean: image(0), variance: (images.len() > 1).then(|| image(1)), samples }
    }
}

/// When an image has samples enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Samples of a pixel, rounded up to a multiple of [`SCRAMBLINGS`]; with `error` the most.
    pub samples: u32,
    /// Noise, as the square root of [`Estimate::noise_relmse`], below which no more samples are taken.
    pub error: Option<f32>,
}

/// Samples of a pixel and scrambling before the noise's estimate is believed.
const LEAST_FOR_AN_ERROR: u32 = 16;

impl Goal {
    /// So many samples.
    pub const fn samples(samples: u32) -> Self {
        Self { samples, error: None }
    }

    /// Whether an image is good enough. One in which no light has arrived yet says nothing of its noise.
    pub(super) fn is_reached(&self, effect: Effect, estimate: &Estimate) -> bool {
        let Some(error) = self.error else { return false };
        let lit = estimate.mean.data().iter().any(|value| *value > 0.0);
        let noise = estimate.noise_relmse(metrics::exposure(effect, &estimate.mean));
        lit && estimate.samples >= LEAST_FOR_AN_ERROR * SCRAMBLINGS
            && noise.is_some_and(|noise| noise.sqrt() <= f64::from(error))
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
    let mut refinement = Refinement::new(effect, shot, sampling.scramblings, sampling.seed);
    refinement.refine(sampling.samples.div_ceil(sampling.scramblings.max(1)).max(1), wanted, |_| {});
    refinement.estimate()
}

/// The mean of some values and the variance of that mean.
pub(super) fn mean_and_variance(values: &[Vec3]) -> [Vec3; 2] {
    // Welford's update: sums of squares would lose what little the values differ by.
    let (mut count, mut mean, mut squares) = (0.0, Vec3::ZERO, Vec3::ZERO);
    for &value in values {
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
    use crate::metrics::relative_mse;
    use crate::path::proving::porch;
    use crate::scene::Camera;

    #[test]
    fn the_stated_noise_is_the_distance_to_truth() {
        let scene = porch();
        let camera = Camera::look_at(Vec3::new(3.0, 0.7, 0.2), Vec3::new(0.0, 0.3, 0.0));
        let shot = Shot::new(&scene, &camera, [24, 32], 2.0);
        let truth = render(Effect::Ao, &shot, Sampling::one(4096, 9)).mean;
        let noisy = render(Effect::Ao, &shot, Sampling::scrambled(32, 1));
        let (stated, found) =
            (noisy.noise_relmse(1.0).expect("scramblings"), relative_mse(&noisy.mean, &truth));
        assert!((0.7..1.4).contains(&(stated / found)), "{stated} is not {found}");
        assert_eq!(render(Effect::Ao, &shot, Sampling::one(32, 1)).noise_relmse(1.0), None);
    }

    #[test]
    fn independent_images_come_to_their_mean_and_its_variance() {
        let images = [1.0, 3.0].map(|value| Planes::filled(1, 1, 2, value));
        let estimate = Estimate::of(&images, 2);
        // Squared deviations 1 + 1, over 1 for the images' variance, over 2 for the mean's.
        assert_eq!(estimate.mean.data(), [2.0; 2]);
        assert_eq!(estimate.variance.expect("two images").data(), [1.0; 2]);
        assert_eq!(Estimate::of(&images[..1], 1).variance, None);
    }

    #[test]
    fn variance_of_a_mean_is_that_of_the_values_over_their_number() {
        let values = [1.0, 2.0, 3.0, 6.0].map(Vec3::splat);
        let [mean, variance] = mean_and_variance(&values);
        // Squared deviations 4 + 1 + 0 + 9, over 3 for the values' variance, over 4 for the mean's.
        assert!((mean.x - 3.0).abs() < 1e-6 && (variance.x - 14.0 / 12.0).abs() < 1e-6);
        let [mean, variance] = mean_and_variance(&[Vec3::ONE]);
        assert_eq!((mean, variance), (Vec3::ONE, Vec3::ZERO));
    }
}
