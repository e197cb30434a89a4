//! Truth: the image that methods are measured against, with its noise as a variance and as what a perfect
//! image would score.

use super::estimate::{Estimate, Goal, SCRAMBLINGS};
use super::{Refinement, Shot};
use deepshade_shaders::{Effect, Planes};
use std::convert::Infallible;

/// An effect's truth in one shot.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// The image and its variance, from eight independent scramblings.
    pub estimate: Estimate,
    /// Means of half the scramblings each, which have nothing to do with each other. How far they agree is a
    /// lower bound of what a perfect image scores: that is measured against the mean of all, which has less
    /// noise than either.
    pub halves: [Planes; 2],
}

impl Truth {
    /// Renders truth of the pixels (x, y) that are wanted; the others are 0. Different seeds give independent
    /// images.
    pub fn render(
        effect: Effect,
        shot: &Shot<'_>,
        goal: Goal,
        seed: u32,
        wanted: impl Fn(usize, usize) -> bool + Sync,
    ) -> Self {
        let look = |_: &Estimate| Ok::<(), Infallible>(());
        let refinement = Refinement::new(effect, shot, SCRAMBLINGS, seed);
        let Ok(truth) = Self::of(refinement, goal, wanted, |_, _| {}, look);
        truth
    }

    /// Renders truth of all pixels for someone who looks on: see [`Refinement::reach`].
    ///
    /// # Errors
    /// If `look` fails.
    pub fn refine<E>(
        effect: Effect,
        shot: &Shot<'_>,
        goal: Goal,
        seed: u32,
        finished: impl Fn(u32, usize) + Sync,
        look: impl FnMut(&Estimate) -> Result<(), E>,
    ) -> Result<Self, E> {
        Self::of(Refinement::new(effect, shot, SCRAMBLINGS, seed), goal, |_, _| true, finished, look)
    }

    fn of<E>(
        mut refinement: Refinement<'_>,
        goal: Goal,
        wanted: impl Fn(usize, usize) -> bool + Sync,
        finished: impl Fn(u32, usize) + Sync,
        look: impl FnMut(&Estimate) -> Result<(), E>,
    ) -> Result<Self, E> {
        let estimate = refinement.reach(goal, wanted, finished, look)?;
        Ok(Self { estimate, halves: refinement.halves() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::proving::porch;
    use crate::scene::Camera;
    use glam::Vec3;

    fn mean_squared_difference(a: &Planes, b: &Planes) -> f64 {
        let squares = a.data().iter().zip(b.data()).map(|(a, b)| f64::from(a - b).powi(2));
        squares.sum::<f64>() / a.data().len() as f64
    }

    fn mean_variance(truth: &Truth) -> f64 {
        let variances = truth.estimate.variance.as_ref().expect("eight scramblings").data();
        variances.iter().map(|variance| f64::from(*variance)).sum::<f64>() / variances.len() as f64
    }

    #[test]
    fn halves_are_apart_as_the_variance_says_and_their_mean_is_the_image() {
        let scene = porch();
        let camera = Camera::look_at(Vec3::new(3.0, 0.7, 0.2), Vec3::new(0.0, 0.3, 0.0));
        let shot = Shot::new(&scene, &camera, [48, 64], 2.0);
        let truth = Truth::render(Effect::Ao, &shot, Goal::samples(60), 1, |_, _| true);
        assert_eq!(truth.estimate.samples, 64, "a multiple of the scramblings");
        let [a, b] = &truth.halves;
        for ((a, b), mean) in a.data().iter().zip(b.data()).zip(truth.estimate.mean.data()) {
            assert!((0.5 * (a + b) - mean).abs() < 1e-5);
        }
        // Each half has twice the variance of the image, so their difference has four times as much.
        let ratio = mean_squared_difference(a, b) / (4.0 * mean_variance(&truth));
        assert!((0.8..1.25).contains(&ratio), "{ratio}");
    }

    #[test]
    fn a_smaller_error_takes_more_samples_and_a_most_ends_it() {
        let scene = porch();
        let camera = Camera::look_at(Vec3::new(3.0, 0.7, 0.2), Vec3::new(0.0, 0.3, 0.0));
        let shot = Shot::new(&scene, &camera, [24, 24], 2.0);
        let samples = |error: f32, samples: u32| {
            let goal = Goal { samples, error: Some(error) };
            let truth = Truth::render(Effect::Ao, &shot, goal, 1, |_, _| true);
            (truth.estimate.samples, mean_variance(&truth))
        };
        let (coarse, fine) = (samples(0.02, 1 << 16), samples(0.004, 1 << 16));
        assert!(coarse.0 < fine.0 && fine.0 < 1 << 16, "{coarse:?} {fine:?}");
        assert!(coarse.1 > 4.0 * fine.1, "{coarse:?} {fine:?}");
        assert_eq!(samples(1e-6, 256).0, 256);
    }
}
