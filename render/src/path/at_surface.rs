//! Effects that depend on nothing but the surface that a point of the image shows, so that its samples share
//! it.

use super::appearance::seen;
use super::{Footprint, Integrator, Shot, mean_of};
use crate::intersection::SurfacePoint;
use crate::sampler::{PixelSampler, Stream};
use glam::{Vec2, Vec3};

/// A surface that the camera sees.
#[derive(Clone, Copy, Debug)]
pub struct Visible {
    /// Where.
    pub point: SurfacePoint,
    /// Unit direction to the camera.
    pub to_viewer: Vec3,
}

impl Visible {
    /// What a pinhole camera sees at a point of the image.
    pub fn at(shot: &Shot<'_>, at: Vec2) -> Option<Self> {
        let direction = shot.camera.direction(at, shot.height, shot.width);
        let point = seen(shot.scene, shot.camera.position, direction)?;
        Some(Self { point, to_viewer: -direction })
    }
}

/// An effect at a surface.
pub trait SurfaceEffect: Sync {
    /// Its value where no surface is seen.
    const BACKGROUND: Vec3 = Vec3::ZERO;

    /// One unbiased sample.
    fn sample(&self, visible: &Visible, stream: &mut Stream) -> Vec3;

    /// Mean of the samples `0..count` of one sequence. Effects that trace many rays at once override this.
    fn mean(&self, visible: &Visible, sampler: PixelSampler, count: u32) -> Vec3 {
        mean_of(count, |i| self.sample(visible, &mut Stream::new(sampler, i)))
    }
}

/// The integrator of such an effect.
#[derive(Clone, Copy, Debug)]
pub struct AtSurface<'a, E> {
    shot: Shot<'a>,
    effect: E,
}

impl<'a, E: SurfaceEffect> AtSurface<'a, E> {
    /// The effect wherever the shot shows a surface.
    pub const fn new(shot: &Shot<'a>, effect: E) -> Self {
        Self { shot: *shot, effect }
    }
}

impl<E: SurfaceEffect> Integrator for AtSurface<'_, E> {
    fn sample(&self, at: Vec2, stream: &mut Stream) -> Vec3 {
        Visible::at(&self.shot, at).map_or(E::BACKGROUND, |visible| self.effect.sample(&visible, stream))
    }

    /// A pixel's middle shows the same surface to all samples.
    fn pixel(&self, shot: &Shot<'_>, x: usize, y: usize, sampler: PixelSampler, count: u32) -> Vec3 {
        if shot.footprint == Footprint::Box {
            return super::mean_of_samples(self, shot, x, y, sampler, count);
        }
        let visible = Visible::at(&self.shot, Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
        visible.map_or(E::BACKGROUND, |visible| self.effect.mean(&visible, sampler, count))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::proving::{floor, traced};
    use crate::scene::{Camera, Material};

    /// The height of a random point above the one that is seen, and the direction to the viewer.
    struct Looked;

    impl SurfaceEffect for Looked {
        fn sample(&self, visible: &Visible, stream: &mut Stream) -> Vec3 {
            Vec3::new(visible.point.position.y + stream.next_1d(), visible.to_viewer.y, 1.0)
        }
    }

    #[test]
    fn pixels_are_means_of_their_samples() {
        let scene = traced(vec![floor()], Material::default());
        let camera = Camera::look_at(Vec3::new(0.5, 1.0, 2.0), Vec3::ZERO);
        let shot = Shot::new(&scene, &camera, [9, 11], 1.0);
        let integrator = AtSurface::new(&shot, Looked);
        let sampler = PixelSampler::new(5, 6, 1);
        let together = integrator.pixel(&shot, 5, 6, sampler, 32);
        let apart = super::super::mean_of_samples(&integrator, &shot, 5, 6, sampler, 32);
        assert!((together - apart).length() < 1e-6 && together.z == 1.0);
        let up = Camera::look_at(Vec3::Y, Vec3::new(0.0, 2.0, 0.1));
        let shot = Shot::new(&scene, &up, [9, 11], 1.0);
        assert_eq!(AtSurface::new(&shot, Looked).pixel(&shot, 5, 6, sampler, 32), Vec3::ZERO);
    }
}
