//! Images with their variance: means of independent scramblings.
//!
//! Samples of one low-discrepancy sequence are not independent, so their own variance says nothing of their mean's.
//! Independently scrambled sequences are, and the means of `n` of them estimate the variance of their mean with `n - 1`
//! degrees of freedom (Owen 1997).

use super::sampler::{MAX_SAMPLES, PixelSampler};
use super::{Integrator, Shot, integrator};
use crate::metrics::relative_mse::EPSILON;
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

impl Estimate {
    /// Mean square of the image's own error, relative to its squared values as [`relative_mse`] is to truth's; `None`
    /// of one scrambling.
    ///
    /// [`relative_mse`]: crate::metrics::relative_mse()
    pub fn noise_relmse(&self) -> Option<f64> {
        let variance = self.variance.as_ref()?;
        let pairs = variance.data().iter().zip(self.mean.data());
        let relative =
            pairs.map(|(variance, mean)| f64::from(*variance) / (f64::from(*mean).powi(2) + EPSILON));
        Some(relative.sum::<f64>() / variance.data().len() as f64)
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

/// An estimate that grows: each pass goes on with the sequences of the one before, so that passes that double the
/// samples give what as many samples at once give, and an image to look at in between.
pub struct Refinement<'a> {
    effect: Effect,
    shot: Shot<'a>,
    integrator: Box<dyn Integrator + 'a>,
    scramblings: u32,
    seed: u32,
    /// Samples of a pixel in each scrambling.
    taken: u32,
    /// Means of the scramblings of each pixel, pixel by pixel, square of pixels by square.
    means: Vec<Vec3>,
}

impl<'a> Refinement<'a> {
    /// No samples yet.
    pub fn new(effect: Effect, shot: &Shot<'a>, scramblings: u32, seed: u32) -> Self {
        let scramblings = scramblings.max(1);
        let pixels = shot.width.div_ceil(TILE) * shot.height.div_ceil(TILE) * TILE * TILE;
        Self {
            effect,
            shot: *shot,
            integrator: integrator(effect, shot),
            scramblings,
            seed,
            taken: 0,
            means: vec![Vec3::ZERO; pixels * scramblings as usize],
        }
    }

    /// Samples of a pixel so far, of all scramblings.
    pub const fn samples(&self) -> u32 {
        self.taken * self.scramblings
    }

    /// Takes `count` more samples in each scrambling of the pixels (x, y) that are wanted, which are the same in every
    /// pass. Says of each square of pixels that is finished how many of them it holds.
    ///
    /// # Panics
    /// If a scrambling gets more than [`MAX_SAMPLES`](super::sampler::MAX_SAMPLES).
    pub fn refine(
        &mut self,
        count: u32,
        wanted: impl Fn(usize, usize) -> bool + Sync,
        finished: impl Fn(usize) + Sync,
    ) {
        assert!(self.taken + count <= MAX_SAMPLES, "no more samples than the sequence has");
        let Self { shot, integrator, scramblings, seed, taken, .. } = self;
        let (height, width, each) = (shot.height, shot.width, *scramblings as usize);
        let columns = width.div_ceil(TILE);
        let share = count as f32 / (*taken + count) as f32;
        self.means.par_chunks_mut(TILE * TILE * each).enumerate().for_each(|(tile, means)| {
            let (x0, y0) = (tile % columns * TILE, tile / columns * TILE);
            let mut inside = 0;
            for (i, means) in means.chunks_exact_mut(each).enumerate() {
                let (x, y) = (x0 + i % TILE, y0 + i / TILE);
                if x >= width || y >= height {
                    continue;
                }
                inside += 1;
                if !wanted(x, y) {
                    continue;
                }
                for (scrambling, mean) in means.iter_mut().enumerate() {
                    let sampler =
                        PixelSampler::new(x, y, *seed).scrambled(scrambling as u32).starting_at(*taken);
                    let new = integrator.pixel(shot, x, y, sampler, count);
                    *mean = if *taken == 0 { new } else { *mean + (new - *mean) * share };
                }
            }
            finished(inside);
        });
        self.taken += count;
    }

    /// The image so far.
    pub fn estimate(&self) -> Estimate {
        let each = self.scramblings as usize;
        let pixels: Vec<[Vec3; 2]> =
            self.means.par_chunks_exact(each).map(|means| mean_and_variance(means.iter().copied())).collect();
        let Shot { height, width, .. } = self.shot;
        let columns = width.div_ceil(TILE);
        let plane = |which: usize| {
            Planes::from_fn(self.effect.channels(), height, width, |c, y, x| {
                let tile = y / TILE * columns + x / TILE;
                pixels[tile * TILE * TILE + y % TILE * TILE + x % TILE][which][c]
            })
        };
        let variance = (self.scramblings > 1).then(|| plane(1));
        Estimate { mean: plane(0), variance, samples: self.samples() }
    }
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
    use crate::bvh::TracedScene;
    use crate::metrics::relative_mse;
    use crate::scene::{Camera, Material, Mesh, Scene};
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// A floor under a roof with an edge, from the side.
    fn porch() -> TracedScene {
        let square = |y: f32, x: f32| Mesh {
            positions: [(-9., -9.), (-9., 9.), (x, 9.), (x, -9.)].map(|(x, z)| Vec3::new(x, y, z)).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        let scene = Scene {
            meshes: vec![square(0.0, 9.0), square(1.0, 0.0)],
            materials: vec![Material::default()],
            ..Scene::default()
        };
        TracedScene::new(scene).expect("two squares")
    }

    #[test]
    fn passes_come_to_what_all_samples_at_once_do() {
        let scene = porch();
        let camera = Camera::look_at(Vec3::new(3.0, 0.7, 0.2), Vec3::new(0.0, 0.3, 0.0));
        let shot = Shot::new(&scene, &camera, [19, 33], 2.0);
        let wanted = |x: usize, _: usize| x != 5;
        let mut refinement = Refinement::new(Effect::Ao, &shot, 8, 3);
        let pixels = AtomicUsize::new(0);
        for count in [2, 2, 4, 8] {
            refinement.refine(count, wanted, |finished| {
                pixels.fetch_add(finished, Ordering::Relaxed);
            });
        }
        assert_eq!(pixels.into_inner(), 4 * 19 * 33);
        let passes = refinement.estimate();
        let at_once = render_where(Effect::Ao, &shot, Sampling::scrambled(128, 3), wanted);
        assert_eq!((passes.samples, at_once.samples), (128, 128));
        let close = |a: &Planes, b: &Planes| a.data().iter().zip(b.data()).all(|(a, b)| (a - b).abs() < 1e-5);
        assert!(close(&passes.mean, &at_once.mean));
        let variances = [&passes, &at_once].map(|estimate| estimate.variance.as_ref().expect("scramblings"));
        assert!(close(variances[0], variances[1]));
        assert!((0..19).all(|y| passes.mean.at(0, y, 5) == 0.0), "not wanted");
        // Other samples come to something else.
        let other = render_where(Effect::Ao, &shot, Sampling::scrambled(128, 4), wanted);
        assert!(!close(&passes.mean, &other.mean));
    }

    #[test]
    fn the_stated_noise_is_the_distance_to_truth() {
        let scene = porch();
        let camera = Camera::look_at(Vec3::new(3.0, 0.7, 0.2), Vec3::new(0.0, 0.3, 0.0));
        let shot = Shot::new(&scene, &camera, [24, 32], 2.0);
        let truth = render(Effect::Ao, &shot, Sampling::one(4096, 9)).mean;
        let noisy = render(Effect::Ao, &shot, Sampling::scrambled(32, 1));
        let (stated, found) = (noisy.noise_relmse().expect("scramblings"), relative_mse(&noisy.mean, &truth));
        assert!((0.7..1.4).contains(&(stated / found)), "{stated} is not {found}");
        assert_eq!(render(Effect::Ao, &shot, Sampling::one(32, 1)).noise_relmse(), None);
    }

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
