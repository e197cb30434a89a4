//! Truth: path-traced effects, one integrator a file, and what they share.
//!
//! An [`Integrator`] gives one sample of an effect at a point of the image; [`render`] takes as many as are wanted of
//! every pixel, in independent scramblings, so that an image comes with the variance of its values. Which integrator
//! belongs to which effect says [`integrator`], the one list to add an effect's truth to.

pub mod ao;
pub mod bsdf;
pub mod direct;
pub mod estimate;
pub mod lights;
pub mod sampler;

pub use ao::Ao;
pub use estimate::{Estimate, Sampling, render, render_where};

use crate::bvh::TracedScene;
use crate::scene::Camera;
use deepshade_shaders::Effect;
use glam::{Vec2, Vec3};
use sampler::{PixelSampler, Stream};

/// A picture to be taken.
#[derive(Clone, Copy, Debug)]
pub struct Shot<'a> {
    /// Of what.
    pub scene: &'a TracedScene,
    /// From where, through which lens.
    pub camera: &'a Camera,
    /// Rows.
    pub height: usize,
    /// Columns.
    pub width: usize,
    /// How far effects with a radius reach, metres; infinite for no limit.
    pub radius: f32,
    /// Where in a pixel samples are.
    pub footprint: Footprint,
}

impl<'a> Shot<'a> {
    /// A picture of `size` rows and columns that shows what the g-buffer shows.
    pub const fn new(
        scene: &'a TracedScene,
        camera: &'a Camera,
        [height, width]: [usize; 2],
        radius: f32,
    ) -> Self {
        Self { scene, camera, height, width, radius, footprint: Footprint::Middle }
    }
}

/// Where in a pixel samples of truth are. Effects that average over the pixel by their definition do so either way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Footprint {
    /// In its middle, which the g-buffer shows.
    #[default]
    Middle,
    /// Anywhere in it alike, as other renderers do with a box filter.
    Box,
}

/// One effect's truth in one shot.
pub trait Integrator: Sync {
    /// One unbiased sample of the effect at a point of the image, in pixels from the top left corner; channels beyond
    /// the effect's are not used.
    fn sample(&self, at: Vec2, stream: &mut Stream) -> Vec3;

    /// Mean of a pixel's samples `0..count` of one sequence. Integrators that trace many rays at once override this.
    fn pixel(&self, shot: &Shot<'_>, x: usize, y: usize, sampler: PixelSampler, count: u32) -> Vec3 {
        mean_of_samples(self, shot, x, y, sampler, count)
    }
}

/// Mean of a pixel's samples `0..count` of one sequence, each by itself.
fn mean_of_samples<I: Integrator + ?Sized>(
    integrator: &I,
    shot: &Shot<'_>,
    x: usize,
    y: usize,
    sampler: PixelSampler,
    count: u32,
) -> Vec3 {
    let sample = |sample: u32| {
        let mut stream = Stream::new(sampler, sample);
        let inside = match shot.footprint {
            Footprint::Middle => Vec2::splat(0.5),
            Footprint::Box => stream.next_2d(),
        };
        integrator.sample(Vec2::new(x as f32, y as f32) + inside, &mut stream)
    };
    (0..count).map(sample).sum::<Vec3>() / count as f32
}

/// The integrator of an effect's truth.
pub fn integrator<'a>(effect: Effect, shot: &Shot<'a>) -> Box<dyn Integrator + 'a> {
    match effect {
        Effect::Ao => Box::new(Ao::new(shot)),
        _ => unimplemented!("CONTRACT: each helper adds its line"),
    }
}
