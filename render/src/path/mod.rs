//! Truth: path-traced effects, one integrator a file, and what they share.
//!
//! An [`Integrator`] gives one sample of an effect at a point of the image; [`render`] takes as many as are
//! wanted of every pixel, in independent scramblings, so that an image comes with the variance of its values.
//! Which integrator belongs to which effect says [`integrator`], the one list to add an effect's truth to.

pub mod aa;
pub mod ao;
pub mod appearance;
pub mod at_surface;
pub mod bsdf;
#[cfg(test)]
pub(crate) mod chi_square;
pub mod direct;
pub mod directional;
pub mod dof;
pub mod estimate;
#[cfg(test)]
mod far_room;
pub mod fog;
pub mod full;
pub mod gi;
pub mod ibl;
pub mod light_part;
pub mod lights;
pub mod medium;
pub mod motion_blur;
pub mod multi;
pub mod phosphor;
#[cfg(test)]
pub(crate) mod proving;
pub mod refinement;
pub mod route;
pub mod sss;
pub mod subsurface;
pub mod transport;
pub mod truth;
pub mod vertex;

pub use aa::AntiAliasing;
pub use ao::Ao;
pub use at_surface::AtSurface;
pub use directional::Directional;
pub use dof::DepthOfField;
pub use estimate::{Estimate, Goal, Sampling, render, render_where};
pub use full::FullPath;
pub use gi::{Gi, Receiver};
pub use ibl::Ibl;
pub use light_part::LightPart;
pub use motion_blur::MotionBlur;
pub use multi::Multi;
use phosphor::KeptLight;
pub use phosphor::Phosphor;
pub use refinement::{Refinement, Taken};
pub use sss::ScreenSpaceScattering;
pub use subsurface::Subsurface;
pub use truth::Truth;

use crate::bvh::TracedScene;
use crate::sampler::{PixelSampler, Stream};
use crate::scene::Camera;
use deepshade_shaders::Effect;
use glam::{DVec3, Vec2, Vec3};

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
    /// Which light; a part that the effect has, see [`LightPart::is_of`].
    pub part: LightPart,
}

impl<'a> Shot<'a> {
    /// A picture of `size` rows and columns that shows what the g-buffer shows.
    pub const fn new(
        scene: &'a TracedScene,
        camera: &'a Camera,
        [height, width]: [usize; 2],
        radius: f32,
    ) -> Self {
        Self { scene, camera, height, width, radius, footprint: Footprint::Middle, part: LightPart::All }
    }
}

/// Where in a pixel samples of truth are. Effects that average over the pixel by their definition do so
/// either way.
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
    /// One unbiased sample of the effect at a point of the image, in pixels from the top left corner;
    /// channels beyond the effect's are not used.
    fn sample(&self, at: Vec2, stream: &mut Stream) -> Vec3;

    /// Mean of a pixel's samples `0..count` of one sequence. Integrators that trace many rays at once
    /// override this.
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
    mean_of(count, sample)
}

/// Mean of samples, summed in f64: in f32, the sum of thousands that are alike is off by some 1e-5 of it.
fn mean_of(count: u32, sample: impl Fn(u32) -> Vec3) -> Vec3 {
    let sum: DVec3 = (0..count).map(|index| sample(index).as_dvec3()).sum();
    (sum / f64::from(count)).as_vec3()
}

/// The integrator of an effect's truth.
pub fn integrator<'a>(effect: Effect, shot: &Shot<'a>) -> Box<dyn Integrator + 'a> {
    match effect {
        Effect::Ao => Box::new(AtSurface::new(shot, Ao::new(shot))),
        Effect::Do => Box::new(AtSurface::new(shot, Directional::new(shot))),
        Effect::Glossy => Box::new(AtSurface::new(shot, Gi::new(shot, Receiver::Glossy))),
        Effect::Gi => Box::new(AtSurface::new(shot, Gi::new(shot, Receiver::Diffuse))),
        Effect::Ibl => Box::new(AtSurface::new(shot, Ibl::unoccluded(shot))),
        Effect::OccludedIbl => Box::new(AtSurface::new(shot, Ibl::occluded(shot))),
        Effect::Sss => Box::new(ScreenSpaceScattering::new(shot)),
        Effect::Subsurface => Box::new(Subsurface::new(shot)),
        Effect::Dof => Box::new(DepthOfField::new(shot)),
        Effect::MotionBlur => Box::new(MotionBlur::new(shot)),
        Effect::Aa => Box::new(AntiAliasing::new(shot)),
        Effect::Multi => Box::new(Multi::new(shot)),
        Effect::FogDirect => Box::new(fog::direct(shot)),
        Effect::FogIndirect => Box::new(fog::indirect(shot)),
        Effect::FogMultiple => Box::new(fog::multiple(shot)),
        Effect::Phosphor => Box::new(Phosphor::new(shot)),
        Effect::PhosphorGi => Box::new(AtSurface::new(shot, KeptLight::new(shot))),
        Effect::Path | Effect::Real => Box::new(FullPath::new(shot)),
    }
}
