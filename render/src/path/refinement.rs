//! Images that grow: passes that go on with the sequences of the one before.

use super::estimate::{Estimate, Goal, mean_and_variance};
use super::{Integrator, Shot, integrator};
use crate::sampler::{MAX_SAMPLES, PixelSampler};
use deepshade_shaders::{Effect, Planes};
use glam::Vec3;
use rayon::prelude::*;

/// Edge of the squares of pixels that threads take, so that a thread's rays stay near each other.
const TILE: usize = 16;

/// An estimate that grows: each pass goes on with the sequences of the one before, so that passes that double
/// the samples give what as many samples at once give, and an image to look at in between.
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

/// What a [`Refinement`] has taken, to go on with another time.
#[derive(Clone, Debug)]
pub struct Taken {
    scramblings: u32,
    seed: u32,
    taken: u32,
    means: Vec<Vec3>,
}

impl Taken {
    /// Samples of a pixel, of all scramblings.
    pub const fn samples(&self) -> u32 {
        self.taken * self.scramblings
    }

    /// Bytes that it takes.
    pub const fn size(&self) -> usize {
        self.means.len() * size_of::<Vec3>()
    }
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

    /// With what another refinement of the same effect and shot has taken.
    ///
    /// # Panics
    /// If that had another size.
    pub fn going_on(effect: Effect, shot: &Shot<'a>, taken: Taken) -> Self {
        let Taken { scramblings, seed, taken, means } = taken;
        let fresh = Self::new(effect, shot, scramblings, seed);
        assert_eq!(fresh.means.len(), means.len(), "of a picture of this size");
        Self { taken, means, ..fresh }
    }

    /// What was taken so far.
    pub fn taken(&self) -> Taken {
        let Self { scramblings, seed, taken, .. } = *self;
        Taken { scramblings, seed, taken, means: self.means.clone() }
    }

    /// Samples of a pixel so far, of all scramblings.
    pub const fn samples(&self) -> u32 {
        self.taken * self.scramblings
    }

    /// Takes `count` more samples in each scrambling of the pixels (x, y) that are wanted, which are the same
    /// in every pass. Says of each square of pixels that is finished how many of them it holds.
    ///
    /// # Panics
    /// If a scrambling gets more than [`MAX_SAMPLES`].
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

    /// Passes that double the samples until there are enough: `finished` is told of each pass's samples of a
    /// pixel, and of each square of pixels that is finished how many of them it holds; `look` sees the image
    /// after each pass but the last.
    ///
    /// # Errors
    /// If `look` fails.
    pub fn reach<E>(
        &mut self,
        goal: Goal,
        wanted: impl Fn(usize, usize) -> bool + Sync,
        finished: impl Fn(u32, usize) + Sync,
        mut look: impl FnMut(&Estimate) -> Result<(), E>,
    ) -> Result<Estimate, E> {
        let each = self.scramblings;
        let most = goal.samples.div_ceil(each).max(1);
        loop {
            let count = self.taken.max(1).min(most - self.taken);
            self.refine(count, &wanted, |pixels| finished(count * each, pixels));
            let estimate = self.estimate();
            if self.taken == most || goal.is_reached(self.effect, &estimate) {
                return Ok(estimate);
            }
            look(&estimate)?;
        }
    }

    /// The image so far.
    pub fn estimate(&self) -> Estimate {
        let variance = (self.scramblings > 1).then(|| self.image(|means| mean_and_variance(means)[1]));
        Estimate { mean: self.image(|means| mean_and_variance(means)[0]), variance, samples: self.samples() }
    }

    /// The scramblings so far as two images that have nothing to do with each other: of the even ones, of the
    /// odd ones.
    pub fn halves(&self) -> [Planes; 2] {
        [0, 1].map(|first| {
            self.image(|means| {
                let half = means.iter().skip(first).step_by(2);
                half.clone().sum::<Vec3>() / half.len().max(1) as f32
            })
        })
    }

    /// An image of what each pixel's means of the scramblings come to.
    fn image(&self, value: impl Fn(&[Vec3]) -> Vec3 + Sync + Send) -> Planes {
        let pixels: Vec<Vec3> = self.means.par_chunks_exact(self.scramblings as usize).map(value).collect();
        let Shot { height, width, .. } = self.shot;
        let columns = width.div_ceil(TILE);
        Planes::from_fn(self.effect.channels(), height, width, |c, y, x| {
            let tile = y / TILE * columns + x / TILE;
            pixels[tile * TILE * TILE + y % TILE * TILE + x % TILE][c]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::proving::porch;
    use crate::path::{Sampling, render_where};
    use crate::scene::Camera;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn passes_come_to_what_all_samples_at_once_do() {
        let scene = porch();
        let camera = Camera::look_at(Vec3::new(3.0, 0.7, 0.2), Vec3::new(0.0, 0.3, 0.0));
        let shot = Shot::new(&scene, &camera, [19, 33], 2.0);
        let wanted = |x: usize, _: usize| x != 5;
        let mut refinement = Refinement::new(Effect::Ao, &shot, 8, 3);
        let pixels = AtomicUsize::new(0);
        for count in [2, 2, 4, 8] {
            // As if it had been put aside after each pass.
            refinement = Refinement::going_on(Effect::Ao, &shot, refinement.taken());
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
}
